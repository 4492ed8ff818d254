//! Repeats as one number: a random-effects mean over runs of several samples, with the spread between samples and
//! between runs kept apart from the uncertainty of the fits.
//!
//! A run `j` of sample `i` gives `y_ij = mean + sample_i + run_ij + error_ij`, where only the last term is what the
//! fit's standard error speaks of. Both variances are found by the method of moments of DerSimonian and Laird
//! (Controlled Clinical Trials 7, 177, 1986): first that of runs within samples, then that of the samples' means.
//! The standard error of the mean is that of Hartung and Knapp (Statistics in Medicine 20, 3875, 2001), never less
//! than the usual one, and the interval takes Student's t with one less than the number of samples: with two or
//! three samples it is wide, as it should be.

pub use ieap_show::Pooled;

use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_numerics::student::quantile_95;

/// On which scale values are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Averaging {
    /// The values themselves.
    Linear,
    /// Their logarithms: for quantities that are positive by definition, whose errors are relative.
    Logarithmic,
}

/// One run's number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeat {
    /// Which sample it was measured on.
    pub sample: usize,
    /// Value.
    pub value: f64,
    /// Standard error of the fit; zero where it is not known.
    pub standard_error: f64,
}

/// Errors below this part of the largest value count as this part: a weight must stay finite.
const LEAST_RELATIVE_ERROR: f64 = 1e-9;

/// The mean of `repeats`; none for no repeat, or for a value that is no number or, where logarithms are averaged,
/// not positive.
pub fn pooled(repeats: &[Repeat], averaging: Averaging) -> Option<Pooled> {
    let scaled: Option<Vec<Repeat>> = repeats.iter().map(|repeat| to_scale(repeat, averaging)).collect();
    let scaled = scaled.filter(|scaled| !scaled.is_empty())?;
    let mean = mean_on_scale(&scaled);
    let back = |number: f64| match averaging {
        Averaging::Linear => number,
        Averaging::Logarithmic => number.exp(),
    };
    // A small step on the scale is this much in the unit of the values.
    let slope = match averaging {
        Averaging::Linear => 1.0,
        Averaging::Logarithmic => mean.value.exp(),
    };
    Some(Pooled {
        value: back(mean.value),
        standard_error: slope * mean.standard_error,
        low_95: back(mean.low_95),
        high_95: back(mean.high_95),
        fit_standard_error: slope * mean.fit_standard_error,
        between_runs: mean.between_runs.map(|spread| slope * spread),
        between_samples: mean.between_samples.map(|spread| slope * spread),
        ..mean
    })
}

fn to_scale(repeat: &Repeat, averaging: Averaging) -> Option<Repeat> {
    let error = if repeat.standard_error.is_finite() {
        repeat.standard_error.max(0.0)
    } else {
        0.0
    };
    let (value, standard_error) = match averaging {
        Averaging::Linear => (repeat.value, error),
        Averaging::Logarithmic if repeat.value > 0.0 => (repeat.value.ln(), error / repeat.value),
        Averaging::Logarithmic => return None,
    };
    value.is_finite().then_some(Repeat {
        sample: repeat.sample,
        value,
        standard_error,
    })
}

/// A number with the weight that it has in a mean.
#[derive(Debug, Clone, Copy)]
struct Weighted {
    value: f64,
    variance: f64,
}

fn mean_on_scale(repeats: &[Repeat]) -> Pooled {
    let largest = repeats
        .iter()
        .fold(1e-300, |largest: f64, repeat| largest.max(repeat.value.abs()));
    let variance = |repeat: &Repeat| repeat.standard_error.max(LEAST_RELATIVE_ERROR * largest).powi(2);
    let mut samples: Vec<usize> = repeats.iter().map(|repeat| repeat.sample).collect();
    samples.sort_unstable();
    samples.dedup();
    let of_sample = |sample: &usize| -> Vec<Weighted> {
        let runs = repeats.iter().filter(|repeat| repeat.sample == *sample);
        runs.map(|repeat| Weighted {
            value: repeat.value,
            variance: variance(repeat),
        })
        .collect()
    };
    let groups: Vec<Vec<Weighted>> = samples.iter().map(of_sample).collect();
    let between_runs = excess_variance(&groups);
    let means: Vec<Weighted> = groups
        .iter()
        .map(|group| weighted_mean(&widened(group, between_runs.unwrap_or(0.0))))
        .collect();
    let between_samples = excess_variance(std::slice::from_ref(&means));
    // With one sample the runs are all there is to judge the mean by.
    let judged = match groups.as_slice() {
        [only] => widened(only, between_runs.unwrap_or(0.0)),
        _ => widened(&means, between_samples.unwrap_or(0.0)),
    };
    let mean = weighted_mean(&judged);
    let standard_error = mean.variance.sqrt() * inflation(&judged, mean.value);
    let half_width = match judged.len() {
        1 => NORMAL_95_ROUNDED,
        count => quantile_95(count as f64 - 1.0),
    } * standard_error;
    let precision: f64 = repeats.iter().map(|repeat| 1.0 / variance(repeat)).sum();
    Pooled {
        value: mean.value,
        standard_error,
        low_95: mean.value - half_width,
        high_95: mean.value + half_width,
        fit_standard_error: precision.recip().sqrt(),
        between_runs: between_runs.map(f64::sqrt),
        between_samples: between_samples.map(f64::sqrt),
        runs: repeats.len(),
        samples: groups.len(),
    }
}

fn widened(numbers: &[Weighted], by_variance: f64) -> Vec<Weighted> {
    let wider = |number: &Weighted| Weighted {
        variance: number.variance + by_variance,
        ..*number
    };
    numbers.iter().map(wider).collect()
}

