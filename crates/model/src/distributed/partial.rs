//! Sums of the first terms of the series of (23), as thesis figure 16A shows them. Everything else takes the sum whose rest
//! is bounded ([`super::series`]).

use std::f64::consts::PI;

use super::DistributedModel;

impl DistributedModel {
    /// Voltage at the positions (cm from the clamp), V, `elapsed_s` after a step of `step_v` from the discharged state, by
    /// the first `terms` terms of (23) with the corrected coefficients.
    pub fn voltage_of_terms_v(
        &self,
        step_v: f64,
        arc_length_cm: &[f64],
        elapsed_s: f64,
        terms: usize,
    ) -> Vec<f64> {
        let along = self.electrode_resistance_ohm_per_cm;
        let steady = along / self.steady_state_resistance_ohm_cm;
        let first = steady + along / self.branch_resistance_ohm_cm;
        let length_cm = self.length_cm;
        let root = steady.sqrt();
        let at = |&s: &f64| {
            let rest = (root * (s - length_cm)).cosh() / (root * length_cm).cosh();
            let term = |n: usize| {
                let beta = (2 * n - 1) as f64 * PI / (2.0 * length_cm);
                let square = beta * beta;
                let rate = self.charging_rate_per_s() * (square + steady) / (square + first);
                let weight = 2.0 * beta / length_cm * ((square + steady).recip() - (square + first).recip());
                weight * (beta * s).sin() * (-rate * elapsed_s).exp()
            };
            step_v * (rest - (1..=terms).map(term).sum::<f64>())
        };
        arc_length_cm.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coupling::CurvaturePerLineCharge;

    #[test]
    fn many_terms_are_the_series_and_few_are_not() {
        // The strip of thesis figure 16.
        let strip = DistributedModel {
            electrode_resistance_ohm_per_cm: 50.0,
            branch_resistance_ohm_cm: 100.0,
            capacitance_f_per_cm: 0.1,
            steady_state_resistance_ohm_cm: 10_000.0,
            length_cm: 4.0,
            coupling: CurvaturePerLineCharge(1.0),
            relaxation_rate_per_s: 0.0,
        };
        let places: Vec<f64> = (0..=40).map(|k| 0.1 * f64::from(k)).collect();
        let whole = strip.voltage_v(1.5, &places, &[2.0]);
        let apart = |terms: usize| {
            let sum = strip.voltage_of_terms_v(1.5, &places, 2.0, terms);
            sum.iter()
                .zip(whole.profile(0))
                .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
        };
        assert!(apart(200) < 1e-5, "{}", apart(200));
        assert!(apart(1) > 0.01, "{}", apart(1));
    }
}
