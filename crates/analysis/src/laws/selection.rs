//! Whether runs that failed, were refused or are missing lie at random over the conditions.

use super::chance_of::random_choice_chance;
use super::policy::FEWEST_ATTEMPTS;

/// A run that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Environment, where it is known.
    pub environment: Option<String>,
    /// Magnitude of the nominal voltage, V.
    pub voltage_v: Option<f64>,
    /// Relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Whether nothing can be used of it.
    pub failed: bool,
}

/// Failed runs and one covariate of all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// `voltage_v`, `relative_humidity_percent` or `environment`.
    pub covariate: &'static str,
    /// Failed runs.
    pub failed: usize,
    /// All runs whose covariate is known.
    pub attempts: usize,
    /// Mean of the covariate over failed runs less that over usable ones; none for names.
    pub shift: Option<f64>,
    /// The name in which the largest part failed, with failed and all runs there; none for numbers.
    pub worst: Option<(String, usize, usize)>,
    /// Probability of a distribution at least as uneven.
    pub p: f64,
    /// The same over all questions of the campaign; 1 until all are asked.
    pub q: f64,
}

/// Asks about every covariate that is known of enough runs. Exact: every choice of as many failures is as likely.
pub fn selections(attempts: &[Attempt], seed: u64) -> Vec<Selection> {
    let mut found = Vec::new();
    found.extend(by_number("voltage_v", attempts, |a| a.voltage_v, seed));
    found.extend(by_number(
        "relative_humidity_percent",
        attempts,
        |a| a.relative_humidity_percent,
        seed.wrapping_add(1),
    ));
    found.extend(by_name(attempts, seed.wrapping_add(2)));
    found
}

fn by_number(
    covariate: &'static str,
    attempts: &[Attempt],
    number: fn(&Attempt) -> Option<f64>,
    seed: u64,
) -> Option<Selection> {
    let known: Vec<(f64, bool)> = attempts
        .iter()
        .filter_map(|a| Some((number(a)?, a.failed)))
        .collect();
    let failed: Vec<bool> = known.iter().map(|(_, failed)| *failed).collect();
    let count = enough(&failed)?;
    let ranks = ranks(&known.iter().map(|(x, _)| *x).collect::<Vec<_>>());
    if ranks.iter().all(|rank| *rank == ranks[0]) {
        return None;
    }
    let expected = count as f64 * (known.len() as f64 + 1.0) / 2.0;
    let extent = |failed: &[bool]| -> f64 {
        let sum: f64 = ranks
            .iter()
            .zip(failed)
            .filter(|(_, failed)| **failed)
            .map(|(rank, _)| rank)
            .sum();
        (sum - expected).abs()
    };
    let mean = |wanted: bool| {
        let of: Vec<f64> = known
            .iter()
            .filter(|(_, failed)| *failed == wanted)
            .map(|(x, _)| *x)
            .collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    Some(Selection {
        covariate,
        failed: count,
        attempts: known.len(),
        shift: Some(mean(true) - mean(false)),
        worst: None,
        p: random_choice_chance(&failed, &extent, seed),
        q: 1.0,
    })
}

fn by_name(attempts: &[Attempt], seed: u64) -> Option<Selection> {
    let known: Vec<(&str, bool)> = attempts
        .iter()
        .filter_map(|a| Some((a.environment.as_deref()?, a.failed)))
        .collect();
    let failed: Vec<bool> = known.iter().map(|(_, failed)| *failed).collect();
    let count = enough(&failed)?;
    let mut names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    names.sort_unstable();
    names.dedup();
    if names.len() < 2 {
        return None;
    }
    let of: Vec<usize> = known
        .iter()
        .map(|(name, _)| names.binary_search(name).unwrap_or(0))
        .collect();
    let mut all = vec![0.0; names.len()];
    of.iter().for_each(|&k| all[k] += 1.0);
    let part = count as f64 / known.len() as f64;
    let counted = |failed: &[bool]| -> Vec<f64> {
        let mut counts = vec![0.0; names.len()];
        of.iter()
            .zip(failed)
            .filter(|(_, failed)| **failed)
            .for_each(|(&k, _)| counts[k] += 1.0);
        counts
    };
    let extent = |failed: &[bool]| -> f64 {
        let counts = counted(failed);
        counts
            .iter()
            .zip(&all)
            .map(|(count, all)| (count - part * all).powi(2) / all)
            .sum()
    };
    let counts = counted(&failed);
    let worst = (0..names.len()).max_by(|&a, &b| (counts[a] / all[a]).total_cmp(&(counts[b] / all[b])))?;
    Some(Selection {
        covariate: "environment",
        failed: count,
        attempts: known.len(),
        shift: None,
        worst: Some((
            names[worst].to_owned(),
            counts[worst] as usize,
            all[worst] as usize,
        )),
        p: random_choice_chance(&failed, &extent, seed),
        q: 1.0,
    })
}

/// Number of failures, where there are enough of both kinds.
fn enough(failed: &[bool]) -> Option<usize> {
    let count = failed.iter().filter(|failed| **failed).count();
    (count >= FEWEST_ATTEMPTS && failed.len() - count >= FEWEST_ATTEMPTS).then_some(count)
}

/// Ranks from 1, those of equal numbers averaged.
fn ranks(numbers: &[f64]) -> Vec<f64> {
    let rank = |x: &f64| {
        let below = numbers.iter().filter(|other| *other < x).count() as f64;
        let equal = numbers.iter().filter(|other| *other == x).count() as f64;
        below + (equal + 1.0) / 2.0
    };
    numbers.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attempts(failed: impl Fn(usize, f64) -> bool) -> Vec<Attempt> {
        let volts = [1.0, 1.5, 2.0, 2.5, 3.0];
        (0..30)
            .map(|k| Attempt {
                environment: Some(["vacuum", "air"][k % 2].to_owned()),
                voltage_v: Some(volts[k % 5]),
                relative_humidity_percent: None,
                failed: failed(k, volts[k % 5]),
            })
            .collect()
    }

    #[test]
    fn failures_at_high_voltage_are_seen() {
        let found = selections(&attempts(|k, volts| volts > 2.9 && k % 3 > 0), 1);
        let voltage = &found[0];
        assert_eq!(
            (voltage.covariate, voltage.failed, voltage.attempts),
            ("voltage_v", 4, 30)
        );
        assert!(voltage.p < 0.01 && voltage.shift.unwrap() > 0.5, "{voltage:?}");
        let environment = &found[1];
        assert!(environment.p > 0.3, "{environment:?}");
    }

    #[test]
    fn without_failures_nothing_is_asked() {
        assert!(selections(&attempts(|_, _| false), 1).is_empty());
        assert!(selections(&attempts(|k, _| k == 3), 1).is_empty());
    }
}
