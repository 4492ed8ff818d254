//! Trains of cycles and impedance spectra that no campaign holds.

use super::{ReadTable, RunAtHand};
use crate::analysis::cycles::cycles_of;
use crate::analysis::tables;
use crate::domain::{Issue, Spectrum, Sweep};
use crate::ingest::derived;
use crate::model::impedance::SpectrumCircuit;
use crate::pipeline::findings::impedance::analysed;
use crate::show::Frame;

/// The cycles of a run, one row a cycle, as `ieap export --what cycles` has them.
///
/// # Errors
/// The drive is no train of three cycles or more.
pub fn cycles(run: &RunAtHand) -> Result<Frame, Issue> {
    let channels = derived::responses(&run.channels, run.task.length_cm, Some(&run.task.drive));
    let Some(mut train) = cycles_of(&run.task.drive, &channels) else {
        let message = "the drive is no train of three cycles or more";
        let issue = Issue::error("no-train", message).at("drive");
        return Err(issue.mend("give a voltage that repeats itself, or state the drive: start (s) and voltage (V) of each segment"));
    };
    train.path = run.name().to_owned();
    Ok(tables::cycles::frame_alone(&train))
}

/// The one spectrum of a table with what is found in it, by the circuits that every spectrum is fitted with and `asked`.
///
/// # Errors
/// The table holds no spectrum or several, or it cannot be analysed.
pub fn impedance(read: &ReadTable, asked: &[SpectrumCircuit]) -> Result<Sweep, Issue> {
    let mut found = Spectrum::of(&read.channels);
    let (Some(spectrum), true) = (found.pop(), found.is_empty()) else {
        let sweeps = if found.is_empty() { 0 } else { found.len() + 1 };
        let message = format!("found {sweeps} spectra, and one is needed");
        let mend = "give frequency_hz with impedance_real_ohm and impedance_imaginary_ohm, or impedance_magnitude_ohm and \
                    impedance_phase_degree, of one sweep";
        return Err(Issue::error("one-spectrum", message).mend(mend));
    };
    let sweep = analysed(spectrum, asked);
    match sweep.analysis {
        Err(issue) => Err(issue),
        Ok(_) => Ok(sweep),
    }
}
