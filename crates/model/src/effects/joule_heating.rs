//! Dissipated heat warms the strip and lowers its resistances.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};

/// See the module.
pub(super) struct JouleHeating;

static ABOUT: About = About {
    id: "joule-heating",
    code: "N1",
    summary: "R falls with dissipated heat",
    equation: "theta' = i u - theta/tau (per cm2), R_k = R_k0 e^(-h theta), of both lambda = lambda_0 e^(h theta) too",
    variants: &["resistance", "both"],
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
    quickens_relaxation: bool,
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
        if self.quickens_relaxation {
            c.relaxation_factor /= factor;
        }
    }
}

impl Equation for JouleHeating {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let relaxes = scale.curvature_per_cm > 0.0 && scale.base.relaxation_rate_per_s > 0.0;
        if variant == 1 && !relaxes {
            return Search::none();
        }
        let energy = scale.charge_c * scale.voltage_v / scale.area_cm2;
        if energy <= 0.0 {
            return Search::none();
        }
        let most = (2.0 / energy).min(MOST_CM2_PER_J);
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(3.0, 100.0)];
        let times_s = if variant == 0 {
            vec![8.0, 20.0, 50.0]
        } else {
            vec![12.0, 40.0]
        };
        Search::over(0.01 * most, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.laws.push(Box::new(Heat {
            per_j: parameters[0],
            time_s: parameters[1],
            quickens_relaxation: variant == 1,
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{respond, scale};
    use super::*;

    /// Heat that never leaves is the energy put in; a late step relaxes faster by what it did.
    #[test]
    fn heat_quickens_the_relaxation_where_it_is_said_to() {
        let levels = [(0.0, Some(2.0))];
        let rate = |variant| {
            let effect = ("joule-heating", variant, [0.4, 1e9].as_slice());
            let kappa = respond(&[effect], &levels, &[], &[300.0, 300.5]).curvature_per_cm;
            (kappa[0] / kappa[1]).ln() / 0.5
        };
        // Charging 0.7 F/cm2 takes C V^2, the leak V^2/R_ss.
        let energy: f64 = 4.0 * (0.7 + 300.25 / 300.0);
        assert!((rate(0) / 0.012 - 1.0).abs() < 1e-3, "{}", rate(0));
        assert!(
            (rate(1) / (0.012 * (0.4 * energy).exp()) - 1.0).abs() < 0.01,
            "{}",
            rate(1)
        );
    }

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
