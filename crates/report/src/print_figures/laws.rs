//! Parameters against what they follow: the laws that hold across runs, and parameters over the life of samples.

use super::FigureInput;
use crate::blocks::chart;
use crate::figures::canvas::Drawing;
use ieap_analysis::monitoring::view::printed;
use ieap_analysis::study::view::law_charts;
use ieap_domain::ParameterInfo;
use ieap_domain::parameters::begins_key;
use ieap_show::Chart;

/// Panels drawn where no parameter is asked for.
const MOST: usize = 8;
/// Panels that stand beside each other.
const COLUMNS: usize = 2;

/// Every law that is shown, with the values behind it and its band.
pub fn laws(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let study = &input.site.input.study;
    let mut charts: Vec<Chart> = law_charts(study, |key| is_asked(input, key)).take(MOST).collect();
    let Some(first) = charts.first_mut() else {
        return Err("no law is shown".to_owned());
    };
    first.caption =
        "Points: runs with their 95 % intervals, moved by what their strip differs from the mean of all. Line and band: the law with its 95 % interval.".to_owned();
    chart::prints(&charts, COLUMNS, width)
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

/// Whether the parameter is the one that is asked for, by its key, the beginning of its key, or its symbol.
fn is_asked(input: &FigureInput, key: &str) -> bool {
    input.parameter.is_none_or(|asked| {
        begins_key(key, asked) || ParameterInfo::of(key).is_some_and(|info| info.is_called(asked))
    })
}
