//! What decides what a page says and what it leaves out: every number with its unit and where it comes from. Sizes of what is
//! drawn stand where it is drawn.

/// Residual over noise up to which the model describes the readings. Chosen.
pub(super) const WITHIN_NOISE: f64 = 1.3;
/// Residual over noise from which a misfit is called systematic whatever its shape. Chosen.
pub(super) const SYSTEMATIC_FROM: f64 = 3.0;
/// Lag-1 autocorrelation from which neighbouring residuals clearly go together. Chosen.
pub(super) const CORRELATED_FROM: f64 = 0.5;

/// Groups that a sentence names at most; more are counted. Chosen.
pub(super) const MOST_GROUPS_NAMED: usize = 3;

/// Shifts of a parameter below this many standard errors are not put into words. Chosen.
pub(super) const CLEAR_SHIFT_SIGMAS: f64 = 2.0;
/// Probability below which an explanation has no row; the leading effect has one all the same, for a cause that is not it. Chosen.
pub(super) const LEAST_PROBABILITY: f64 = 0.005;
/// Rows of explanations at most. Chosen.
pub(super) const MOST_EXPLANATIONS: usize = 8;

/// Issues of one list that are not folded. Chosen.
pub(crate) const OPEN_ISSUES: usize = 8;
/// Files listed for one reason at most: a folder of thousands of foreign files must not bury the rest of the page. Chosen.
pub(super) const MOST_FILES_OF_REASON: usize = 20;
/// Flagged stretches that are listed at most. Chosen.
pub(super) const MOST_FLAGS: usize = 12;
/// Segments of a drive that are spelled out at most. Chosen.
pub(super) const MOST_SEGMENTS: usize = 6;
/// So long a number that moved says what it was, s: a week, in which people who work with a report open it. Chosen.
pub(crate) const MOVED_SHOWN_S: f64 = 604_800.0;
/// Numbers that moved which the overview names. Chosen.
pub(super) const MOST_MOVED_NAMED: usize = 3;
/// Runs listed on the overview at most: a page of thousands opens slowly. The pages of the groups have all. Chosen.
pub(super) const MOST_RUNS_LISTED: usize = 500;
/// Sweeps, or modulus logs, that have a section of their own; the table and the export have all. Chosen.
pub(crate) const MOST_SECTIONS: usize = 40;
/// Residual figures on the page of a finding at most: a page with more takes long to open. The worst runs come first. Chosen.
pub(super) const MOST_RESIDUAL_FIGURES: usize = 16;
/// Held-out residuals on such a page at most. Chosen.
pub(super) const MOST_HELD_OUT_FIGURES: usize = 6;
/// Links to other samples in the same condition at most: of more, the first stand there. Chosen.
pub(super) const MOST_BESIDE: usize = 12;
