//! Equivalent circuits of thesis figures 7 and 8: R-C branches beside a steady-state resistor, and the reductions
//! of other drawings to that form.

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

/// Impedance of unit area at one frequency, Ohm cm2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impedance {
    /// Real part (in phase), Ohm cm2.
    pub real_ohm_cm2: f64,
    /// Imaginary part, Ohm cm2; negative for a capacitive circuit.
    pub imaginary_ohm_cm2: f64,
}

impl EquivalentCircuit {
    /// Impedance at the angular frequency `angular_frequency_per_s` (2 pi f), from the admittances of the branches
    /// `Y_k = (w^2 tau_k C_k + j w C_k) / (1 + w^2 tau_k^2)`. Infinite at zero frequency where nothing leaks.
    pub fn impedance(&self, angular_frequency_per_s: f64) -> Impedance {
        let w = angular_frequency_per_s;
        let (mut real, mut imaginary) = (self.steady_state_resistance_ohm_cm2.recip(), 0.0);
        for branch in &self.branches {
            let turn = w * branch.time_constant_s();
            let through = w * branch.capacitance_f_per_cm2 / (1.0 + turn * turn);
            real += turn * through;
            imaginary += through;
        }
        let square = real * real + imaginary * imaginary;
        if square == 0.0 {
            return Impedance {
                real_ohm_cm2: f64::INFINITY,
                imaginary_ohm_cm2: 0.0,
            };
        }
        Impedance {
            real_ohm_cm2: real / square,
            imaginary_ohm_cm2: -imaginary / square,
        }
    }

    /// Resistance that limits the first current after a step, Ohm cm2: the branches and R_ss in parallel.
    pub fn instantaneous_resistance_ohm_cm2(&self) -> f64 {
        let branches = self.branches.iter().map(|b| b.resistance_ohm_cm2.recip());
        (branches.sum::<f64>() + self.steady_state_resistance_ohm_cm2.recip()).recip()
    }

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

/// One R-C chain from resistors and capacitors in series (figure 7A to 7B): resistances add, capacitances as
/// their reciprocals. The two electrodes' double layers in series are such a pair.
///
/// None where a list is empty.
pub fn series_chain(resistances_ohm_cm2: &[f64], capacitances_f_per_cm2: &[f64]) -> Option<Branch> {
    if resistances_ohm_cm2.is_empty() || capacitances_f_per_cm2.is_empty() {
        return None;
    }
    let elastance: f64 = capacitances_f_per_cm2.iter().map(|c| c.recip()).sum();
    Some(Branch {
        resistance_ohm_cm2: resistances_ohm_cm2.iter().sum(),
        capacitance_f_per_cm2: elastance.recip(),
    })
}

/// An R-C chain that a leak bridges in part: `outer` in series with (`leak` beside (`inner` in series with C)).
///
/// Where a leak can sit in the drawings 7C to 7E: across the terminals (`outer` 0), across the laminate between
/// the electrodes' resistances (both positive), or across the capacitors (`inner` 0, which is form 7F). The
/// thesis's text says only that all of them reduce to 7F and 7G; with any placement they do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgedChain {
    /// Resistance outside the leak, Ohm cm2; not negative.
    pub outer_resistance_ohm_cm2: f64,
    /// Resistance inside the leak, in series with the capacitance, Ohm cm2; not negative, and positive where
    /// there is none outside.
    pub inner_resistance_ohm_cm2: f64,
    /// The leak, Ohm cm2; infinite where there is none.
    pub leak_resistance_ohm_cm2: f64,
    /// Capacitance, F/cm2.
    pub capacitance_f_per_cm2: f64,
}

impl BridgedChain {
    /// The same one-port in the form of figure 7G: one branch beside R_ss. With x = outer/leak
    /// `R_ss = outer + leak`, `R_c = (1 + x)(outer + (1 + x) inner)`, `C' = C/(1 + x)^2`.
    pub fn canonical(&self) -> EquivalentCircuit {
        let raised = 1.0 + self.outer_resistance_ohm_cm2 / self.leak_resistance_ohm_cm2;
        EquivalentCircuit {
            branches: vec![Branch {
                resistance_ohm_cm2: raised
                    * (self.outer_resistance_ohm_cm2 + raised * self.inner_resistance_ohm_cm2),
                capacitance_f_per_cm2: self.capacitance_f_per_cm2 / (raised * raised),
            }],
            steady_state_resistance_ohm_cm2: self.outer_resistance_ohm_cm2 + self.leak_resistance_ohm_cm2,
        }
    }

    /// Charge on the real capacitor over charge on that of the canonical form: `1 + outer/leak`, at all times.
    ///
    /// Terminals cannot tell the drawings apart, but the strip is bent by the charge that is really stored: a
    /// coupling alpha identified with the canonical form is too large by this factor for the drawing.
    pub fn charge_ratio(&self) -> f64 {
        1.0 + self.outer_resistance_ohm_cm2 / self.leak_resistance_ohm_cm2
    }

