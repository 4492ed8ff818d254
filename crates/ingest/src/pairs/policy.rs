//! What decides which files are the halves of one run: every number with its unit and where it comes from.

/// By how much a hand that starts two instruments scatters, s. Chosen.
pub(super) const SCATTER_S: f64 = 12.0;
/// By how much the clocks of two instruments may differ, s. Chosen: a clock that nobody set is minutes off.
pub(super) const MOST_APART_S: f64 = 1800.0;
/// Fewest pairs that show how far two clocks are apart. Chosen.
pub(super) const FEWEST: usize = 3;
/// By how many pairs one difference must be better than any other, beyond what chance pairs. Chosen: e^3 to one.
pub(super) const BETTER_BY: f64 = 3.0;
/// Part of the shorter record for which two must run together to be one. Chosen.
pub(super) const TOGETHER: f64 = 0.5;
