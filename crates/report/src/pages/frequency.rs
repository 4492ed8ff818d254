//! Amplitude and phase of current and bending against frequency: one figure, and what was measured in numbers.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use ieap_analysis::frequency::{FrequencyPoint, FrequencyRun, PerVolt};
use serde::Serialize;

use super::Content;
use crate::error::ReportError;
use crate::figures::svg::inline;
use crate::input::Input;
use crate::prints::frequency::drawn;
use crate::site::Site;
use ieap_domain::number::significant;

/// Width of the figure, px.
const WIDTH: u32 = 760;
/// mA/V of A/V.
const MILLI: f64 = 1e3;

#[derive(Debug, Serialize)]
struct Page {
    answer: String,
    figure: String,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    run: String,
    href: Option<String>,
    waveform: String,
    frequency: String,
    /// Amplitude and phase of the current, then of the curvature.
    numbers: [String; 4],
}

/// Whether a run has a sine or a chirp for its voltage.
pub fn is_shown(input: &Input) -> bool {
    !input.frequency.is_empty()
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let runs = &site.input.frequency;
    let figure = "frequency".to_owned();
    let title = "Amplitude and phase per volt against frequency";
    let answer = answer(runs);
    let svg = drawn(site, WIDTH).map_err(|reason| ReportError::Figure {
        figure: figure.clone(),
        reason,
    })?;
    let figures = BTreeMap::from([(figure.clone(), inline(&svg, title, &answer))]);
    let page = Page {
        answer,
        figure,
        rows: runs.iter().flat_map(|run| rows(site, run)).collect(),
    };
    Content::new("frequency.html", &page, figures)
}

/// How many runs there are, over which frequencies, and how many of them have a model's line.
fn answer(runs: &[FrequencyRun]) -> String {
    let frequencies = runs
        .iter()
        .flat_map(|run| run.measured.iter().map(|point| point.frequency_hz));
    let (low, high) = ieap_domain::range_of(frequencies);
    let modelled = runs.iter().filter(|run| !run.line.is_empty()).count();
    let line = match modelled {
        0 => "of none the fit determines a circuit whose line could be drawn".to_owned(),
        all if all == runs.len() => "the lines are those of their fits".to_owned(),
        some => format!("of {some} the fit determines a circuit, whose line is drawn"),
    };
    let range = if high > low * 1.001 {
        format!("{} to {} Hz", significant(low, 3), significant(high, 3))
    } else {
        format!("{} Hz", significant(low, 3))
    };
    format!(
        "{} under a sine or a chirp, {range}; {line}.",
        counted(runs.len(), "run")
    )
}

fn rows(site: &Site, run: &FrequencyRun) -> Vec<Row> {
    let place = site.input.runs.iter().position(|own| own.id == run.run_id);
    let name = place.map_or_else(|| run.path.clone(), |place| site.run_name(place).to_owned());
    let row = |point: &FrequencyPoint| {
        let [current, current_phase] = numbers(point.current, MILLI);
        let [curvature, curvature_phase] = numbers(point.curvature, 1.0);
        Row {
            run: name.clone(),
            href: place.map(|place| site.run_href(place)),
            waveform: run.waveform.to_owned(),
            frequency: significant(point.frequency_hz, 3),
            numbers: [current, current_phase, curvature, curvature_phase],
        }
    };
    run.measured.iter().map(row).collect()
}

/// Amplitude and phase with their 95 % intervals; empty where that response was not measured.
fn numbers(found: Option<PerVolt>, factor: f64) -> [String; 2] {
    let Some(found) = found else {
        return [String::new(), String::new()];
    };
    let text = |value: f64, half: f64| format!("{} ± {}", significant(value, 4), significant(half, 2));
    let phase = found.phase_half_deg().map(|half| text(found.phase_deg(), half));
    [
        text(factor * found.amplitude(), factor * found.half_95),
        phase.unwrap_or_else(|| "not determined".to_owned()),
    ]
}
