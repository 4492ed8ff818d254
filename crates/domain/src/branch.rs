//! One branch of the equivalent circuit.

/// A resistance in series with a capacitance, both of unit area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Areal resistance R_k, Ohm cm2; positive.
    pub resistance_ohm_cm2: f64,
    /// Areal capacitance C_k, F/cm2; positive.
    pub capacitance_f_per_cm2: f64,
}

impl Branch {
    /// Time constant tau_k = R_k C_k, s.
    pub fn time_constant_s(&self) -> f64 {
        self.resistance_ohm_cm2 * self.capacitance_f_per_cm2
    }
}
