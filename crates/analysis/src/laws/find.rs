//! Asks every question of a campaign, and judges the answers together.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::covariate::Covariate;
use super::dependence::{Asking, Dependence};
use super::design::{Level, Rows};
use super::doubt::{Doubted, Doubts, Findings};
use super::facts::{RunFacts, facts};
use super::offset::{LengthDoubt, length_doubts};
use super::parts::{Lacking, Part, parts};
use super::selection::{Attempt, Selection, selections};
use super::table::Table;
use super::values::{Values, keys, values};
use crate::cache::{Cache, Hash};
use crate::false_discovery::{CLAIMED_BELOW, q_values, q_values_dependent};
use ieap_domain::{Campaign, Quantity, RunRecord};

/// What laws are sought in.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// Current runs with their fits.
    pub runs: &'a [RunRecord],
    /// The campaign.
    pub campaign: &'a Campaign,
    /// Charge that passed in each run, C, where it is known.
    pub charge_c: &'a [Option<f64>],
    /// Every run that was tried, failed ones too.
    pub attempts: &'a [Attempt],
    /// What the diagnoses say against fits.
    pub findings: Findings<'a>,
    /// What the study says of laws of the humidity.
    pub of_humidity: &'a OfHumidity,
    /// Seed of the draws.
    pub seed: u64,
    /// What was found of materials before.
    pub kept: &'a Cache,
}

/// Covariates that the design of a material ties together.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TiedSet {
    /// Material.
    pub material: String,
    /// Whether runs or samples are compared.
    pub level: Level,
    /// The covariates, two at least.
    pub covariates: Vec<Covariate>,
}

/// What a campaign says across its runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CampaignLaws {
    /// Facts of the runs.
    pub facts: Vec<RunFacts>,
    /// Covariates that cannot be told apart, by material.
    pub tied: Vec<TiedSet>,
    /// Covariates that some runs do not state.
    pub lacking: Vec<Lacking>,
    /// Covariates that differ, by material, those within samples first.
    pub asked: BTreeMap<String, Vec<Covariate>>,
    /// Every question of a parameter and a covariate with its answer.
    pub dependences: Vec<Dependence>,
    /// Lengths that were doubted.
    pub lengths: Vec<LengthDoubt>,
    /// Failed runs over the conditions.
    pub selections: Vec<Selection>,
    /// Groups whose fits are in doubt, and what was done with them.
    pub doubted: Vec<Doubted>,
    /// What is done with each of their runs.
    pub doubts: Doubts,
    /// Number of questions that share the q-values.
    pub questions: usize,
}

impl CampaignLaws {
    /// What may be claimed.
    pub fn claimed(&self) -> impl Iterator<Item = &Dependence> {
        self.dependences.iter().filter(|found| found.is_claimed())
    }
}

/// Seeks the laws of a campaign. The outcome does not depend on the number of threads.
pub fn find(evidence: &Evidence) -> CampaignLaws {
    let facts = facts(evidence.runs, evidence.campaign, evidence.charge_c);
    let doubts = Doubts::new(evidence.findings, evidence.runs);
    let mut by_material: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (place, fact) in facts.iter().enumerate() {
        let run = &evidence.runs[fact.run];
        if run.fit.as_ref().is_some_and(|fit| fit.converged) && !doubts.leaves_out(&run.path) {
            by_material.entry(fact.material.clone()).or_default().push(place);
        }
    }
    let mut laws = CampaignLaws {
        doubted: doubts.told(evidence.findings),
        ..CampaignLaws::default()
    };
    for (material, places) in &by_material {
        let hash = hash_of(evidence, &doubts, (&facts, places), material);
        let make = || of_material(evidence, &doubts, (&facts, places), material);
        laws.add(evidence.kept.or_make(&hash, make), material, |place| {
            facts[places[place]].run
        });
    }
    laws.selections = selections(evidence.attempts, evidence.seed);
    laws.facts = facts;
    laws.doubts = doubts;
    judge(&mut laws, shares_fits(evidence.runs), evidence.of_humidity);
    laws
}

/// p and q of laws of the humidity by material and parameter, as the study says them: whether there is one is asked there and
/// nowhere else, for its model holds what strips and surroundings differ by. Here stays which form it has.
pub type OfHumidity = BTreeMap<(String, String), (f64, f64)>;

/// What is found of one material alone.
#[derive(Default, Serialize, Deserialize)]
struct OfMaterial {
    tied: Vec<TiedSet>,
    /// Runs are counted among those of the material, here and in answers: which number they have among all is nothing that
    /// this is made from.
    lacking: Vec<Lacking>,
    asked: Vec<Covariate>,
    dependences: Vec<Dependence>,
    lengths: Vec<LengthDoubt>,
}

