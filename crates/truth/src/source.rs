//! The source and the contact.
//!
//! - `source-rise`: `source' = (level - source)/tau`, from the level before the edge. The source follows the strip
//!   while the circuit is open, and starts from there when it is closed again. With d = level - source: "slew":
//!   `source' = tanh(d/0.02 V) 1 V/tau`; "creeping": `source' = d |d|/(1 V tau)`.
//! - `current-limit`: where the current would exceed the limit the voltage falls so that it is the limit. "soft": it is
//!   i/(1 + (i/limit)^4)^(1/4), i the current of the full voltage; "one-sided": positive currents alone are limited.
//! - `contact-break`: from `break_time_s` (clock time) on R_1, R_2 and R_ss ("resistance"), C_1 and C_2
//!   ("capacitance": the voltages stay, the charge of the lost part is lost without a change of bending), or the
//!   curvature per strain ("coupling") are multiplied by 1 + factor_change. Without `run` in every run. With t from the
//!   break on, the change is multiplied by `1 - exp(-t/20 s)` ("gradual") or `exp(-t/60 s)` ("healing").
//! - `current-offset`: a constant added to the measured current, also before the drive and in an open circuit.
//! - `sensing-feedback`: the source is raised by `gamma kappa'`, kappa the curvature of charge and back-relaxation
//!   alone (saturation, motion and surroundings do not enter). "saturating": by `gamma r tanh(kappa'/r)`,
//!   r = 0.02/(cm s); "position": by `gamma kappa/(10 s)`.
//! - `x-polarity-memory`: R_1, R_2 times 1 + m under a voltage of the sign of the one held before it (zeros left out),
//!   times 1 - m where that had the other sign, and as they are where there was none.

use super::effects::Effects;
use super::environment::Factors;

/// Rate of bending that is fast where the induced voltage saturates, 1/(cm s).
const MUCH_PER_CM_S: f64 = 0.02;
/// Time that makes a curvature a rate where the position induces the voltage, s.
const POSITION_S: f64 = 10.0;
/// Time in which a break grows, and in which one heals, s.
const BREAKING_S: f64 = 20.0;
const HEALING_S: f64 = 60.0;

/// The source's own effects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Source {
    /// Time constant, s; 0: it follows at once.
    pub rise_time_s: f64,
    /// Largest current, A per cm2 of the strip.
    pub limit: f64,
    /// Voltage per rate of curvature, V s cm.
    pub emf_v_s_cm: f64,
    rise_law: &'static str,
    limit_law: &'static str,
    emf_law: &'static str,
}

impl Source {
    pub fn new(effects: &Effects, area_cm2: f64) -> Source {
        let limit = effects.get("current-limit");
        Source {
            rise_time_s: effects.value("source-rise", "rise_time_s"),
            limit: limit.map_or(f64::INFINITY, |effect| effect.value("limit_a") / area_cm2),
            emf_v_s_cm: effects.value("sensing-feedback", "emf_v_s_cm"),
            rise_law: effects.law("source-rise"),
            limit_law: effects.law("current-limit"),
            emf_law: effects.law("sensing-feedback"),
        }
    }

    /// Rate at which the source follows its level, V/s.
    pub fn rise(&self, behind_v: f64) -> f64 {
        let rising = match self.rise_law {
            "slew" => (behind_v / 0.02).tanh(),
            "creeping" => behind_v * behind_v.abs(),
            _ => behind_v,
        };
        rising / self.rise_time_s
    }

    /// What the source gives of a current, A/cm2; none: all of it.
    pub fn limited(&self, current: f64) -> Option<f64> {
        match self.limit_law {
            _ if self.limit.is_infinite() => None,
            "soft" => Some(current / (1.0 + (current / self.limit).powi(4)).powf(0.25)),
            "one-sided" if current < 0.0 => None,
            _ => (current.abs() > self.limit).then(|| self.limit.copysign(current)),
        }
    }

    /// Voltage that the motion induces, V, at that rate (1/(cm s)) and curvature (1/cm).
    pub fn induced_v(&self, rate: f64, curvature: f64) -> f64 {
        let answer = match self.emf_law {
            "saturating" => MUCH_PER_CM_S * (rate / MUCH_PER_CM_S).tanh(),
            "position" => curvature / POSITION_S,
            _ => rate,
        };
        self.emf_v_s_cm * answer
    }
}

/// What a break multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Broken {
    Resistance,
    Capacitance,
    Coupling,
}

/// A contact that breaks at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Break {
    /// Clock time, s.
    pub at_s: f64,
    what: Broken,
    change: f64,
    law: &'static str,
}

impl Break {
    pub fn new(effects: &Effects) -> Option<Break> {
        let effect = effects.get("contact-break")?;
        Some(Break {
            at_s: effect.value("break_time_s"),
            what: if effect.is("resistance") {
                Broken::Resistance
            } else if effect.is("capacitance") {
                Broken::Capacitance
            } else {
                Broken::Coupling
            },
            change: effect.value("factor_change"),
            law: effect.law(),
        })
    }

    /// Multiplies what is broken at that clock time.
    pub fn apply(&self, clock_s: f64, factors: &mut Factors) {
        let since_s = (clock_s - self.at_s).max(0.0);
        let factor = 1.0
            + self.change
                * match self.law {
                    "gradual" => -(-since_s / BREAKING_S).exp_m1(),
                    "healing" => (-since_s / HEALING_S).exp(),
                    _ => 1.0,
                };
        match self.what {
            Broken::Resistance => {
                factors.resistance *= factor;
                factors.steady_resistance *= factor;
            }
            Broken::Capacitance => factors.capacitance *= factor,
            Broken::Coupling => factors.coupling *= factor,
        }
    }
}

/// The polarity before.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Memory {
    change: f64,
    /// Sign of the voltage that was held last, 0 where none was.
    last: f64,
    /// 1 where the one before had the same sign, -1 the other.
    agrees: f64,
}

impl Memory {
    pub fn new(effects: &Effects, baseline_v: f64) -> Memory {
        let mut memory = Memory {
            change: effects.value("x-polarity-memory", "change"),
            ..Memory::default()
        };
        memory.holds(baseline_v);
        memory
    }

    /// Factor on R_1 and R_2.
    pub fn factor(&self) -> f64 {
        1.0 + self.change * self.agrees
    }

    /// From now on this voltage is held.
    pub fn holds(&mut self, v: f64) {
        if v != 0.0 {
            self.agrees = self.last * v.signum();
            self.last = v.signum();
        }
    }
}
