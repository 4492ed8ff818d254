//! By how much a number moved with a reading: the mean from it on against the mean before.

use std::ops::Range;

use super::series::Series;
use crate::monitoring::fitted::Interval;
use crate::monitoring::policy::STEP_PAID;
use ieap_numerics::grouped::Grouped;
use ieap_numerics::student::{quantile_95, two_sided_chance};
use ieap_numerics::sums::dot;

/// A difference of two means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moved {
    /// On the series' scale.
    pub size: Interval,
    /// Standard error, same scale.
    pub error: f64,
    /// Probability that chance brings it at any of the readings.
    pub p: f64,
}

impl Moved {
    /// How clear it is, in standard errors.
    pub(super) fn deviations(&self) -> f64 {
        (self.size.value / self.error).abs()
    }
}

impl Series {
    /// By how much the readings `within` moved with the reading `at`, where scatter may go on from one to the next; none where
    /// they are too few.
    pub(super) fn moved(&self, within: Range<usize>, at: usize) -> Option<Moved> {
        let n = within.len();
        if n < 3 || at <= within.start || at >= within.end {
            return None;
        }
        let of = |all: &[f64]| all[within.clone()].to_vec();
        let own = Series {
            x: of(&self.x),
            y: of(&self.y),
            variance: of(&self.variance),
            is_log: self.is_log,
            breaks: Vec::new(),
        };
        let (one, column) = (vec![0; n], own.column(at - within.start));
        // The chart looked for the place, which is paid.
        let scatter = own.scatter(&one, std::slice::from_ref(&column), STEP_PAID - 1);
        let level = Grouped::new(&scatter.variance, &one, &[]);
        let (step, left) = (level.residual(&column), level.residual(&own.y));
        let square = dot(&step, &step);
        let (value, error) = (dot(&step, &left) / square, square.sqrt().recip());
        let freedom = ((n - 2) as f64 / scatter.per_independent).max(1.0);
        let reach = quantile_95(freedom) * error;
        Some(Moved {
            size: Interval {
                value,
                low_95: Some(value - reach),
                high_95: Some(value + reach),
            },
            error,
            p: (self.y.len() as f64 * two_sided_chance(value / error, freedom)).min(1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// 40 readings that move by 0.2 with the 21st; their scatter of 0.05 goes on by that correlation.
    fn series(moves: f64, correlation: f64, seed: u64) -> Series {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut scatter = normal();
        let y = (0..40).map(|k| {
            scatter = correlation * scatter + (1.0 - correlation * correlation).sqrt() * normal();
            0.05 * scatter + if k >= 20 { moves } else { 0.0 }
        });
        Series {
            y: y.collect(),
            x: (0..40).map(f64::from).collect(),
            variance: vec![1e-4; 40],
            is_log: true,
            breaks: Vec::new(),
        }
    }

    #[test]
    fn a_change_is_held_by_its_interval_and_nothing_is_none() {
        // Of 95 in 100 held, fewer, and of 1 in 100 told, more than these come by chance in one of 1,000 tries.
        for correlation in [0.0, 0.3, 0.6] {
            let of = |moves: f64| (0..400).map(move |seed| series(moves, correlation, 90_000 + seed));
            let holds = |own: &Series| {
                let all = (15..=25).map(|at| own.moved(0..40, at).unwrap());
                let likeliest = all.max_by(|a, b| a.deviations().total_cmp(&b.deviations()));
                let size = likeliest.unwrap().size;
                size.low_95.unwrap() <= 0.2 && 0.2 <= size.high_95.unwrap()
            };
            let held = of(0.2).filter(holds).count();
            let told = |own: &Series| (1..40).any(|at| own.moved(0..40, at).unwrap().p <= 0.01);
            let told = of(0.0).filter(told).count();
            println!("correlation {correlation}: {held} of 400 held; of nothing {told} told at 1 %");
            assert!(held >= 366 && told <= 11, "{correlation}: {held}, {told}");
        }
    }

    #[test]
    fn one_side_alone_tells_no_change() {
        let own = series(0.2, 0.0, 1);
        assert_eq!(
            (own.moved(0..40, 0), own.moved(0..2, 1), own.moved(0..40, 40)),
            (None, None, None)
        );
    }
}
