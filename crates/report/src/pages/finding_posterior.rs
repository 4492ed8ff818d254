//! What may be behind a misfit, with how probable it is.

use ieap_domain::words::in_a_row;
use serde::Serialize;

use crate::input::Findings;
use crate::pages::policy::{LEAST_PROBABILITY, MOST_EXPLANATIONS};
use ieap_domain::ParameterInfo;
use ieap_domain::finding_words::explanation;
use ieap_domain::number::probabilities::share;
use ieap_domain::{GroupDiagnosis, Hypothesis, HypothesisKind};

/// A hypothesis in words.
#[derive(Debug, Serialize)]
pub struct HypothesisRow {
    what: String,
    detail: String,
    percent: String,
    /// Length of its bar, percent.
    bar: f64,
}

/// The leading hypotheses.
pub fn hypothesis_rows(found: &GroupDiagnosis, findings: &Findings) -> Vec<HypothesisRow> {
    let shown = found.posterior.iter().filter(|own| own.mass >= LEAST_PROBABILITY);
    shown
        .take(MOST_EXPLANATIONS)
        .map(|own| row(own, findings))
        .collect()
}

fn row(own: &Hypothesis, findings: &Findings) -> HypothesisRow {
    let about = |id: &str| findings.effect(id).map(|known| known.summary.as_str());
    let said = explanation(own, &about);
    let (what, detail) = match own.kind {
        HypothesisKind::Base => (said, "nothing is missing".to_owned()),
        HypothesisKind::SlowNoise => (
            said,
            "readings wander over the length of a record, at rest as under voltage".to_owned(),
        ),
        HypothesisKind::Unnamed => (
            said,
            "a smooth answer to the voltage, of all runs or of each its own".to_owned(),
        ),
        HypothesisKind::Varies => (parameters(own), follows(own)),
        HypothesisKind::Law => (said, "as a free curve".to_owned()),
        HypothesisKind::Effect => {
            let summary = own.effect.as_deref().and_then(about);
            (said, summary.unwrap_or_default().to_owned())
        }
    };
    HypothesisRow {
        what,
        detail,
        bar: bar(own.mass),
        percent: share(own.mass),
    }
}

/// Length of the bar of a probability, percent.
fn bar(probability: f64) -> f64 {
    (1e3 * probability).round() / 10.0
}

fn parameters(own: &Hypothesis) -> String {
    let symbol =
        |key: &String| ParameterInfo::of(key).map_or_else(|| key.clone(), |known| known.symbol.to_owned());
    let symbols: Vec<String> = own.parameters_that_differ.iter().map(symbol).collect();
    match symbols.len() {
        1 => format!("{} differs between the runs", symbols[0]),
        _ => format!("{} differ between the runs", in_a_row(&symbols)),
    }
}

fn follows(own: &Hypothesis) -> String {
    match own.with.as_deref() {
        None | Some("run") => "freely".to_owned(),
        Some("voltage_v") => "with the voltage".to_owned(),
        Some(tag) => format!("with {}", tag.trim_start_matches(ieap_domain::diagnosis::FOLLOWS)),
    }
}
