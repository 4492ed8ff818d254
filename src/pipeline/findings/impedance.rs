//! The impedance spectra of a campaign with what is found in them, and beside the steps of the same samples. Nothing of
//! it is stored: it follows from the readings and the current fits whenever it is read.

use std::collections::BTreeSet;

use crate::analysis::impedance::comparisons;
pub use crate::analysis::impedance::{Spectra, view};
use crate::domain::fault::caught;
use crate::domain::{Campaign, Channel, Issue, RunRecord, Spectrum, SpectrumRun, Sweep};
use crate::fit::impedance;
use crate::model::impedance::{SpectrumCircuit, circuit};
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::{Context, PipelineError};

/// Code of what is said of a sweep whose analysis a fault of the program stopped.
const FAULT: &str = "analysis-fault";

/// Code of what is said of a text that is no circuit.
const NO_CIRCUIT: &str = "circuit-notation";

/// Schema of what is printed of them.
pub const SCHEMA: &str = "ieap/impedance/2";

/// Whether a fault of the program stopped an analysis.
pub fn has_fault(spectra: &Spectra) -> bool {
    let sweeps = spectra.runs.iter().flat_map(|run| &run.sweeps);
    sweeps
        .filter_map(|sweep| sweep.analysis.as_ref().err())
        .any(|issue| issue.code == FAULT)
}

/// Reads and analyses every spectrum, with the circuits of campaign.toml and those in `more`. The outcome does not depend on
/// the number of threads.
///
/// # Errors
/// The database cannot be read; a sweep that cannot be analysed is no error.
pub fn spectra(context: &Context, more: &[SpectrumCircuit]) -> Result<Spectra, PipelineError> {
    let found = standing::spectra(context)?;
    if found.speaking.is_empty() {
        return Ok(Spectra {
            set_aside: found.set_aside.iter().map(SetAside::of).collect(),
            ..Spectra::default()
        });
    }
    let (asked, refused) = asked(&context.campaign, more);
    let load = |context: &Context, run: &RunRecord| Ok(context.store.channels(run.id)?);
    let runs = compute(context, &found.speaking, load, |run, channels: Vec<Channel>| {
        let sweeps = Spectrum::of(&channels).into_iter();
        SpectrumRun {
            run: run.clone(),
            sweeps: sweeps.map(|sweep| analysed(sweep, &asked)).collect(),
        }
    })?;
    let beside_steps = comparisons(&runs, &standing::speaking(context)?);
    Ok(Spectra {
        runs,
        set_aside: found.set_aside.iter().map(SetAside::of).collect(),
        refused_circuits: refused,
        beside_steps,
    })
}

/// The circuits of campaign.toml and `more`, each once, and what is said of those that are none.
fn asked(campaign: &Campaign, more: &[SpectrumCircuit]) -> (Vec<SpectrumCircuit>, Vec<Issue>) {
    let (mut asked, mut refused): (Vec<SpectrumCircuit>, Vec<Issue>) = (Vec::new(), Vec::new());
    for text in &campaign.impedance_circuits {
        match circuit(text) {
            Ok(found) => asked.push(found),
            Err(error) => {
                let issue = Issue::warning(NO_CIRCUIT, error.to_string());
                let issue = issue.at("campaign.toml, [impedance] circuits".to_owned());
                refused.push(issue.mend("correct it there; the notation stands in docs/impedance.md"));
            }
        }
    }
    asked.extend(more.iter().cloned());
    let mut seen = BTreeSet::new();
    asked.retain(|circuit| seen.insert(circuit.id.clone()));
    (asked, refused)
}

/// A fault of the analysis stops its sweep only.
pub(crate) fn analysed(spectrum: Spectrum, asked: &[SpectrumCircuit]) -> Sweep {
    let analysis = caught(|| impedance::analyse(&spectrum, asked)).unwrap_or_else(|reason| {
        let issue = Issue::fault(FAULT, "the analysis", &reason);
        Err(issue.mend("report it with this spectrum; the others are not affected"))
    });
    Sweep { spectrum, analysis }
}
