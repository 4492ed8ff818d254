//! What the order of the runs lets nobody tell apart.

use std::collections::BTreeMap;

use super::conditions::nominal_voltage_v;
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

/// Factors that always changed together with the age of the sample.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Confounding {
    /// Samples whose environments were measured one after the other, never returning to an earlier one.
    pub environment_with_age: Vec<String>,
    /// Samples whose voltages only rose with time within every environment.
    pub voltage_with_age: Vec<String>,
}

/// Looks for both in runs with a known start. A sample needs two environments, or two voltages, to count.
pub fn confounding(runs: &[RunRecord]) -> Confounding {
    let mut samples: BTreeMap<&str, Vec<&RunRecord>> = BTreeMap::new();
    for run in runs {
        if let (Some(sample), Some(_)) = (run.tag(keys::SAMPLE), run.tag(keys::STARTED_AT)) {
            samples.entry(sample).or_default().push(run);
        }
    }
    let mut found = Confounding::default();
    for (sample, mut runs) in samples {
        runs.sort_by_key(|run| run.tag(keys::STARTED_AT));
        if in_blocks(&runs) {
            found.environment_with_age.push(sample.to_owned());
        }
        if rising(&runs) {
            found.voltage_with_age.push(sample.to_owned());
        }
    }
    found
}

/// At least two environments, each measured in one unbroken stretch.
fn in_blocks(runs: &[&RunRecord]) -> bool {
    let stretches: Vec<Option<&str>> = runs
        .chunk_by(|a, b| a.tag(keys::ENVIRONMENT) == b.tag(keys::ENVIRONMENT))
        .map(|stretch| stretch[0].tag(keys::ENVIRONMENT))
        .collect();
    let mut distinct = stretches.clone();
    distinct.sort_unstable();
    distinct.dedup();
    distinct.len() >= 2 && distinct.len() == stretches.len()
}

/// Some stretch has two voltages, and in no stretch does the voltage fall.
fn rising(runs: &[&RunRecord]) -> bool {
    let mut rises = false;
    for stretch in runs.chunk_by(|a, b| a.tag(keys::ENVIRONMENT) == b.tag(keys::ENVIRONMENT)) {
        let magnitudes: Vec<f64> = stretch
            .iter()
            .filter_map(|run| nominal_voltage_v(run))
            .map(f64::abs)
            .collect();
        if magnitudes.windows(2).any(|pair| pair[1] < pair[0]) {
            return false;
        }
        rises |= magnitudes.windows(2).any(|pair| pair[1] > pair[0]);
    }
    rises
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{run, tag};

    fn in_order(order: &[(&str, f64)]) -> Vec<RunRecord> {
        let started = |(hour, &(environment, voltage_v)): (usize, &(&str, f64))| {
            let mut run = run("r", "CNaf-01", environment, None, voltage_v);
            run.tags
                .push(tag(keys::STARTED_AT, &format!("2026-11-20T{hour:02}:00:00Z")));
            run
        };
        order.iter().enumerate().map(started).collect()
    }

    #[test]
    fn the_thesis_order_confounds_both() {
        let found = confounding(&in_order(&[
            ("vacuum", 1.2),
            ("vacuum", 2.5),
            ("air", 1.2),
            ("air", 2.5),
        ]));
        assert_eq!(found.environment_with_age, ["CNaf-01"]);
        assert_eq!(found.voltage_with_age, ["CNaf-01"]);
    }

    #[test]
    fn returning_and_falling_voltages_do_not() {
        let found = confounding(&in_order(&[
            ("vacuum", 2.5),
            ("air", 2.5),
            ("air", 1.2),
            ("vacuum", 1.2),
        ]));
        assert_eq!(found, Confounding::default());
        assert_eq!(
            confounding(&in_order(&[("air", 1.2), ("air", 1.2)])),
            Confounding::default()
        );
    }
}
