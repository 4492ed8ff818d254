//! Models compared: what was measured with every model's curve, and below it what each leaves in units of the noise.

use super::FigureInput;
use crate::blocks::chart;
use crate::figures::canvas::Drawing;
use ieap_analysis::models_compared::view::charts;

/// Runs side by side at most.
const MOST_COLUMNS: usize = 3;

/// Draws one run of every material and environment, that of the highest voltage; or the run that is asked for.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let site = input.site;
    if site.input.comparisons.is_empty() {
        return Err("no models were compared yet: `ieap compare` does it".to_owned());
    }
    let asked = input.run.map(|run| site.input.record(run).path.as_str());
    let charts = charts(site.input.compared(), asked).into_iter();
    let charts: Vec<_> = charts.map(|(chart, _)| chart).collect();
    if charts.is_empty() {
        return Err("models were not compared on that run: `ieap compare` does it".to_owned());
    }
    chart::prints(&charts, MOST_COLUMNS, width)
}
