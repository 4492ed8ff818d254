//! Stiffness that changes during the run.

use super::acting::{APPROACHES, LEAST, approached, read_as};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ModulusDrift;

static ABOUT: About = About {
    id: "modulus-drift",
    code: "M4",
    summary: "stiffness changes during the run",
    equation: "kappa = kappa_q/(1 - e g(t/tau)), t the time since the start of the drive; exponential: g = 1 - e^-x; diffusive: g = 1 - SUM 8/((2n+1)^2 pi^2) e^(-(2n+1)^2 x); delayed: g = 1 - (1 + x) e^-x",
    variants: &APPROACHES,
    parameters: &[
        EffectParameter {
            key: "softening",
            symbol: "e",
            unit: "",
            meaning: "part of the stiffness lost in the end",
        },
        EffectParameter {
            key: "time_constant_s",
            symbol: "tau",
            unit: "s",
            meaning: "time in which it changes",
        },
    ],
    vanishes: "e = 0",
    signature: "multiplies the bending by clock time",
    twins: &[
        "second-relaxation",
        "coupling-saturation",
        "faradaic-leak",
        "clock-rate",
    ],
    separated_by: "a pulse train, or the force of a strip that is held",
    sources: "hydration-dependent modulus of ionomers; uptake of a sheet (Crank 1975)",
};

impl Equation for ModulusDrift {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let limits = vec![
            Limits::linear(-1.0, 0.6),
            Limits::logarithmic(scale.longest_s() / 50.0, 2.0 * scale.longest_s()),
        ];
        let times_s = match variant {
            0 => scale.times_s(0.03, 1.0, 4),
            _ => scale.times_s(0.06, 0.4, 2),
        };
        Search::over(0.01, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [lost, time_s] = [parameters[0], parameters[1]];
        system.observations.push(read_as(move |t, kappa| {
            kappa / (1.0 - lost * approached(variant, t / time_s)).max(LEAST)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn in_the_end_the_strip_is_softer() {
        let levels = [(0.0, Some(2.0))];
        for variant in 0..super::APPROACHES.len() {
            let with = respond(&[("modulus-drift", variant, &[0.2, 5.0])], &levels, &[], &[200.0]);
            let without = respond(&[], &levels, &[], &[200.0]);
            assert!((with.curvature_per_cm[0] / without.curvature_per_cm[0] - 1.25).abs() < 1e-9);
        }
    }
}
