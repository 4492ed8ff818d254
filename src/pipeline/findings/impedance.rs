//! The impedance spectra of a campaign with what is found in them, and beside the steps of the same samples. Nothing of
//! it is stored: it follows from the readings and the current fits whenever it is read.

use rayon::prelude::*;

use crate::analysis::impedance::{Comparison, comparisons};
use crate::domain::fault::caught;
use crate::domain::{Channel, Issue, RunRecord, Spectrum, SpectrumRun, Sweep};
use crate::fit::impedance;
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::{Context, PipelineError};

/// Spectra whose readings are in memory at once.
const BATCH: usize = 64;

/// Code of what is said of a sweep whose analysis a fault of the program stopped.
const FAULT: &str = "analysis-fault";

/// Every spectrum of a campaign.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spectra {
    /// Those that results are made from, by path.
    pub runs: Vec<SpectrumRun>,
    /// The others.
    pub set_aside: Vec<SetAside>,
    /// Those with steps of the same sample and condition, beside them.
    pub beside: Vec<Comparison>,
}

impl Spectra {
    /// Whether a fault of the program stopped an analysis.
    pub fn has_fault(&self) -> bool {
        let sweeps = self.runs.iter().flat_map(|run| &run.sweeps);
        sweeps
            .filter_map(|sweep| sweep.analysis.as_ref().err())
            .any(|issue| issue.code == FAULT)
    }
}

/// Reads and analyses every spectrum. The outcome does not depend on the number of threads.
///
/// # Errors
/// The database cannot be read; a sweep that cannot be analysed is no error.
pub fn spectra(context: &Context) -> Result<Spectra, PipelineError> {
    let found = standing::spectra(context)?;
    if found.speaking.is_empty() {
        return Ok(Spectra {
            set_aside: found.set_aside.iter().map(SetAside::of).collect(),
            ..Spectra::default()
        });
    }
    let mut runs = Vec::with_capacity(found.speaking.len());
    for batch in found.speaking.chunks(BATCH) {
        let read = batch.iter().map(|run| Ok((run, context.store.channels(run.id)?)));
        let read: Vec<(&RunRecord, Vec<Channel>)> = read.collect::<Result<_, PipelineError>>()?;
        let analysed = read.par_iter().map(|(run, channels)| SpectrumRun {
            run: (*run).clone(),
            sweeps: Spectrum::of(channels).into_iter().map(analysed).collect(),
        });
        runs.extend(analysed.collect::<Vec<_>>());
    }
    let beside = comparisons(&runs, &standing::speaking(context)?);
    Ok(Spectra {
        runs,
        set_aside: found.set_aside.iter().map(SetAside::of).collect(),
        beside,
    })
}

/// A fault of the analysis stops its sweep only.
fn analysed(spectrum: Spectrum) -> Sweep {
    let analysis = caught(|| impedance::analyse(&spectrum)).unwrap_or_else(|reason| {
        let issue = Issue::error(
            FAULT,
            format!("the analysis stopped on an internal fault: {reason}"),
        );
        Err(issue.mend("report it with this spectrum; the others are not affected"))
    });
    Sweep { spectrum, analysis }
}
