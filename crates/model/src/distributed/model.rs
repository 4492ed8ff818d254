//! Parameters of a strip per unit of its length, and of the laminate that it is cut from.

use crate::coupling::{ActiveArea, CurvaturePerArealCharge, CurvaturePerLineCharge};
use crate::lumped::Branch;

/// Parameters of a strip per unit of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistributedModel {
    /// Resistance R_e of both electrodes along the strip, Ohm/cm; zero makes the strip a lumped one.
    pub electrode_resistance_ohm_per_cm: f64,
    /// Resistance R_c of the chain across the laminate, Ohm cm; positive.
    pub branch_resistance_ohm_cm: f64,
    /// Capacitance C, F/cm; positive.
    pub capacitance_f_per_cm: f64,
    /// Steady-state resistance R_ss across the laminate, Ohm cm; infinite where no steady current flows.
    pub steady_state_resistance_ohm_cm: f64,
    /// Free length L, cm; positive.
    pub length_cm: f64,
    /// Curvature per local line charge, mu of (26).
    pub coupling: CurvaturePerLineCharge,
    /// Rate lambda of back-relaxation, 1/s; not negative.
    pub relaxation_rate_per_s: f64,
}

/// The laminate that a strip is cut from: the parameters as thesis table 3 states them, per area and per square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laminate {
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub electrode_resistance_ohm_per_sq: f64,
    /// The chain across the laminate, Ohm cm2 and F/cm2.
    pub branch: Branch,
    /// Steady-state resistance, Ohm cm2.
    pub steady_state_resistance_ohm_cm2: f64,
    /// Curvature per areal charge.
    pub coupling: CurvaturePerArealCharge,
    /// Rate lambda of back-relaxation, 1/s.
    pub relaxation_rate_per_s: f64,
}

impl Laminate {
    /// A strip of that length and width: `R_e = R_sq/b`, `R_c = R_areal/b`, `C = C_areal b`.
    pub fn strip(&self, of: &ActiveArea) -> DistributedModel {
        DistributedModel {
            electrode_resistance_ohm_per_cm: self.electrode_resistance_ohm_per_sq / of.width_cm,
            branch_resistance_ohm_cm: self.branch.resistance_ohm_cm2 / of.width_cm,
            capacitance_f_per_cm: self.branch.capacitance_f_per_cm2 * of.width_cm,
            steady_state_resistance_ohm_cm: self.steady_state_resistance_ohm_cm2 / of.width_cm,
            length_cm: of.length_cm,
            coupling: self.coupling.line(of),
            relaxation_rate_per_s: self.relaxation_rate_per_s,
        }
    }
}

impl DistributedModel {
    /// Charging rate r = 1/(R_c C) of a cell whose voltage is held, 1/s: the limit of the modes' rates k_n.
    pub fn charging_rate_per_s(&self) -> f64 {
        (self.branch_resistance_ohm_cm * self.capacitance_f_per_cm).recip()
    }

    /// `g^2 = R_e/R_ss`, 1/cm2: how the voltage falls along the strip in the end.
    pub(crate) fn steady_decay_per_cm2(&self) -> f64 {
        self.electrode_resistance_ohm_per_cm / self.steady_state_resistance_ohm_cm
    }

    /// `R_e/R_c`, 1/cm2: what the empty capacitors add to g^2 at the first instant.
    pub(crate) fn charging_decay_per_cm2(&self) -> f64 {
        self.electrode_resistance_ohm_per_cm / self.branch_resistance_ohm_cm
    }

    /// `g0^2 = R_e (1/R_c + 1/R_ss)`, 1/cm2: how the voltage falls along the strip at the first instant.
    pub(crate) fn first_decay_per_cm2(&self) -> f64 {
        self.steady_decay_per_cm2() + self.charging_decay_per_cm2()
    }
}
