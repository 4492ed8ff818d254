//! Cells of fitted parameters: one run's estimate as it is, several pooled, bounds and gaps with their reasons.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::TableInput;
use crate::conditions::{Condition, Conditions, Surroundings};
use crate::laws::doubt::Doubts;
use crate::one_fit::SharedEstimate;
use crate::parameters::ParameterInfo;
use crate::pooling::{Averaging, Repeat, pooled};
use ieap_domain::number::fixed;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Estimate, RunRecord, RunState};
use ieap_show::{Cell, Column, Content, Measured, Notes, Quantity, Source, SourceOrigin};

/// Remark of tables whose cells are means over the runs of a condition.
pub fn pooled_remark() -> String {
    pooled_where("a condition has several runs")
}

/// Remark of tables whose cells are means where `several` holds.
pub fn pooled_where(several: &str) -> String {
    format!(
        "Values are given with their standard error. Where {several} the value is their random-effects mean (spread between samples and between runs is part of the error; table spread shows each source); means of positive quantities are geometric."
    )
}

/// A number column: which stored number it shows, and how.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// Stored key.
    pub key: &'a str,
    /// Column key, with the shown unit.
    pub column: &'a str,
    /// Symbol.
    pub symbol: &'a str,
    /// The quantity in words.
    pub quantity: &'a str,
    /// Shown unit.
    pub unit: &'a str,
    /// Shown number per stored number.
    pub factor: f64,
}

impl<'a> Shown<'a> {
    /// A stored number with how it is shown.
    pub const fn new(
        key: &'a str,
        column: &'a str,
        symbol: &'a str,
        quantity: &'a str,
        unit: &'a str,
        factor: f64,
    ) -> Shown<'a> {
        Shown {
            key,
            column,
            symbol,
            quantity,
            unit,
            factor,
        }
    }

    /// A quantity as tables show it.
    pub const fn of(quantity: &'a Quantity) -> Shown<'a> {
        Shown::new(
            quantity.key,
            quantity.column,
            quantity.symbol,
            quantity.name,
            quantity.unit,
            quantity.factor,
        )
    }

    /// A parameter as tables show it.
    pub fn parameter(info: &'static ParameterInfo) -> Shown<'static> {
        Shown {
            key: info.key,
            column: match info.key {
                "rss_ohm_cm2" => "rss_kohm_cm2",
                key => key,
            },
            symbol: info.symbol,
            quantity: info.name,
            unit: info.shown_unit,
            factor: info.shown_factor,
        }
    }

    /// Its column.
    pub fn column(&self) -> Column {
        Column::of(self.column, self.symbol, self.quantity, self.unit)
    }

    /// Couplings and changes may be negative; everything else is positive by definition.
    fn averaging(&self) -> Averaging {
        let signed = [
            "alpha",
            "mu_",
            "k1_",
            "k2_",
            "kept_",
            "curvature",
            "relative_change",
            "relative_humidity",
        ];
        // Of a parameter of an effect nothing is known here.
        let is_of_effect = self.key.contains('.');
        if is_of_effect || signed.iter().any(|start| self.key.starts_with(start)) {
            Averaging::Linear
        } else {
            Averaging::Logarithmic
        }
    }
}

/// One run's contribution to a cell.
pub struct Contribution<'a> {
    /// What it comes from.
    pub origin: SourceOrigin,
    /// Name of the run or log.
    pub name: &'a str,
    /// Sample, where it is known.
    pub sample: Option<&'a str>,
    /// Its number, or why it has none.
    pub estimate: Result<Cow<'a, Estimate>, String>,
    /// Identity of a number that several runs share.
    pub shared: Option<SharedEstimate>,
}

