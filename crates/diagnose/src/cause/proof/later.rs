//! Later times of several runs predicted from the earlier times of all of them.
//!
//! A single run has its end among its held-out parts; of several runs whole drives are held out, and that a model also
//! carries forward in time is a question of its own: what drifts, leaks or creeps shows at the end of every run. It is
//! told beside the other gain and decides nothing.

use rayon::prelude::*;

use crate::cause::policy::EARLIER_PART;
use crate::cause::proof::doubt::Doubt;
use crate::cause::proof::held_out::{Part, REFIT, SETTLE, beyond_doubt, compare, later_rows};
use crate::cause::proof::predictive::Predictive;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;
use ieap_domain::number::seconds::seconds;

/// Evaluations of a refit to the earlier times of all runs.
const LATER_REFIT: u64 = 12;

/// The later time of every run, predicted by the model refitted to the earlier time of all; none for a single run.
///
/// The deviance of a run's part is what it adds to the earlier readings of all runs, whatever the later ones of the
/// others are.
pub(crate) fn later_parts(fitted: &Fitted, group: &RunGroup) -> Vec<Part> {
    let runs: Vec<usize> = (0..group.runs.len()).collect();
    if runs.len() < 2 {
        return Vec::new();
    }
    let predictive = Predictive::of(fitted);
    let all_later = later_rows(group, &runs);
    let earlier = fitted.problem.without(&all_later);
    let earlier = earlier.search(&fitted.at, LATER_REFIT, SETTLE, &[]);
    let model = fitted.problem.model(&earlier.at);
    let doubt = Doubt::of(&fitted.problem, &predictive, &earlier.at, &all_later);
    let part = |&run: &usize| {
        let others: Vec<usize> = runs.iter().copied().filter(|&other| other != run).collect();
        let out = later_rows(group, &others);
        let with = fitted.problem.without(&out);
        let with = with.search(&earlier.at, REFIT, SETTLE, &predictive.columns_without(&out));
        let group_run = &group.runs[run];
        let context = group_run.context(run, None);
        let found = group_run.fitted(&model, &context);
        let from_s = EARLIER_PART * (group_run.duration_s - context.start_s());
        let mut part = Part::new(
            format!("{} after {} s", group_run.given.name, seconds(from_s)),
            predictive.added((&out, with.local.square), (&all_later, earlier.local.square)),
        );
        let own = later_rows(group, &[run]);
        part.beyond_doubt = Some(beyond_doubt(fitted, &predictive, &earlier.at, (&all_later, &own)));
        let variances = doubt.variances(&fitted.problem, &earlier.at, run);
        compare(&mut part, group, run, (&found, Some(&variances)), &|row| own[row]);
        part
    };
    runs.par_iter().map(part).collect()
}
