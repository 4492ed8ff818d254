//! What is simulated.

use ieap_domain::Branch;

use super::effects::HiddenEffect;

/// A sample with the effects that are hidden in its data.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Branches of the base model, fastest first; at least one.
    pub branches: Vec<Branch>,
    /// Steady-state resistance R_ss, Ohm cm2; infinite where no steady current flows.
    pub steady_state_resistance_ohm_cm2: f64,
    /// Coupling alpha, 1/(C cm).
    pub charge_to_curvature_per_c_cm: f64,
    /// Rate lambda of back-relaxation, 1/s.
    pub relaxation_rate_per_s: f64,
    /// Active area A, cm2.
    pub area_cm2: f64,
    /// Free length L, cm; some effects need it.
    pub length_cm: Option<f64>,
    /// Width, cm; none: area over length.
    pub width_cm: Option<f64>,
    /// Effects; one of strength 0 is absent.
    pub effects: Vec<HiddenEffect>,
}
