//! What decides in several rooms of this crate alike. What decides in one stands in its own `policy.rs`.

/// Two things differ, or something is there, where chance alone brings as much in fewer cases than this: the one in twenty
/// that lies outside a 95 % interval, a convention of the field.
pub(crate) const DIFFERS_BELOW: f64 = 0.05;
