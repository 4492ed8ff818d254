//! Something that happened to the current at one instant, and that the drive did not cause.

use super::event::{COURSES, is_in, search, written};
use super::{About, EffectParameter, Equation, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CurrentEvent;

static ABOUT: About = About {
    id: "current-event",
    code: "E21",
    summary: "a step or a kick of the current at one instant, whatever the drive does",
    equation: "I -> I + s g((t - t_0)/w) from t_0 on, in one run; step: g = 1 - e^-x, kick: g = (e^-x - e^(-10x))/0.697, t the time since the start of the drive",
    variants: &COURSES,
    parameters: &[
        EffectParameter {
            key: "size_a",
            symbol: "s",
            unit: "A",
            meaning: "height of the step, or largest current of the kick",
        },
        EffectParameter {
            key: "event_time_s",
            symbol: "t_0",
            unit: "s",
            meaning: "instant, from the start of the drive",
        },
        EffectParameter {
            key: "width_s",
            symbol: "w",
            unit: "s",
            meaning: "time in which the step rises, or the kick falls",
        },
        EffectParameter {
            key: "run",
            symbol: "r",
            unit: "",
            meaning: "the run in which it happens, counted from 0 in the group",
        },
    ],
    vanishes: "s = 0",
    signature: "the current leaves its course at one instant of one run, away from every edge",
    twins: &["contact-break", "current-offset"],
    separated_by: "the instant itself is the evidence; a note of what happened then; the same run again",
    sources: "additions to a cell, switched apparatus near by",
};

impl Equation for CurrentEvent {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        search(variant, scale, scale.current_a)
    }

    fn acts_in(&self, parameters: &[f64], run: usize) -> bool {
        is_in(parameters, run)
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        if self.acts_in(parameters, run.index) {
            system.written_current.push(written(variant, parameters));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn it_is_added_to_the_current_of_its_run_from_its_instant_on() {
        let (levels, times) = ([(10.0, Some(2.0))], [60.0, 75.0, 300.0]);
        let own = respond(&[], &levels, &times, &times);
        for (variant, course) in [
            -(-0.5_f64).exp_m1(),
            ((-0.5_f64).exp() - (-5.0_f64).exp()) / 0.696_837_3,
        ]
        .into_iter()
        .enumerate()
        {
            let of_run = |run| {
                respond(
                    &[("current-event", variant, &[0.01, 60.0, 10.0, run])],
                    &levels,
                    &times,
                    &times,
                )
            };
            let found = of_run(0.0);
            assert_eq!(found.current_a[0], own.current_a[0]);
            assert!((found.current_a[1] - own.current_a[1] - 0.01 * course).abs() < 1e-8);
            assert_eq!(found.curvature_per_cm, own.curvature_per_cm);
            assert_eq!(of_run(1.0), own);
        }
    }
}
