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
use crate::outcome::policy::NEARLY_ALL_RUNS;
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

/// What is said where no cause is found and nearly all runs by themselves are described.
pub(crate) fn in_words(alone: &[RunAlone]) -> Option<String> {
    let count = alone.len();
    let right = alone
        .iter()
        .filter(|run| run.p_misfit.is_some_and(|p| p >= RIGHT_FROM))
        .count();
    (right as f64 >= NEARLY_ALL_RUNS * count as f64).then(|| {
        format!(
            "by itself each of {right} of {count} runs is described to within the noise: one set of parameters does not \
             describe them together"
        )
    })
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
    fn runs_that_are_right_alone_are_worth_a_remark() {
        let said = in_words(&runs(&[0.5, 0.3, 0.06, 0.02])).unwrap();
        assert!(said.contains("each of 3 of 4 runs"), "{said}");
        assert_eq!(in_words(&runs(&[0.5, 0.001])), None);
    }
}
