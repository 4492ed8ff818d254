//! What only this diagnosis states of a hidden cause: its strength, and what its name is worth on held-out runs; and how
//! the sureness of every method goes with being right.

use std::fmt::Write;

use ieap_diagnose::{DiagnoseOptions, RunInput, known_cause_gain};
use ieap_domain::GroupDiagnosis;
use ieap_model::ModelChoice;
use ieap_model::effects::{ALL, Applied};

use crate::benchmark::percent;
use crate::methods::{METHODS, Said};

/// One group.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Whether all causes given are of the hidden one's class (electrical, mechanical, coupling, ...); none where none is
    /// given.
    of_class: Option<bool>,
    /// Error of the stated strength over the true one, times d, and whether the interval holds that.
    strength: Option<(f64, bool)>,
    /// Fall of the deviance of held-out readings by what was accepted.
    gain: Option<f64>,
    /// The same where the hidden cause is known and only fitted.
    known: Option<f64>,
}

/// The heading of the table.
pub fn strengths_and_gains() -> String {
    "\n### One cause hidden: its class, its strength, and what its name is worth on held-out readings\n\n\
     | drives | d | groups | class right, % of those given causes | strengths stated | held by the interval, % | median error of the strength, 1/d | held-out gain of what was accepted, % of the known cause's (median) | the same over all groups (sums) |\n\
     |---|---|---|---|---|---|---|---|---|\n"
        .to_owned()
}

/// Letter of the effect's code.
fn class(id: &str) -> Option<char> {
    let effect = ALL.iter().find(|effect| effect.about().id == id)?;
    effect.about().code.chars().next()
}

fn median(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => "-".to_owned(),
        n => format!("{:.2}", 0.5 * (values[(n - 1) / 2] + values[n / 2])),
    }
}

impl Detail {
    pub fn of(found: &GroupDiagnosis, hidden: &Applied, d: f64, runs: &[RunInput]) -> Detail {
        let id = hidden.effect.about().id;
        let own = found.effects.iter().find(|own| own.effect == id);
        let stated = own
            .and_then(|own| own.parameters.first())
            .map(|own| &own.estimate);
        let truth = hidden.parameters[0];
        let strength = stated.and_then(|stated| {
            let (low, high) = stated.low_95.zip(stated.high_95)?;
            let error = (stated.value? / truth - 1.0).abs() * d;
            Some((error, low <= truth && truth <= high))
        });
        let of_class = found.set.iter().all(|other| class(other) == class(id));
        let choice = ModelChoice {
            base: DiagnoseOptions::default().model,
            effects: vec![hidden.effect],
        };
        Detail {
            of_class: (!found.set.is_empty()).then_some(of_class),
            strength,
            gain: found.gain.as_ref().map(|gain| gain.proof.deviance),
            known: known_cause_gain(runs, &choice),
        }
    }

    /// A row of the table.
    pub fn row(name: &str, d: f64, all: &[&Detail]) -> String {
        let classes: Vec<bool> = all.iter().filter_map(|detail| detail.of_class).collect();
        let strengths: Vec<(f64, bool)> = all.iter().filter_map(|detail| detail.strength).collect();
        let both = |detail: &&&Detail| detail.known.is_some_and(|known| known > 0.0);
        let known: Vec<&&Detail> = all.iter().filter(both).collect();
        let parts = known
            .iter()
            .filter_map(|detail| Some(100.0 * detail.gain? / detail.known?));
        let ceiling: f64 = known.iter().filter_map(|detail| detail.known).sum();
        let ours: f64 = known.iter().filter_map(|detail| detail.gain).sum();
        let is_true = |flags: &[bool]| flags.iter().filter(|flag| **flag).count();
        let held: Vec<bool> = strengths.iter().map(|(_, held)| *held).collect();
        format!(
            "| {name} | {d} | {} | {} | {} | {} | {} | {} | {:.0} |\n",
            all.len(),
            percent(is_true(&classes), classes.len()),
            strengths.len(),
            percent(is_true(&held), held.len()),
            median(strengths.iter().map(|(error, _)| *error).collect()),
            median(parts.collect()),
            100.0 * ours / ceiling
        )
    }
}

/// Area under the generalised risk over coverage (Traub and others, 2024), times 1000, for every method that names: 0
/// where it never names wrongly, or is least sure where it does; half its rate of wrong names where its sureness says
/// nothing.
pub fn ignorance(name: &str, all: &[(Vec<Said>, Option<&str>)]) -> String {
    let mut out = String::new();
    let _ = write!(
        out,
        "\nArea under the generalised risk, times 1000, {name}, all strengths:"
    );
    for (k, method) in METHODS.iter().enumerate() {
        let mut surest: Vec<(f64, bool)> = all
            .iter()
            .map(|(said, truth)| {
                let wrong = said[k].name.as_deref().is_some_and(|name| Some(name) != *truth);
                let sureness = match said[k].name {
                    Some(_) => said[k].confidence,
                    None => f64::NEG_INFINITY,
                };
                (sureness, wrong)
            })
            .collect();
        if surest.iter().all(|(sureness, _)| *sureness == f64::NEG_INFINITY) {
            continue;
        }
        surest.sort_by(|a, b| b.0.total_cmp(&a.0));
        let n = surest.len() as f64;
        let mut wrong = 0.0;
        let area: f64 = surest
            .iter()
            .map(|(_, is_wrong)| {
                wrong += f64::from(u8::from(*is_wrong));
                wrong / n / n
            })
            .sum();
        let _ = write!(out, " {method} {:.1};", 1000.0 * area);
    }
    out.push('\n');
    out
}
