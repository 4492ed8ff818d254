//! What is left of a group's misfit where an effect is known from elsewhere.

use ieap_model::effects::{Limits, effect};
use ieap_model::{Branch, LumpedModel};

use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::misfit::residual_bins::residual_bins;
use crate::misfit::signature::signatures;
use crate::options::DiagnoseOptions;
use crate::readings::group::{RunGroup, RunInput};

/// Factors on the resistances of the branches from which they are searched: an effect that resists before them has made
/// those of the base model too large.
const STARTS: [f64; 3] = [1.0, 0.3, 0.1];

/// Fits the base parameters of a group beside the first form of the effect `id` with its parameters held at `values`, and
/// says how often chance leaves as much; none where the effect is not known or does not act in these runs, or nothing can
/// be fitted.
pub(crate) fn p_leftover(
    runs: &[RunInput],
    options: &DiagnoseOptions,
    id: &str,
    values: &[f64],
) -> Option<f64> {
    let effect = effect(id)?;
    let raw = RunGroup::new(runs);
    let found = with_base(&raw, options.model, |group, base| {
        let scale = scale(group, &base.problem, &base.at);
        let search = effect.search(0, &scale);
        if search.probes.is_empty() || search.limits.len() != values.len() {
            return None;
        }
        let held = |limits: &Limits| Limits {
            held: true,
            ..*limits
        };
        let limits: Vec<Limits> = search.limits.iter().map(held).collect();
        let free_effect = || FreeEffect::new(effect, 0, limits.clone(), values);
        let fitted = STARTS.into_iter().filter_map(|factor| {
            let start = conducting(&base.base(), factor);
            let problem = ExtendedProblem::new(group, &start, vec![free_effect()]);
            let at = problem.coordinates(&start, &[values.to_vec()]);
            Some(Fitted::search(problem, &[at], &[])?.converged())
        });
        let with = fitted
            .filter(|with| with.square.is_finite())
            .min_by(|a, b| a.square.total_cmp(&b.square))?;
        let signatures = signatures(&base.problem, &base.at, &scale);
        let input = SelectionInput {
            group,
            base: &base,
            signatures: &signatures,
            bins: &residual_bins(group, &base),
            draws: options.draws,
            seed: options.seed,
            absent: options.absent,
        };
        let (null, directions) = input.null(&with, 1);
        let left = null.observe(group, &with.residuals(), &directions);
        Some(null.p_misfit(&left, None))
    });
    found?
}

/// The model with the resistances of its branches times a factor.
fn conducting(model: &LumpedModel, factor: f64) -> LumpedModel {
    let branch = |branch: &Branch| Branch {
        resistance_ohm_cm2: factor * branch.resistance_ohm_cm2,
        ..*branch
    };
    LumpedModel {
        branches: model.branches.iter().map(branch).collect(),
        ..model.clone()
    }
}
