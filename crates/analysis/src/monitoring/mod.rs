//! Long-term monitoring: parameters in the reference condition over the life of each sample, their trends, charts and
//! alarms, and what of a change comes back with the air.

mod alarm_words;
mod chance_of;
pub mod charts;
mod course;
#[cfg(test)]
mod course_tests;
mod events;
pub mod fitted;
pub mod forecasts;
#[cfg(test)]
mod jump_tests;
pub mod lives;
#[cfg(test)]
mod memory_tests;
mod moved;
pub mod policy;
pub mod reference;
#[cfg(test)]
mod season_tests;
mod seasons;
pub mod series;
pub mod shape;
mod sheet;
pub mod view;
mod watched;
pub mod words;

pub use watched::Watched;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::laws::covariate::Covariate;
use crate::laws::doubt::Doubts;
use crate::laws::facts::{RunFacts, start_s};
use crate::laws::values::{Value, keys, values};
use ieap_domain::{Alarm, Campaign, RunRecord};
use ieap_numerics::control_chart;
use reference::Reference;
use series::{Reaches, Series};

/// What monitoring says of a campaign.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Monitoring {
    /// The reference condition.
    pub reference: Option<Reference>,
    /// Why there is none.
    pub why_not: String,
    /// Runs of a sample between two false alarms of any of its charts, on average.
    pub false_alarm_runs: f64,
    /// Charts of the sample that has the most.
    pub charts_of_a_sample: usize,
    /// Parameters of samples, those that moved first within each sample.
    pub watched: Vec<Watched>,
    /// Alarms, whether known or not.
    pub alarms: Vec<Alarm>,
}

impl Monitoring {
    /// Runs until a chart sees a shift by one standard deviation, on average.
    pub fn shifted_run_length(&self) -> f64 {
        let runs = runs_of_a_chart(self.false_alarm_runs, self.charts_of_a_sample).max(2.0);
        control_chart::run_length(control_chart::limit(runs), 1.0)
    }
}

/// Runs between two false alarms of one chart where `charts` of them together give one in `false_alarm_runs`: at most, for
/// parameters that move together alarm together.
fn runs_of_a_chart(false_alarm_runs: f64, charts: usize) -> f64 {
    false_alarm_runs * charts.max(1) as f64
}

/// What is watched.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// Runs that speak, with their fits.
    pub runs: &'a [RunRecord],
    /// The campaign.
    pub campaign: &'a Campaign,
    /// Facts of the runs.
    pub facts: &'a [RunFacts],
    /// What findings say against fits.
    pub doubts: &'a Doubts,
}

/// Watches every parameter of every sample in the reference condition.
pub fn monitor(evidence: Evidence) -> Monitoring {
    let Evidence {
        runs,
        campaign,
        facts,
        ..
    } = evidence;
    let rules = &campaign.monitoring;
    let mut monitoring = Monitoring {
        false_alarm_runs: rules.false_alarm_runs,
        ..Monitoring::default()
    };
    let reference = match reference::reference(runs, facts, rules) {
        Ok(reference) => reference,
        Err(why_not) => {
            monitoring.why_not = why_not;
            return monitoring;
        }
    };
    let mut samples: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for &place in &reference.places {
        samples.entry(&facts[place].sample).or_default().push(place);
    }
    let mut limits: BTreeMap<usize, f64> = BTreeMap::new();
    let mut questions: Vec<(Vec<usize>, String, usize)> = Vec::new();
    for places in samples
        .into_values()
        .filter(|places| places.len() >= policy::FEWEST_RUNS)
    {
        let keys = keys(runs, facts, &places);
        let charts = keys.len();
        let of_chart = || control_chart::limit(runs_of_a_chart(rules.false_alarm_runs, charts));
        limits.entry(charts).or_insert_with(of_chart);
        questions.extend(keys.into_iter().map(|key| (places.clone(), key, charts)));
    }
    monitoring.charts_of_a_sample = limits.keys().copied().max().unwrap_or(0);
    monitoring.watched = questions
        .par_iter()
        .filter_map(|(places, key, charts)| watch(evidence, places, (key, limits[charts])))
        .collect();
    if let Some(why_not) = without_order(facts, &questions).filter(|_| monitoring.watched.is_empty()) {
        monitoring.why_not = why_not;
        return monitoring;
    }
    monitoring.alarms = events::alarms(runs, campaign, &monitoring.watched);
    monitoring.reference = Some(reference);
    monitoring
}

