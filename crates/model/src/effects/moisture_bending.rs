//! One side wetter than the other: the strip bends by itself.

use super::acting::{APPROACHES, approached, read_as};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct MoistureBending;

static ABOUT: About = About {
    id: "moisture-bending",
    code: "N4",
    summary: "one side wetter: baseline bends by itself",
    equation: "kappa -> kappa + k g(t/tau), t the time since the start of the drive; exponential: g = 1 - e^-x; diffusive: g = 1 - SUM 8/((2n+1)^2 pi^2) e^(-(2n+1)^2 x); delayed: g = 1 - (1 + x) e^-x",
    variants: &APPROACHES,
    parameters: &[
        EffectParameter {
            key: "bending_per_cm",
            symbol: "k",
            unit: "1/cm",
            meaning: "bending in the end",
        },
        EffectParameter {
            key: "time_constant_s",
            symbol: "tau",
            unit: "s",
            meaning: "time of the exchange",
        },
    ],
    vanishes: "k = 0",
    signature: "a drift with the same sign for both polarities",
    twins: &[
        "partial-relaxation",
        "creep",
        "counter-flow",
        "leak-coupling",
        "camera-zero",
    ],
    separated_by: "reversed polarity; readings before the drive for a quarter of the run",
    sources: "hygroscopic bending of laminates; uptake of a sheet (Crank 1975)",
};

impl Equation for MoistureBending {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let most = scale.curvature_per_cm;
        let longest_s = scale.longest_s();
        let limits = vec![
            Limits::linear(-most, most),
            Limits::logarithmic(longest_s / 100.0, 5.0 * longest_s),
        ];
        let times_s = match variant {
            0 => scale.times_s(0.03, 2.0, 4),
            _ => scale.times_s(0.06, 0.6, 2),
        };
        Search::over(0.01 * most, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [bending, time_s] = [parameters[0], parameters[1]];
        system.observations.push(read_as(move |t, kappa| {
            kappa + bending * approached(variant, t / time_s)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn without_a_drive_it_bends_alone() {
        let of = |variant, t| {
            let effect = ("moisture-bending", variant, [0.05, 20.0].as_slice());
            respond(&[effect], &[(0.0, Some(0.0))], &[], &[t]).curvature_per_cm[0]
        };
        assert!((of(0, 20.0) + 0.05 * (-1.0_f64).exp_m1()).abs() < 1e-12);
        assert!((of(1, 1.0) - 0.05 * 4.0 * (0.05 / std::f64::consts::PI.powi(3)).sqrt()).abs() < 1e-12);
        assert!((of(2, 20.0) - 0.05 * (1.0 - 2.0 * (-1.0_f64).exp())).abs() < 1e-12);
    }
}
