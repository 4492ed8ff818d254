//! Runs in the surroundings asked for: those made there, else all of the environment, brought there by the laws that hold
//! across the runs.
//!
//! A parameter that follows the humidity, the temperature or the age goes from a run's own to the one asked for as the study's
//! model of it does. What that leaves open goes into the prediction. That runs stray from it is seen in how they then differ
//! from each other.

use crate::domain::words::in_a_row;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::asked::{AskedStrip, Condition};
use super::source::{LeftOutEntry, Source};
use crate::analysis::laws::Covariate;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::laws::facts::{RunFacts, facts};
use crate::analysis::laws::words::symbol;
use crate::analysis::study::{Course, Evidence, courses};
use crate::domain::tag::keys;
use crate::domain::{RunRecord, range_of};
use crate::model::changing::Change;
use crate::model::scaling::propagation::{values, with_values};
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::{Context, PipelineError};

/// Runs that tell of the surroundings asked for.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// The runs.
    pub runs: Vec<RunRecord>,
    /// Runs that do not state what is asked for.
    pub left_out: Vec<LeftOutEntry>,
    /// What brings them there; empty where they were made there.
    ways: Vec<Way>,
    /// How the humidity goes on from there, as [`AskedStrip::humidity_course`] has it.
    humidity_course: Vec<(f64, f64)>,
}

/// A condition to which runs are brought, with the laws that do it.
#[derive(Debug)]
struct Way {
    condition: Condition,
    /// The condition of each run, by its path.
    own: BTreeMap<String, f64>,
    /// One law a parameter.
    laws: Vec<Course>,
}

/// A condition that no run has, to which runs were brought.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BroughtEntry {
    /// What it is of: `relative_humidity_percent`, `temperature_c` or `age_h`.
    pub covariate: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What was asked for; of a course its beginning.
    pub to: f64,
    /// The smallest that was asked for.
    pub to_low: f64,
    /// The largest.
    pub to_high: f64,
    /// The smallest of the runs.
    pub from_low: f64,
    /// The largest of them.
    pub from_high: f64,
    /// Keys of the parameters that a law took there.
    pub by_law: Vec<String>,
}

impl Surroundings {
    /// Of `runs`, all of one environment and of the material of the sample asked for; `speaking` are all runs of the campaign.
    ///
    /// # Errors
    /// Nothing was measured about the conditions asked for, no law tells of them, or the database cannot be read.
    pub fn of(
        context: &Context,
        speaking: &[RunRecord],
        runs: Vec<RunRecord>,
        asked: &AskedStrip,
        material: &str,
    ) -> Result<Surroundings, PipelineError> {
        let mut found = Surroundings {
            runs,
            left_out: Vec::new(),
            ways: Vec::new(),
            humidity_course: asked.humidity_course.clone(),
        };
        let conditions = asked.conditions();
        if conditions.is_empty() {
            return Ok(found);
        }
        for condition in conditions {
            let own = numbers(context, speaking, condition.covariate);
            found.leave_out_unstated(&condition, &own)?;
            found.ways.push(Way {
                condition,
                own,
                laws: Vec::new(),
            });
        }
        let near = |run: &&RunRecord| found.ways.iter().all(|way| way.is_near(run));
        let near: Vec<RunRecord> = found.runs.iter().filter(near).cloned().collect();
        let is_of_sample = |run: &RunRecord| run.tag(keys::SAMPLE) == Some(&asked.sample);
        if found.humidity_course.is_empty() && near.iter().any(is_of_sample) {
            found.runs = near;
            found.ways.clear();
            return Ok(found);
        }
        for way in &found.ways {
            found
                .all_asked(way)
                .try_for_each(|to| way.refuse_outside(to, &found.runs))?;
        }
        let now = current_findings(context)?;
        let findings = Findings {
            groups: &now.groups,
            runs: &now.runs,
        };
        let evidence = Evidence {
            runs: speaking,
            campaign: &context.campaign,
            doubts: &Doubts::new(findings, speaking),
            curves: &[],
        };
        for way in &mut found.ways {
            way.laws = courses(&evidence, material, way.condition.covariate);
            way.refuse_without_laws(&found.runs, material)?;
        }
        Ok(found)
    }

    /// Runs that do not state the condition tell nothing.
    fn leave_out_unstated(
        &mut self,
        condition: &Condition,
        own: &BTreeMap<String, f64>,
    ) -> Result<(), PipelineError> {
        let environment = self.runs.first().and_then(|run| run.tag(keys::ENVIRONMENT));
        let environment = environment.unwrap_or_default().to_owned();
        let label = condition.covariate.label();
        let (stated, unstated): (Vec<_>, Vec<_>) = std::mem::take(&mut self.runs)
            .into_iter()
            .partition(|run| own.contains_key(&run.path));
        self.left_out.extend(unstated.into_iter().map(|run| LeftOutEntry {
            run: run.path,
            reason: format!("it states no {label}"),
        }));
        self.runs = stated;
        if self.runs.is_empty() {
            Err(PipelineError::bad_argument(
                condition.option,
                condition.to.to_string(),
                format!("no {}: runs in {environment} state no {label}", condition.option),
            ))
        } else {
            Ok(())
        }
    }

