//! Charge stored by a reaction at one potential.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct RedoxPeak;

static ABOUT: About = About {
    id: "redox-peak",
    code: "E17",
    summary: "pseudo-capacitance at one potential",
    equation: "dq_2/de_2 = C_2 + q_r f (1 - f)/w, f = 1/(1 + e^(-(e_2 - E_0)/w)), w = 25.7 mV, of broad 90 mV",
    variants: &["sharp", "broad"],
    parameters: &[
        EffectParameter {
            key: "redox_charge_c_per_cm2",
            symbol: "q_r",
            unit: "C/cm2",
            meaning: "charge of the reaction",
        },
        EffectParameter {
            key: "redox_potential_v",
            symbol: "E_0",
            unit: "V",
            meaning: "potential at which it takes place",
        },
    ],
    vanishes: "q_r = 0",
    signature: "further charge only where the capacitor passes E_0",
    twins: &["voltage-dependent-capacitance"],
    separated_by: "voltages below and above E_0, or a slow ramp",
    sources: "Nernst equation of a surface-bound couple at 25 degrees; broadened by repulsion of its ions (Laviron 1974)",
};

/// Thermal voltage of one electron at 25 degrees, V.
const WIDTH_V: f64 = 0.0257;
/// The same of a couple whose ions repel each other, as in conducting polymers: a third of a volt at half height.
const BROAD_V: f64 = 0.09;

struct Peak {
    of_base: usize,
    charge: f64,
    potential_v: f64,
    width_v: f64,
}

impl Law for Peak {
    fn act(&self, now: &Now, _memory: f64, c: &mut Coefficients) {
        let ours = |(_, b): &(usize, &crate::extended::BranchLaw)| b.of_base == Some(self.of_base);
        let total: f64 = now
            .branches
            .iter()
            .enumerate()
            .filter(ours)
            .map(|(_, b)| b.capacitance_f_per_cm2)
            .sum();
        for (k, branch) in now.branches.iter().enumerate().filter(ours) {
            let away = (now.capacitor_v[k] - self.potential_v) / (2.0 * self.width_v);
            // f (1 - f) = 1/(2 cosh)^2.
            let bell = (2.0 * away.abs().min(300.0).cosh()).powi(-2) / self.width_v;
            c.capacitance_f_per_cm2[k] += self.charge * bell * branch.capacitance_f_per_cm2 / total;
        }
    }
    /// The sharp peak is a tenth of a volt wide.
    fn finer(&self) -> f64 {
        if self.width_v < BROAD_V { 5.0 } else { 2.0 }
    }
}

impl Equation for RedoxPeak {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let Some(slowest) = scale.base.branches.last() else {
            return Search::none();
        };
        let volts = scale.voltage_v;
        if volts == 0.0 {
            return Search::none();
        }
        let charge = slowest.capacitance_f_per_cm2 * volts;
        let limits = vec![Limits::linear(0.0, 0.5 * charge), Limits::linear(-volts, volts)];
        let potentials: &[f64] = match variant {
            0 => &[-0.6, 0.15, 0.4, 0.65, 0.85],
            _ => &[0.3, 0.7],
        };
        let potentials = potentials.iter().map(|part| part * volts).collect();
        Search::over(0.02 * charge, limits, &[potentials])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        if let Some(of_base) = system.slowest_of_base() {
            system.laws.push(Box::new(Peak {
                of_base,
                charge: parameters[0],
                potential_v: parameters[1],
                width_v: if variant == 0 { WIDTH_V } else { BROAD_V },
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn charge_of_the_peak_goes_in() {
        let times: Vec<f64> = (0..20_001).map(|k| 0.01 * f64::from(k)).collect();
        let levels = [(0.0, Some(1.0))];
        let without = respond(&[], &levels, &times, &[]);
        let reacted = |volts: f64| 1.0 / (1.0 + (-(volts - 0.4) / super::BROAD_V).exp());
        for (variant, part) in [1.0, reacted(1.0) - reacted(0.0)].into_iter().enumerate() {
            let effect = ("redox-peak", variant, [0.05, 0.4].as_slice());
            let with = respond(&[effect], &levels, &times, &[]);
            let pairs = with.current_a.iter().zip(&without.current_a);
            let more: f64 = pairs.map(|(a, b)| 0.01 * (a - b)).sum();
            assert!(
                (more / (0.1 * 0.05 * part) - 1.0).abs() < 2e-3,
                "{variant}: {more}"
            );
        }
    }
}
