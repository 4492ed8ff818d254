//! What runs say of a fitted parameter: one run's estimate as it is, several pooled, bounds and gaps with their reasons.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::TableInput;
use crate::laws::doubt::Doubts;
use crate::one_fit::SharedEstimate;
use crate::pooling::{Averaging, Repeat, pooled};
use ieap_domain::tag::keys;
use ieap_domain::{Estimate, Fit, RunRecord, RunState};
use ieap_show::{Combined, Content, Measured, Source, SourceOrigin, Value, content_of};

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

/// Couplings and changes may be negative; everything else is positive by definition.
fn averaging(key: &str) -> Averaging {
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
    let is_of_effect = key.contains('.');
    if is_of_effect || signed.iter().any(|start| key.starts_with(start)) {
        Averaging::Linear
    } else {
        Averaging::Logarithmic
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

/// Some runs, as rows are made from them.
#[derive(Clone)]
pub struct Runs<'a> {
    input: TableInput<'a>,
    /// Their places among the runs.
    pub at: Vec<usize>,
}

impl<'a> Runs<'a> {
    /// The runs at these places.
    pub fn new(input: &TableInput<'a>, at: impl Into<Vec<usize>>) -> Runs<'a> {
        Runs {
            input: *input,
            at: at.into(),
        }
    }

    /// The runs themselves.
    pub fn records(&self) -> impl Iterator<Item = &'a RunRecord> {
        let runs = self.input.runs;
        self.at.iter().map(move |&at| &runs[at])
    }

    /// Those of which that holds.
    pub fn only(&self, holds: impl Fn(&RunRecord) -> bool) -> Runs<'a> {
        let at = self.at.iter().copied();
        Runs {
            at: at.filter(|&at| holds(&self.input.runs[at])).collect(),
            ..*self
        }
    }

    /// The campaign with all its runs.
    pub fn input(&self) -> &TableInput<'a> {
        &self.input
    }

    /// What they say of a parameter.
    pub fn parameter(&self, key: &str) -> Combined {
        let of_runs = self
            .records()
            .map(|run| contribution(self.input.doubts, run, key));
        combined(&of_runs.collect::<Vec<_>>(), key)
    }

    /// They as sources of a cell that takes no number from them.
    pub fn sources(&self) -> Vec<Source> {
        let of = |run: &RunRecord| Source::of(SourceOrigin::Run(run.id), &run.path);
        self.records().map(of).collect()
    }

    /// Mean of a coefficient of determination over those whose fits converged.
    pub fn score(&self, score: fn(&Fit) -> Option<f64>) -> Value {
        let fits = self.records().filter_map(|run| run.fit.as_ref());
        let scores: Vec<f64> = fits.filter(|fit| fit.converged).filter_map(score).collect();
        match scores.len() {
            0 => Value::Missing,
            count => Value::Score(scores.iter().sum::<f64>() / count as f64),
        }
    }

    /// Number of distinct samples among them.
    pub fn sample_count(&self) -> usize {
        let samples: BTreeSet<Option<&str>> = self.records().map(|run| run.tag(keys::SAMPLE)).collect();
        samples.len()
    }
}

/// What several runs say.
///
/// Runs with a value are pooled, those that share one count once, and the others are left out, with a footnote. Where none has a value, bounds on the
/// same side give the bound that holds for every run.
pub fn combined(parts: &[Contribution], key: &str) -> Combined {
    let mut counted = BTreeSet::new();
    let values: Vec<&Contribution> = parts
        .iter()
        .filter(|part| matches!(&part.estimate, Ok(estimate) if estimate.value.is_some()))
        .filter(|part| part.shared.as_ref().is_none_or(|own| counted.insert(own)))
        .collect();
    let content = match values.as_slice() {
        [] => without_value(parts),
        [
            Contribution {
                estimate: Ok(only), ..
            },
        ] => content_of(only),
        several => mean(several, averaging(key)),
    };
    Combined {
        content,
        notes: reasons(parts, values.len()),
        sources: sources(parts, key, !values.is_empty()),
    }
}

fn mean(parts: &[&Contribution], averaging: Averaging) -> Content {
    let mut samples: Vec<Option<&str>> = parts.iter().map(|part| part.sample).collect();
    samples.sort_unstable();
    samples.dedup();
    let repeat = |part: &&Contribution| {
        let estimate = part.estimate.as_ref().ok()?;
        Some(Repeat {
            sample: samples.iter().position(|sample| *sample == part.sample)?,
            value: estimate.value?,
            standard_error: estimate.standard_error.unwrap_or(0.0),
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
    let mean = pooled(&repeats, averaging).or_else(|| pooled(&repeats, Averaging::Linear));
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
fn without_value(parts: &[Contribution]) -> Content {
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

fn sources(parts: &[Contribution], key: &str, some_have_values: bool) -> Vec<Source> {
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
            key: Some(key.to_owned()),
            estimate: part.estimate.as_deref().ok().cloned(),
            left_out,
        }
    };
    parts.iter().map(source).collect()
}
