//! What a law gains on readings that took no part in its fit.

use ieap_numerics::sums::dot;
use rayon::prelude::*;

use super::refit::Refit;
use crate::cause::proof::held_out::rows;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// Sums of squares of every held-out part by the base and by the model with the law, each fitted without it.
pub(crate) struct HeldOut {
    pub(crate) before: Vec<f64>,
    pub(crate) after: Vec<f64>,
}

impl HeldOut {
    /// Parts that come out better, of how many.
    pub(crate) fn better(&self) -> (usize, usize) {
        let falls = self.before.iter().zip(&self.after);
        (
            falls.filter(|(before, after)| after < before).count(),
            self.before.len(),
        )
    }

    /// By how much the sum of squares falls on all of them.
    pub(crate) fn fall(&self) -> f64 {
        self.before.iter().sum::<f64>() - self.after.iter().sum::<f64>()
    }
}

/// Runs, or stretches of a single one, held out in turn.
pub(crate) fn held_out(group: &RunGroup, base: &Fitted, law: &Refit) -> HeldOut {
    let parts = rows(group);
    let plain = Refit {
        problem: base.problem.clone(),
        known: Vec::new(),
        at: base.at.clone(),
        square: base.square,
        columns: base.problem.slope(&base.at).1,
    };
    let of = |refit: &Refit, out: &Vec<bool>| {
        let at = refit.without(out);
        let mut all = Vec::new();
        refit.problem.residuals(&at, &mut all);
        let held: Vec<f64> = all
            .iter()
            .zip(out)
            .filter(|(_, is_out)| **is_out)
            .map(|(r, _)| *r)
            .collect();
        dot(&held, &held)
    };
    HeldOut {
        before: parts.par_iter().map(|out| of(&plain, out)).collect(),
        after: parts.par_iter().map(|out| of(law, out)).collect(),
    }
}
