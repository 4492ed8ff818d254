//! What may be behind a misfit, with how probable it is.

use ieap_domain::words::in_a_row;
use serde::Serialize;

use crate::input::Findings;
use crate::pages::policy::{LEAST_PROBABILITY, MOST_EXPLANATIONS};
use ieap_analysis::ParameterInfo;
use ieap_domain::finding_words::explanation;
use ieap_domain::number::probabilities::share;
use ieap_domain::{CauseNode, GroupDiagnosis, Hypothesis, HypothesisKind};

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
    let of_effects = |own: &&Hypothesis| own.kind == HypothesisKind::Effect;
    let effect = found.posterior.iter().position(|own| of_effects(&own));
    let shown = found.posterior.iter().enumerate();
    let shown = shown.filter(|(place, own)| own.mass >= LEAST_PROBABILITY || Some(*place) == effect);
    let rows = shown.take(MOST_EXPLANATIONS).map(|(_, own)| row(own, findings));
    found
        .node
        .as_ref()
        .filter(|node| node.depth < EFFECT)
        .map(of_node)
        .into_iter()
        .chain(rows)
        .collect()
}

/// Depth of a node that is one effect: its row says it.
const EFFECT: usize = 3;

/// What the causes below it have in common.
fn of_node(node: &CauseNode) -> HypothesisRow {
    HypothesisRow {
        what: node.path.join(" › "),
        detail: format!("{}: all causes of this kind together", node.words),
        percent: share(node.probability),
        bar: bar(node.probability),
    }
}

fn row(own: &Hypothesis, findings: &Findings) -> HypothesisRow {
    let (what, detail) = match own.kind {
        HypothesisKind::Base => (explanation(own), "nothing is missing".to_owned()),
        HypothesisKind::SlowNoise => (
            explanation(own),
            "readings wander over the length of a record, at rest as under voltage".to_owned(),
        ),
        HypothesisKind::Unnamed => (
            explanation(own),
            "a smooth answer to the voltage, or a course over the clock, that no effect of the library has"
                .to_owned(),
        ),
        HypothesisKind::Varies => (parameters(own), follows(own)),
        HypothesisKind::Effect => effect(own, findings),
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

fn effect(own: &Hypothesis, findings: &Findings) -> (String, String) {
    let summary = |id: &String| findings.effect(id).map(|known| known.summary.clone());
    let summaries: Vec<String> = own.effects.iter().filter_map(summary).collect();
    let mut detail = summaries.join("; ");
    if let Some(form) = &own.form {
        detail += &format!(" ({form})");
    }
    (explanation(own), detail)
}
