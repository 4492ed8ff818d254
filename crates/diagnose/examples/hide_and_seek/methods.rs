//! The same readings judged by this diagnosis and by textbook criteria.

use ieap_diagnose::{DiagnoseOptions, ForwardStep, RunInput, Textbook, diagnose_group, textbook};
use ieap_domain::{GroupDiagnosis, Verdict};
use ieap_model::extended::Responses;
use ieap_numerics::chance::chi_square_chance;

use crate::case::{Case, inputs, measured};

/// Methods in the order of the tables; the oracle stands last and is asked elsewhere.
pub const METHODS: [&str; 8] = [
    "this diagnosis",
    "this diagnosis, made to choose",
    "AIC forward",
    "BIC forward",
    "likelihood ratio, 5 %",
    "Ljung-Box, best BIC",
    "discrepancy without a name",
    "linear oracle",
];
pub const OURS: usize = 0;
pub const ORACLE: usize = 7;

/// What a nameless discrepancy must gain on held-out runs to count as seen.
const NAMELESS: f64 = 10.0;

/// What one method says of one group.
#[derive(Debug, Clone, Default)]
pub struct Said {
    /// Whether it says that the simulation is wrong.
    pub seen: bool,
    /// Causes that are given together: a name where there is one, twins where this diagnosis or the oracle leaves it open,
    /// what a forward selection took.
    pub causes: Vec<String>,
    /// The one cause that is said to be the first.
    pub name: Option<String>,
    /// How sure the method is of it: the larger, the surer; a scale of its own for every method.
    pub confidence: f64,
}

/// Adds noise to `responses` and asks all methods but the oracle.
pub fn ask(case: &mut Case, responses: &[Responses]) -> (GroupDiagnosis, Vec<Said>) {
    let channels = measured(case, responses);
    judged(&inputs(case, &channels))
}

/// Asks all methods but the oracle.
pub fn judged(runs: &[RunInput]) -> (GroupDiagnosis, Vec<Said>) {
    let options = DiagnoseOptions::default();
    let found = diagnose_group("case", runs, &options);
    let mut said = vec![ours(&found), forced(&found)];
    match textbook(runs, &options) {
        Some(book) => said.extend(criteria(&book)),
        None => said.resize(ORACLE, Said::default()),
    }
    (found, said)
}

fn ours(found: &GroupDiagnosis) -> Said {
    Said {
        seen: found.p_misfit.is_some_and(|p| p < 0.05),
        causes: found.set.clone(),
        name: match found.set.as_slice() {
            [one] if found.verdict != Verdict::Unknown => Some(one.clone()),
            _ => None,
        },
        confidence: lead(found),
    }
}

/// The cause that was fitted, or where none was accepted the most promising one: what a user would read who wants one
/// name at any price.
fn forced(found: &GroupDiagnosis) -> Said {
    let seen = found.p_misfit.is_some_and(|p| p < 0.05);
    let fitted = found.effects.first().map(|effect| effect.effect.clone());
    let promising = found.candidates.first().map(|first| first.effect.clone());
    let name = fitted.or(promising).filter(|_| seen);
    Said {
        seen,
        causes: name.iter().cloned().collect(),
        name,
        confidence: lead(found),
    }
}

/// By how much the best candidate is ahead of the next.
fn lead(found: &GroupDiagnosis) -> f64 {
    let gain = |place: usize| {
        let candidate = found.candidates.get(place);
        candidate.map_or(0.0, |c| c.fitted_gain.unwrap_or(c.forecast_gain))
    };
    gain(0) - gain(1)
}

fn criteria(book: &Textbook) -> Vec<Said> {
    let log_readings = (book.readings as f64).ln();
    let taken = |takes: &dyn Fn(&ForwardStep) -> bool| {
        let causes: Vec<String> = book
            .path
            .iter()
            .take_while(|step| takes(step))
            .map(|step| step.effect.to_owned())
            .collect();
        Said {
            seen: !causes.is_empty(),
            name: causes.first().cloned(),
            causes,
            confidence: book.path.first().map_or(0.0, |step| step.gain),
        }
    };
    let bic = |step: &ForwardStep| step.gain > step.parameters as f64 * log_readings;
    let first = book.path.first().map(|step| step.effect.to_owned());
    let portmanteau = book.ljung_box_p < 0.05;
    vec![
        taken(&|step| step.gain > 2.0 * step.parameters as f64),
        taken(&bic),
        taken(&|step| chi_square_chance(step.gain, step.parameters.max(1)) < 0.05),
        Said {
            seen: portmanteau,
            causes: first.iter().filter(|_| portmanteau).cloned().collect(),
            name: first.filter(|_| portmanteau),
            confidence: -book.ljung_box_p,
        },
        Said {
            seen: book.nameless_gain > NAMELESS,
            ..Said::default()
        },
    ]
}
