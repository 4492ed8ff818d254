//! Control charts of a watched parameter: drawn, and in numbers.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::control::{ControlChart, control_charts};
use crate::site::Site;
use ieap_analysis::laws::words::symbol;
use ieap_analysis::monitoring::Watched;
use ieap_analysis::monitoring::series::Charted;
use ieap_domain::number::significant;
use ieap_domain::tag::keys;

/// A chart in numbers.
#[derive(Debug, Serialize)]
pub struct ChartRow {
    chart: &'static str,
    now: String,
    limit: String,
    state: String,
}

/// The charts of a parameter in numbers.
pub fn chart_rows(site: &Site, watched: &Watched) -> Vec<ChartRow> {
    let row = |charted: &Charted| ChartRow {
        chart: name(charted),
        now: charted
            .statistic
            .last()
            .map_or_else(|| "–".to_owned(), |(_, x)| significant(*x, 2)),
        limit: significant(charted.limit, 3),
        state: match charted.first_alarm {
            Some(at) => format!("alarm since {}", site.run_name(watched.runs[at])),
            None => "in control".to_owned(),
        },
    };
    watched.study.charts.iter().map(row).collect()
}

fn name(charted: &Charted) -> &'static str {
    match charted.chart.key() {
        "shewhart" => "Shewhart",
        "ewma" => "EWMA",
        _ => "CUSUM",
    }
}

/// Draws the charts of watched parameter number `number` over its life, and gives the id under which they went to `figures`.
///
/// # Errors
/// [`ReportError::Figure`] where they cannot be drawn.
pub fn draw_charts(
    site: &Site,
    (number, watched): (usize, &Watched),
    x: &Axis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<String>, ReportError> {
    if watched.study.span.length() <= 0.0 {
        return Ok(None);
    }
    let id = format!("control-{number}");
    let charts: Vec<ControlChart> = watched
        .study
        .charts
        .iter()
        .map(|charted| drawn(site, watched, charted))
        .collect();
    let title = format!(
        "Control charts of {} of {}",
        symbol(&watched.parameter),
        watched.sample
    );
    let svg = control_charts(&charts, x, &title, &seen(watched)).map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    Ok(svg.map(|svg| {
        figures.insert(id.clone(), svg);
        id
    }))
}

fn drawn<'a>(site: &Site, watched: &Watched, charted: &Charted) -> ControlChart<'a> {
    ControlChart {
        name: name(charted),
        points: charted
            .statistic
            .iter()
            .map(|(at, value)| (watched.series.x[*at], *value))
            .collect(),
        limit: charted.limit,
        first_beyond: charted
            .first_alarm
            .map_or_else(String::new, |at| when(site, watched.runs[at])),
    }
}

/// The day of a run; its name where it states none.
fn when(site: &Site, run: usize) -> String {
    let start = site.input.runs[run].tag(keys::STARTED_AT);
    start.map_or_else(|| site.run_name(run).to_owned(), |start| site.zone().day(start))
}

/// What is seen: which charts signal.
fn seen(watched: &Watched) -> String {
    let signal = watched
        .study
        .charts
        .iter()
        .filter(|charted| charted.first_alarm.is_some());
    let signal: Vec<&str> = signal.map(name).collect();
    if signal.is_empty() {
        "All within their limits.".to_owned()
    } else {
        format!("Beyond its limits: {}.", signal.join(", "))
    }
}
