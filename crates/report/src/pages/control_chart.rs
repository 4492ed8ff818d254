//! The control chart of a watched parameter: drawn, and in numbers.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::control::{ControlChart, control_chart};
use crate::site::Site;
use ieap_analysis::laws::words::symbol;
use ieap_analysis::monitoring::Watched;
use ieap_domain::number::significant;
use ieap_domain::tag::keys;

/// A chart in numbers.
#[derive(Debug, Serialize)]
pub struct ChartNumbers {
    now: String,
    limit: String,
    state: String,
}

/// The chart of a parameter in numbers.
pub fn chart_numbers(site: &Site, watched: &Watched) -> ChartNumbers {
    let chart = &watched.study.chart;
    ChartNumbers {
        now: chart
            .statistic
            .last()
            .map_or_else(|| "–".to_owned(), |(_, x)| significant(*x, 2)),
        limit: significant(chart.limit, 3),
        state: match chart.first_alarm {
            Some(at) => format!("alarm since {}", site.run_name(watched.runs[at])),
            None => "in control".to_owned(),
        },
    }
}

/// Draws the chart of watched parameter number `number` over its life, and gives the id under which it went to `figures`.
///
/// # Errors
/// [`ReportError::Figure`] where it cannot be drawn.
pub fn draw_chart(
    site: &Site,
    (number, watched): (usize, &Watched),
    x: &Axis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<String>, ReportError> {
    if watched.study.span.length() <= 0.0 {
        return Ok(None);
    }
    let id = format!("control-{number}");
    let chart = &watched.study.chart;
    let point = |(at, value): &(usize, f64)| (watched.series.x[*at], *value);
    let drawn = ControlChart {
        name: "EWMA",
        points: chart.statistic.iter().map(point).collect(),
        limit: chart.limit,
        first_beyond: chart
            .first_alarm
            .map_or_else(String::new, |at| when(site, watched.runs[at])),
    };
    let title = format!(
        "Control chart of {} of {}",
        symbol(&watched.parameter),
        watched.sample
    );
    let seen = match chart.first_alarm {
        Some(_) => "Beyond its limits.",
        None => "Within its limits.",
    };
    let svg = control_chart(&drawn, x, &title, seen).map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    Ok(svg.map(|svg| {
        figures.insert(id.clone(), svg);
        id
    }))
}

/// The day of a run; its name where it states none.
fn when(site: &Site, run: usize) -> String {
    let start = site.input.runs[run].tag(keys::STARTED_AT);
    start.map_or_else(|| site.run_name(run).to_owned(), |start| site.zone().day(start))
}