    /// The form of figure 7F, a resistor before a leaking capacitor, of a branch beside R_ss (figure 7G); with
    /// y = R_c/R_ss `outer = R_c/(1 + y)`, `leak = R_ss/(1 + y)`, `C = C'(1 + y)^2`.
    pub fn leaking_capacitor(branch: &Branch, steady_state_resistance_ohm_cm2: f64) -> BridgedChain {
        let raised = 1.0 + branch.resistance_ohm_cm2 / steady_state_resistance_ohm_cm2;
        BridgedChain {
            outer_resistance_ohm_cm2: branch.resistance_ohm_cm2 / raised,
            inner_resistance_ohm_cm2: 0.0,
            leak_resistance_ohm_cm2: steady_state_resistance_ohm_cm2 / raised,
            capacitance_f_per_cm2: branch.capacitance_f_per_cm2 * raised * raised,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Drive;
    use ieap_domain::testing::branch;
    use ieap_numerics::ode::integrate;

    fn three_branches() -> EquivalentCircuit {
        EquivalentCircuit {
            branches: vec![branch(50.0, 0.02), branch(300.0, 0.1), branch(2000.0, 0.2)],
            steady_state_resistance_ohm_cm2: 9000.0,
        }
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
            let z = circuit.impedance(w);
            let (real, imaginary) = admittance_by_integration(&circuit, w);
            let square = real * real + imaginary * imaginary;
            assert!((z.real_ohm_cm2 * square / real - 1.0).abs() < 1e-6, "{z:?}");
            assert!(
                (-z.imaginary_ohm_cm2 * square / imaginary - 1.0).abs() < 1e-6,
                "{z:?}"
            );
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
            let z = circuit.impedance(w);
            let square = z.real_ohm_cm2.powi(2) + z.imaginary_ohm_cm2.powi(2);
            let (real, imaginary) = (
                z.real_ohm_cm2 / square - 1.0 / 9000.0,
                -z.imaginary_ohm_cm2 / square,
            );
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
        let fast = circuit.impedance(1e9).real_ohm_cm2;
        assert!((fast / circuit.instantaneous_resistance_ohm_cm2() - 1.0).abs() < 1e-12);
        assert!((circuit.impedance(0.0).real_ohm_cm2 / 9000.0 - 1.0).abs() < 1e-15);
        let tight = EquivalentCircuit {
            steady_state_resistance_ohm_cm2: f64::INFINITY,
            ..circuit
        };
        assert_eq!(tight.impedance(0.0).real_ohm_cm2, f64::INFINITY);
    }

    /// Current and stored charge of the drawing itself after a step of 1 V, by integrating Kirchhoff's laws.
    fn drawn(chain: &BridgedChain, t: f64) -> (f64, f64) {
        let (a, b, leak) = (
            chain.outer_resistance_ohm_cm2,
            chain.inner_resistance_ohm_cm2,
            chain.leak_resistance_ohm_cm2,
        );
        // Mesh currents: i through the outer resistor, j through the capacitor; the leak carries i - j.
        // 1 = a i + leak (i - j), leak (i - j) = b j + q/C.
        let currents = |q: f64| {
            let across_capacitor = q / chain.capacitance_f_per_cm2;
            let j = (leak - across_capacitor * (a + leak)) / (b * (a + leak) + a * leak);
            ((1.0 + leak * j) / (a + leak), j)
        };
        let mut q = [0.0];
        integrate(
            |_, q, out| out[0] = currents(q[0]).1,
            0.0,
            t,
            &mut q,
            1e-12,
            1e-18,
        );
        (currents(q[0]).0, q[0])
    }

    #[test]
    fn every_drawing_and_its_canonical_form_carry_the_same_current_but_not_the_same_charge() {
        for (outer, inner) in [(0.0, 40.0), (15.0, 25.0), (40.0, 0.0)] {
            let chain = BridgedChain {
                outer_resistance_ohm_cm2: outer,
                inner_resistance_ohm_cm2: inner,
                leak_resistance_ohm_cm2: 90.0,
                capacitance_f_per_cm2: 0.1,
            };
            let model = chain.canonical().with_relaxation(1.0, 0.0);
            let drive = Drive::step(1.0);
            for t in [0.0, 0.5, 3.0, 20.0] {
                let (current, charge) = drawn(&chain, t);
                let canonical = model.current_a(&drive, 1.0, &[t])[0];
                assert!((canonical / current - 1.0).abs() < 1e-9, "{canonical} {current}");
                let stored = chain.charge_ratio() * model.charge_c(&drive, 1.0, &[t])[0];
                assert!(
                    (stored - charge).abs() < 1e-9 * chain.capacitance_f_per_cm2,
                    "{stored} {charge}"
                );
            }
        }
    }

    #[test]
    fn forms_f_and_g_turn_into_each_other() {
        let g = branch(90.0, 0.07);
        for rss in [300.0, f64::INFINITY] {
            let back = BridgedChain::leaking_capacitor(&g, rss).canonical();
            assert!((back.branches[0].resistance_ohm_cm2 / 90.0 - 1.0).abs() < 1e-14);
            assert!((back.branches[0].capacitance_f_per_cm2 / 0.07 - 1.0).abs() < 1e-14);
            assert!((rss / back.steady_state_resistance_ohm_cm2 - 1.0).abs() < 1e-14 || rss.is_infinite());
            assert_eq!(
                back.steady_state_resistance_ohm_cm2.is_infinite(),
                rss.is_infinite()
            );
        }
    }

    #[test]
    fn a_series_chain_has_one_resistor_and_one_capacitor() {
        let chain = series_chain(&[5.0, 20.0, 5.0], &[0.2, 0.2]).unwrap();
        assert_eq!(chain, branch(30.0, 0.1));
        assert_eq!(series_chain(&[], &[0.1]), None);
    }

    #[test]
    fn branches_are_sorted_by_time_constant() {
        let mut circuit = three_branches();
        circuit.branches.reverse();
        assert_eq!(circuit.sorted(), three_branches());
    }
}
