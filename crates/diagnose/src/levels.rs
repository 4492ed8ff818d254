//! Chances below which something is said: the levels that a diagnosis decides by in several of its rooms. What decides in one
//! stands in its own `policy.rs`.

pub(crate) use ieap_domain::diagnosis::{RIGHT_FROM, WRONG_BELOW};

/// A simulation is called right only where an error of this part of the range of current or curvature, in percent, would have been
/// seen: what a strip does is known to a few per cent from run to run, and an error that hides behind more is worth a sentence.
/// Chosen.
pub(crate) const VISIBLE_PERCENT: f64 = 10.0;

/// Relative standard deviation of a parameter up to which runs scatter; beyond it they differ, which is a finding. Chosen, for
/// repeats of one strip agree to a few per cent; `cargo run --release --example hide_and_seek -- null 40 1 scatter` counts what
/// it gives.
pub(crate) const SCATTER: f64 = 0.1;
/// Rise of the logarithm of the likelihood that scatter must bring to be taken as noise. Chosen; the same command counts it.
pub(crate) const SCATTER_EVIDENCE: f64 = 3.0;
/// Rise that a spread beyond [`SCATTER`] must bring over [`SCATTER`] for runs to differ: what a number is worth (Akaike).
pub(crate) const DIFFERENCE_EVIDENCE: f64 = 1.0;

/// A candidate is taken where chance gives as much in fewer groups than this, one that follows a tag where chance does in
/// fewer deals, and one that places along the strip ask for likewise. Chosen; the command at [`WRONG_BELOW`] counts what it gives.
pub(crate) const TAKEN: f64 = 0.01;

/// Levels in which a moving voltage is followed from one turn to the next. Of 150 in a period the staircase itself is seen as a
/// misfit, at noise of 0.4 % of the current; `cargo run --release --example hide_and_seek -- null 40 1 sine` counts what it gives.
pub(crate) const STEPS_IN_HALF_PERIOD: usize = 200;
