//! What decides whether two sources of a tag agree: every number with its unit and where it comes from.

/// A logged mean agrees with a stated humidity within this, percent points: the accuracy that makers of capacitive sensors state.
pub(super) const HUMIDITY_AGREES_PERCENT: f64 = 3.0;
/// The same of a temperature, °C: of thermistor loggers.
pub(super) const TEMPERATURE_AGREES_C: f64 = 1.0;
/// Two starts agree within this, s: what is written by hand has no seconds.
pub(super) const START_AGREES_S: f64 = 60.0;