/// What a run says of a parameter, with what findings say against it.
pub fn contribution<'a>(doubts: &Doubts, run: &'a RunRecord, key: &str) -> Contribution<'a> {
    let estimate = match &run.fit {
        None => Err(why_unfitted(run).to_owned()),
        Some(fit) if !fit.converged => Err("the fit did not converge".to_owned()),
        Some(fit) => fit
            .parameter(key)
            .map(|own| doubts.stated(&run.path, key, own))
            .ok_or_else(|| format!("the model {} has no such parameter", fit.model)),
    };
    Contribution {
        origin: SourceOrigin::Run(run.id),
        name: &run.path,
        sample: run.tag(keys::SAMPLE),
        shared: estimate
            .as_ref()
            .ok()
            .and_then(|own| SharedEstimate::of(run, own)),
        estimate,
    }
}

/// Why a run has no fit, in words.
fn why_unfitted(run: &RunRecord) -> &'static str {
    match run.state {
        RunState::Ready => "the run is not fitted yet",
        RunState::Untagged => "a needed tag is missing",
        RunState::NotFitted => "the run is not a step response that the model describes",
        RunState::NoSteps => "the voltage does not go in steps",
    }
}

/// The cell of a parameter over some runs.
pub fn parameter_cell(input: &TableInput, runs: &[usize], shown: &Shown, notes: &mut Notes) -> Cell {
    let of_runs = runs
        .iter()
        .map(|&run| contribution(input.doubts, &input.runs[run], shown.key));
    combined(&of_runs.collect::<Vec<_>>(), shown, notes)
}

/// One cell from what several runs say.
///
/// Runs with a value are pooled, those that share one count once, and the others are left out, with a footnote. Where none has a value, bounds on the
/// same side give the bound that holds for every run.
pub fn combined(parts: &[Contribution], shown: &Shown, notes: &mut Notes) -> Cell {
    let mut counted = BTreeSet::new();
    let values: Vec<&Contribution> = parts
        .iter()
        .filter(|part| matches!(&part.estimate, Ok(estimate) if estimate.value.is_some()))
        .filter(|part| part.shared.as_ref().is_none_or(|own| counted.insert(own)))
        .collect();
    let content = match values.as_slice() {
        [] => without_value(parts, shown),
        [only] => single(only, shown),
        several => mean(several, shown),
    };
    let mut cell = Cell::new(content, sources(parts, shown, !values.is_empty()));
    for note in reasons(parts, values.len()) {
        cell = cell.noted(notes.at(&note));
    }
    cell
}

fn single(part: &Contribution, shown: &Shown) -> Content {
    let Ok(estimate) = &part.estimate else {
        return Content::NotDetermined;
    };
    let own = estimate.scaled(shown.factor);
    match own.value {
        Some(value) => Content::Measured(Measured {
            value,
            standard_error: own.standard_error,
            low_95: own.low_95,
            high_95: own.high_95,
            pooled: None,
        }),
        None => Content::NotDetermined,
    }
}

fn mean(parts: &[&Contribution], shown: &Shown) -> Content {
    let mut samples: Vec<Option<&str>> = parts.iter().map(|part| part.sample).collect();
    samples.sort_unstable();
    samples.dedup();
    let repeat = |part: &&Contribution| {
        let estimate = part.estimate.as_ref().ok()?;
        Some(Repeat {
            sample: samples.iter().position(|sample| *sample == part.sample)?,
            value: estimate.value? * shown.factor,
            standard_error: estimate.standard_error.unwrap_or(0.0) * shown.factor,
        })
    };
    let repeats: Vec<Repeat> = parts.iter().filter_map(repeat).collect();
    // Equal values without an error are stated, not measured: a mean would make up an uncertainty.
    let is_stated = |repeat: &Repeat| repeat.standard_error == 0.0 && repeat.value == repeats[0].value;
    if repeats.iter().all(is_stated) {
        return repeats.first().map_or(Content::NotDetermined, |stated| {
            Content::Measured(Measured {
                value: stated.value,
                standard_error: None,
                low_95: None,
                high_95: None,
                pooled: None,
            })
        });
    }
    // A value that is not positive has no logarithm: such a column is averaged as it is.
    let mean = pooled(&repeats, shown.averaging()).or_else(|| pooled(&repeats, Averaging::Linear));
    mean.map_or(Content::NotDetermined, |mean| {
        Content::Measured(Measured {
            value: mean.value,
            standard_error: Some(mean.standard_error),
            low_95: Some(mean.low_95),
            high_95: Some(mean.high_95),
            pooled: Some(mean),
        })
    })
}

