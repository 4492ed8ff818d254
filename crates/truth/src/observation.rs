//! From the strip to the readings: when an instrument looks, and what it makes of what it sees.
//!
//! Curvature is read at `t' = t_0 + (t - t_0)(1 + e) - d`, t_0 the first edge:
//! - `clock-rate`: e; `camera-delay`: d. Before the first edge the strip has its start value. With s = t - t_0:
//!   "sawtooth": `d (0.8 + 0.4 f)`, f the fraction of s/20 s; "catching-up": `d exp(-s/60 s)`.
//! - `exposure-smoothing`: the mean over `[t' - T_e, t']`. "double": the mean of what is seen at both ends;
//!   "growing": the same, T_e times s/(300 s).
//!
//! Then in this order:
//! - `precurvature`: plus a constant (the strip's own).
//! - `tip-formula`: "arc" `kappa (1 - (kappa L)^2/3)`, "axis" `kappa (1 + (kappa L)^2/4)`, L the free length; the
//!   correction is multiplied by `applied`.
//! - `noncircular-shape`: `kappa (1 + c |kappa|)`. "saturating": `|kappa|/(1 + |kappa|/(0.3/cm))` in place of |kappa|;
//!   "threshold": what it has above 0.3/cm.
//! - `camera-zero`: plus a constant.
//! - `x-staircase`: plus `h floor(s/P)`, P the tread.
//! - `x-event`: from s = t_e on times `1 + h exp(-(s - t_e)/tau)`, tau the recovery: the curvature, or the current.
//!
//! Current: `current-offset` (from the first edge on "warming": times `1 - 0.4 exp(-s/100 s)`, "settling": times `2 exp(-s/100 s)`); `x-current-oscillation` adds
//! `a sin(2 pi s/P)` from the first edge on, in an open circuit too. `x-dead-time`: both responses are those of d
//! earlier.

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
    delay_law: &'static str,
    exposure_s: f64,
    exposure_law: &'static str,
    precurvature: f64,
    /// Factor of kappa^3.
    tip: f64,
    bias: f64,
    bias_law: &'static str,
    zero: f64,
    /// Step and tread of a staircase.
    stair: Option<(f64, f64)>,
    event: Option<Event>,
    offset_a: f64,
    offset_law: &'static str,
    oscillation: Option<(f64, f64)>,
}

/// Something that the drive did not cause.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Event {
    share: f64,
    at_s: f64,
    recovery_s: f64,
    of_current: bool,
}

impl Event {
    fn factor(&self, since_start_s: f64) -> f64 {
        let since_s = since_start_s - self.at_s;
        if since_s < 0.0 {
            return 1.0;
        }
        1.0 + self.share * (-since_s / self.recovery_s).exp()
    }
}

/// Curvature that is much for a shape that is no arc, 1/cm.
const MUCH_PER_CM: f64 = 0.3;

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
            delay_law: effects.law("camera-delay"),
            exposure_s: effects.value("exposure-smoothing", "exposure_s"),
            exposure_law: effects.law("exposure-smoothing"),
            precurvature: effects.value("precurvature", "offset_per_cm"),
            tip,
            bias: effects.value("noncircular-shape", "bias_cm"),
            bias_law: effects.law("noncircular-shape"),
            stair: effects
                .get("x-staircase")
                .map(|effect| (effect.value("step_per_cm"), effect.value("tread_s"))),
            event: effects.get("x-event").map(|effect| Event {
                share: effect.value("share"),
                at_s: effect.value("event_time_s"),
                recovery_s: effect.value("recovery_s"),
                of_current: effect.is("current"),
            }),
            offset_law: effects.law("current-offset"),
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
        self.exposure_s > 0.0 && self.exposure_law.is_empty()
    }

    /// What an exposure sees of the curvatures at its last and first instant.
    pub fn exposed(&self, last: f64, first: f64) -> f64 {
        match self.exposure_law {
            "double" | "growing" => 0.5 * (last + first),
            _ => last,
        }
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
        let since_s = (t - self.start_s).max(0.0);
        let delay_s = self.delay_s
            * match self.delay_law {
                "sawtooth" => 0.8 + 0.4 * (since_s / 20.0).fract(),
                "catching-up" => (-since_s / 60.0).exp(),
                _ => 1.0,
            };
        let last = own - delay_s - self.dead_time_s;
        let back = if self.exposure_law == "growing" {
            since_s / 300.0
        } else {
            1.0
        };
        (last - back * self.exposure_s, last)
    }

    /// The reading of a current, A.
    pub fn current_a(&self, t: f64, current_a: f64) -> f64 {
        let swing = match self.oscillation {
            Some((amplitude, turning)) if t > self.start_s => {
                amplitude * (turning * (t - self.start_s)).sin()
            }
            _ => 0.0,
        };
        let since_s = t - self.start_s;
        let offset = match self.offset_law {
            "warming" if since_s > 0.0 => 1.0 - 0.4 * (-since_s / 100.0).exp(),
            "settling" if since_s > 0.0 => 2.0 * (-since_s / 100.0).exp(),
            _ => 1.0,
        };
        let event = self.event.filter(|event| event.of_current);
        current_a * event.map_or(1.0, |event| event.factor(since_s)) + self.offset_a * offset + swing
    }

    /// The reading at `t` of a mean curvature, 1/cm.
    pub fn curvature_per_cm(&self, t: f64, curvature_per_cm: f64) -> f64 {
        let since_s = t - self.start_s;
        let event = self.event.filter(|event| !event.of_current);
        let curvature_per_cm = curvature_per_cm * event.map_or(1.0, |event| event.factor(since_s));
        let bent = curvature_per_cm + self.precurvature;
        let measured = bent + self.tip * bent.powi(3);
        let size = match self.bias_law {
            "saturating" => measured.abs() / (1.0 + measured.abs() / MUCH_PER_CM),
            "threshold" => (measured.abs() - MUCH_PER_CM).max(0.0),
            _ => measured.abs(),
        };
        let climbed = self
            .stair
            .map_or(0.0, |(step, tread_s)| step * (since_s.max(0.0) / tread_s).floor());
        measured * (1.0 + self.bias * size) + self.zero + climbed
    }

    /// Mean over the exposure from the integral at its end and start.
    pub fn mean(&self, end: f64, start: f64) -> f64 {
        (end - start) / self.exposure_s
    }
}
