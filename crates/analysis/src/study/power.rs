//! Power before measuring: in how many campaigns of a design the study would see a change of a given size.
//!
//! Campaigns are simulated with what strips, strips in surroundings and runs differ by, and asked by the model that answers the
//! study (`scoped.rs`); the other questions of the study stand beside it with chances of their own, as where they have
//! nothing to find.

use ieap_domain::tag::keys;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::answer::{InScope, Scale};
use super::combinations::Combinations;
use super::combined::InBoth;
use super::evidence::{Evidence, measured_of};
use super::measured::{Measured, Value, distinct};
use super::measures::MEASURES;
pub use super::policy::{ALIKE_PERCENT, MOST_STRIPS};
use super::policy::{
    FEWEST_LEVELS, HUMIDITIES_PERCENT, SCATTER_PERCENT, STATED_ERROR_PERCENT, STRIPS_DIFFER_PERCENT,
};
use super::scoped::Scoped;
use super::slope::{Followed, Over, Slope, set_humidities};
use crate::conditions::conditions_of_materials;
use crate::false_discovery::{CLAIMED_BELOW, q_values};
use crate::laws::Covariate;
use crate::laws::facts::{RunFacts, facts};
use crate::parameters::COMPARED;

/// What differs by chance: standard deviations of logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Of strips.
    pub strips: f64,
    /// Of a strip in one surroundings.
    pub in_surroundings: f64,
    /// From run to run.
    pub runs: f64,
    /// Of a fit.
    pub fits: f64,
    /// Materials whose runs tell it; none where it is assumed.
    pub told_by: usize,
}

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// One environment against another.
    Environment,
    /// The law of the humidity over these, percent.
    Humidity(Vec<f64>),
}

/// A design with the change that is to be seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// What is asked.
    pub question: Question,
    /// Strips.
    pub strips: usize,
    /// Voltages at which each is measured.
    pub voltages: usize,
    /// Runs a strip and condition.
    pub repeats: usize,
    /// Logarithm of the factor between both environments, or from the lowest humidity to the highest.
    pub change: f64,
    /// Questions of the study that chances are judged together with.
    pub questions: usize,
}

/// In how many of the simulated campaigns it is seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Seen {
    /// Of the strips measured.
    pub of_strips: usize,
    /// Of the material.
    pub of_material: usize,
}

impl Chance {
    /// What is assumed where no runs tell.
    pub fn assumed(scatter_percent: Option<f64>) -> Chance {
        Chance {
            strips: STRIPS_DIFFER_PERCENT / 100.0,
            in_surroundings: SCATTER_PERCENT / 100.0,
            runs: scatter_percent.unwrap_or(SCATTER_PERCENT) / 100.0,
            fits: STATED_ERROR_PERCENT / 100.0,
            told_by: 0,
        }
    }
}

/// What the runs of a campaign tell of each parameter of which they do: of materials with repeats on two strips and more in
/// two surroundings and more, the mean of their variances.
pub fn chances(evidence: &Evidence) -> Vec<(&'static str, Chance)> {
    let conditions = conditions_of_materials(evidence.runs, evidence.campaign);
    let facts = facts(evidence.runs, evidence.campaign);
    let all = measured_of(evidence, &conditions, &facts);
    let of_key = |key: &'static str| {
        let own = all.iter().filter(|((_, own), _)| *own == key);
        let told: Vec<[f64; 4]> = own.filter_map(|(_, of)| variances(of.as_ref().ok()?)).collect();
        let mean = |k: usize| (told.iter().map(|own| own[k]).sum::<f64>() / told.len() as f64).sqrt();
        let chance = Chance {
            strips: mean(0),
            in_surroundings: mean(1),
            runs: mean(2),
            fits: mean(3),
            told_by: told.len(),
        };
        (!told.is_empty()).then_some((key, chance))
    };
    COMPARED.into_iter().filter_map(of_key).collect()
}

fn variances(of: &Measured) -> Option<[f64; 4]> {
    let surroundings = of.cells.iter().any(|cell| cell.0 != of.cells[0].0);
    let [strips, in_surroundings, runs] = of.estimated()?.variances[..] else {
        return None;
    };
    let fits = of.values.iter().map(|own| own.variance).sum::<f64>() / of.values.len() as f64;
    surroundings.then_some([strips, in_surroundings, runs, fits])
}

impl Planned {
    /// In how many of so many campaigns the study sees it, at the same rate of false discoveries as any answer.
    pub fn seen(&self, chance: &Chance, (draws, seed): (usize, u64)) -> Seen {
        let each = (0..draws)
            .into_par_iter()
            .map(|draw| self.seen_once(chance, (seed, draw as u64)));
        let sum = |a: Seen, b: Seen| Seen {
            of_strips: a.of_strips + b.of_strips,
            of_material: a.of_material + b.of_material,
        };
        each.reduce(Seen::default, sum)
    }