/// The widest bounds of runs that have nothing else, where all are bounded on the same sides.
fn without_value(parts: &[Contribution], shown: &Shown) -> Content {
    let estimates: Vec<&Estimate> = parts
        .iter()
        .filter_map(|part| part.estimate.as_deref().ok())
        .collect();
    if parts.is_empty() {
        return Content::Missing;
    }
    let side = |get: fn(&Estimate) -> Option<f64>, widest: fn(f64, f64) -> f64| {
        let all: Option<Vec<f64>> = estimates.iter().map(|estimate| get(estimate)).collect();
        all.filter(|all| all.len() == parts.len())
            .and_then(|all| all.into_iter().reduce(widest))
            .map(|bound| bound * shown.factor)
    };
    let (low, high) = (side(|e| e.low_95, f64::min), side(|e| e.high_95, f64::max));
    match (low, high) {
        (None, None) => Content::NotDetermined,
        (low, high) => Content::Bound { low, high },
    }
}

/// Footnotes of a cell: why runs were left out, or what their estimates say beside the number.
fn reasons(parts: &[Contribution], with_value: usize) -> Vec<String> {
    let mut texts: Vec<(String, usize)> = Vec::new();
    for part in parts {
        let reason = match &part.estimate {
            Err(reason) => Some(reason.clone()),
            Ok(estimate) => estimate.reason.clone().or_else(|| {
                estimate
                    .at_bound
                    .then(|| "the value lies at a limit of the search".to_owned())
            }),
        };
        let Some(reason) = reason else { continue };
        let has_value = matches!(&part.estimate, Ok(estimate) if estimate.value.is_some());
        let text = match (parts.len() > 1, has_value, with_value > 0) {
            (true, false, true) => format!("left out: {reason}"),
            _ => reason,
        };
        match texts.iter_mut().find(|(known, _)| *known == text) {
            Some((_, count)) => *count += 1,
            None => texts.push((text, 1)),
        }
    }
    let total = parts.len();
    texts
        .into_iter()
        .map(|(text, count)| match total {
            1 => text,
            _ => format!("{count} of {total} runs: {text}"),
        })
        .collect()
}

fn sources(parts: &[Contribution], shown: &Shown, some_have_values: bool) -> Vec<Source> {
    let source = |part: &Contribution| {
        let left_out = match &part.estimate {
            Err(reason) => Some(reason.clone()),
            Ok(estimate) if estimate.value.is_none() && some_have_values => Some(
                estimate
                    .reason
                    .clone()
                    .unwrap_or_else(|| "it has no value".to_owned()),
            ),
            Ok(_) => None,
        };
        Source {
            origin: part.origin,
            name: part.name.to_owned(),
            key: Some(shown.key.to_owned()),
            estimate: part.estimate.as_deref().ok().cloned(),
            left_out,
        }
    };
    parts.iter().map(source).collect()
}

/// Runs as sources of a cell that takes no number from them.
pub fn run_sources(input: &TableInput, runs: &[usize]) -> Vec<Source> {
    let of = |&run: &usize| run_source(input.runs[run].id, &input.runs[run].path);
    runs.iter().map(of).collect()
}

/// A run as the source of a cell that takes no number from it.
pub fn run_source(id: i64, path: &str) -> Source {
    Source {
        origin: SourceOrigin::Run(id),
        name: path.to_owned(),
        key: None,
        estimate: None,
        left_out: None,
    }
}

