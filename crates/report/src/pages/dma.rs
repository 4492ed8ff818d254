//! Modulus logs: the thesis's table 4 and figure 24, and each log with its humidity steps.

use ieap_domain::words::{counted, in_a_row};
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::dma_humidity::{HumidityPanel, WholeSpan, humidity_panel, whole_span};
use super::wording::{EstimateText, IssueText};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::figures::modulus::{NormalisedLog, log_panels, normalised};
use crate::pages::policy::MOST_SECTIONS;
use crate::site::Site;
use ieap_domain::modulus::step_keys;
use ieap_domain::number::{fixed, measured, plain};
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::tag::keys;
use ieap_domain::{Estimate, Issue, ModulusAnalysis, ModulusLog, ModulusStep, Quantity, RunCurve};

const PER_MINUTE: f64 = 1.0 / 60.0;
/// Logs drawn in the figure of all: as many as there are colours.
pub const MOST_DRAWN: usize = Ink::SERIES.len();

#[derive(Debug, Serialize)]
struct Dma {
    findings: Vec<String>,
    rows: Vec<Row>,
    footnotes: Vec<String>,
    figure: Option<String>,
    figure_note: String,
    /// |E*| over the humidity, a panel a log.
    over_humidity: Vec<HumidityPanel>,
    logs: Vec<LogSection>,
    more: String,
    not_analysed: Vec<NotAnalysed>,
}

/// The first humidity step of a log: a row of table 4.
#[derive(Debug, Serialize)]
struct Row {
    sample: String,
    anchor: Option<String>,
    humidity: String,
    before: Cell,
    after: Cell,
    change: Cell,
    equilibrium: Cell,
    recovery: Cell,
}

#[derive(Debug, Serialize)]
struct Cell {
    text: String,
    /// `± 0.31`, to stand below the value.
    error: String,
    /// 95 % interval and reason, shown on hover.
    hover: String,
    kind: &'static str,
    /// Number of the footnote with the reason.
    footnote: Option<usize>,
}

#[derive(Debug, Serialize)]
struct LogSection {
    anchor: String,
    heading: String,
    path: String,
    facts: Vec<(String, String)>,
    figure: String,
    /// Heads of the table of steps: name and unit.
    columns: Vec<(&'static str, &'static str)>,
    steps: Vec<StepRow>,
    footnotes: Vec<String>,
    round_trip: Vec<RoundTrip>,
    issues: Vec<IssueText>,
}

#[derive(Debug, Serialize)]
struct StepRow {
    when: String,
    humidity: String,
    cells: Vec<Cell>,
}

#[derive(Debug, Serialize)]
struct RoundTrip {
    name: String,
    estimate: EstimateText,
}

#[derive(Debug, Serialize)]
struct NotAnalysed {
    path: String,
    issues: Vec<IssueText>,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let analysed = analysed(site);
    let mut reasons = Vec::new();
    let rows = analysed
        .iter()
        .enumerate()
        .filter_map(|(at, (log, found))| row(log, found, at, &mut reasons))
        .collect();
    let (figure, figure_note) = overview(&analysed, &mut figures)?;
    let sections = analysed.iter().take(MOST_SECTIONS).enumerate();
    let logs: Result<Vec<LogSection>, ReportError> = sections
        .map(|(at, (log, found))| section(site, log, found, at, &mut figures))
        .collect();
    let logs = logs?;
    let mut over_humidity = Vec::new();
    for (at, (log, found)) in analysed.iter().take(MOST_SECTIONS).enumerate() {
        over_humidity.extend(humidity_panel(name(log), found, at, &mut figures)?);
    }
    let left_out = analysed.len().saturating_sub(MOST_SECTIONS);
    let logs_without = site
        .input
        .modulus_logs
        .iter()
        .filter(|log| log.analysis.is_none());
    let page = Dma {
        findings: findings(site),
        rows,
        footnotes: reasons,
        figure,
        figure_note,
        over_humidity,
        logs,
        more: match left_out {
            0 => String::new(),
            _ => format!(
                "{} more stand in the table above and in dma.csv.",
                counted(left_out, "log")
            ),
        },
        not_analysed: logs_without
            .map(|log| NotAnalysed {
                path: log.run.path.clone(),
                issues: log.run.issues.iter().map(IssueText::from).collect(),
            })
            .collect(),
    };
    Content::new("dma.html", &page, figures)
}

