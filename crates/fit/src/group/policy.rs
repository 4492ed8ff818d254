//! What decides in fits of groups: every number with its unit and where it comes from.

/// Standard errors apart from which a single parameter is named as the one that contradicts what is known. Chosen.
pub(super) const CONTRADICTS_SIGMAS: f64 = 2.0;
