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

impl Strip {
    /// The resistance along the electrodes where it is taken as exact, Ohm per cm.
    pub(super) fn held_ohm_per_cm(&self) -> Option<f64> {
        match self.probed() {
            Some(_) => None,
            None => self.electrode_resistance_ohm_per_sq.map(|r| r / self.width_cm),
        }
    }

    /// What a probe read, where its error is known.
    pub(super) fn probed(&self) -> Option<Probed> {
        let error = self.electrode_resistance_error_ohm_per_sq;
        let error = error.filter(|error| error.is_finite() && *error > 0.0)?;
        let read = self.electrode_resistance_ohm_per_sq?;
        Some(Probed {
            log_ohm_per_cm: (read / self.width_cm).ln(),
            error: error / read,
        })
    }

    /// The strip without what is known of its electrodes.
    pub(super) fn unprobed(self) -> Strip {
        Strip {
            electrode_resistance_ohm_per_sq: None,
            electrode_resistance_error_ohm_per_sq: None,
            ..self
        }
    }
}

/// A resistance as a probe read it: one more reading, of its logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Probed {
    /// Logarithm of the resistance along the electrodes in Ohm per cm.
    pub log_ohm_per_cm: f64,
    /// Its standard error.
    pub error: f64,
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
