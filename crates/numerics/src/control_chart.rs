//! The control chart of standard normal numbers: an exponentially weighted moving average, and how many numbers pass until a false
//! alarm.
//!
//! Average run lengths are those of a Markov chain over a fine partition of the average (Brook and Evans 1972; Lucas and
//! Saccucci 1990).

use super::line::edge;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Weight of the newest number in the weighted average.
pub const EWMA_WEIGHT: f64 = 0.2;
/// States of the Markov chain.
const STATES: usize = 61;

/// The limit at which a false alarm comes after `run_length` numbers on average.
pub fn limit(mean_run_length: f64) -> f64 {
    // The length grows as the exponential of the limit or faster.
    edge(0.5, 16.0, 30, |limit| run_length(limit, 0.0) < mean_run_length)
}

/// The weighted average after each number, over the standard deviation that it settles to.
pub fn statistic(numbers: &[f64]) -> Vec<f64> {
    let mut average = 0.0;
    let scale = (EWMA_WEIGHT / (2.0 - EWMA_WEIGHT)).sqrt();
    let next = |number: &f64| {
        average += EWMA_WEIGHT * (number - average);
        average / scale
    };
    numbers.iter().map(next).collect()
}

/// Standard normal numbers from readings that nothing is known of beforehand but the `variance` of each: it is compared with
/// the mean and the standard deviation of those before it, by Student's t (Hawkins 1987). While the readings keep one mean and
/// deviation the numbers are independent and standard normal, however few readings came before. The first two give
/// none.
///
/// A reading whose own variance is larger than theirs may lie as much farther off. One that says that it is better is not
/// taken at its word: the error that a fit states follows what it found, so that it would count more on one side.
pub fn self_starting(readings: &[f64], variance: &[f64]) -> Vec<f64> {
    let mut numbers = Vec::with_capacity(readings.len().saturating_sub(2));
    let (mut mean, mut square, mut own) = (0.0, 0.0, 0.0);
    for (k, (&reading, &variance)) in readings.iter().zip(variance).enumerate() {
        let n = k as f64;
        if k >= 2 {
            let scatter = square / (n - 1.0);
            let more = (variance - own).max(0.0) / scatter.max(own).max(f64::MIN_POSITIVE);
            let deviation = (scatter * (1.0 + more + 1.0 / n)).sqrt();
            numbers.push(as_normal(
                (reading - mean) / deviation.max(f64::MIN_POSITIVE),
                n - 1.0,
            ));
        }
        let difference = reading - mean;
        mean += difference / (n + 1.0);
        own += (variance - own) / (n + 1.0);
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

/// Average number of numbers until the average, from 0, leaves that `limit`, where they lie `shift` standard deviations off.
pub fn run_length(limit: f64, shift: f64) -> f64 {
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
        // 0.2 at 2.962: 500, 10.5 at one deviation (Lucas and Saccucci 1990, table 3).
        for (shift, expected) in [(0.0, 500.0), (1.0, 10.5)] {
            let found = run_length(2.962, shift);
            assert!((found / expected - 1.0).abs() < 2e-2, "{shift}: {found}");
        }
        assert!((run_length(limit(300.0), 0.0) / 300.0 - 1.0).abs() < 1e-5);
    }

    /// Variance of a reading's own.
    type Variance = fn(usize) -> f64;

    /// Numbers until the first alarm, averaged over `tries` series; self-starting where each reading has a variance of its
    /// own beside what all scatter.
    fn simulated(limit: f64, variance: Option<Variance>, tries: u64) -> (f64, f64) {
        let lengths: Vec<f64> = (0..tries)
            .map(|seed| {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let own = |k: usize| variance.map_or(0.0, |of| of(k));
                let mut reading = |k: usize| -> f64 {
                    let normal: f64 = StandardNormal.sample(&mut random);
                    (1.0 + own(k)).sqrt() * normal
                };
                let mut readings: Vec<f64> = (0..150).map(&mut reading).collect();
                loop {
                    let variances: Vec<f64> = (0..readings.len()).map(own).collect();
                    let numbers = match variance {
                        Some(_) => self_starting(&readings, &variances),
                        None => readings.clone(),
                    };
                    let first = statistic(&numbers).iter().position(|x| x.abs() > limit);
                    if let Some(first) = first {
                        return (first + 1) as f64;
                    }
                    let more = readings.len();
                    readings.extend((more..2 * more).map(&mut reading));
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
        let limit = limit(60.0);
        let kinds: [(&str, Option<Variance>); 4] = [
            ("known", None),
            ("self-starting", Some(|_| 0.2)),
            ("worse from the 20th on", Some(|k| if k < 20 { 0.1 } else { 9.0 })),
            (
                "better from the 20th on",
                Some(|k| if k < 20 { 9.0 } else { 0.1 }),
            ),
        ];
        for (kind, variance) in kinds {
            let (mean, error) = simulated(limit, variance, tries);
            println!("{kind}: {mean:.1} +- {error:.1} of 60");
            // Where errors change, alarms come no more often, and more rarely for a while.
            let near = (mean - 60.0).abs() < 3.5 * error + 0.6;
            assert!(
                near || kind.ends_with("on") && mean > 60.0,
                "{kind}: {mean} {error}"
            );
        }
    }
}
