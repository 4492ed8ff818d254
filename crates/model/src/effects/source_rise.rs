//! A source that takes time to reach its level.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct SourceRise;

static ABOUT: About = About {
    id: "source-rise",
    code: "E14",
    summary: "the source rises with a time constant",
    equation: "v from the level before the edge; exponential: v' = (level - v)/tau; ramp: on a straight line to the level within 2 tau",
    variants: &["exponential", "ramp"],
    parameters: &[EffectParameter {
        key: "rise_time_s",
        symbol: "tau",
        unit: "s",
        meaning: "time constant of the source, half the time of its ramp",
    }],
    vanishes: "tau = 0",
    signature: "the first readings after an edge are too low, current and bending alike",
    twins: &[
        "current-limit",
        "series-resistance",
        "camera-delay",
        "fast-branch",
    ],
    separated_by: "a record of the voltage; a step of another size: a limit scales, a rise does not",
    sources: "bandwidth and slew rate of potentiostats",
};

/// No source that is used for steps is slower, s.
const SLOWEST_S: f64 = 0.5;

impl Equation for SourceRise {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let most = SLOWEST_S;
        if 5.0 * most < scale.shortest_s {
            return Search::none();
        }
        let low = (0.3 * scale.shortest_s).clamp(0.01, 0.1 * most);
        let small = match variant {
            0 => super::search::spread(low, 0.5 * most, 3),
            _ => vec![(2.0 * low).min(0.5 * most)],
        };
        Search {
            limits: vec![Limits::linear(0.0, most)],
            probes: small.into_iter().map(|rise_s| vec![rise_s]).collect(),
            absent: 0.0,
        }
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.source_rise_s += parameters[0].max(0.0);
        system.source_ramps |= variant == 1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn branches_are_driven_by_a_ramp() {
        let (rise, times) = (0.2, [0.0, 0.25, 0.4, 1.5]);
        let found = respond(&[("source-rise", 1, &[rise])], &[(0.0, Some(2.0))], &times, &[]);
        let slope = 2.0 / (2.0 * rise);
        let of_branch = |c: f64, tau: f64, t: f64| c * slope * -(-t / tau).exp_m1();
        let ramped = |t: f64| of_branch(0.1, 0.3, t) + of_branch(0.6, 9.0, t) + slope * t / 300.0;
        for (t, found) in times.into_iter().zip(found.current_a) {
            let after = if t > 0.4 { ramped(t - 0.4) } else { 0.0 };
            let expected = 0.1 * (ramped(t) - after);
            assert!((found - expected).abs() < 2e-3 * 0.1, "{t}: {found} {expected}");
        }
    }

    #[test]
    fn branches_are_driven_by_an_exponential() {
        let (rise, t) = (0.1, 0.25_f64);
        let found = respond(
            &[("source-rise", 0, &[rise])],
            &[(0.0, Some(2.0))],
            &[0.0, t],
            &[],
        );
        let left = (-t / rise).exp();
        let of_branch = |c: f64, tau: f64| c * (left - (-t / tau).exp()) / (rise - tau);
        let expected = 0.1 * 2.0 * (of_branch(0.1, 0.3) + of_branch(0.6, 9.0) + (1.0 - left) / 300.0);
        assert!(found.current_a[0].abs() < 1e-12);
        assert!((found.current_a[1] / expected - 1.0).abs() < 3e-3);
    }
}