fn weighted_mean(numbers: &[Weighted]) -> Weighted {
    let weight: f64 = numbers.iter().map(|number| 1.0 / number.variance).sum();
    let sum: f64 = numbers.iter().map(|number| number.value / number.variance).sum();
    Weighted {
        value: sum / weight,
        variance: 1.0 / weight,
    }
}

/// Variance within the groups beyond that of the numbers themselves (DerSimonian and Laird, over all groups at
/// once); none where no group has two members.
fn excess_variance(groups: &[Vec<Weighted>]) -> Option<f64> {
    let (mut scatter, mut freedom, mut weight) = (0.0, 0.0, 0.0);
    for group in groups.iter().filter(|group| group.len() > 1) {
        let mean = weighted_mean(group).value;
        let weights: Vec<f64> = group.iter().map(|number| 1.0 / number.variance).collect();
        let sum: f64 = weights.iter().sum();
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        let deviation = |(number, weight): (&Weighted, &f64)| weight * (number.value - mean).powi(2);
        scatter += group.iter().zip(&weights).map(deviation).sum::<f64>();
        freedom += group.len() as f64 - 1.0;
        weight += sum - squares / sum;
    }
    (freedom > 0.0).then(|| ((scatter - freedom) / weight).max(0.0))
}

/// By how much the scatter of the numbers about their mean exceeds what their variances promise; 1 at least.
fn inflation(numbers: &[Weighted], mean: f64) -> f64 {
    if numbers.len() < 2 {
        return 1.0;
    }
    let scatter: f64 = numbers
        .iter()
        .map(|number| (number.value - mean).powi(2) / number.variance)
        .sum();
    (scatter / (numbers.len() as f64 - 1.0)).sqrt().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn repeat(sample: usize, value: f64, standard_error: f64) -> Repeat {
        Repeat {
            sample,
            value,
            standard_error,
        }
    }

    #[test]
    fn one_run_is_itself() {
        let mean = pooled(&[repeat(0, 24.6, 0.3)], Averaging::Linear).unwrap();
        assert_eq!((mean.runs, mean.samples), (1, 1));
        assert!((mean.value - 24.6).abs() < 1e-12);
        assert!((mean.standard_error - 0.3).abs() < 1e-12);
        assert_eq!((mean.between_runs, mean.between_samples), (None, None));
    }

    #[test]
    fn repeats_that_agree_have_no_spread_of_their_own() {
        let mean = pooled(&[repeat(0, 10.0, 1.0), repeat(0, 10.5, 1.0)], Averaging::Linear).unwrap();
        assert_eq!(mean.between_runs, Some(0.0));
        assert!((mean.value - 10.25).abs() < 1e-12);
        assert!((mean.fit_standard_error - 0.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn spread_of_samples_is_told_from_that_of_fits() {
        let runs = [
            repeat(0, 10.0, 0.01),
            repeat(0, 10.1, 0.01),
            repeat(1, 14.0, 0.01),
            repeat(1, 14.1, 0.01),
        ];
        let mean = pooled(&runs, Averaging::Linear).unwrap();
        assert!((mean.value - 12.05).abs() < 1e-6);
        // Sample variance of 10.05 and 14.05 is 8; the means' own errors take almost nothing from it.
        assert!((mean.between_samples.unwrap() - 8f64.sqrt()).abs() < 0.01);
        assert!((mean.between_runs.unwrap() - 0.07).abs() < 0.01);
        assert!((mean.fit_standard_error - 0.005).abs() < 1e-12);
        assert!(
            mean.high_95 - mean.low_95 > 40.0,
            "two samples say little: {mean:?}"
        );
    }

    #[test]
    fn positive_quantities_are_averaged_by_their_logarithms() {
        let runs = [repeat(0, 1e-4, 1e-7), repeat(1, 1e-2, 1e-5)];
        let mean = pooled(&runs, Averaging::Logarithmic).unwrap();
        assert!((mean.value / 1e-3 - 1.0).abs() < 1e-6, "{mean:?}");
        assert!(mean.low_95 > 0.0);
        assert_eq!(pooled(&[repeat(0, -1.0, 0.1)], Averaging::Logarithmic), None);
        assert_eq!(pooled(&[], Averaging::Linear), None);
    }

    /// Share of intervals that hold the truth.
    fn coverage(samples: usize, runs: usize, between_samples: f64, between_runs: f64) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
        let trials = 1500;
        let mut held = 0;
        for _ in 0..trials {
            let mut repeats = Vec::new();
            for sample in 0..samples {
                let of_sample = between_samples * normal();
                for run in 0..runs {
                    let error = 0.5 + 0.2 * run as f64;
                    let value = 50.0 + of_sample + between_runs * normal() + error * normal();
                    repeats.push(repeat(sample, value, error));
                }
            }
            let mean = pooled(&repeats, Averaging::Linear).unwrap();
            held += usize::from((mean.low_95..=mean.high_95).contains(&50.0));
        }
        held as f64 / f64::from(trials)
    }

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        for (samples, runs, between_samples, between_runs) in [
            (2, 1, 2.0, 0.0),
            (3, 3, 2.0, 1.0),
            (6, 2, 1.0, 1.0),
            (1, 4, 0.0, 1.5),
            (4, 2, 0.0, 0.0),
        ] {
            let share = coverage(samples, runs, between_samples, between_runs);
            // 1500 trials know the share to 0.6 %; unknown variances and few groups may only widen.
            assert!(share > 0.93, "{samples} samples of {runs} runs: {share}");
        }
    }
}
