//! The base model fitted to a group, its noise found beside it and outliers left out.

use ieap_model::FitModel;

use crate::fitting::base_fit::{base_fit, refit, refit_from};
use crate::fitting::edges;
use crate::fitting::fitted::Fitted;
use crate::fitting::policy::OUTLIER_ROUNDS;
use crate::readings::group::RunGroup;
use crate::readings::outliers;

/// Calls `then` with the group, its noise found beside the base model, and the base model fitted to it; none where no
/// run gives a start.
pub(crate) fn with_base<R>(
    raw: &RunGroup,
    model: &'static FitModel,
    then: impl FnOnce(&RunGroup, Fitted) -> R,
) -> Option<R> {
    let first = base_fit(raw, model)?;
    on_edges(raw, &first, |group, first| {
        without_outliers(group, first, OUTLIER_ROUNDS, Box::new(then))
    })?
}

/// Calls `then` with the group and the base model with the edges that only readings tell of where both have them best.
fn on_edges<R>(group: &RunGroup, base: &Fitted, then: impl FnOnce(&RunGroup, &Fitted) -> R) -> Option<R> {
    match edges::settled(group, base) {
        None => Some(then(group, base)),
        Some((moved, at)) => {
            let base = refit_from(&moved, &base.problem.model(&at).base)?;
            Some(then(&moved, &base))
        }
    }
}

/// What is made of a group and the base model fitted to it. In a box: rounds are nested, and a type of its own for
/// each would have no end.
type Then<'t, R> = Box<dyn FnOnce(&RunGroup, Fitted) -> R + 't>;

/// Calls `then` as [`with_base`] does, from a first fit of the base model and without the readings that are far off it.
fn without_outliers<R>(raw: &RunGroup, first: &Fitted, rounds: usize, then: Then<R>) -> Option<R> {
    let model = first.problem.model(&first.at);
    if let Some(cleaned) = outliers::without(raw, &model).filter(|_| rounds > 0) {
        let again = refit(&cleaned, first)?;
        return without_outliers(&cleaned, &again, rounds - 1, then);
    }
    // The noise that the readings alone show holds what is fast in them; a first fit takes that out.
    let once = raw.renoised(&first.problem.model(&first.at));
    let second = refit(&once, first)?;
    on_edges(&once, &second, |once, second| {
        let group = once.renoised(&second.problem.model(&second.at));
        let base = refit(&group, second)?;
        Some(then(&group, base))
    })?
}
