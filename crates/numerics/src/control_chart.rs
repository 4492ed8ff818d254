//! Control charts of standard normal numbers: their statistics, and how many numbers pass until a false alarm.
//!
//! Average run lengths are those of a Markov chain over a fine partition of the chart's statistic (Brook and Evans
//! 1972; Lucas and Saccucci 1990 for the weighted average).

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Weight of the newest number in the weighted average.
pub const EWMA_WEIGHT: f64 = 0.2;
/// Allowance of the cumulative sum: half the shift that it is meant for, in standard deviations.
pub const CUSUM_ALLOWANCE: f64 = 0.5;
/// States of the Markov chains.
const STATES: usize = 61;

/// A chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Chart {
    /// Each number by itself (Shewhart).
    Shewhart,
    /// Exponentially weighted moving average.
    Ewma,
    /// Cumulative sums, upwards and downwards.
    Cusum,
}

impl Chart {
    /// Every chart.
    pub const ALL: [Chart; 3] = [Chart::Shewhart, Chart::Ewma, Chart::Cusum];

    /// Stored name.
    pub fn key(self) -> &'static str {
        match self {
            Chart::Shewhart => "shewhart",
            Chart::Ewma => "ewma",
            Chart::Cusum => "cusum",
        }
    }

    /// Average number of numbers until an alarm at that `limit`, where they lie `shift` standard deviations off.
    pub fn run_length(self, limit: f64, shift: f64) -> f64 {
        match self {
            Chart::Shewhart => 1.0 / (1.0 - below(limit - shift) + below(-limit - shift)).max(1e-300),
            Chart::Ewma => ewma_run_length(limit, shift),
            Chart::Cusum => {
                // Alarms of either side come as those of the two together (Van Dobben de Bruyn 1968).
                let (up, down) = (cusum_run_length(limit, shift), cusum_run_length(limit, -shift));
                1.0 / (1.0 / up + 1.0 / down)
            }
        }
    }

    /// The limit at which a false alarm comes after `run_length` numbers on average.
    pub fn limit(self, run_length: f64) -> f64 {
        // The length grows as the exponential of the limit or faster; the cumulative sum has the largest limits.
        let (mut low, mut high) = (0.5_f64, 16.0_f64);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if self.run_length(middle, 0.0) < run_length {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    /// The chart's statistic after each number: the number, the average over its own standard deviation, or the larger
    /// of the two sums with the sign of its side.
    pub fn statistic(self, numbers: &[f64]) -> Vec<f64> {
        match self {
            Chart::Shewhart => numbers.to_vec(),
            Chart::Ewma => {
                let mut average = 0.0;
                // In units of the deviation that it settles to.
                let scale = (EWMA_WEIGHT / (2.0 - EWMA_WEIGHT)).sqrt();
                let next = |number: &f64| {
                    average += EWMA_WEIGHT * (number - average);
                    average / scale
                };
                numbers.iter().map(next).collect()
            }
            Chart::Cusum => {
                let (mut up, mut down) = (0.0_f64, 0.0_f64);
                let next = |number: &f64| {
                    up = (up + number - CUSUM_ALLOWANCE).max(0.0);
                    down = (down - number - CUSUM_ALLOWANCE).max(0.0);
                    if up >= down { up } else { -down }
                };
                numbers.iter().map(next).collect()
            }
        }
    }
}

/// Standard normal numbers from readings that nothing is known of beforehand: each is compared with the mean and the
/// standard deviation of those before it, by Student's t (Hawkins 1987). While the readings keep one mean and
/// deviation the numbers are independent and standard normal, however few readings came before. The first two give
/// none.
pub fn self_starting(readings: &[f64]) -> Vec<f64> {
    let mut numbers = Vec::with_capacity(readings.len().saturating_sub(2));
    let (mut mean, mut square) = (0.0, 0.0);
    for (k, &reading) in readings.iter().enumerate() {
        let n = k as f64;
        if k >= 2 {
            let deviation = (square / (n - 1.0)).sqrt();
            let t = (reading - mean) / deviation.max(f64::MIN_POSITIVE) * (n / (n + 1.0)).sqrt();
            numbers.push(as_normal(t, n - 1.0));
        }
        let difference = reading - mean;
        mean += difference / (n + 1.0);
        square += difference * (reading - mean);
    }
    numbers
}

/// The standard normal number with the probability of Student's t.
fn as_normal(t: f64, freedom: f64) -> f64 {
    let tail = StudentsT::new(0.0, 1.0, freedom).map_or(0.5, |student| student.sf(t.abs()));
    let size = Normal::standard().inverse_cdf(1.0 - tail.max(1e-16));
    size.copysign(t)
}

fn below(x: f64) -> f64 {
    Normal::standard().cdf(x)
}

/// One-sided cumulative sum from 0.
fn cusum_run_length(limit: f64, shift: f64) -> f64 {
    // States: 0, then even parts of what is below the limit; the first is half as wide (Brook and Evans).
    let width = 2.0 * limit / (2 * STATES - 1) as f64;
    let passage = |from: usize, to: usize| {
        let start = from as f64 * width;
        let upper = (to as f64 + 0.5) * width - start + CUSUM_ALLOWANCE - shift;
        match to {
            0 => below(upper),
            _ => below(upper) - below(upper - width),
        }
    };
    mean_passage(STATES, &passage)[0]
}

/// Weighted average from 0, limits in units of the deviation that it settles to.
fn ewma_run_length(limit: f64, shift: f64) -> f64 {
    let reach = limit * (EWMA_WEIGHT / (2.0 - EWMA_WEIGHT)).sqrt();
    let width = 2.0 * reach / STATES as f64;
    let center = |state: usize| -reach + (state as f64 + 0.5) * width;
    let passage = |from: usize, to: usize| {
        let low = (center(to) - 0.5 * width - (1.0 - EWMA_WEIGHT) * center(from)) / EWMA_WEIGHT - shift;
        below(low + width / EWMA_WEIGHT) - below(low)
    };
    mean_passage(STATES, &passage)[STATES / 2]
}

/// Mean number of steps until the chain leaves its states, from each.
fn mean_passage(states: usize, passage: &dyn Fn(usize, usize) -> f64) -> Vec<f64> {
    // (1 - P) x = 1 by elimination; the matrix is diagonally dominant.
    let mut rows: Vec<Vec<f64>> = (0..states)
        .map(|from| {
            let mut row: Vec<f64> = (0..states).map(|to| -passage(from, to)).collect();
            row[from] += 1.0;
            row.push(1.0);
            row
        })
        .collect();
    for pivot in 0..states {
        let (done, rest) = rows.split_at_mut(pivot + 1);
        let lead = &done[pivot];
        for row in rest {
            let factor = row[pivot] / lead[pivot];
            if factor != 0.0 {
                for column in pivot..=states {
                    row[column] -= factor * lead[column];
                }
            }
        }
    }
    let mut x = vec![0.0; states];
    for row in (0..states).rev() {
        let known: f64 = (row + 1..states)
            .map(|column| rows[row][column] * x[column])
            .sum();
        x[row] = (rows[row][states] - known) / rows[row][row];
    }
    x
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn run_lengths_of_the_printed_tables() {
        // Shewhart at 3: 370.4. Cumulative sum k = 0.5, h = 5: 465 in control, 10.4 at one deviation (Montgomery,
        // table 9.3). Weighted average 0.2 at 2.962: 500, 10.5 at one deviation (Lucas and Saccucci 1990, table 3).
        for (chart, limit, shift, expected, part) in [
            (Chart::Shewhart, 3.0, 0.0, 370.4, 1e-3),
            (Chart::Shewhart, 3.0, 1.0, 43.89, 1e-3),
            (Chart::Cusum, 5.0, 0.0, 465.0, 5e-3),
            (Chart::Cusum, 5.0, 1.0, 10.4, 5e-3),
            (Chart::Ewma, 2.962, 0.0, 500.0, 2e-2),
            (Chart::Ewma, 2.962, 1.0, 10.5, 2e-2),
        ] {
            let found = chart.run_length(limit, shift);
            assert!(
                (found / expected - 1.0).abs() < part,
                "{chart:?} {shift}: {found}"
            );
        }
        for chart in Chart::ALL {
            assert!((chart.run_length(chart.limit(300.0), 0.0) / 300.0 - 1.0).abs() < 1e-5);
        }
    }

    /// Numbers until the first alarm, averaged over `tries` series.
    fn simulated(chart: Chart, limit: f64, self_start: bool, tries: u64) -> (f64, f64) {
        let lengths: Vec<f64> = (0..tries)
            .map(|seed| {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let mut readings: Vec<f64> = (0..150).map(|_| StandardNormal.sample(&mut random)).collect();
                loop {
                    let numbers = if self_start {
                        self_starting(&readings)
                    } else {
                        readings.clone()
                    };
                    let first = chart.statistic(&numbers).iter().position(|x| x.abs() > limit);
                    if let Some(first) = first {
                        return (first + 1) as f64;
                    }
                    let more = readings.len();
                    readings.extend((0..more).map(|_| -> f64 { StandardNormal.sample(&mut random) }));
                }
            })
            .collect();
        let mean = lengths.iter().sum::<f64>() / tries as f64;
        let square: f64 = lengths.iter().map(|length| (length - mean).powi(2)).sum();
        (mean, (square / (tries as f64 - 1.0) / tries as f64).sqrt())
    }

    #[test]
    #[ignore = "slow: cargo test -- --ignored"]
    fn simulated_series_alarm_as_often_as_computed() {
        let tries = if std::env::var_os("IEAP_LONG").is_some() {
            20_000
        } else {
            2_000
        };
        for chart in Chart::ALL {
            let limit = chart.limit(60.0);
            for self_start in [false, true] {
                let (mean, error) = simulated(chart, limit, self_start, tries);
                println!(
                    "{} self-starting {self_start}: {mean:.1} +- {error:.1} of 60",
                    chart.key()
                );
                assert!(
                    (mean - 60.0).abs() < 3.5 * error + 0.6,
                    "{chart:?} {self_start}: {mean} {error}"
                );
            }
        }
    }
}
