//! Limits of an effect that follow from the base parameters beside it.
//!
//! What a strength may be follows from sizes of the base's answers: an error of a curvature may be its whole, an offset of
//! a current a fifth of the largest current. A base that was fitted without the effect may have these sizes wrong: to it
//! curvatures that are read twice too large are a coupling twice too large. A strength that ends at such a limit is sought
//! on within those that follow from the base that was found beside it.

use ieap_model::effects::Limits;

use crate::fitting::fitted::Fitted;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::scale::scale;

/// Times that limits are drawn anew: each time the base comes nearer to its own.
const TIMES: usize = 6;

impl<'g> Fitted<'g> {
    /// The same, or where a parameter of an effect lies at a limit that the base beside it would put farther, searched on
    /// from there.
    pub(crate) fn in_own_limits(self) -> Fitted<'g> {
        let mut best = self;
        for _ in 0..TIMES {
            let Some(problem) = wider(&best) else { break };
            let there = Fitted::unsearched(problem, best.at.clone()).map(Fitted::converged);
            let Some(there) = there.filter(|there| there.square < best.square) else {
                break;
            };
            best = Fitted {
                evaluations: best.evaluations + there.evaluations,
                ..there
            };
        }
        best
    }
}

/// The problem with the limits of every effect that lies at one put farther; none where none is.
fn wider<'g>(fitted: &Fitted<'g>) -> Option<ExtendedProblem<'g>> {
    let problem = &fitted.problem;
    let mut place = problem.base_len();
    let mut effects = problem.effects.clone();
    let mut is_wider = false;
    for free_effect in &mut effects {
        let end = place + free_effect.free();
        if (place..end).any(|k| problem.at_limit(k, fitted.at[k])) {
            is_wider |= put_farther(free_effect, &of_own_base(fitted, free_effect));
        }
        place = end;
    }
    is_wider.then(|| problem.within_limits_of(effects))
}

/// Limits of an effect beside the base parameters of the fitted model.
fn of_own_base(fitted: &Fitted, free_effect: &FreeEffect) -> Vec<Limits> {
    let group = fitted.problem.group;
    let base = fitted.base();
    let alone = ExtendedProblem::new(group, &base, Vec::new());
    let scale = scale(group, &alone, &alone.coordinates(&base, &[]));
    free_effect.effect.search(free_effect.variant, &scale).limits
}

/// Puts limits of searched parameters farther where `own` are; whether any was.
fn put_farther(free_effect: &mut FreeEffect, own: &[Limits]) -> bool {
    let mut is_farther = false;
    for (limits, own) in free_effect.limits.iter_mut().zip(own) {
        if limits.held || own.held {
            continue;
        }
        is_farther |= own.low < limits.low || own.high > limits.high;
        limits.low = limits.low.min(own.low);
        limits.high = limits.high.max(own.high);
    }
    is_farther
}
