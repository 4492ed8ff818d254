//! The account of the error: what of it is noise, between runs, within runs by the law that is told, and left.

use ieap_numerics::sums::dot;

use super::refit::Refit;
use crate::fitting::fitted::Fitted;
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;

/// Parts of the squared error that the base leaves, in units of the noise.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Account {
    pub(crate) noise: f64,
    pub(crate) between_runs: f64,
    pub(crate) within_runs: f64,
    pub(crate) unexplained: f64,
}

impl Account {
    /// What is beyond noise.
    pub(crate) fn beyond(&self) -> f64 {
        self.between_runs + self.within_runs + self.unexplained
    }

    /// A part of what is beyond noise.
    pub(crate) fn share(&self, part: f64) -> f64 {
        part / self.beyond().max(f64::MIN_POSITIVE)
    }
}

/// The account of a group. `own` is what all runs leave with parameters of their own; none of a single run.
pub(crate) fn account(group: &RunGroup, base: &Fitted, law: Option<&Refit>, own: Option<f64>) -> Account {
    let rows = group.rows() as f64;
    let parameters = base.at.len() as f64;
    let noise = rows - parameters;
    let beyond = (base.square - noise).max(0.0);
    let more = parameters * (group.runs.len() as f64 - 1.0);
    // What parameters of their own take of mere noise is no part of an account.
    let excess = |square: f64, free: f64| (square + free - noise).clamp(0.0, beyond);
    let left_own = own.map_or(beyond, |square| excess(square, more));
    let left_law = law.map_or(beyond, |law| excess(law.square, law.at.len() as f64 - parameters));
    let left_both = match (law, own) {
        (Some(law), Some(_)) => {
            let taken = by_own_parameters(group, law);
            (excess(law.square - taken, more)).min(left_own).min(left_law)
        }
        _ => left_own.min(left_law),
    };
    // Each by what it takes first and what it takes last (Shapley).
    Account {
        noise: base.square - beyond,
        between_runs: 0.5 * ((beyond - left_own) + (left_law - left_both)),
        within_runs: 0.5 * ((beyond - left_law) + (left_own - left_both)),
        unexplained: left_both,
    }
}

/// What parameters of each run's own take of what a law leaves, to first order.
fn by_own_parameters(group: &RunGroup, law: &Refit) -> f64 {
    let mut residuals = Vec::new();
    law.problem.residuals(&law.at, &mut residuals);
    let before = dot(&residuals, &residuals);
    let base = law.problem.base_len();
    let mut first = 0;
    let mut taken = 0.0;
    for run in 0..group.runs.len() {
        let end = first + law.problem.rows_of(run);
        let own: Vec<Vec<f64>> = law.columns[..base]
            .iter()
            .map(|column| column[first..end].to_vec())
            .collect();
        let mut rows = residuals[first..end].to_vec();
        let square = dot(&rows, &rows);
        Tangent::of(&own).remove(&mut rows);
        taken += square - dot(&rows, &rows);
        first = end;
    }
    taken.min(before)
}