impl CampaignLaws {
    fn add(&mut self, found: OfMaterial, material: &str, run_at: impl Fn(usize) -> usize) {
        self.tied.extend(found.tied);
        self.lacking
            .extend(found.lacking.into_iter().map(|lacking| Lacking {
                without: lacking.without.iter().map(|&place| run_at(place)).collect(),
                ..lacking
            }));
        self.asked.insert(material.to_owned(), found.asked);
        self.dependences
            .extend(found.dependences.into_iter().map(|answer| Dependence {
                used: answer.used.iter().map(|&place| run_at(place)).collect(),
                ..answer
            }));
        self.lengths.extend(found.lengths);
    }
}

/// A hash over all that [`of_material`] is made from.
fn hash_of(
    evidence: &Evidence,
    doubts: &Doubts,
    (facts, places): (&[RunFacts], &[usize]),
    material: &str,
) -> String {
    let hash = Hash::default()
        .with(&"laws/2")
        .with(&material)
        .with(&evidence.seed);
    let runs = places.iter().map(|&place| &evidence.runs[facts[place].run]);
    let is_length = from_displacement(&runs.collect::<Vec<_>>());
    let of_run = |hash: Hash, &place: &usize| {
        let (fact, run) = (&facts[place], &evidence.runs[facts[place].run]);
        hash.with(&(&fact.sample, &fact.numbers, &fact.names))
            .with(&run.fit)
            .with(&doubts.of(&run.path))
    };
    places.iter().fold(hash.with(&is_length), of_run).text()
}

/// Asks every question of a material, of whose runs the facts are those at `places`.
fn of_material(
    evidence: &Evidence,
    doubts: &Doubts,
    (facts, places): (&[RunFacts], &[usize]),
    material: &str,
) -> OfMaterial {
    let parts = parts(facts, places);
    let mut found = OfMaterial::default();
    for part in &parts {
        let several = part.sets.iter().filter(|(_, set)| set.len() > 1);
        found.tied.extend(several.map(|(level, set)| TiedSet {
            material: material.to_owned(),
            level: *level,
            covariates: set.clone(),
        }));
        found.lacking.extend(part.lacking(facts, places, material));
        found.asked.extend(part.differing());
        found
            .dependences
            .extend(answers(evidence, doubts, facts, part, material));
    }
    for answer in &mut found.dependences {
        let among = |place: &usize| places.iter().position(|own| own == place);
        answer.used = answer.used.iter().filter_map(among).collect();
    }
    let whole = &parts[0];
    let all = values_of(evidence, doubts, facts, whole);
    let tables: Vec<(&Values, Table)> = all
        .iter()
        .map(|values| (values, Table::new(values, &whole.between, &whole.within)))
        .collect();
    let runs: Vec<&RunRecord> = places
        .iter()
        .map(|&place| &evidence.runs[facts[place].run])
        .collect();
    found.lengths = length_doubts(facts, material, &tables, from_displacement(&runs));
    found
}

/// Values of every parameter that the fits of a part hold.
fn values_of(evidence: &Evidence, doubts: &Doubts, facts: &[RunFacts], part: &Part) -> Vec<Values> {
    keys(evidence.runs, facts, &part.places)
        .iter()
        .map(|key| values(evidence.runs, facts, &part.places, key).in_doubt(doubts, evidence.runs, facts))
        .collect()
}

/// Every question of a part with its answer.
fn answers(
    evidence: &Evidence,
    doubts: &Doubts,
    facts: &[RunFacts],
    part: &Part,
    material: &str,
) -> Vec<Dependence> {
    let all = values_of(evidence, doubts, facts, part);
    let questions: Vec<(&Values, &Rows, Option<&[Covariate]>)> = all
        .iter()
        .flat_map(|values| {
            let sets = (part.sets.iter()).map(|(level, set)| (part.rows(*level), Some(set.as_slice())));
            let samples = part.is_whole.then_some((&part.between, None));
            sets.chain(samples).map(move |(rows, set)| (values, rows, set))
        })
        .collect();
    let asker = Asker {
        seed: evidence.seed,
        facts,
        material,
        within: &part.within,
    };
    let answers: Vec<Option<Dependence>> = questions
        .par_iter()
        .map(|&(values, rows, set)| match set {
            Some(set) => asker.asking(values, rows, Some(set)).about(set),
            None => asker.asking(values, rows, None).about_samples(),
        })
        .collect();
    let describe = |mut found: Dependence| {
        let values = all.iter().find(|values| values.key == found.parameter);
        if let Some(values) = values.filter(|_| is_described(&found)) {
            asker
                .asking(values, part.rows(found.level), None)
                .describe(&mut found);
        }
        found
    };
    answers.into_par_iter().flatten().map(describe).collect()
}

