//! One side wetter than the other: the strip bends by itself.

use super::acting::read_as;
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct MoistureBending;

static ABOUT: About = About {
    id: "moisture-bending",
    code: "N4",
    class: Class::Relaxation,
    summary: "one side wetter: baseline bends by itself",
    equation: "kappa -> kappa + k (1 - e^(-t/tau)), t the time since the start of the drive",
    variants: &[],
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
    sources: "hygroscopic bending of laminates",
};

impl Effect for MoistureBending {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let most = scale.curvature_per_cm;
        let longest_s = scale.longest_s();
        let limits = vec![
            Limits::linear(-most, most),
            Limits::logarithmic(longest_s / 100.0, 5.0 * longest_s),
        ];
        Search::over(0.01 * most, limits, &[scale.times_s(0.03, 2.0, 4)])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [bending, time_s] = [parameters[0], parameters[1]];
        system
            .observations
            .push(read_as(move |t, kappa| kappa - bending * (-t / time_s).exp_m1()));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn without_a_drive_it_bends_alone() {
        let found = respond(
            &[("moisture-bending", 0, &[0.05, 20.0])],
            &[(0.0, Some(0.0))],
            &[],
            &[20.0],
        );
        assert!((found.curvature_per_cm[0] + 0.05 * (-1.0_f64).exp_m1()).abs() < 1e-12);
    }
}
