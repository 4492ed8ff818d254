//! Something that happened to the bending at one instant, and that the drive did not cause.

use super::event::{COURSES, is_in, search, written};
use super::{About, EffectParameter, Equation, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct BendingEvent;

static ABOUT: About = About {
    id: "bending-event",
    code: "G11",
    summary: "a step or a kick of the bending at one instant, whatever the drive does",
    equation: "kappa -> kappa + s g((t - t_0)/w) from t_0 on, in one run; step: g = 1 - e^-x, kick: g = (e^-x - e^(-10x))/0.697, t the time since the start of the drive",
    variants: &COURSES,
    parameters: &[
        EffectParameter {
            key: "size_per_cm",
            symbol: "s",
            unit: "1/cm",
            meaning: "height of the step, or largest bending of the kick",
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
    signature: "the bending leaves its course at one instant of one run, away from every edge, and the current does not",
    twins: &["contact-break", "camera-zero", "moisture-bending"],
    separated_by: "the pictures of that instant; the same run again",
    sources: "a bumped stand, a door, a draught, a camera that was moved",
};

impl Equation for BendingEvent {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        search(variant, scale, scale.curvature_per_cm)
    }

    fn acts_in(&self, parameters: &[f64], run: usize) -> bool {
        is_in(parameters, run)
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        if self.acts_in(parameters, run.index) {
            system.written_curvature.push(written(variant, parameters));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn it_is_added_to_the_bending_of_its_run_from_its_instant_on() {
        let (levels, times) = ([(0.0, Some(2.0))], [60.0, 65.0, 300.0]);
        let own = respond(&[], &levels, &times, &times);
        for (variant, in_the_end) in [0.02, 0.0].into_iter().enumerate() {
            let effect = ("bending-event", variant, [0.02, 60.0, 10.0, 0.0].as_slice());
            let found = respond(&[effect], &levels, &times, &times);
            assert_eq!(found.curvature_per_cm[0], own.curvature_per_cm[0]);
            assert!(found.curvature_per_cm[1] > own.curvature_per_cm[1] + 0.005);
            assert!((found.curvature_per_cm[2] - own.curvature_per_cm[2] - in_the_end).abs() < 1e-9);
            assert_eq!(found.current_a, own.current_a);
        }
    }
}
