//! What one run gives to a distributed fit.

use ieap_domain::{Channel, Drive};

/// The strip that was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// Free length, cm.
    pub length_cm: f64,
    /// Width, cm.
    pub width_cm: f64,
    /// Resistance of both electrodes along the strip, Ohm per square, as measured by a probe; none: fitted.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Standard error of that resistance, Ohm per square; none: taken as exact.
    pub electrode_resistance_error_ohm_per_sq: Option<f64>,
}

/// What one run gives to a distributed fit.
#[derive(Debug, Clone, Copy)]
pub struct DistributedInput<'a> {
    /// Channels of the run: voltages and curvatures with a position, and the current at the clamp.
    pub channels: &'a [Channel],
    /// Voltage at the clamp; open circuits are not described.
    pub drive: &'a Drive,
    /// The strip.
    pub strip: Strip,
}
