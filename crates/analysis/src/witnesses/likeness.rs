//! Which of two statements the readings of a run are like: its parameters against those of other runs, of which nobody doubts
//! what they are.
//!
//! The witnesses of a statement are the runs that it would put the run among: alike in all but the key, and of the stated value.
//! In each parameter they have a mean; the scatter about means of the same condition is that of all witnesses. How much better
//! one of the two means fits is told by Student's densities, over all parameters. What was divided by the area of the strip that
//! a run is said to be of is brought to the area of the other one first.

use std::collections::BTreeMap;

use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord, Tag};
use ieap_numerics::sums::mean;

use super::doubt::{Doubt, KEYS};
use crate::conditions::{HUMIDITY_GAP_PERCENT, VOLTAGE_STEP_V};
use crate::parameters::usable;

/// Parameters that are compared, each with the power of the strip's area in it: each is told apart from the others by a fit,
/// and their logarithms scatter alike.
const COMPARED: [(&str, f64); 5] = [
    ("r_parallel_ohm_cm2", 1.0),
    ("c_total_f_per_cm2", -1.0),
    ("rss_ohm_cm2", 1.0),
    ("alpha_per_c_cm", 0.0),
    ("lambda_per_s", 0.0),
];

/// How many times better one statement must fit the readings to be named. Chosen: what it decides is a word of advice.
const NAMED_FROM: f64 = 100.0;

/// Runs of which nobody doubts what they are.
pub(super) struct Witnesses<'a> {
    runs: Vec<&'a RunRecord>,
    campaign: &'a Campaign,
    /// Variance of each parameter about the means of runs that are tagged alike, and its degrees of freedom.
    scatter: [Option<(f64, f64)>; COMPARED.len()],
}

impl<'a> Witnesses<'a> {
    pub fn of(runs: Vec<&'a RunRecord>, campaign: &'a Campaign) -> Witnesses<'a> {
        Witnesses {
            scatter: COMPARED.map(|(parameter, _)| scatter(&runs, parameter)),
            runs,
            campaign,
        }
    }

    /// Logarithm of how many times larger the strip is by a statement than the fit took it for; 0 where that is not known.
    fn log_area(&self, run: &RunRecord, stated: &Tag) -> f64 {
        let area = |sample: &str| self.campaign.sample(sample)?.active_area_cm2();
        let of = |sample: Option<&str>| sample.and_then(area).filter(|area| *area > 0.0);
        let stated = (stated.key == keys::SAMPLE).then_some(&stated.value[..]);
        let both = of(stated).zip(of(run.tag(keys::SAMPLE)));
        both.map_or(0.0, |(stated, taken)| (stated / taken).ln())
    }

    /// The statement that the readings are like; none where they do not tell.
    pub fn like<'b>(&self, doubt: &Doubt<'b>) -> Option<&'b Tag> {
        let as_stated = |tag: &Tag| -> Vec<&RunRecord> {
            let all = self.runs.iter().copied();
            all.filter(|run| is_as(run, doubt.run, tag)).collect()
        };
        let both = [doubt.said, doubt.other].map(as_stated);
        let log_areas = [doubt.said, doubt.other].map(|tag| self.log_area(doubt.run, tag));
        let odds: f64 = (COMPARED.iter().zip(&self.scatter))
            .filter_map(|((parameter, power), scatter)| {
                let by_area = log_areas.map(|log| power * log);
                log_odds(doubt.run, by_area, &both, parameter, (*scatter)?)
            })
            .sum();
        match odds {
            odds if odds > NAMED_FROM.ln() => Some(doubt.said),
            odds if odds < -NAMED_FROM.ln() => Some(doubt.other),
            _ => None,
        }
    }
}

/// Logarithm of how many times better a parameter of a run fits the first of two sets of runs than the other, its logarithm
/// larger by so much as one of each; none where it is not told.
fn log_odds(
    run: &RunRecord,
    by_area: [f64; 2],
    both: &[Vec<&RunRecord>; 2],
    parameter: &str,
    (variance, freedom): (f64, f64),
) -> Option<f64> {
    let own = value(run, parameter)?;
    let log_density = |side: usize| {
        let of: Vec<f64> = both[side]
            .iter()
            .filter_map(|run| value(run, parameter))
            .collect();
        let share = 1.0 + 1.0 / of.len() as f64;
        let square = (own + by_area[side] - mean(&of)).powi(2) / (variance * share);
        (!of.is_empty()).then(|| -0.5 * share.ln() - 0.5 * (freedom + 1.0) * (square / freedom).ln_1p())
    };
    Some(log_density(0)? - log_density(1)?)
}

/// Logarithm of a parameter of a run.
fn value(run: &RunRecord, parameter: &str) -> Option<f64> {
    let estimate = usable(run, parameter).filter(|estimate| !estimate.at_bound)?;
    Some(estimate.value?.abs().ln()).filter(|log| log.is_finite())
}

/// Whether a witness is of the stated value, and in all else as the run.
fn is_as(witness: &RunRecord, run: &RunRecord, stated: &Tag) -> bool {
    KEYS.iter().all(|key| {
        let wanted = if *key == stated.key {
            Some(&stated.value[..])
        } else {
            run.tag(key)
        };
        match (witness.tag(key), wanted) {
            (None, None) => true,
            (Some(own), Some(wanted)) => is_near(key, own, wanted),
            _ => false,
        }
    })
}

/// Whether two values of a key are one condition.
fn is_near(key: &str, one: &str, other: &str) -> bool {
    let within = match key {
        keys::VOLTAGE_V => VOLTAGE_STEP_V,
        keys::RELATIVE_HUMIDITY_PERCENT => HUMIDITY_GAP_PERCENT,
        _ => return one == other,
    };
    let numbers = one.parse::<f64>().ok().zip(other.parse::<f64>().ok());
    numbers.map_or(one == other, |(a, b)| (a - b).abs() <= within)
}

/// Variance of a parameter about the means of runs that are tagged alike, and its degrees of freedom.
fn scatter(witnesses: &[&RunRecord], parameter: &str) -> Option<(f64, f64)> {
    let mut alike: BTreeMap<[Option<&str>; KEYS.len()], Vec<f64>> = BTreeMap::new();
    for run in witnesses {
        if let Some(value) = value(run, parameter) {
            alike.entry(KEYS.map(|key| run.tag(key))).or_default().push(value);
        }
    }
    let (mut square, mut freedom) = (0.0, 0.0);
    for values in alike.values() {
        let mean = mean(values);
        square += values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        freedom += values.len() as f64 - 1.0;
    }
    let variance = square / freedom;
    (freedom > 0.0 && variance > 0.0).then_some((variance, freedom))
}