fn analysed<'a>(site: &'a Site) -> Vec<(&'a ModulusLog, &'a ModulusAnalysis)> {
    let logs = site.input.modulus_logs.iter();
    logs.filter_map(|log| Some((log, log.analysis.as_ref()?)))
        .collect()
}

/// What the logs say in sentences, the largest change first; the overview shows them too.
pub fn findings(site: &Site) -> Vec<String> {
    let analysed = analysed(site);
    let mut changes: Vec<(f64, String)> = analysed
        .iter()
        .filter_map(|(log, found)| change_words(name(log), found))
        .collect();
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    changes.into_iter().map(|(_, text)| text).collect()
}

/// What the whole span of humidity does to a log's modulus, with its size.
fn change_words(name: &str, found: &ModulusAnalysis) -> Option<(f64, String)> {
    let step = found.steps.first()?;
    let (value, error, interval, span) = match whole_span(found) {
        Some(WholeSpan {
            from_to_percent: (from, to),
            change_percent,
            standard_error_percent,
        }) => {
            let reach = NORMAL_95_ROUNDED * standard_error_percent;
            let interval = (change_percent - reach, change_percent + reach);
            (
                change_percent,
                standard_error_percent,
                interval,
                span_words(from, to),
            )
        }
        None => {
            let change = step.estimate(step_keys::RELATIVE_CHANGE)?;
            let interval = (change.low_95?, change.high_95?);
            (
                change.value?,
                change.standard_error.unwrap_or(0.0),
                interval,
                humidity(step),
            )
        }
    };
    let text = match interval {
        (low, high) if low <= 0.0 && high >= 0.0 => {
            format!("|E*| of {name} does not change beyond its uncertainty from {span}.")
        }
        _ => format!(
            "|E*| of {name} {} by {}\u{a0}% from {span}.",
            if value < 0.0 { "falls" } else { "rises" },
            measured(value.abs(), error),
        ),
    };
    Some((value.abs(), text))
}

/// `0 to 40 % RH`
fn span_words(from_percent: f64, to_percent: f64) -> String {
    format!(
        "{} to {}\u{a0}%\u{a0}RH",
        fixed(from_percent, 0),
        fixed(to_percent, 0)
    )
}

/// The sample, or the file where it is not known.
fn name(log: &ModulusLog) -> &str {
    log.run.tag(keys::SAMPLE).unwrap_or(&log.run.path)
}

/// `0 to 40 % RH`
fn humidity(step: &ModulusStep) -> String {
    let percent = |key| {
        let value = step.estimate(key).and_then(|estimate| estimate.value);
        value.map_or("?".to_owned(), |value| fixed(value, 0))
    };
    let (before, after) = (
        percent(step_keys::HUMIDITY_BEFORE),
        percent(step_keys::HUMIDITY_AFTER),
    );
    format!("{before} to {after}\u{a0}%\u{a0}RH")
}

fn row(log: &ModulusLog, found: &ModulusAnalysis, at: usize, reasons: &mut Vec<String>) -> Option<Row> {
    let step = found.steps.first()?;
    let mut of_step = |key, factor| cell(step.estimate(key), factor, reasons);
    Some(Row {
        sample: name(log).to_owned(),
        anchor: (at < MOST_SECTIONS).then(|| anchor(at)),
        humidity: humidity(step),
        before: of_step(step_keys::MODULUS_BEFORE, 1.0),
        after: of_step(step_keys::MODULUS_AFTER, 1.0),
        change: of_step(step_keys::RELATIVE_CHANGE, 1.0),
        equilibrium: of_step(step_keys::EQUILIBRIUM_TIME, PER_MINUTE),
        recovery: cell(found.recovery(), 1.0, reasons),
    })
}

