//! The runs of a group by themselves: whether each is described by its own parameters.

use rayon::prelude::*;

use ieap_domain::RunAlone;

use crate::cause::selection_input::SelectionInput;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::levels::RIGHT_FROM;
use crate::misfit::residual_bins::residual_bins;
use crate::misfit::signature::signatures;
use crate::options::DiagnoseOptions;
use crate::readings::group::{RunGroup, RunInput};

/// The misfit of every run beside the base fitted to it alone.
pub(crate) fn alone(runs: &[RunInput], options: &DiagnoseOptions) -> Vec<RunAlone> {
    let of_run = |run: &RunInput| {
        let raw = RunGroup::new(std::slice::from_ref(run));
        RunAlone {
            run: run.name.to_owned(),
            p_misfit: with_base(&raw, options.model, |group, base| {
                let scale = scale(group, &base.problem, &base.at);
                let signatures = signatures(&base.problem, &base.at, &scale);
                let bins = residual_bins(group, &base);
                let input = SelectionInput {
                    group,
                    base: &base,
                    signatures: &signatures,
                    bins: &bins,
                    draws: options.draws,
                    seed: options.seed,
                    absent: options.absent,
                };
                let (null, directions) = input.null(&base, 0);
                let observed = null.observe(group, &base.residuals(), &directions);
                let calibration = input.calibration(&null, &observed, &directions);
                null.p_beyond_draws(&observed, calibration.as_ref())
            }),
        }
    };
    runs.par_iter().map(of_run).collect()
}

/// Whether every run by itself is described to within the noise: chance leaves the worst of so many.
pub(crate) fn are_right(alone: &[RunAlone]) -> bool {
    let each = alone.iter().map(|run| run.p_misfit.unwrap_or(0.0));
    each.fold(1.0, f64::min) * alone.len() as f64 >= RIGHT_FROM
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(p: &[f64]) -> Vec<RunAlone> {
        let of = |p: &f64| RunAlone {
            run: "run".to_owned(),
            p_misfit: Some(*p),
        };
        p.iter().map(of).collect()
    }

    #[test]
    fn the_worst_of_several_runs_may_be_as_bad_as_chance_has_it() {
        assert!(are_right(&runs(&[0.5, 0.3, 0.06, 0.02])));
        assert!(!are_right(&runs(&[0.5, 0.001])));
    }
}
