//! What the comparison says, before any figure: by how much a parameter differs between conditions.

use super::conditions::{Condition, Conditions};
use super::laws::doubt::Doubts;
use super::parameters::usable;
use ieap_domain::RunRecord;

/// The clearest difference of one parameter between two runs of one material.
#[derive(Debug, Clone, PartialEq)]
pub enum Contrast {
    /// The two 95 % intervals do not overlap.
    Differs {
        /// Run whose interval ends lowest.
        low_run: usize,
        /// Run whose interval starts highest.
        high_run: usize,
        /// Ratio of the two values; none where it means nothing because the lower one may be zero.
        ratio: Option<f64>,
        /// Whether a bound stands for one of the values, so that the ratio is the least possible.
        at_least: bool,
        /// Number of runs that determine or bound the parameter.
        runs: usize,
    },
    /// All 95 % intervals overlap.
    Agrees {
        /// Number of runs that determine or bound the parameter.
        runs: usize,
    },
    /// A single run says something of the parameter: nothing to compare.
    Single,
    /// No run says anything of it.
    NotDetermined,
}

/// What one run says of the parameter; a bound leaves the other end open.
struct Known {
    run: usize,
    value: Option<f64>,
    low_95: f64,
    high_95: f64,
}

/// The contrast of parameter `key` for each material of `table`, in its order.
///
/// Single runs are compared, the two whose intervals lie farthest apart. With many runs such a pair can occur
/// by chance: this says where to look and is no test of significance. Fits that a finding doubts enter with `doubts`'
/// errors, or not at all.
pub fn contrasts(runs: &[RunRecord], table: &Conditions, key: &str, doubts: &Doubts) -> Vec<Contrast> {
    (0..table.materials.len())
        .map(|material| {
            let of_material = table.measured.iter().filter(|c| c.material == material);
            contrast(
                &of_material
                    .flat_map(|c| known(runs, c, key, doubts))
                    .collect::<Vec<_>>(),
            )
        })
        .collect()
}

fn contrast(known: &[Known]) -> Contrast {
    let runs = known.len();
    let lowest = known.iter().min_by(|a, b| a.high_95.total_cmp(&b.high_95));
    let highest = known.iter().max_by(|a, b| a.low_95.total_cmp(&b.low_95));
    match (lowest, highest) {
        (Some(low), Some(high)) if low.high_95 < high.low_95 => {
            let (ratio, at_least) = match (high.value, low.value) {
                (Some(high), Some(low)) if low > 0.0 => (Some(high / low), false),
                _ => (Some(high.low_95 / low.high_95), true),
            };
            Contrast::Differs {
                low_run: low.run,
                high_run: high.run,
                ratio: ratio.filter(|ratio| ratio.is_finite() && *ratio > 0.0),
                at_least,
                runs,
            }
        }
        (Some(_), Some(_)) if runs > 1 => Contrast::Agrees { runs },
        (Some(_), Some(_)) => Contrast::Single,
        _ => Contrast::NotDetermined,
    }
}

fn known(runs: &[RunRecord], condition: &Condition, key: &str, doubts: &Doubts) -> Vec<Known> {
    let known = |&run: &usize| {
        let estimate = doubts.widened(&runs[run].path, key, usable(&runs[run], key)?)?;
        let (low, high) = (estimate.low_95, estimate.high_95);
        // Without an interval a value cannot be compared.
        low.or(high)?;
        Some(Known {
            run,
            value: estimate.value,
            low_95: low.unwrap_or(f64::NEG_INFINITY),
            high_95: high.unwrap_or(f64::INFINITY),
        })
    };
    condition.runs.iter().filter_map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions;
    use ieap_domain::Estimate;
    use ieap_domain::testing::{campaign, fit, known, run};

    fn contrast_of(estimates: &[Estimate]) -> Contrast {
        let runs: Vec<RunRecord> = estimates
            .iter()
            .map(|estimate| {
                let mut fitted = run("r", "CNaf-01", "air", None, 2.5);
                fitted.fit = Some(fit(&[("lambda_per_s", estimate.clone())]));
                fitted
            })
            .collect();
        let table = conditions(&runs, &campaign());
        contrasts(&runs, &table, "lambda_per_s", &Doubts::default()).remove(0)
    }

    #[test]
    fn a_difference_needs_intervals_apart() {
        let differs = contrast_of(&[known(1.8e-3, 0.05), known(1e-4, 0.05), known(4e-4, 0.05)]);
        let Contrast::Differs {
            low_run,
            high_run,
            ratio: Some(ratio),
            at_least: false,
            runs: 3,
        } = differs
        else {
            panic!("{differs:?}");
        };
        assert_eq!((low_run, high_run), (1, 0));
        assert!((ratio - 18.0).abs() < 1e-9);
        assert_eq!(
            contrast_of(&[known(1.0, 0.1), known(1.1, 0.1)]),
            Contrast::Agrees { runs: 2 }
        );
    }

    #[test]
    fn a_narrow_interval_between_wide_ones_is_seen() {
        // The extremes overlap, but the second lies apart from the first.
        let estimates = [
            Estimate::determined(1.0, 0.05, 0.9, 1.1),
            Estimate::determined(1.3, 0.01, 1.28, 1.32),
            Estimate::determined(1.4, 0.3, 0.8, 2.0),
        ];
        assert!(matches!(
            contrast_of(&estimates),
            Contrast::Differs {
                low_run: 0,
                high_run: 1,
                ..
            }
        ));
    }

    #[test]
    fn a_value_above_a_bound_differs_by_at_least_that() {
        let bound = Estimate::below(3e-5, "search limit");
        let alone = contrast_of(std::slice::from_ref(&bound));
        assert_eq!(alone, Contrast::Single);
        let differs = contrast_of(&[bound, Estimate::determined(1e-4, 1e-5, 9e-5, 1.2e-4)]);
        let Contrast::Differs {
            ratio: Some(ratio),
            at_least: true,
            ..
        } = differs
        else {
            panic!("{differs:?}");
        };
        assert!((ratio - 3.0).abs() < 1e-9);
        assert_eq!(
            contrast_of(&[Estimate::not_determined("r")]),
            Contrast::NotDetermined
        );
    }
}
