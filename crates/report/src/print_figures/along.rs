//! Figures along strips: maps of curvature (as the thesis's figures 5, 18 and 21 show it), shapes, curves at places,
//! voltages. One strip under the other, each as large as it needs.

use plotters::element::Text;
use plotters::style::text_anchor::{HPos, VPos};

use super::FigureInput;
use crate::blocks::chart;
use crate::figures::along::frames;
use crate::figures::along::map::{self, Shown};
use crate::figures::along::shapes::{self, Layout};
use crate::figures::canvas::{Area, Drawing, Ink, TENTHS, drawing};
use crate::figures::panel::{TITLE_SIZE, text_style};
use ieap_analysis::along::charts;
use ieap_domain::{AlongCurve, AlongStrip};
use ieap_show::Chart;

/// Room above a panel for its title, px.
const TITLE_ROOM: u32 = 18;
/// Height of a map, px.
const MAP_HEIGHT: u32 = 176;
/// Narrowest map that can be read with two beside it, px.
const NARROWEST_MAP: u32 = 205;
/// What is said where there is nothing to draw.
const NOTHING: &str = "no run has what this figure shows: readings at several places along a strip, in columns like curvature_per_cm@5.0";
/// Runs of one figure at most: more would not fit a page.
const MOST_RUNS: usize = 6;

/// A panel of its own height.
struct Panel<'a> {
    title: String,
    height: u32,
    #[allow(clippy::type_complexity)]
    draw: Box<dyn Fn(&Area) -> Result<(), String> + 'a>,
}

/// Maps: measured, simulated, and their difference in units of the noise.
pub fn maps(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let strips = strips(input)?;
    let mut rows: Vec<Vec<Panel>> = Vec::new();
    for (name, strip) in &strips {
        let Some(curve) = drawable(strip) else { continue };
        let panel = |(words, shown): (&str, Shown)| Panel {
            title: match shown {
                Shown::Measured => titled(&strips, name, words),
                // The run stands above the first of its maps.
                Shown::Simulated | Shown::Residual => words.to_owned(),
            },
            height: MAP_HEIGHT,
            draw: Box::new(move |area| map::draw(area, strip, curve, shown)),
        };
        let mut of_run = vec![("measured", Shown::Measured)];
        if !curve.fitted.is_empty() {
            of_run.extend([
                ("simulated", Shown::Simulated),
                ("difference / noise", Shown::Residual),
            ]);
        }
        let panels = of_run.into_iter().map(panel);
        if width / 3 >= NARROWEST_MAP {
            rows.push(panels.collect())
        } else {
            rows.extend(panels.map(|panel| vec![panel]))
        }
    }
    laid_out(width, &rows)
}

/// Shapes at a few times, to scale.
pub fn shapes(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let strips = strips(input)?;
    let layouts: Vec<Option<Layout>> = strips.iter().map(|(_, strip)| Layout::of(strip, width)).collect();
    let rows: Vec<Vec<Panel>> = strips
        .iter()
        .zip(&layouts)
        .filter_map(|((name, strip), layout)| {
            let layout = layout.as_ref()?;
            Some(vec![Panel {
                title: titled(&strips, name, ""),
                height: layout.size().1,
                draw: Box::new(move |area| shapes::draw(area, strip, layout)),
            }])
        })
        .collect();
    laid_out(width, &rows)
}

/// Curvature over time at a few places.
pub fn places(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    charted(input, width, charts::places)
}

/// Voltage along the strip at a few times.
pub fn voltage(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    charted(input, width, charts::voltages)
}

/// The chart of every strip, under each other.
fn charted(input: &FigureInput, width: u32, of: fn(&AlongStrip) -> Option<Chart>) -> Result<Drawing, String> {
    let strips = strips(input)?;
    let chart = |(name, strip): &(String, AlongStrip)| {
        let chart = of(strip)?;
        let title = match strips.len() {
            1 => chart.title,
            _ => name.clone(),
        };
        Some(Chart { title, ..chart })
    };
    let charts: Vec<Chart> = strips.iter().filter_map(chart).collect();
    if charts.is_empty() {
        return Err(NOTHING.to_owned());
    }
    chart::prints(&charts, 1, width)
}

/// Strips that are asked for, with the names of their runs.
fn strips(input: &FigureInput) -> Result<Vec<(String, AlongStrip)>, String> {
    let runs = &input.site.input.runs;
    let all = (0..runs.len()).filter(|&run| runs[run].is_along() && input.run.is_none_or(|only| only == run));
    let asked: Vec<usize> = all.collect();
    if asked.len() > MOST_RUNS {
        return Err(format!(
            "{} runs are read along their strip, more than {MOST_RUNS} on a page: name one with --run, such as --run {}",
            asked.len(),
            runs[asked[0]].path
        ));
    }
    let mut strips = Vec::new();
    for run in asked {
        let strip = input.curves.along(runs[run].id)?;
        strips.extend(strip.map(|strip| (input.site.run_name(run).to_owned(), strip)));
    }
    Ok(strips)
}

/// The curvature of a strip, where a map of it can be drawn.
fn drawable(strip: &AlongStrip) -> Option<&AlongCurve> {
    let curve = strip.curvature.as_ref()?;
    frames::frames(strip, curve).map(|_| curve)
}

/// What stands above a panel: the run where there are several, and what is shown of it.
fn titled(strips: &[(String, AlongStrip)], name: &str, words: &str) -> String {
    match (strips.len(), words.is_empty()) {
        (0..=1, _) => words.to_owned(),
        (_, true) => name.to_owned(),
        (_, false) => format!("{name}: {words}"),
    }
}

/// Rows of panels under each other, each with a letter where there are several.
fn laid_out(width: u32, rows: &[Vec<Panel>]) -> Result<Drawing, String> {
    if rows.is_empty() {
        return Err(NOTHING.to_owned());
    }
    let panels: usize = rows.iter().map(Vec::len).sum();
    let room = if rows.iter().flatten().all(|panel| panel.title.is_empty()) {
        0
    } else {
        TITLE_ROOM
    };
    let height = |row: &[Panel]| room + row.iter().map(|panel| panel.height).max().unwrap_or(0);
    let whole: u32 = rows.iter().map(|row| height(row)).sum();
    drawing((width, whole), |area| {
        let mut rest = area.clone();
        let mut letters = 'A'..='Z';
        for row in rows {
            let (this, below) = rest.split_vertically(height(row) as i32 * TENTHS);
            rest = below;
            for (panel, cell) in row.iter().zip(this.split_evenly((1, row.len()))) {
                let (title, plot) = cell.split_vertically(room as i32 * TENTHS);
                let letter = letters.next().filter(|_| panels > 1 && room > 0);
                let letter = letter.map_or_else(String::new, |letter| format!("{letter}  "));
                let style = text_style(Ink::Text, TITLE_SIZE, HPos::Left, VPos::Center);
                let at = (4 * TENTHS, TITLE_ROOM as i32 * TENTHS / 2);
                let text = Text::new(format!("{letter}{}", panel.title), at, style);
                title.draw(&text).map_err(|error| error.to_string())?;
                (panel.draw)(&plot)?;
            }
        }
        Ok(())
    })
}
