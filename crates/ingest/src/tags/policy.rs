//! What decides whether two sources of a tag agree: every number with its unit and where it comes from.

/// Two starts agree within this, s: what is written by hand has no seconds.
pub(super) const START_AGREES_S: f64 = 60.0;
