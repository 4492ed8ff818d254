//! Asks every question of a study, and judges the answers together.

use std::collections::BTreeSet;

use ieap_domain::{Drive, Factor, RunRecord, Sample, Standing as RunStanding};
use schemars::JsonSchema;
use serde::Serialize;

use super::answer::{Answer, Certainty, InScope, Kind, Scale, Scope, Verdict};
use super::asked::Asked;
use super::evidence::Evidence;
use super::measured::distinct;
use super::odd::OddValue;
use super::policy::{ALIKE_PERCENT, ALIKE_POINTS, LIKELY_FROM};
use crate::cache::Cache;
use crate::conditions::{Conditions, conditions_of_materials};
use crate::false_discovery::{CLAIMED_BELOW, chances_of_difference, q_values};
use crate::laws::facts::facts;

/// Why a run takes part in no answer of which two sources say different things.
const CONTRADICTED: &str = "what is stated of it contradicts itself, and `ieap status` asks which is right";

/// What the study asked, with its answers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Study {
    /// What is compared.
    pub compared: Vec<Factor>,
    /// Whether campaign.toml says so; else it is what the campaign varies.
    pub is_declared: bool,
    /// Answers, by material, what the study asked before its details.
    pub answers: Vec<Answer>,
    /// Fitted runs that take part in no answer about a parameter.
    pub left_out: Vec<String>,
    /// Why, in their order.
    pub left_out_why: Vec<&'static str>,
    /// Those that take part in one, and in none about a whole curve.
    pub left_out_of_curves: Vec<String>,
    /// Values that may be of something else than their condition says, and count for less.
    pub odd: Vec<OddValue>,
}

impl Study {
    /// Asks every question.
    pub fn of(evidence: Evidence) -> Study {
        Study::kept(evidence, &Cache::default())
    }

    /// The same, where answers that were made before from the same are taken from `kept`.
    pub fn kept(evidence: Evidence, kept: &Cache) -> Study {
        let mut own = evidence.campaign.clone();
        if own.study.materials_together {
            let together = |sample: &Sample| Sample {
                material: ALL_MATERIALS.to_owned(),
                ..sample.clone()
            };
            own.samples = own.samples.iter().map(together).collect();
            own.materials.clear();
        }
        let evidence = Evidence {
            campaign: &own,
            ..evidence
        };
        let conditions = conditions_of_materials(evidence.runs, evidence.campaign);
        let facts = facts(evidence.runs, evidence.campaign);
        let declared = &evidence.campaign.study.compare;
        let compared = if declared.is_empty() {
            varied(&conditions)
        } else {
            declared.clone()
        };
        let asked = Asked {
            evidence,
            compared: &compared,
            conditions: &conditions,
            facts: &facts,
        };
        let (mut answers, odd) = asked.answered(kept);
        judge(&mut answers, evidence.campaign.study.alike_percent);
        let rules = &evidence.campaign.study;
        let is_asked = |own: &Answer| own.is_of_study && own.kind == Kind::Environment;
        let asks_curves =
            !evidence.curves.is_empty() && !rules.voltages_together && answers.iter().any(is_asked);
        let [used, in_curves] = [false, true].map(|is_curve| -> BTreeSet<usize> {
            let own = answers.iter().filter(|own| own.is_of_curve() == is_curve);
            own.flat_map(|own| own.of_runs.iter().copied()).collect()
        });
        let fitted: Vec<usize> = (0..evidence.runs.len())
            .filter(|&at| evidence.runs[at].fit.is_some())
            .collect();
        let left = |is_left: &dyn Fn(&usize) -> bool| -> Vec<String> {
            let left = fitted.iter().filter(|at| is_left(at));
            left.map(|&at| evidence.runs[at].path.clone()).collect()
        };
        let unused = fitted.iter().filter(|at| !used.contains(at));
        let why = |&at: &usize| why_left_out(&evidence, &conditions, at);
        Study {
            left_out_why: unused.map(why).collect(),
            left_out: left(&|at| !used.contains(at)),
            left_out_of_curves: left(&|at| asks_curves && used.contains(at) && !in_curves.contains(at)),
            is_declared: !declared.is_empty(),
            compared,
            answers,
            odd,
        }
    }

    /// The same, which says of those of these runs that wait for an answer of a person that they take part in none of its own.
    #[must_use]
    pub fn beside(mut self, set_aside: &[RunRecord]) -> Study {
        let waits =
            |run: &&RunRecord| run.fit.is_some() && matches!(run.standing, RunStanding::Contradicted { .. });
        for run in set_aside.iter().filter(waits) {
            self.left_out.push(run.path.clone());
            self.left_out_why.push(CONTRADICTED);
        }
        self
    }

    /// Answers to what the study asked.
    pub fn asked(&self) -> impl Iterator<Item = &Answer> {
        self.answers.iter().filter(|answer| answer.is_of_study)
    }

