//! The account of the error: what of it is noise, between runs, within runs by the laws that are told, and left.

use ieap_domain::Account;
use ieap_numerics::sums::dot;

use crate::fitting::fitted::Fitted;
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;

/// The account of a group with the model that has the laws that are told, where any is. `own` is what all runs leave with
/// parameters of their own; none of a single run.
pub(crate) fn account(group: &RunGroup, base: &Fitted, law: Option<&Fitted>, own: Option<f64>) -> Account {
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
    let percent = |part: f64| 100.0 * part / base.square.max(f64::MIN_POSITIVE);
    // What is told takes first: parameters of each run's own can imitate most laws.
    Account {
        noise: percent(base.square - beyond),
        between_runs: percent(left_law - left_both),
        within_runs: percent(beyond - left_law),
        unexplained: percent(left_both),
        ..Account::default()
    }
}

/// What parameters of each run's own take of what a law leaves, to first order.
fn by_own_parameters(group: &RunGroup, law: &Fitted) -> f64 {
    let residuals = law.residuals();
    let (_, columns) = law.problem.slope(&law.at);
    let before = dot(&residuals, &residuals);
    let base = law.problem.base_len();
    let mut first = 0;
    let mut taken = 0.0;
    for run in 0..group.runs.len() {
        let end = first + law.problem.rows_of(run);
        let own: Vec<Vec<f64>> = columns[..base]
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
