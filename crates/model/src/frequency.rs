//! The lumped model under a small sine that has lasted for ever: current and curvature per volt, in closed form.
//!
//! With `s = j 2 pi f`, a branch takes the current `s C_k / (1 + s R_k C_k)` per volt and unit area and holds the charge
//! `C_k / (1 + s R_k C_k)`; the spring feels `s / (s + lambda)` of the charge (14).

use std::f64::consts::TAU;

use ieap_numerics::complex::Complex;

use super::lumped::LumpedModel;

impl LumpedModel {
    /// Current per volt at a frequency, A/V, for a sample of `area_cm2`.
    pub fn admittance_a_per_v(&self, area_cm2: f64, frequency_hz: f64) -> Complex {
        let s = Complex::new(0.0, TAU * frequency_hz);
        let leak = Complex::new(self.steady_state_resistance_ohm_cm2.recip(), 0.0);
        (leak + s * self.charge_per_volt(s)) * area_cm2
    }

    /// Curvature per volt at a frequency above 0, 1/(cm V).
    pub fn curvature_per_cm_v(&self, area_cm2: f64, frequency_hz: f64) -> Complex {
        let s = Complex::new(0.0, TAU * frequency_hz);
        let kept = s / (s + Complex::new(self.relaxation_rate_per_s, 0.0));
        self.charge_per_volt(s) * kept * (self.charge_to_curvature_per_c_cm * area_cm2)
    }

    /// Charge of unit area per volt, F/cm2.
    fn charge_per_volt(&self, s: Complex) -> Complex {
        let of_branch = |branch: &super::Branch| {
            let held = Complex::ONE + s * branch.time_constant_s();
            held.reciprocal() * branch.capacitance_f_per_cm2
        };
        self.branches
            .iter()
            .map(of_branch)
            .fold(Complex::ZERO, |sum, part| sum + part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ode::integrate_under;
    use ieap_domain::testing::branch;

    #[test]
    fn a_sine_that_lasts_gives_what_the_differential_equation_settles_to() {
        let model = LumpedModel {
            branches: vec![branch(23.4, 0.06), branch(43.1, 1.94)],
            steady_state_resistance_ohm_cm2: 1720.0,
            charge_to_curvature_per_c_cm: 3.02,
            relaxation_rate_per_s: 5e-2,
        };
        let area_cm2 = 0.1;
        for frequency_hz in [0.004, 0.1, 2.0] {
            let w = TAU * frequency_hz;
            // Five hundred seconds are six of the slowest time constant; whole periods follow.
            let start_s = (1200.0 * frequency_hz).ceil() / frequency_hz;
            let times: Vec<f64> = (0..64)
                .map(|k| start_s + k as f64 / 64.0 / frequency_hz)
                .collect();
            let time_s: Vec<f64> = std::iter::once(0.0).chain(times).collect();
            let found = integrate_under(&model, |t| (w * t).cos(), area_cm2, &time_s, 1e-10);
            let settled = |series: &[f64]| {
                let waves = time_s[1..].iter().zip(&series[1..]);
                waves.fold(Complex::ZERO, |sum, (t, y)| {
                    sum + Complex::new((w * t).cos(), -(w * t).sin()) * (y / 32.0)
                })
            };
            let pairs = [
                (
                    settled(&found.current_a),
                    model.admittance_a_per_v(area_cm2, frequency_hz),
                ),
                (
                    settled(&found.curvature_per_cm),
                    model.curvature_per_cm_v(area_cm2, frequency_hz),
                ),
            ];
            for (integrated, closed) in pairs {
                let off = (integrated - closed).magnitude() / closed.magnitude();
                assert!(off < 1e-5, "{frequency_hz} Hz: {integrated:?} {closed:?}");
            }
        }
    }
}