    /// Everything that is asked for of a condition: one number, or those of a course.
    fn all_asked(&self, way: &Way) -> impl Iterator<Item = f64> {
        let course = self.humidity_course.iter().map(|(_, percent)| *percent);
        let course: Vec<f64> = course.filter(|_| way.is_of_humidity()).collect();
        course.into_iter().chain([way.condition.to])
    }

    /// Whether runs are taken to conditions in which they were not made.
    pub fn brings(&self) -> bool {
        !self.ways.is_empty()
    }

    /// Takes the parameters of a run to the conditions, their errors in proportion.
    pub fn bring(&self, source: &mut Source) {
        if !self.brings() {
            return;
        }
        let before = values(&source.model);
        let after = self.taken(source, &before, None, None);
        let variants = self.variants();
        let models: Vec<Vec<f64>> = variants
            .iter()
            .map(|&variant| self.taken(source, &before, Some(variant), None))
            .collect();
        source.changes = self.changes(source, &before, None, &after);
        source.variant_changes = variants
            .iter()
            .zip(&models)
            .map(|(&variant, first)| self.changes(source, &before, Some(variant), first))
            .collect();
        source.variants = models.iter().map(|values| with_values(values)).collect();
        let n = before.len();
        let ratio = |k: usize| {
            if before[k] == 0.0 {
                1.0
            } else {
                after[k] / before[k]
            }
        };
        for (at, covariance) in source.covariance.iter_mut().enumerate() {
            *covariance *= ratio(at / n) * ratio(at % n);
        }
        source.model = with_values(&after);
    }

    /// What the parameters are of `first`, those at the beginning of the course of the humidity, from each of its times on.
    fn changes(
        &self,
        source: &Source,
        before: &[f64],
        variant: Option<Variant>,
        first: &[f64],
    ) -> Vec<Change> {
        let change = |&(from_s, percent): &(f64, f64)| {
            let then = self.taken(source, before, variant, Some(percent));
            let factor = |(then, first): (&f64, &f64)| if then == first { 1.0 } else { then / first };
            (from_s, then.iter().zip(first).map(factor).collect())
        };
        self.humidity_course.iter().map(change).collect()
    }

    /// The parameters of a run at the conditions, one law in another variant where one is given, at another humidity where one
    /// is given.
    fn taken(
        &self,
        source: &Source,
        before: &[f64],
        variant: Option<Variant>,
        humidity_percent: Option<f64>,
    ) -> Vec<f64> {
        let mut after = before.to_vec();
        for (w, way) in self.ways.iter().enumerate() {
            let to = humidity_percent
                .filter(|_| way.is_of_humidity())
                .unwrap_or(way.condition.to);
            let own = way.own.get(&source.run).copied().unwrap_or(to);
            for (l, law) in way.laws.iter().enumerate() {
                let Some(at) = source.keys.iter().position(|key| *key == law.parameter) else {
                    continue;
                };
                after[at] *= match variant.filter(|variant| (variant.way, variant.law) == (w, l)) {
                    Some(variant) => law.factors_one_error_off(own, to)[variant.direction],
                    None => law.factor(own, to),
                };
            }
        }
        after
    }

    /// What the laws allow as well, in the order of [`Source::variants`].
    fn variants(&self) -> Vec<Variant> {
        let ways = self.ways.iter().enumerate();
        let laws = ways.flat_map(|(w, way)| way.laws.iter().enumerate().map(move |(l, law)| (w, l, law)));
        let of_law = |(way, law, of): (usize, usize, &Course)| {
            let directions = 0..of.directions();
            directions.map(move |direction| Variant { way, law, direction })
        };
        laws.flat_map(of_law).collect()
    }

    /// What was brought where.
    pub fn brought(&self) -> Vec<BroughtEntry> {
        let entry = |way: &Way| {
            let (from_low, from_high) = way.range(&self.runs);
            let (to_low, to_high) = range_of(self.all_asked(way));
            BroughtEntry {
                covariate: way.condition.covariate.key(),
                unit: way.condition.covariate.unit(),
                to: way.condition.to,
                to_low,
                to_high,
                from_low,
                from_high,
                by_law: way.laws.iter().map(|law| law.parameter.clone()).collect(),
            }
        };
        self.ways.iter().map(entry).collect()
    }