    fn seen_once(&self, chance: &Chance, (seed, stream): (u64, u64)) -> Seen {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        let values = self.simulated(chance, &mut random);
        let (of_strips, of_material) = self.asked(values);
        let others: Vec<f64> = (1..self.questions).map(|_| random.random()).collect();
        let is_claimed = |p: Option<f64>| {
            let all: Vec<f64> = p.into_iter().chain(others.iter().copied()).collect();
            usize::from(p.is_some() && q_values(&all)[0] <= CLAIMED_BELOW)
        };
        Seen {
            of_strips: is_claimed(of_strips),
            of_material: is_claimed(of_material),
        }
    }

    /// Surroundings, each with the part of the change that is there, and its humidity.
    fn surroundings(&self) -> Vec<(f64, Option<f64>)> {
        match &self.question {
            Question::Environment => vec![(0.0, None), (1.0, None)],
            Question::Humidity(levels) => {
                let low = levels.iter().copied().fold(f64::INFINITY, f64::min);
                let high = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let part = |level: f64| (level - low) / (high - low);
                levels.iter().map(|&level| (part(level), Some(level))).collect()
            }
        }
    }

    fn simulated(&self, chance: &Chance, random: &mut ChaCha8Rng) -> Vec<Value> {
        let mut draw = |size: f64| -> f64 {
            let of: f64 = StandardNormal.sample(random);
            size * of
        };
        let mut values = Vec::new();
        for sample in 0..self.strips {
            let level = draw(chance.strips);
            for (at, (part, humidity_percent)) in self.surroundings().into_iter().enumerate() {
                let there = level + part * self.change + draw(chance.in_surroundings);
                for voltage in 0..self.voltages {
                    for _ in 0..self.repeats {
                        values.push(Value {
                            place: values.len(),
                            sample,
                            cell: (at, voltage),
                            humidity_percent,
                            y: there + draw(chance.runs) + draw(chance.fits),
                            variance: chance.fits * chance.fits,
                            weight: 1.0,
                            off: None,
                        });
                    }
                }
            }
        }
        values
    }

    /// Chances of what the study finds: of the strips, and of their material. Of one strip there is no material.
    fn asked(&self, values: Vec<Value>) -> (Option<f64>, Option<f64>) {
        let chances = |of: &Scoped| {
            let both = InBoth::of(&[(of, 1.0)]);
            let p = |of: Option<Vec<_>>| Some(InScope::of(&of?, Scale::PerUnit, None)?.p);
            (p(both.strips), p(both.material))
        };
        let (strips, material) = match &self.question {
            Question::Environment => {
                let of = Combinations::new(Measured::new(values, Default::default(), &[], None));
                let part = 1.0 / self.voltages as f64;
                let factor = |cell: &(usize, usize)| if cell.0 == 1 { part } else { -part };
                chances(&of.scoped(&of.cells.iter().map(factor).collect::<Vec<f64>>()))
            }
            Question::Humidity(_) => {
                let followed = Followed {
                    of: Covariate::RelativeHumidity,
                    numbers: values.iter().filter_map(|own| own.humidity_percent).collect(),
                };
                let facts = vec![RunFacts::default(); values.len()];
                let over = Over::new(&values, &followed, &facts, |own| own.cell.1);
                let slope = over.and_then(|over| Slope::of(&over));
                slope.map_or((None, None), |slope| chances(&slope.scoped))
            }
        };
        if self.strips == 1 {
            (strips.or(material), None)
        } else {
            (strips, material)
        }
    }
}

/// A study as the campaign is made up: what a planned one is taken to be where nothing else is stated.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Voltages.
    pub voltages: usize,
    /// Runs a strip and condition: the median.
    pub repeats: usize,
    /// Humidities, percent: those that were measured from three levels on, else five from 20 to 80.
    pub humidities_percent: Vec<f64>,
    /// Whether they were measured.
    pub humidities_are_measured: bool,
    /// Questions of the study: of every material, each parameter once.
    pub questions: usize,
}

impl Design {
    /// That of a campaign.
    pub fn of(evidence: &Evidence) -> Design {
        let conditions = conditions_of_materials(evidence.runs, evidence.campaign);
        let mut repeats: Vec<usize> = Vec::new();
        for condition in &conditions.measured {
            let sample = |&at: &usize| evidence.runs[at].tag(keys::SAMPLE);
            let strips = distinct(condition.runs.iter().map(sample)).len();
            repeats.push(condition.runs.len().div_ceil(strips.max(1)));
        }
        repeats.sort_unstable();
        let middle = |own: &crate::conditions::HumidityLevel| 0.5 * (own.low_percent + own.high_percent);
        let all = conditions
            .surroundings
            .iter()
            .filter_map(|own| own.humidity.as_ref());
        let measured = set_humidities(all.map(middle));
        let are_measured = measured.len() >= FEWEST_LEVELS;
        Design {
            voltages: conditions.voltages_v.len().max(1),
            repeats: repeats.get(repeats.len() / 2).copied().unwrap_or(1),
            humidities_percent: if are_measured {
                measured
            } else {
                HUMIDITIES_PERCENT.to_vec()
            },
            humidities_are_measured: are_measured,
            questions: MEASURES.len() * conditions.materials.len().max(1),
        }
    }
}
