//! From the strip to the readings: when an instrument looks, and what it makes of what it sees.
//!
//! Curvature is read at `t' = t_0 + (t - t_0)(1 + e) - d`, t_0 the first edge:
//! - `clock-rate`: e; `camera-delay`: d. Before the first edge the strip has its start value.
//! - `exposure-smoothing`: the mean over `[t' - T_e, t']`.
//!
//! Then in this order:
//! - `precurvature`: plus a constant (the strip's own).
//! - `tip-formula`: "arc" `kappa (1 - (kappa L)^2/3)`, "axis" `kappa (1 + (kappa L)^2/4)`, L the free length; the
//!   correction is multiplied by `applied`.
//! - `noncircular-shape`: `kappa (1 + c |kappa|)`.
//! - `camera-zero`: plus a constant.
//!
//! Current: `current-offset`; `x-current-oscillation` adds `a sin(2 pi t/P)` from the first edge on, in an open
//! circuit too. `x-dead-time`: both responses are those of d earlier.

use super::Truth;
use super::effects::Effects;
use super::error::TruthError;

/// What the instruments do.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Observation {
    start_s: f64,
    dead_time_s: f64,
    delay_s: f64,
    rate_error: f64,
    exposure_s: f64,
    precurvature: f64,
    /// Factor of kappa^3.
    tip: f64,
    bias: f64,
    zero: f64,
    offset_a: f64,
    oscillation: Option<(f64, f64)>,
}

impl Observation {
    pub fn new(truth: &Truth, effects: &Effects, start_s: f64) -> Result<Observation, TruthError> {
        let tip = match effects.get("tip-formula") {
            None => 0.0,
            Some(effect) => {
                let length_cm = truth.length_cm.ok_or_else(|| TruthError::NoLength {
                    id: effect.id.clone(),
                })?;
                let share = if effect.is("arc") { -1.0 / 3.0 } else { 0.25 };
                effect.value("applied") * share * length_cm * length_cm
            }
        };
        Ok(Observation {
            start_s,
            dead_time_s: effects.value("x-dead-time", "dead_time_s"),
            delay_s: effects.value("camera-delay", "delay_s"),
            rate_error: effects.value("clock-rate", "rate_error"),
            exposure_s: effects.value("exposure-smoothing", "exposure_s"),
            precurvature: effects.value("precurvature", "offset_per_cm"),
            tip,
            bias: effects.value("noncircular-shape", "bias_cm"),
            zero: effects.value("camera-zero", "offset_per_cm"),
            offset_a: effects.value("current-offset", "offset_a"),
            oscillation: effects.get("x-current-oscillation").map(|effect| {
                let turning = std::f64::consts::TAU / effect.value("period_s");
                (effect.value("amplitude_a"), turning)
            }),
        })
    }

    /// Whether curvature is averaged over an exposure.
    pub fn averages(&self) -> bool {
        self.exposure_s > 0.0
    }

    /// Time at which the current read at `t` flowed, s.
    pub fn current_time_s(&self, t: f64) -> f64 {
        t - self.dead_time_s
    }

    /// First and last instant that the curvature read at `t` comes from, s.
    pub fn curvature_times_s(&self, t: f64) -> (f64, f64) {
        let own = if self.rate_error == 0.0 {
            t
        } else {
            self.start_s + (t - self.start_s) * (1.0 + self.rate_error)
        };
        let last = own - self.delay_s - self.dead_time_s;
        (last - self.exposure_s, last)
    }

    /// The reading of a current, A.
    pub fn current_a(&self, t: f64, current_a: f64) -> f64 {
        let swing = match self.oscillation {
            Some((amplitude, turning)) if t > self.start_s => {
                amplitude * (turning * (t - self.start_s)).sin()
            }
            _ => 0.0,
        };
        current_a + self.offset_a + swing
    }

    /// The reading of a mean curvature, 1/cm.
    pub fn curvature_per_cm(&self, curvature_per_cm: f64) -> f64 {
        let bent = curvature_per_cm + self.precurvature;
        let measured = bent + self.tip * bent.powi(3);
        measured * (1.0 + self.bias * measured.abs()) + self.zero
    }

    /// Mean over the exposure from the integral at its end and start.
    pub fn mean(&self, end: f64, start: f64) -> f64 {
        (end - start) / self.exposure_s
    }
}
