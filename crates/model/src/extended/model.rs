//! A base model with effects, and what it gives.

use crate::LumpedModel;
use crate::effects::Applied;

use super::grid::Grids;
use super::stepper::{Responses, Stepper};
use super::system::{RunContext, System, Written};

/// A base model with effects.
#[derive(Clone)]
pub struct ExtendedModel {
    /// The base.
    pub base: LumpedModel,
    /// Effects with their parameters, in order.
    pub effects: Vec<Applied>,
}

impl ExtendedModel {
    /// The base with what every effect makes of it in that run.
    pub fn system(&self, run: &RunContext) -> System {
        let mut system = System::of(&self.base);
        for applied in &self.effects {
            applied
                .effect
                .apply(applied.variant, &applied.parameters, run, &mut system);
        }
        system
    }

    /// Current and curvature at increasing times, s.
    pub fn responses(&self, run: &RunContext, current_time_s: &[f64], curvature_time_s: &[f64]) -> Responses {
        self.responses_by(&Grids::default(), run, current_time_s, curvature_time_s)
    }

    /// The same, stepped on one of these grids where one of them serves.
    pub fn responses_by(
        &self,
        grids: &Grids,
        run: &RunContext,
        current_time_s: &[f64],
        curvature_time_s: &[f64],
    ) -> Responses {
        let system = self.system(run);
        let grid = grids.of(run, &system, current_time_s, curvature_time_s);
        let mut found = Stepper::new(&system, run).responses(&grid);
        let start_s = run.start_s();
        write_down(
            &mut found.current_a,
            current_time_s,
            start_s,
            &system.written_current,
        );
        write_down(
            &mut found.curvature_per_cm,
            curvature_time_s,
            start_s,
            &system.written_curvature,
        );
        found
    }
}

/// Readings as they are written down.
fn write_down(values: &mut [f64], time_s: &[f64], start_s: f64, written: &[Written]) {
    for (value, t) in values.iter_mut().zip(time_s) {
        *value = written.iter().fold(*value, |value, map| map(t - start_s, value));
    }
}