fn anchor(at: usize) -> String {
    format!("log-{}", at + 1)
}

fn cell(estimate: Option<&Estimate>, factor: f64, reasons: &mut Vec<String>) -> Cell {
    let shown = estimate.map_or_else(
        || EstimateText::missing("not looked for"),
        |estimate| EstimateText::of(estimate, factor),
    );
    let footnote = (!shown.reason.is_empty()).then(|| {
        let known = reasons.iter().position(|reason| *reason == shown.reason);
        known.unwrap_or_else(|| {
            reasons.push(shown.reason.clone());
            reasons.len() - 1
        }) + 1
    });
    Cell {
        hover: if shown.interval.is_empty() {
            String::new()
        } else {
            format!("95 %: {}", shown.interval)
        },
        text: shown.stacked.0,
        error: shown.stacked.1,
        kind: shown.kind,
        footnote,
    }
}

fn curve(found: &ModulusAnalysis, quantity: Quantity) -> Option<&RunCurve> {
    found.curves.iter().find(|curve| curve.quantity == quantity)
}

/// A log as figure 24 shows it; none without a humidity step.
pub fn drawable<'a>(log: &'a ModulusLog, found: &'a ModulusAnalysis) -> Option<NormalisedLog<'a>> {
    let step = found.steps.first()?;
    Some(NormalisedLog {
        name: name(log).to_owned(),
        modulus: curve(found, Quantity::ComplexModulus)?,
        humidity: curve(found, Quantity::RelativeHumidity),
        origin_s: step.start_s,
        whole_mpa: step.estimate(step_keys::MODULUS_BEFORE)?.value?,
    })
}

/// Figure 24, and which logs are missing from it.
fn overview(
    analysed: &[(&ModulusLog, &ModulusAnalysis)],
    figures: &mut BTreeMap<String, String>,
) -> Result<(Option<String>, String), ReportError> {
    let drawable: Vec<NormalisedLog> = analysed
        .iter()
        .filter_map(|(log, found)| drawable(log, found))
        .collect();
    let drawn = &drawable[..drawable.len().min(MOST_DRAWN)];
    if drawn.is_empty() {
        return Ok((None, "No log has a humidity step to be drawn from.".to_owned()));
    }
    let names: Vec<String> = drawn.iter().map(|log| log.name.clone()).collect();
    let title = "Normalised complex modulus under humidity";
    let desc = format!(
        "|E*| of {} relative to its value before the first humidity step, with the humidity below.",
        in_a_row(&names)
    );
    let id = "normalised".to_owned();
    let svg = normalised(drawn, title, &desc).map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    figures.insert(id.clone(), svg);
    let left_out = drawable.len() - drawn.len();
    let note = match left_out {
        0 => String::new(),
        _ => format!(
            "{} more are not drawn here; each has its own figure below.",
            counted(left_out, "log")
        ),
    };
    Ok((Some(id), note))
}

fn section(
    site: &Site,
    log: &ModulusLog,
    found: &ModulusAnalysis,
    at: usize,
    figures: &mut BTreeMap<String, String>,
) -> Result<LogSection, ReportError> {
    let id = format!("panels-{}", at + 1);
    let order = [
        Quantity::ComplexModulus,
        Quantity::StorageModulus,
        Quantity::LossModulus,
        Quantity::LossFactor,
        Quantity::RelativeHumidity,
        Quantity::Temperature,
    ];
    let curves: Vec<&RunCurve> = order
        .iter()
        .filter_map(|&quantity| curve(found, quantity))
        .collect();
    let steps_s: Vec<f64> = found.steps.iter().map(|step| step.start_s).collect();
    let title = format!("Modulus log of {}", name(log));
    let desc = "Complex, storage and loss modulus, loss factor, humidity and temperature over time, as far as they \
                were logged; lines: the humidity steps; red: fitted relaxations.";
    let svg = log_panels(&curves, &steps_s, &title, desc).map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    figures.insert(id.clone(), svg);
    let issues: Vec<&Issue> = log.run.issues.iter().chain(&found.issues).collect();
    let mut footnotes = Vec::new();
    let steps = found.steps.iter().map(|step| step_row(step, &mut footnotes));
    Ok(LogSection {
        columns: STEP_NUMBERS
            .iter()
            .map(|(name, unit, ..)| (*name, *unit))
            .collect(),
        steps: steps.collect(),
        footnotes,
        anchor: anchor(at),
        heading: name(log).to_owned(),
        path: log.run.path.clone(),
        facts: facts(site, log, found),
        figure: id,
        round_trip: round_trip(found),
        issues: issues.into_iter().map(IssueText::from).collect(),
    })
}