/// What all questions about a material share.
struct Asker<'a> {
    seed: u64,
    facts: &'a [RunFacts],
    material: &'a str,
    within: &'a Rows,
}

impl<'a> Asker<'a> {
    fn asking(&self, values: &'a Values, rows: &'a Rows, set: Option<&[Covariate]>) -> Asking<'a> {
        let words: Vec<String> = set
            .unwrap_or_default()
            .iter()
            .map(|one| one.seed_word())
            .collect();
        let names = format!("[{}]", words.join(", "));
        Asking {
            facts: self.facts,
            material: self.material,
            values,
            rows,
            within: self.within,
            seed: seed(self.seed, &[self.material, &values.key, &names]),
        }
    }
}

/// Whether laws are sought: always for the humidity, which has a study of its own, else where chance is a poor
/// explanation. What is not claimed in the end needs no law.
fn is_described(found: &Dependence) -> bool {
    match found.covariate {
        Covariate::Sample => false,
        Covariate::RelativeHumidity | Covariate::Temperature => true,
        _ => found.p <= CLAIMED_BELOW,
    }
}

/// Whether every run's curvature was made from a displacement, by the length.
fn from_displacement(runs: &[&RunRecord]) -> bool {
    let has = |run: &RunRecord, quantity| run.channels.iter().any(|channel| channel.quantity == quantity);
    runs.iter()
        .all(|run| has(run, Quantity::TipDisplacement) && !has(run, Quantity::Curvature))
}

fn seed(of_campaign: u64, names: &[&str]) -> u64 {
    let mut hasher = blake3::Hasher::new();
    for name in names {
        hasher.update(name.as_bytes());
        hasher.update(&[0]);
    }
    let hash = hasher.finalize();
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&hash.as_bytes()[..8]);
    of_campaign ^ u64::from_le_bytes(bytes)
}

/// Whether any runs were fitted together with one parameter set.
fn shares_fits(runs: &[RunRecord]) -> bool {
    runs.iter()
        .filter_map(|run| run.fit.as_ref())
        .any(|fit| fit.is_of_group())
}

/// Fills in the q of every answer. Laws over covariates, differences of samples, their lengths, and failures are
/// families of their own: samples do differ, and where many such findings are right, wrong ones would pass with them
/// among the others. Where runs share parameter sets (`is_shared`) nothing is known of how the answers depend on each
/// other, and the rule of Benjamini and Yekutieli is used. Laws of the humidity have what the study says of them.
fn judge(laws: &mut CampaignLaws, is_shared: bool, of_humidity: &OfHumidity) {
    let answered = |found: &Dependence| {
        let own = (found.material.clone(), found.parameter.clone());
        of_humidity
            .get(&own)
            .filter(|_| found.covariate == Covariate::RelativeHumidity)
    };
    for found in &mut laws.dependences {
        if let Some(&(p, q)) = answered(found) {
            (found.p, found.q) = (p, q);
        }
    }
    let asked = laws
        .dependences
        .iter_mut()
        .filter(|found| answered(found).is_none());
    let (of_samples, of_laws): (Vec<&mut Dependence>, Vec<&mut Dependence>) =
        asked.partition(|found| found.covariate == Covariate::Sample);
    let mut of_laws: Vec<(f64, &mut f64)> = of_laws.into_iter().map(|one| (one.p, &mut one.q)).collect();
    let mut of_samples: Vec<(f64, &mut f64)> =
        of_samples.into_iter().map(|one| (one.p, &mut one.q)).collect();
    let mut of_lengths: Vec<(f64, &mut f64)> =
        laws.lengths.iter_mut().map(|one| (one.p, &mut one.q)).collect();
    let mut of_failures: Vec<(f64, &mut f64)> = laws
        .selections
        .iter_mut()
        .map(|one| (one.p, &mut one.q))
        .collect();
    let mut questions = 0;
    for family in [&mut of_laws, &mut of_samples, &mut of_lengths, &mut of_failures] {
        questions += family.len();
        let p: Vec<f64> = family.iter().map(|(p, _)| *p).collect();
        let q = if is_shared {
            q_values_dependent(&p)
        } else {
            q_values(&p)
        };
        for ((_, target), q) in family.iter_mut().zip(q) {
            **target = q;
        }
    }
    laws.questions = questions;
    for found in &mut laws.dependences {
        found.keep_rivals();
    }
}
