//! Dissipated heat warms the strip and lowers its resistances.

use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct JouleHeating;

static ABOUT: About = About {
    id: "joule-heating",
    code: "N1",
    class: Class::Drift,
    summary: "R falls with dissipated heat",
    equation: "theta' = i u - theta/tau (per cm2), R_k = R_k0 e^(-h theta)",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "softening_cm2_per_j",
            symbol: "h",
            unit: "cm2/J",
            meaning: "relative fall of the resistances per heat kept",
        },
        EffectParameter {
            key: "cooling_time_s",
            symbol: "tau",
            unit: "s",
            meaning: "time in which the heat leaves",
        },
    ],
    vanishes: "h = 0",
    signature: "the current rises for seconds, with the square of the voltage or more, alike for both signs",
    twins: &[
        "piezoresistive-electrode",
        "water-redistribution",
        "asymmetric-capacitance",
    ],
    separated_by: "reversed polarity; the heat set free bounds it (a few kelvin at most)",
    sources: "energy balance of the strip; Vogel-Fulcher-Tammann viscosity of ionic liquids",
};

/// Largest fall of the resistances per heat: 5 % a kelvin, in a strip of 0.1 mm that holds 2 J/(cm3 K). What needs more is
/// another cause, however well this one fits: the energy that was put in bounds it.
const MOST_CM2_PER_J: f64 = 2.5;

struct Heat {
    per_j: f64,
    time_s: f64,
}

impl Law for Heat {
    fn memory_time_s(&self) -> Option<f64> {
        Some(self.time_s)
    }
    fn finer(&self) -> f64 {
        2.0
    }
    fn memory_input(&self, now: &Now) -> f64 {
        now.current_a_per_cm2 * now.terminal_v
    }
    fn act(&self, _now: &Now, heat: f64, c: &mut Coefficients) {
        let factor = (-self.per_j * heat).clamp(-3.0, 3.0).exp();
        c.resistance_ohm_cm2.iter_mut().for_each(|r| *r *= factor);
    }
}

impl Effect for JouleHeating {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let energy = scale.charge_c * scale.voltage_v / scale.area_cm2;
        if energy <= 0.0 {
            return Search::none();
        }
        let most = (2.0 / energy).min(MOST_CM2_PER_J);
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(3.0, 100.0)];
        Search::over(0.01 * most, limits, &[vec![8.0, 20.0, 50.0]])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.laws.push(Box::new(Heat {
            per_j: parameters[0],
            time_s: parameters[1],
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::scale;
    use super::*;

    /// A capacitor of 100 uF at 5 V takes 2.5 mJ: it cannot warm anything by what a fit would ask for.
    #[test]
    fn the_energy_put_in_bounds_the_fall() {
        let of = |energy_j_per_cm2: f64| {
            let mut scale = scale();
            scale.charge_c = energy_j_per_cm2 * scale.area_cm2 / scale.voltage_v;
            let search = JouleHeating.search(0, &scale);
            search.limits[0].high * energy_j_per_cm2
        };
        assert!((of(10.0) - 2.0).abs() < 1e-12);
        assert!((of(2.5e-3) - 2.5 * 2.5e-3).abs() < 1e-12);
    }
}
