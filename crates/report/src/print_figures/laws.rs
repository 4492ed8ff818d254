//! Parameters against what they follow: the laws that hold across runs, and parameters over the life of samples.

use super::FigureInput;
use super::grid::{Panel, grid};
use crate::blocks::chart;
use crate::figures::canvas::Drawing;
use crate::figures::law::LawFigure;
use crate::pages::{humidity, law_cards};
use ieap_analysis::ParameterInfo;
use ieap_analysis::laws::words;
use ieap_analysis::monitoring::view::printed;
use ieap_analysis::parameters::begins_key;
use ieap_show::Chart;

/// Height of a panel, px.
const HEIGHT: u32 = 190;
/// Panels drawn where no parameter is asked for.
const MOST: usize = 8;
/// Panels that stand beside each other.
const COLUMNS: usize = 2;

/// Every claimed law, physical causes first, with the law and its band.
pub fn laws(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let claimed = humidity::strongest_first(input.site);
    let asked = claimed
        .into_iter()
        .filter(|found| is_asked(input, &found.parameter));
    let figures = asked.filter_map(|found| {
        let figure = law_cards::figure_of(found, &law_cards::aside(input.site, found))?;
        let what = format!("{} of {}", words::symbol(&found.parameter), found.material);
        // A marker stands for a sample; of one the name is enough.
        let samples = match found.samples.as_slice() {
            [only] => format!("{what}: sample {only}."),
            several => {
                let named: Vec<String> = several
                    .iter()
                    .enumerate()
                    .map(|(at, name)| format!("{name} {}", MARKERS[at % MARKERS.len()]))
                    .collect();
                format!(
                    "{what}: {}; each moved by what it differs from the mean of all.",
                    named.join(", ")
                )
            }
        };
        Some((what, samples, figure))
    });
    let mut notes = vec![
        "Points: runs with their 95 % intervals. Line and band: the law with its 95 % interval.".to_owned(),
    ];
    let mut drawn = Vec::new();
    for (what, samples, figure) in figures.take(MOST) {
        notes.push(samples);
        drawn.push((what, figure));
    }
    if drawn.is_empty() {
        return Err("no law is claimed".to_owned());
    }
    let panel = |(title, figure): (String, LawFigure)| Panel {
        title,
        draw: Box::new(move |area| figure.on(area)),
    };
    let panels: Vec<Panel> = drawn.into_iter().map(panel).collect();
    grid(width, COLUMNS, HEIGHT, &[], &panels, &notes)
}

/// Every watched parameter over the life of its sample.
pub fn lives(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let lives = input.site.lives();
    let mut charts: Vec<Chart> = printed(&lives, |key| is_asked(input, key)).take(MOST).collect();
    let Some(first) = charts.first_mut() else {
        return Err("no parameter is watched over the life of a sample".to_owned());
    };
    first.caption =
        "Bars: 95 % intervals. Band: the 95 % interval of the trend. Dashed: a change.".to_owned();
    chart::prints(&charts, COLUMNS, width)
}

/// Forms of the markers in the order of the samples, as words would name them.
const MARKERS: [&str; 5] = ["●", "■", "▲", "◆", "▼"];

/// Whether the parameter is the one that is asked for, by its key, the beginning of its key, or its symbol.
fn is_asked(input: &FigureInput, key: &str) -> bool {
    input.parameter.is_none_or(|asked| {
        begins_key(key, asked) || ParameterInfo::of(key).is_some_and(|info| info.is_called(asked))
    })
}
