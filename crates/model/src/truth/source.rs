//! The source and the contact.
//!
//! - `source-rise`: `source' = (level - source)/tau`, from the level before the edge. The source follows the strip
//!   while the circuit is open, and starts from there when it is closed again.
//! - `current-limit`: where the current would exceed the limit the voltage falls so that it is the limit.
//! - `contact-break`: from `break_time_s` (clock time) on R_1, R_2 and R_ss ("resistance"), C_1 and C_2
//!   ("capacitance": the voltages stay, the charge of the lost part is lost without a change of bending), or the
//!   curvature per strain ("coupling") are multiplied by 1 + factor_change. Without `run` in every run.
//! - `current-offset`: a constant added to the measured current, also before the drive and in an open circuit.
//! - `sensing-feedback`: the source is raised by `gamma kappa'`, kappa the curvature of charge and back-relaxation
//!   alone (saturation, motion and surroundings do not enter).

use super::effects::Effects;
use super::environment::Factors;

/// The source's own effects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Source {
    /// Time constant, s; 0: it follows at once.
    pub rise_time_s: f64,
    /// Largest current, A per cm2 of the strip.
    pub limit: f64,
    /// Voltage per rate of curvature, V s cm.
    pub emf_v_s_cm: f64,
}

impl Source {
    pub fn new(effects: &Effects, area_cm2: f64) -> Source {
        let limit = effects.get("current-limit");
        Source {
            rise_time_s: effects.value("source-rise", "rise_time_s"),
            limit: limit.map_or(f64::INFINITY, |effect| effect.value("limit_a") / area_cm2),
            emf_v_s_cm: effects.value("sensing-feedback", "emf_v_s_cm"),
        }
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
    factor: f64,
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
            factor: 1.0 + effect.value("factor_change"),
        })
    }

    /// Multiplies what is broken.
    pub fn apply(&self, factors: &mut Factors) {
        match self.what {
            Broken::Resistance => {
                factors.resistance *= self.factor;
                factors.steady_resistance *= self.factor;
            }
            Broken::Capacitance => factors.capacitance *= self.factor,
            Broken::Coupling => factors.coupling *= self.factor,
        }
    }
}