    /// Where the runs were taken, in the beginning of a sentence.
    fn lead(&self, way: &Way) -> String {
        let Condition { covariate, to, .. } = way.condition;
        let unit = covariate.unit();
        if way.is_of_humidity() && !self.humidity_course.is_empty() {
            let (low, high) = range_of(self.all_asked(way));
            format!(
                "The humidity goes from {to} {unit} on between {low} and {high} {unit}, and the strip is taken to follow it at once: "
            )
        } else {
            format!("No run of the sample was made at {to} {unit}: ")
        }
    }

    /// The same as sentences; `keys` are the parameters that the runs' models have.
    pub fn sentences(&self, keys: &[String]) -> Vec<String> {
        self.ways
            .iter()
            .map(|way| format!("{}{}", self.lead(way), way.sentence(&self.runs, keys)))
            .collect()
    }
}

/// A law that is one standard error off in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Variant {
    way: usize,
    law: usize,
    direction: usize,
}

/// The covariate of every run that has it, by path.
fn numbers(context: &Context, speaking: &[RunRecord], covariate: Covariate) -> BTreeMap<String, f64> {
    let facts = facts(speaking, &context.campaign);
    let number = |fact: &RunFacts| {
        let known = fact.numbers.get(&covariate)?;
        Some((speaking[fact.run].path.clone(), known.value))
    };
    facts.iter().filter_map(number).collect()
}

impl Way {
    fn is_near(&self, run: &RunRecord) -> bool {
        let own = self.own.get(&run.path);
        own.is_some_and(|own| (own - self.condition.to).abs() <= self.condition.alike)
    }

    fn range(&self, runs: &[RunRecord]) -> (f64, f64) {
        range_of(runs.iter().filter_map(|run| self.own.get(&run.path).copied()))
    }

    fn is_of_humidity(&self) -> bool {
        self.condition.covariate == Covariate::RelativeHumidity
    }

    fn refuse_outside(&self, to: f64, runs: &[RunRecord]) -> Result<(), PipelineError> {
        let Condition {
            covariate, option, ..
        } = self.condition;
        let (low, high) = self.range(runs);
        if (low..=high).contains(&to) {
            return Ok(());
        }
        let environment = runs.first().and_then(|run| run.tag(keys::ENVIRONMENT));
        let (environment, unit) = (environment.unwrap_or_default(), covariate.unit());
        let needed = format!(
            "{low} to {high} {unit}, as runs in {environment} have{}",
            self.near()
        );
        Err(PipelineError::bad_argument(option, to.to_string(), needed))
    }

    /// `, or within 5 % RH of one`; nothing where runs have to have the very number.
    fn near(&self) -> String {
        let Condition { covariate, alike, .. } = self.condition;
        if alike > 0.0 {
            format!(", or within {alike} {} of one", covariate.unit())
        } else {
            String::new()
        }
    }

    fn refuse_without_laws(&self, runs: &[RunRecord], material: &str) -> Result<(), PipelineError> {
        if !self.laws.is_empty() {
            return Ok(());
        }
        let Condition {
            covariate,
            option,
            to,
            ..
        } = self.condition;
        let mut own: Vec<String> = runs
            .iter()
            .filter_map(|run| self.own.get(&run.path))
            .map(f64::to_string)
            .collect();
        own.dedup();
        let needed = format!(
            "what a run has ({}){}: no parameter of {material} has a law over the {} that takes runs elsewhere; `ieap table laws` says what was asked",
            own.join(", "),
            self.near(),
            covariate.label()
        );
        Err(PipelineError::bad_argument(option, to.to_string(), needed))
    }

    fn sentence(&self, runs: &[RunRecord], keys: &[String]) -> String {
        let covariate = self.condition.covariate;
        let (label, unit) = (covariate.label(), covariate.unit());
        let (low, high) = self.range(runs);
        let has_law = |key: &&String| self.laws.iter().any(|law| law.parameter == **key);
        let (with, without): (Vec<&String>, Vec<&String>) = keys.iter().partition(has_law);
        let names =
            |keys: &[&String]| in_a_row(&keys.iter().map(|key| symbol(key).to_owned()).collect::<Vec<_>>());
        let mut sentence = format!(
            "runs at {low} to {high} {unit} were taken there by the study's model of them, with what that leaves open ({}).",
            names(&with)
        );
        if !without.is_empty() {
            sentence += &format!(
                " {} without a law over the {label} stayed as they are.",
                names(&without)
            );
        }
        let tied: Vec<String> = self
            .laws
            .iter()
            .flat_map(|law| &law.tied)
            .map(|of| of.label().to_owned())
            .collect();
        if let Some(first) = tied.first() {
            sentence +=
                &format!(" In these runs the {first} changed with the {label}: the laws may be of either.");
        }
        sentence
    }
}
