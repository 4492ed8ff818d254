//! What an extended model leaves, asked in the noise and on the edges that are found beside it.
//!
//! The noise of a diagnosis and the edges that only readings tell of are found beside the base model. Where that is wrong, some of
//! its misfit is taken for noise that is louder and remembers longer, and what a right extension leaves looks smaller than it is
//! (of 215 hidden effects of 32 standard deviations, the p of what the truth left was below 0.05 in 2 where 11 are due); and edges
//! move to hide what it misses, so that a right extension leaves what they are off by.

use crate::cause::selection_input::SelectionInput;
use crate::fitting::edges;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::misfit::calibration::{Asked, Calibration};
use crate::misfit::null::Null;
use crate::misfit::signature::{Signature, directions};
use crate::readings::group::RunGroup;

impl SelectionInput<'_, '_> {
    /// How often chance leaves as much as `model` does: calibrated, unless it is clear already.
    pub(crate) fn p_of(&self, model: &Fitted) -> f64 {
        self.p_in_own_noise(model, 1).unwrap_or_else(|| {
            let (null, directions) = self.null(model, 1);
            null.p_misfit(&null.observe(self.group, &model.residuals(), &directions), None)
        })
    }

    fn p_in_own_noise(&self, model: &Fitted, step: u64) -> Option<f64> {
        let on_edges = edges::settled(self.group, model);
        let (group, at) = match &on_edges {
            Some((moved, at)) => (moved, at),
            None => (self.group, &model.at),
        };
        let group = group.renoised(&model.problem.model(at));
        let again = refitted(&group, model, at)?;
        let signatures: Vec<Signature> = self
            .signatures
            .iter()
            .map(|signature| signature.in_noise_of(self.group, &group))
            .collect();
        let (_, tangent) = again.tangent();
        let directions = directions(&signatures, &tangent);
        let seed = self.seed.wrapping_add(step);
        let null = Null::new(&group, &tangent, &directions, self.bins, self.draws, seed);
        let left = null.observe(&group, &again.residuals(), &directions);
        if Calibration::is_needless(null.unbounded_p(&left)) {
            return Some(null.p_misfit(&left, None));
        }
        let calibration = Calibration::of(&Asked {
            group: &group,
            null: &null,
            tangent: &tangent,
            signatures: &signatures,
            directions: &directions,
            bins: self.bins,
            seed,
        });
        Some(null.p_misfit(&left, Some(&calibration)))
    }
}

/// The model with its effects fitted to the same readings with another noise, from those coordinates.
fn refitted<'g>(group: &'g RunGroup<'g>, from: &Fitted, at: &[f64]) -> Option<Fitted<'g>> {
    let extended = from.problem.model(at);
    let problem = ExtendedProblem::new(group, &extended.base, from.problem.effects.clone());
    let values: Vec<Vec<f64>> = (extended.effects.into_iter())
        .map(|applied| applied.parameters)
        .collect();
    let at = problem.coordinates(&extended.base, &values);
    Fitted::search(problem, &[at], &[]).map(Fitted::polished)
}
