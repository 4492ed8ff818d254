//! The runs of a group by themselves: whether each is described by its own parameters.

use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use ieap_domain::RunAlone;
use ieap_domain::number::probabilities::equation;

use crate::cause::selection_input::SelectionInput;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::levels::{RIGHT_FROM, WRONG_BELOW};
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
                    of_several: true,
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

/// Whether each run by itself is described: neither is the smallest p of all runs smaller than chance makes the smallest of
/// so many, nor are all of them together (Fisher's product), each asked at half the level.
pub(crate) fn are_described(alone: &[RunAlone]) -> bool {
    let known: Vec<f64> = alone.iter().filter_map(|run| run.p_misfit).collect();
    if known.is_empty() || known.len() < alone.len() {
        return false;
    }
    let n = known.len() as f64;
    let smallest = known.iter().copied().fold(1.0, f64::min);
    let of_smallest = 1.0 - (1.0 - smallest).powf(n);
    let product: f64 = known.iter().map(|p| -2.0 * p.max(f64::MIN_POSITIVE).ln()).sum();
    let of_product = ChiSquared::new(2.0 * n).map_or(1.0, |chi| chi.sf(product));
    of_smallest.min(of_product) >= 0.5 * WRONG_BELOW
}

/// Every run that by itself leaves more than a single one is called right by, with its p.
pub(crate) fn doubts(alone: &[RunAlone]) -> impl Iterator<Item = String> {
    let low = |run: &RunAlone| run.p_misfit.filter(|p| *p < WRONG_BELOW);
    alone.iter().filter_map(move |run| {
        Some(format!(
            "{} leaves more than noise by itself, or chance did ({})",
            run.run,
            equation("p", low(run)?)
        ))
    })
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
    fn runs_are_described_unless_one_or_all_are_worse_than_chance_makes_them() {
        assert!(are_described(&runs(&[0.02, 0.6, 0.9])));
        assert!(!are_described(&runs(&[0.0003, 0.6, 0.9])));
        // A smallest p below what 999 draws tell condemns even one of many ...
        let mut many = vec![0.5; 20];
        assert!(are_described(&runs(&many)));
        many[3] = 1e-5;
        assert!(!are_described(&runs(&many)));
        // ... and many that are small each.
        assert!(!are_described(&runs(&[0.02; 20])));
        let mut unknown = runs(&[0.5, 0.5]);
        unknown[0].p_misfit = None;
        assert!(!are_described(&unknown) && !are_described(&[]));
    }

    #[test]
    fn a_run_that_leaves_more_than_noise_by_itself_is_worth_a_remark() {
        assert_eq!(doubts(&runs(&[0.003, 0.6])).count(), 1);
    }

    #[test]
    fn runs_that_are_right_alone_are_worth_a_remark() {
        let said = in_words(&runs(&[0.5, 0.3, 0.06, 0.02])).unwrap();
        assert!(said.contains("each of 3 of 4 runs"), "{said}");
        assert_eq!(in_words(&runs(&[0.5, 0.001])), None);
    }
}