fn facts(site: &Site, log: &ModulusLog, found: &ModulusAnalysis) -> Vec<(String, String)> {
    let run = &log.run;
    let sample = run
        .tag(keys::SAMPLE)
        .and_then(|id| site.input.campaign.sample(id));
    let mut facts = vec![("modulus", found.modulus_source.clone())];
    facts.extend(sample.map(|sample| ("material", sample.material.clone())));
    facts.extend(
        found
            .frequency_hz
            .map(|f| ("frequency", format!("{} Hz", plain(f)))),
    );
    facts.extend(found.temperature_c.map(|(low, high)| {
        let text = format!("{} to {} °C", fixed(low, 1), fixed(high, 1));
        ("temperature", text)
    }));
    facts.push(("readings", found.readings.to_string()));
    facts.extend(
        run.tag(keys::INSTRUMENT)
            .map(|text| ("instrument", text.to_owned())),
    );
    facts.extend(run.tag(keys::STARTED_AT).map(|text| ("started", text.to_owned())));
    facts.push((
        "file",
        format!("{} ({}, revision {})", run.path, run.format, run.revision),
    ));
    facts
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}

/// Numbers of a step: name, shown unit, key, and the factor to that unit.
const STEP_NUMBERS: [(&str, &str, &str, f64); 7] = [
    ("|E*| before", "MPa", step_keys::MODULUS_BEFORE, 1.0),
    ("|E*| at the end", "MPa", step_keys::MODULUS_AFTER, 1.0),
    ("Change of |E*|", "%", step_keys::RELATIVE_CHANGE, 1.0),
    (
        "Equilibrium after",
        "min",
        step_keys::EQUILIBRIUM_TIME,
        PER_MINUTE,
    ),
    ("|E*| in equilibrium", "MPa", step_keys::MODULUS_EQUILIBRIUM, 1.0),
    ("tan δ before", "", step_keys::LOSS_FACTOR_BEFORE, 1.0),
    ("tan δ at the end", "", step_keys::LOSS_FACTOR_AFTER, 1.0),
];

fn step_row(step: &ModulusStep, reasons: &mut Vec<String>) -> StepRow {
    let minutes = |seconds: f64| plain((10.0 * seconds * PER_MINUTE).round() / 10.0);
    let mut cells = Vec::new();
    for &(_, _, key, factor) in &STEP_NUMBERS {
        cells.push(cell(step.estimate(key), factor, reasons));
    }
    StepRow {
        when: format!("{} to {}", minutes(step.start_s), minutes(step.end_s)),
        humidity: humidity(step),
        cells,
    }
}

fn round_trip(found: &ModulusAnalysis) -> Vec<RoundTrip> {
    let mut rows = Vec::new();
    if let Some(recovery) = found.recovery() {
        rows.push(RoundTrip {
            name: "recovery of the change at the end of the way back (%)".to_owned(),
            estimate: EstimateText::of(recovery, 1.0),
        });
    }
    for (humidity_percent, estimate) in found.hysteresis() {
        let at = humidity_percent.map_or(String::new(), |percent| {
            format!(" at {}\u{a0}%\u{a0}RH", fixed(percent, 0))
        });
        rows.push(RoundTrip {
            name: format!("|E*| on the way back against the way out{at} (%)"),
            estimate: EstimateText::of(estimate, 1.0),
        });
    }
    rows
}
