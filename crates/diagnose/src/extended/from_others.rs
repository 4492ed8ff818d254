//! A sample predicted with an effect whose parameters were found from other samples.

use ieap_model::effects::{Limits, effect};
use ieap_numerics::sums::dot;

use crate::fitting::fitted::Fitted;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::options::DiagnoseOptions;
use crate::readings::group::{RunGroup, RunInput};

/// How much better an effect from elsewhere describes a sample than the base model alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FromOthersFall {
    /// Fall of the sum of squares with all parameters from elsewhere, in units of the noise; below zero where the sample
    /// is described worse.
    pub fall: f64,
    /// Its standard error, from the noise.
    pub standard_error: f64,
    /// Fall with the strength found from the sample itself, and all else from elsewhere.
    pub fall_own_strength: f64,
}

/// Fits the base parameters of a group beside the effect `id` with its parameters held at `values`; none where the
/// effect is not known in that form, does not act in these runs, or nothing can be fitted. Readings of the group decide
/// its base parameters in both models, and nothing of the effect.
pub fn fall_from_others(
    runs: &[RunInput],
    options: &DiagnoseOptions,
    id: &str,
    variant: Option<&str>,
    values: &[f64],
) -> Option<FromOthersFall> {
    let effect = effect(id)?;
    let about = effect.about();
    let variant = match variant {
        Some(name) => about.variants.iter().position(|known| *known == name)?,
        None => 0,
    };
    if values.len() != about.parameters.len() {
        return None;
    }
    let raw = RunGroup::new(runs);
    let found = with_base(&raw, options.model, |group, base| {
        let search = effect.search(variant, &scale(group, &base.problem, &base.at));
        let acts = (0..group.runs.len()).any(|run| effect.acts_in(values, run));
        if search.probes.is_empty() || !acts {
            return None;
        }
        let fitted = |strength_is_free: bool| {
            let held = |(k, limits): (usize, &Limits)| Limits {
                held: limits.held || k > 0 || !strength_is_free,
                ..*limits
            };
            let limits = search.limits.iter().enumerate().map(held).collect();
            let free_effect = FreeEffect::new(effect, variant, limits, values);
            let problem = ExtendedProblem::new(group, &base.base(), vec![free_effect]);
            let start = problem.coordinates(&base.base(), &[values.to_vec()]);
            let with = Fitted::search(problem, &[start], &[])?.exhausted();
            with.square.is_finite().then_some(with)
        };
        Some(compared(&base, &fitted(false)?, &fitted(true)?))
    });
    found?
}

fn compared(base: &Fitted, with: &Fitted, own_strength: &Fitted) -> FromOthersFall {
    let (before, after) = (base.residuals(), with.residuals());
    let difference: Vec<f64> = before.iter().zip(&after).map(|(b, a)| b - a).collect();
    FromOthersFall {
        fall: base.square - with.square,
        standard_error: 2.0 * dot(&difference, &difference).sqrt(),
        fall_own_strength: base.square - own_strength.square,
    }
}