/// Why no question has an order to go by; none where every run of one has a place in some order.
fn without_order(facts: &[RunFacts], questions: &[(Vec<usize>, String, usize)]) -> Option<String> {
    let has = |place: &usize| {
        Covariate::OF_AGE
            .iter()
            .any(|axis| facts[*place].numbers.contains_key(axis))
    };
    let (places, ..) = questions
        .iter()
        .min_by_key(|(places, ..)| places.iter().filter(|place| !has(place)).count())?;
    let missing = places.iter().filter(|place| !has(place)).count();
    (missing > 0).then(|| {
        format!(
            "{missing} of {} runs of {} in the reference condition do not say when they were made; tag them with cycle, or with started_at and its time",
            places.len(),
            facts[places[0]].sample
        )
    })
}

fn watch(evidence: Evidence, places: &[usize], (key, chart_limit): (&str, f64)) -> Option<Watched> {
    let Evidence {
        runs,
        campaign,
        facts,
        doubts,
    } = evidence;
    let mut found = values(runs, facts, places, key).in_doubt_of_one_series(doubts, runs, facts);
    if found.values.len() < policy::FEWEST_RUNS {
        return None;
    }
    let is_stated = |axis: &Covariate| {
        let mut values = found.values.iter();
        values.all(|value| facts[value.place].numbers.contains_key(axis))
    };
    let axis = Covariate::OF_AGE.into_iter().find(is_stated)?;
    let number =
        |place: usize, axis: Covariate| facts[place].numbers.get(&axis).map_or(0.0, |known| known.value);
    let mut order: Vec<usize> = (0..found.values.len()).collect();
    // Of runs at one place of the axis the order of the runs decides.
    order.sort_by(|&a, &b| {
        let by = |axis| number(found.values[a].place, axis).total_cmp(&number(found.values[b].place, axis));
        by(axis).then(by(Covariate::RunOrder))
    });
    let brought = seasons::bring(&mut found, facts, &order);
    let ordered: Vec<Value> = order.into_iter().map(|k| found.values[k]).collect();
    let is_another = |k: &usize, name: &Covariate| {
        let of = |k: usize| facts[ordered[k].place].names.get(name);
        of(*k) != of(*k - 1)
    };
    let breaks = (1..ordered.len())
        .filter(|k| {
            [Covariate::Instrument, Covariate::Calibration]
                .iter()
                .any(|name| is_another(k, name))
        })
        .collect();
    let series = Series {
        x: ordered.iter().map(|value| number(value.place, axis)).collect(),
        y: ordered.iter().map(|value| value.y).collect(),
        variance: ordered.iter().map(|value| value.variance).collect(),
        is_log: found.is_log,
        breaks,
    };
    let of_runs: Vec<usize> = ordered.iter().map(|value| facts[value.place].run).collect();
    let seed = of_runs.first().map_or(1, |run| runs[*run].id.unsigned_abs() + 1);
    let study = series.study(chart_limit, seed);
    let fact = &facts[places[0]];
    let limit = campaign.monitoring.limits.iter().find(|limit| {
        limit.parameter == key
            && limit
                .material
                .as_ref()
                .is_none_or(|material| *material == fact.material)
    });
    let limit = limit.map(|limit| {
        let on_scale = |x: f64| if found.is_log { x.max(1e-300).ln() } else { x };
        let reaches = match (limit.below, limit.above) {
            (Some(below), _) => series.reaches(&study, on_scale(below), true),
            (None, Some(above)) => series.reaches(&study, on_scale(above), false),
            (None, None) => Reaches::Unknown("no limit is stated".to_owned()),
        };
        (limit.clone(), reaches)
    });
    let starts_s: Option<Vec<f64>> = of_runs.iter().map(|run| start_s(&runs[*run])).collect();
    Some(Watched {
        material: fact.material.clone(),
        sample: fact.sample.clone(),
        parameter: key.to_owned(),
        axis,
        starts_s: starts_s.unwrap_or_default(),
        runs: of_runs,
        series,
        study,
        brought,
        limit,
        left_out: found.left_out.len(),
    })
}
