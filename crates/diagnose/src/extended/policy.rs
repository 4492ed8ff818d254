//! What decides what is said of a fit with an extended model.

/// A shift of a base parameter by more standard errors than this is worth a sentence. Chosen.
pub(super) const SHIFT_SIGMAS: f64 = 3.0;
/// Intervals that are widened by more than this, for what even the extended model leaves, are said to be. Chosen.
pub(super) const WIDENED_FROM: f64 = 1.2;
