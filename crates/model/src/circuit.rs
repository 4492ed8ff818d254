//! Equivalent circuits of thesis figures 7G and 8: R-C branches beside a steady-state resistor.

use super::lumped::{Branch, LumpedModel};

/// Any number of R-C branches in parallel with each other and with R_ss, per unit area: figure 7G has one branch,
/// figure 8 two.
#[derive(Debug, Clone, PartialEq)]
pub struct EquivalentCircuit {
    /// Branches; every resistance and capacitance positive and finite.
    pub branches: Vec<Branch>,
    /// Steady-state ("leakage") resistance R_ss, Ohm cm2; infinite where no steady current flows (figure 7B).
    pub steady_state_resistance_ohm_cm2: f64,
}

impl EquivalentCircuit {
    /// The branches in order of their time constants, fastest first, as tables state them.
    pub fn sorted(mut self) -> EquivalentCircuit {
        self.branches
            .sort_by(|a, b| a.time_constant_s().total_cmp(&b.time_constant_s()));
        self
    }

    /// The circuit with a strip that its stored charge bends and that relaxes back.
    pub fn with_relaxation(
        self,
        charge_to_curvature_per_c_cm: f64,
        relaxation_rate_per_s: f64,
    ) -> LumpedModel {
        LumpedModel {
            branches: self.branches,
            steady_state_resistance_ohm_cm2: self.steady_state_resistance_ohm_cm2,
            charge_to_curvature_per_c_cm,
            relaxation_rate_per_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Drive;
    use ieap_domain::testing::branch;
    use ieap_numerics::complex::Complex;
    use ieap_numerics::ode::integrate;

    fn three_branches() -> EquivalentCircuit {
        EquivalentCircuit {
            branches: vec![branch(50.0, 0.02), branch(300.0, 0.1), branch(2000.0, 0.2)],
            steady_state_resistance_ohm_cm2: 9000.0,
        }
    }

    /// Impedance of unit area at an angular frequency, Ohm cm2.
    fn impedance(circuit: &EquivalentCircuit, w: f64) -> Complex {
        let model = circuit.clone().with_relaxation(1.0, 0.0);
        model
            .admittance_a_per_v(1.0, w / std::f64::consts::TAU)
            .reciprocal()
    }

    /// Current amplitude (in phase, in quadrature) over voltage amplitude, by driving the circuit with
    /// `sin(w t)` until transients are gone and correlating over one period.
    fn admittance_by_integration(circuit: &EquivalentCircuit, w: f64) -> (f64, f64) {
        let n = circuit.branches.len();
        // A particular start, the capacitors' steady lag, would need the answer; waiting does not.
        let slowest = circuit
            .branches
            .iter()
            .map(Branch::time_constant_s)
            .fold(0.0, f64::max);
        let period = std::f64::consts::TAU / w;
        let start = (30.0 * slowest / period).ceil() * period;
        let mut state = vec![0.0; n + 2];
        let rate = |t: f64, y: &[f64], out: &mut [f64]| {
            let v = (w * t).sin();
            let mut current = v / circuit.steady_state_resistance_ohm_cm2;
            for (k, b) in circuit.branches.iter().enumerate() {
                out[k] = (v - y[k] / b.capacitance_f_per_cm2) / b.resistance_ohm_cm2;
                current += out[k];
            }
            let measuring = if t >= start { 2.0 / period } else { 0.0 };
            out[n] = measuring * current * (w * t).sin();
            out[n + 1] = measuring * current * (w * t).cos();
        };
        integrate(rate, 0.0, start, &mut state, 1e-10, 1e-14);
        (state[n], state[n + 1]) = (0.0, 0.0);
        integrate(rate, start, start + period, &mut state, 1e-10, 1e-14);
        (state[n], state[n + 1])
    }

    #[test]
    fn impedance_is_what_a_sinusoidal_drive_meets() {
        let circuit = three_branches();
        for w in [0.01, 0.2] {
            let z = impedance(&circuit, w);
            let (real, imaginary) = admittance_by_integration(&circuit, w);
            let square = real * real + imaginary * imaginary;
            assert!((z.re * square / real - 1.0).abs() < 1e-6, "{z:?}");
            assert!((-z.im * square / imaginary - 1.0).abs() < 1e-6, "{z:?}");
        }
    }

    #[test]
    fn step_response_is_the_transform_of_the_impedance() {
        // INT_0^oo (i(t) - i_ss) e^(-jwt) dt = (Y(jw) - 1/R_ss) / (jw) for a step of 1 V.
        let circuit = three_branches();
        let model = circuit.clone().with_relaxation(1.0, 0.0);
        for w in [1e-3, 0.02, 0.5] {
            let rate = |t: f64, _: &[f64], out: &mut [f64]| {
                let transient = model.current_a(&Drive::step(1.0), 1.0, &[t])[0] - 1.0 / 9000.0;
                out[0] = transient * (w * t).cos();
                out[1] = transient * (w * t).sin();
            };
            let mut transform = [0.0; 2];
            integrate(rate, 0.0, 20_000.0, &mut transform, 1e-9, 1e-15);
            let z = impedance(&circuit, w);
            let square = z.re.powi(2) + z.im.powi(2);
            let (real, imaginary) = (z.re / square - 1.0 / 9000.0, -z.im / square);
            let size = real.hypot(imaginary) / w;
            assert!(
                (transform[0] - imaginary / w).abs() < 1e-6 * size,
                "{w}: {transform:?}"
            );
            assert!(
                (transform[1] - real / w).abs() < 1e-6 * size,
                "{w}: {transform:?}"
            );
        }
    }

    #[test]
    fn impedance_has_its_limits() {
        let circuit = three_branches();
        let fast = impedance(&circuit, 1e9).re;
        let first = 1.0 / 50.0 + 1.0 / 300.0 + 1.0 / 2000.0 + 1.0 / 9000.0;
        assert!((fast * first - 1.0).abs() < 1e-12);
        assert!((impedance(&circuit, 0.0).re / 9000.0 - 1.0).abs() < 1e-15);
        let tight = EquivalentCircuit {
            steady_state_resistance_ohm_cm2: f64::INFINITY,
            ..circuit
        };
        assert_eq!(impedance(&tight, 0.0).re, f64::INFINITY);
    }

    #[test]
    fn branches_are_sorted_by_time_constant() {
        let mut circuit = three_branches();
        circuit.branches.reverse();
        assert_eq!(circuit.sorted(), three_branches());
    }
}