    /// Names of the conditions beside those of [`Study::compared`] that it asks of.
    pub fn other_conditions(&self) -> Vec<&'static str> {
        let others = self.asked().filter(|own| own.kind == Kind::OtherLaw);
        distinct(others.filter_map(|own| own.covariate))
    }

    /// Laws over what differs from run to run: of the humidity, of the voltage, of what else does.
    pub fn laws(&self) -> impl Iterator<Item = &Answer> {
        let laws = self.answers.iter().filter(|answer| answer.kind.is_law());
        laws.filter(|answer| answer.p.is_some())
    }

    /// Whether there is no more than one strip of each material.
    pub fn has_one_strip_each(&self) -> bool {
        let of_material = self.asked().filter(|own| !own.kind.is_by_material());
        of_material.map(|own| own.samples).max() == Some(1)
    }

    /// Materials, in the order of the campaign.
    pub fn materials(&self) -> Vec<&str> {
        let mut found: Vec<&str> = Vec::new();
        for answer in &self.answers {
            if !found.contains(&answer.material.as_str()) {
                found.push(&answer.material);
            }
        }
        found
    }
}

/// Why a fitted run takes part in no answer about a parameter.
fn why_left_out(evidence: &Evidence, conditions: &Conditions, at: usize) -> &'static str {
    let run = &evidence.runs[at];
    if run.drive.as_ref().is_some_and(Drive::moves) {
        "the voltage moves"
    } else if conditions.unplaced.contains(&at) {
        "sample, environment or voltage is not stated"
    } else if evidence.doubts.leaves_out(&run.path) {
        "what the model gets wrong has no known cause"
    } else {
        "there is nothing in another condition to hold against"
    }
}

/// What materials are called where campaign.toml puts them together.
const ALL_MATERIALS: &str = "all materials";

/// What a campaign varies.
fn varied(conditions: &Conditions) -> Vec<Factor> {
    let environments = || conditions.surroundings.iter().map(|own| own.environment.as_str());
    let first = environments().next();
    [
        (Factor::Environment, environments().any(|own| Some(own) != first)),
        (
            Factor::Humidity,
            environments().any(|own| conditions.varies_humidity(own)),
        ),
        (Factor::Voltage, conditions.voltages_v.len() > 1),
        (Factor::Material, conditions.materials.len() > 1),
    ]
    .into_iter()
    .filter_map(|(factor, differs)| differs.then_some(factor))
    .collect()
}

/// Fills in the q of every answer and how sure it is, by families (parameters, whole curves, laws of what else differs, details of parameters and
/// of curves; in each of them what is told in the other scope by itself), and what it shows. What is said of parameters is the
/// same whether curves are read or not.
fn judge(answers: &mut [Answer], alike_percent: Option<f64>) {
    let family = |own: &Answer| (own.is_of_study, own.is_of_curve(), own.kind == Kind::OtherLaw);
    for of_family in distinct(answers.iter().map(family)) {
        let mut judged: Vec<&mut Answer> = (answers.iter_mut())
            .filter(|own| family(own) == of_family && own.p.is_some())
            .collect();
        let p: Vec<f64> = judged.iter().filter_map(|own| own.p).collect();
        for ((own, q), chance) in judged.iter_mut().zip(q_values(&p)).zip(chances_of_difference(&p)) {
            own.q = Some(q);
            // What is said to be likely has an interval without "none".
            let is_likely = chance >= LIKELY_FROM && own.p.is_some_and(|p| p <= CLAIMED_BELOW);
            own.certainty = if is_likely {
                Certainty::Likely
            } else {
                Certainty::Open
            };
        }
        for scope in Scope::ALL {
            let mut told: Vec<&mut InScope> =
                (judged.iter_mut()).filter_map(|own| own.beside(scope)).collect();
            let p: Vec<f64> = told.iter().map(|own| own.p).collect();
            for (own, q) in told.iter_mut().zip(q_values(&p)) {
                (own.q, own.is_shown) = (Some(q), q <= CLAIMED_BELOW);
            }
        }
    }
    for own in answers.iter_mut() {
        let least = match own.scale {
            Scale::Points => ALIKE_POINTS,
            Scale::Ratio | Scale::PerUnit | Scale::OfRange => alike_percent.unwrap_or(ALIKE_PERCENT),
        };
        own.verdict = match own.q {
            Some(q) if q <= CLAIMED_BELOW => Verdict::Differs,
            _ if own.no_more_than.is_some_and(|most| most <= least) => Verdict::Alike,
            Some(_) => Verdict::Open,
            None if own.at_least.is_some() || own.at_most.is_some() => Verdict::Bound,
            None if own.value.is_some() => Verdict::Open,
            None => Verdict::NotTold,
        };
        own.certainty = match own.verdict {
            Verdict::Differs | Verdict::Alike => Certainty::Sure,
            Verdict::Open if own.q.is_some() => own.certainty,
            _ => Certainty::Open,
        };
    }
}
