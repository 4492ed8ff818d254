//! What a place in the space of parameters says of the strip.

use super::input::Strip;
use super::policy::MOST_REACH;
use ieap_model::coupling::CurvaturePerLineCharge;
use ieap_model::distributed::DistributedModel;

/// The strip with a coupling of one, and the coupling.
#[derive(Debug, Clone)]
pub(super) struct Described {
    /// The strip, its coupling one.
    pub model: DistributedModel,
    /// Coupling mu, 1/C.
    pub mu_per_c: f64,
    /// Where the electrodes begin to resist otherwise; none for even ones.
    pub contact_break: Option<Break>,
}

/// Electrodes that resist otherwise from a place on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Break {
    /// The place, cm from the clamp.
    pub place_cm: f64,
    /// Resistance beyond it over that before it.
    pub factor: f64,
}

impl Described {
    /// Raises the resistance along the electrodes until `R_e L^2 / R_c` is at least `reach`.
    pub fn reach_at_least(&mut self, reach: f64) {
        let model = &mut self.model;
        let least = reach * model.branch_resistance_ohm_cm / model.length_cm.powi(2);
        model.electrode_resistance_ohm_per_cm = model.electrode_resistance_ohm_per_cm.max(least);
    }

    /// The strip as it would be with even electrodes.
    pub fn even(&self) -> DistributedModel {
        self.model
    }
}

/// The model with these electrical parameters (logarithms of R_c in Ohm cm, C in F/cm, R_ss in Ohm cm and, where the
/// strip does not state it as exact, R_e in Ohm/cm) and a coupling of one.
pub(super) fn model_of(strip: &Strip, electrical: &[f64], relaxation_rate_per_s: f64) -> DistributedModel {
    let given = strip.held_ohm_per_cm();
    let along = given.unwrap_or_else(|| electrical[3].exp());
    DistributedModel {
        branch_resistance_ohm_cm: electrical[0]
            .exp()
            .max(along * strip.length_cm.powi(2) / MOST_REACH),
        capacitance_f_per_cm: electrical[1].exp(),
        steady_state_resistance_ohm_cm: electrical[2].exp(),
        electrode_resistance_ohm_per_cm: along,
        length_cm: strip.length_cm,
        coupling: CurvaturePerLineCharge(1.0),
        relaxation_rate_per_s,
    }
}

/// Number of electrical parameters that are fitted.
pub(super) fn electrical_parameters(strip: &Strip) -> usize {
    3 + usize::from(strip.held_ohm_per_cm().is_none())
}

/// The strip by its electrical parameters alone, which bend nothing.
pub(super) fn electrical(strip: &Strip, at: &[f64]) -> Described {
    Described {
        model: model_of(strip, at, 0.0),
        mu_per_c: 0.0,
        contact_break: None,
    }
}

/// The strip by all parameters: the electrical ones, mu in units of `scale`, and the logarithm of lambda in 1/s.
pub(super) fn whole(strip: &Strip, at: &[f64], scale: f64) -> Described {
    let electrical = electrical_parameters(strip);
    Described {
        model: model_of(strip, &at[..electrical], at[electrical + 1].exp()),
        mu_per_c: at[electrical] * scale,
        contact_break: None,
    }
}
