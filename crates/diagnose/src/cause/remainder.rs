//! What an extended model leaves, asked in the noise that is found beside it.
//!
//! The noise of a diagnosis is found beside the base model. Where that is wrong, some of its misfit is taken for noise that
//! is louder and remembers longer, and what a right extension leaves looks smaller than it is: of 215 hidden effects of 32
//! standard deviations, the p of what the truth left was below 0.05 in 2 where 11 are due.

use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::misfit::calibration::{Asked, Calibration};
use crate::misfit::null::{Null, Statistics};
use crate::misfit::signature::{Signature, directions};
use crate::readings::group::RunGroup;

impl SelectionInput<'_, '_> {
    /// How often chance leaves as much as `model` does.
    pub(crate) fn p_of(&self, model: &Fitted) -> f64 {
        let (null, directions) = self.null(model, 1);
        let left = null.observe(self.group, &model.residuals(), &directions);
        self.p_left(model, &null, &left, 1)
    }

    /// How often chance leaves as much as `model` does, from what it leaves in the noise beside the base: found anew in the
    /// noise beside `model`, and calibrated, unless it is clear already.
    fn p_left(&self, model: &Fitted, null: &Null, left: &Statistics, step: u64) -> f64 {
        let first = || null.p_misfit(left, None);
        if model.problem.effects.is_empty() || Calibration::is_needless(null.unbounded_p(left)) {
            return first();
        }
        self.p_in_own_noise(model, step).unwrap_or_else(first)
    }

    fn p_in_own_noise(&self, model: &Fitted, step: u64) -> Option<f64> {
        let group = self.group.renoised(&model.problem.model(&model.at));
        let again = refitted(&group, model)?;
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

/// The model with its effects fitted to the same readings with another noise, from where it was.
fn refitted<'g>(group: &'g RunGroup<'g>, from: &Fitted) -> Option<Fitted<'g>> {
    let problem = ExtendedProblem::new(group, &from.base(), from.problem.effects.clone());
    let at = problem.coordinates(&from.base(), &from.effect_values());
    Fitted::search(problem, &[at], &[]).map(Fitted::polished)
}