/// Mean of a coefficient of determination over runs whose fits converged.
pub fn score_cell(input: &TableInput, runs: &[usize], score: fn(&ieap_domain::Fit) -> Option<f64>) -> Cell {
    let fits = runs.iter().filter_map(|&run| input.runs[run].fit.as_ref());
    let scores: Vec<f64> = fits.filter(|fit| fit.converged).filter_map(score).collect();
    let content = if scores.is_empty() {
        Content::Missing
    } else {
        Content::Score(scores.iter().sum::<f64>() / scores.len() as f64)
    };
    Cell::new(content, run_sources(input, runs))
}

/// Number of distinct samples among runs.
pub fn sample_count(input: &TableInput, runs: &[usize]) -> usize {
    let mut samples: Vec<Option<&str>> = runs
        .iter()
        .map(|&run| input.runs[run].tag(keys::SAMPLE))
        .collect();
    samples.sort_unstable();
    samples.dedup();
    samples.len()
}

/// Columns that say which condition a row is about.
pub fn condition_columns() -> Vec<Column> {
    vec![
        Column::plain("material", "Material", "material"),
        Column::plain("environment", "Environment", "environment"),
        Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
        Column::of("voltage_v", "V₀", "step voltage", "V"),
    ]
}

/// Cells of [`condition_columns`], and the label of their row.
pub fn condition_stub(input: &TableInput, table: &Conditions, condition: &Condition) -> (String, Vec<Cell>) {
    let surroundings = &table.surroundings[condition.surroundings];
    let material = &table.materials[condition.material];
    let voltage_v = table.voltages_v[condition.voltage];
    let sources = run_sources(input, &condition.runs);
    let cells = vec![
        Cell::text(Some(material.clone()), sources.clone()),
        Cell::text(Some(surroundings.environment.clone()), sources.clone()),
        Cell::text(humidity_text(surroundings), sources.clone()),
        Cell::exact(Some(voltage_v), sources),
    ];
    let label = format!(
        "{material}, {}, {}",
        surroundings_text(surroundings),
        volts(voltage_v)
    );
    (label, cells)
}

/// `28–38`; none where no humidity is known.
pub fn humidity_text(surroundings: &Surroundings) -> Option<String> {
    let level = surroundings.humidity?;
    let (low, high) = (fixed(level.low_percent, 0), fixed(level.high_percent, 0));
    Some(if low == high {
        low
    } else {
        format!("{low}–{high}")
    })
}

/// `air`, or `air at 28–38 % RH` where the environment was measured at more than one humidity.
pub fn surroundings_text(surroundings: &Surroundings) -> String {
    match (surroundings.humidity_varies, humidity_text(surroundings)) {
        (true, Some(humidity)) => format!("{} at {humidity} % RH", surroundings.environment),
        _ => surroundings.environment.clone(),
    }
}

/// `2.0 V`
pub fn volts(voltage_v: f64) -> String {
    let shortest = format!("{voltage_v}");
    if shortest.contains('.') {
        format!("{shortest} V")
    } else {
        format!("{shortest}.0 V")
    }
}

/// Samples of the campaign that these runs were made on, in the order of the campaign.
pub fn sample_ids<'a>(campaign: &'a Campaign, runs: &'a [RunRecord]) -> Vec<&'a str> {
    let used: Vec<&str> = runs.iter().filter_map(|run| run.tag(keys::SAMPLE)).collect();
    let known = campaign.samples.iter().map(|sample| sample.id.as_str());
    let mut ids: Vec<&str> = known.filter(|id| used.contains(id)).collect();
    for id in used {
        if !ids.contains(&id) {
            ids.push(id);
        }
    }
    ids
}

/// Alpha, as tables show it.
pub(super) const ALPHA: Shown = Shown::new(
    "alpha_per_c_cm",
    "alpha_per_c_cm",
    "α",
    "charge-to-curvature coupling",
    "C⁻¹ cm⁻¹",
    1.0,
);

/// Alpha of some runs, as tables show it.
pub(crate) fn alpha_of(input: &TableInput, runs: &[usize], notes: &mut Notes) -> Cell {
    parameter_cell(input, runs, &ALPHA, notes)
}
