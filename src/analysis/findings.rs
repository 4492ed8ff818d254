//! What the comparison says, before any figure: by how much a parameter differs between conditions.

use super::conditions::{Condition, Conditions};
use crate::domain::{Estimate, RunRecord};

/// The largest difference of one parameter between two conditions of one material.
#[derive(Debug, Clone, PartialEq)]
pub enum Contrast {
    /// The two 95 % intervals do not overlap.
    Differs {
        /// Run with the smallest value.
        low_run: usize,
        /// Run with the largest value.
        high_run: usize,
        /// Largest value over the smallest.
        ratio: f64,
        /// Number of runs that determine the parameter.
        runs: usize,
    },
    /// No two runs' 95 % intervals lie apart.
    Agrees {
        /// Number of runs that determine the parameter.
        runs: usize,
    },
    /// A single run determines the parameter: nothing to compare.
    Single,
    /// No run determines it.
    NotDetermined,
}

/// A value with its 95 % interval in one run.
struct Known {
    run: usize,
    value: f64,
    low_95: f64,
    high_95: f64,
}

/// The contrast of parameter `key` for each material of `table`, in its order.
///
/// The extremes are compared as they stand, run by run: with several runs this looks for the largest
/// difference, so it says where to look and is no test of significance.
pub fn contrasts(runs: &[RunRecord], table: &Conditions, key: &str) -> Vec<Contrast> {
    (0..table.materials.len())
        .map(|material| {
            let of_material = table.measured.iter().filter(|c| c.material == material);
            contrast(&of_material.flat_map(|c| known(runs, c, key)).collect::<Vec<_>>())
        })
        .collect()
}

fn contrast(known: &[Known]) -> Contrast {
    if known.len() < 2 {
        return match known.is_empty() {
            true => Contrast::NotDetermined,
            false => Contrast::Single,
        };
    }
    let runs = known.len();
    let low = known.iter().min_by(|a, b| a.value.total_cmp(&b.value));
    let high = known.iter().max_by(|a, b| a.value.total_cmp(&b.value));
    match (low, high) {
        (Some(low), Some(high)) if low.high_95 < high.low_95 && low.value > 0.0 => Contrast::Differs {
            low_run: low.run,
            high_run: high.run,
            ratio: high.value / low.value,
            runs,
        },
        _ => Contrast::Agrees { runs },
    }
}

fn known(runs: &[RunRecord], condition: &Condition, key: &str) -> Vec<Known> {
    let known = |&run: &usize| {
        let estimate: &Estimate = runs[run].fit.as_ref()?.parameter(key)?;
        Some(Known {
            run,
            value: estimate.value?,
            low_95: estimate.low_95?,
            high_95: estimate.high_95?,
        })
    };
    condition.runs.iter().filter_map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::conditions;
    use crate::analysis::sample_campaign::{campaign, fit, known, run};

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
        contrasts(&runs, &table, "lambda_per_s").remove(0)
    }

    #[test]
    fn a_difference_needs_intervals_apart() {
        let differs = contrast_of(&[known(1.8e-3, 0.05), known(1e-4, 0.05), known(4e-4, 0.05)]);
        let Contrast::Differs {
            low_run,
            high_run,
            ratio,
            runs,
        } = differs
        else {
            panic!("{differs:?}");
        };
        assert_eq!((low_run, high_run, runs), (1, 0, 3));
        assert!((ratio - 18.0).abs() < 1e-9);
        assert_eq!(
            contrast_of(&[known(1.0, 0.1), known(1.1, 0.1)]),
            Contrast::Agrees { runs: 2 }
        );
    }

    #[test]
    fn bounds_and_gaps_are_not_compared() {
        let bound = Estimate::below(3e-5, "search limit");
        assert_eq!(contrast_of(std::slice::from_ref(&bound)), Contrast::NotDetermined);
        assert_eq!(contrast_of(&[bound, known(1e-4, 0.1)]), Contrast::Single);
    }
}
