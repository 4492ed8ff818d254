//! One cause in several samples of a material: which of its numbers are one for all, and how far the samples differ in
//! the others.

use std::collections::BTreeMap;

use super::laws::words::{round, short};
use super::pooling::{Averaging, Pooled, Repeat, pooled};
use crate::policy::DIFFERS_BELOW;
use ieap_domain::diagnosis::{LAW, follows_a_tag};
use ieap_domain::number::percent;
use ieap_domain::number::probabilities::equation;
use ieap_domain::quantiles::CHI_SQUARE_99_OF_ONE;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, EffectFinding, FromOthers, GroupDiagnosis, RunRecord};
use ieap_numerics::chance::chi_square_chance;

/// What a strength of its own must lower the sum of squares by to count: chance gives more in 1 of 100.
const OWN_STRENGTH: f64 = CHI_SQUARE_99_OF_ONE;

/// Key of the parameter that tells in which run of the group an effect acts.
const RUN: &str = "run";

/// An effect that was accepted in groups of at least two samples of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedEffect {
    /// Material.
    pub material: String,
    /// Id of the effect.
    pub effect: String,
    /// Form that it takes, where it has several.
    pub variant: Option<String>,
    /// Groups in which it was accepted, with their sample.
    pub groups: Vec<(String, String)>,
    /// Its parameters, the strength first.
    pub parameters: Vec<SharedParameter>,
}

/// A parameter of it.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedParameter {
    /// Key with the unit.
    pub key: String,
    /// Mean over the samples, whose differences are taken as random; none where no sample determines it.
    pub mean: Option<Pooled>,
    /// Whether logarithms were averaged: spreads are then relative.
    pub is_log: bool,
    /// Probability of differences as large by the errors of the fits alone; none for fewer than two numbers.
    pub p_equal: Option<f64>,
}

impl SharedParameter {
    /// Whether one value stands for all samples.
    pub fn is_one(&self) -> bool {
        self.p_equal.is_some_and(|p| p >= DIFFERS_BELOW)
    }
}

/// A group in which an effect was accepted.
struct Carrier<'a> {
    group: &'a str,
    sample: &'a str,
    finding: &'a EffectFinding,
}

/// Effects that several samples of a material share, by material and id. The first effect that a group accepted counts;
/// accidents of single runs do not, nor what follows a tag: its strength is that over the tag's span in one group, and
/// across samples tags are covariates of [`crate::laws`].
pub fn shared_effects(
    found: &[GroupDiagnosis],
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Vec<SharedEffect> {
    by_effect(found, runs, campaign)
        .into_iter()
        .filter(|(_, carriers)| samples(carriers).len() > 1)
        .map(|((material, effect, variant), carriers)| SharedEffect {
            material: material.to_owned(),
            effect: effect.to_owned(),
            variant: variant.map(str::to_owned),
            groups: carriers
                .iter()
                .map(|carrier| (carrier.group.to_owned(), carrier.sample.to_owned()))
                .collect(),
            parameters: parameters(&carriers),
        })
        .collect()
}

/// What samples say of an effect without one of them.
#[derive(Debug, Clone, PartialEq)]
pub struct OfOthers {
    /// Keys and values of the effect's parameters.
    pub values: Vec<(String, f64)>,
    /// The samples that they are from.
    pub samples: Vec<String>,
}

/// The values of the effect's parameters by the samples other than `sample`, with those samples; none where they do not
/// determine them all.
pub fn values_without(
    effect: &SharedEffect,
    sample: &str,
    found: &[GroupDiagnosis],
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Option<OfOthers> {
    let key = (
        effect.material.as_str(),
        effect.effect.as_str(),
        effect.variant.as_deref(),
    );
    let mut all = by_effect(found, runs, campaign);
    let mut others = all.remove(&key)?;
    others.retain(|carrier| carrier.sample != sample);
    if others.is_empty() {
        return None;
    }
    let values = parameters(&others)
        .into_iter()
        .map(|parameter| {
            let mean = parameter.mean?.value;
            mean.is_finite().then_some((parameter.key, mean))
        })
        .collect::<Option<Vec<_>>>()?;
    let samples = samples(&others).into_iter().map(str::to_owned).collect();
    Some(OfOthers { values, samples })
}

/// How well the other samples predict each: sample, group, fall of the sum of squares with its standard error.
pub fn left_out<'a>(
    effect: &'a SharedEffect,
    found: &'a [GroupDiagnosis],
) -> impl Iterator<Item = (&'a str, &'a str, &'a FromOthers)> {
    effect.groups.iter().filter_map(move |(group, sample)| {
        let own = found.iter().find(|one| one.group == *group)?;
        let is_it = |held: &&FromOthers| held.effect == effect.effect && held.variant == effect.variant;
        let held = own.from_others.iter().find(is_it)?;
        Some((sample.as_str(), group.as_str(), held))
    })
}

/// The finding in a few sentences.
pub fn sentence(effect: &SharedEffect, found: &[GroupDiagnosis]) -> String {
    let mut samples: Vec<&str> = effect.groups.iter().map(|(_, sample)| sample.as_str()).collect();
    samples.sort_unstable();
    samples.dedup();
    let mut text = format!(
        "{} was accepted in {} samples of {}.",
        effect.effect,
        samples.len(),
        effect.material
    );
    for parameter in &effect.parameters {
        let Some(mean) = parameter.mean else { continue };
        let spread = mean.between_samples.unwrap_or(0.0);
        let value = format!(
            "{} {} [{}, {}]",
            parameter.key,
            round(mean.value, mean.standard_error),
            round(mean.low_95, mean.standard_error),
            round(mean.high_95, mean.standard_error)
        );
        text += &match parameter.p_equal {
            Some(p) if p >= DIFFERS_BELOW => {
                format!(" One {value} stands for all of them ({}).", equation("p", p))
            }
            Some(_) if parameter.is_log => format!(
                " Samples have a {value} of their own, with a standard deviation of {} between them.",
                percent(spread / mean.value, 0)
            ),
            Some(_) => format!(
                " Samples have a {value} of their own, with a standard deviation of {} between them.",
                short(spread)
            ),
            None => format!(" Its {value} has no error to be compared by."),
        };
    }
    let held: Vec<&FromOthers> = left_out(effect, found)
        .map(|(_, _, held)| held)
        .filter(|held| held.fall.is_finite())
        .collect();
    if !held.is_empty() {
        let better = held
            .iter()
            .filter(|held| held.fall > 2.0 * held.standard_error)
            .count();
        let of_own = held
            .iter()
            .filter(|held| held.fall_own_strength > OWN_STRENGTH)
            .count();
        let all = held.len();
        if effect.parameters.len() > 1 {
            text += &format!(
                " With its shape from the other samples and a strength of their own it describes {of_own} of {all} left-out groups better than the base model does."
            );
        }
        text += &format!(" With the mean strength of the others it describes {better} of {all} better.");
    }
    text
}

type Key<'a> = (&'a str, &'a str, Option<&'a str>);

fn by_effect<'a>(
    found: &'a [GroupDiagnosis],
    runs: &'a [RunRecord],
    campaign: &'a Campaign,
) -> BTreeMap<Key<'a>, Vec<Carrier<'a>>> {
    let sample_of: BTreeMap<&str, &str> = runs
        .iter()
        .filter_map(|run| Some((run.path.as_str(), run.tag(keys::SAMPLE)?)))
        .collect();
    let mut carriers: BTreeMap<Key, Vec<Carrier>> = BTreeMap::new();
    for one in found {
        let sample = one.runs.first().and_then(|run| sample_of.get(run.as_str()));
        let (Some(&sample), Some(finding)) = (sample, one.effects.first()) else {
            continue;
        };
        // The weights of a law without an equation are of one group's own variable.
        let is_law = finding.effect.starts_with(LAW);
        if is_of_one_run(finding) || follows_a_tag(&finding.effect) || is_law {
            continue;
        }
        let material = campaign
            .sample(sample)
            .map_or(sample, |sample| sample.material.as_str());
        carriers
            .entry((material, finding.effect.as_str(), finding.variant.as_deref()))
            .or_default()
            .push(Carrier {
                group: &one.group,
                sample,
                finding,
            });
    }
    carriers
}

/// Whether it happened to one run of its group, as a foil cracks: samples do not share that.
fn is_of_one_run(finding: &EffectFinding) -> bool {
    finding.parameters.iter().any(|parameter| parameter.key == RUN)
}

fn samples<'a>(carriers: &[Carrier<'a>]) -> Vec<&'a str> {
    let mut samples: Vec<&str> = carriers.iter().map(|carrier| carrier.sample).collect();
    samples.sort_unstable();
    samples.dedup();
    samples
}

fn parameters(carriers: &[Carrier]) -> Vec<SharedParameter> {
    let samples = samples(carriers);
    let keys = carriers[0]
        .finding
        .parameters
        .iter()
        .map(|parameter| &parameter.key);
    keys.map(|key| {
        let repeat = |carrier: &Carrier| {
            let own = carrier
                .finding
                .parameters
                .iter()
                .find(|parameter| parameter.key == *key)?;
            Some(Repeat {
                sample: samples.iter().position(|sample| *sample == carrier.sample)?,
                value: own.estimate.value?,
                // A law without free strength has none.
                standard_error: own.estimate.standard_error.unwrap_or(0.0),
            })
        };
        let repeats: Vec<Repeat> = carriers.iter().filter_map(repeat).collect();
        let is_log = !repeats.is_empty() && repeats.iter().all(|repeat| repeat.value > 0.0);
        let averaging = if is_log {
            Averaging::Logarithmic
        } else {
            Averaging::Linear
        };
        SharedParameter {
            key: key.clone(),
            mean: pooled(&repeats, averaging),
            is_log,
            p_equal: p_equal(&repeats, is_log),
        }
    })
    .collect()
}

/// Cochran's test that all numbers are one, by the errors of the fits.
fn p_equal(repeats: &[Repeat], is_log: bool) -> Option<f64> {
    if repeats.len() < 2 || repeats.iter().any(|repeat| repeat.standard_error <= 0.0) {
        return None;
    }
    let on_scale = |repeat: &Repeat| {
        if is_log {
            (repeat.value.ln(), repeat.standard_error / repeat.value)
        } else {
            (repeat.value, repeat.standard_error)
        }
    };
    let weighted: Vec<(f64, f64)> = repeats
        .iter()
        .map(on_scale)
        .map(|(value, error)| (value, error.powi(-2)))
        .collect();
    let whole: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let mean = weighted.iter().map(|(value, weight)| value * weight).sum::<f64>() / whole;
    let square: f64 = weighted
        .iter()
        .map(|(value, weight)| weight * (value - mean).powi(2))
        .sum();
    Some(chi_square_chance(square, repeats.len() - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Verdict;
    use ieap_domain::testing::{campaign, effect, finding, known, parameter, run, sample};

    fn carrier(sample: &str, strength: f64, onset_v: f64) -> GroupDiagnosis {
        let parameters = vec![
            parameter("exchange_current_a_per_cm2", known(strength, 0.02)),
            parameter("onset_v", known(onset_v, 0.01)),
        ];
        GroupDiagnosis {
            group: format!("sample={sample},environment=air"),
            runs: vec![format!("runs/{sample}.csv")],
            verdict: Verdict::Law,
            effects: vec![effect("faradaic-leak", parameters)],
            ..finding()
        }
    }

    fn three() -> (Vec<GroupDiagnosis>, Vec<RunRecord>, Campaign) {
        let found = vec![
            carrier("A", 1.0e-4, 1.500),
            carrier("B", 2.0e-4, 1.505),
            carrier("C", 4.0e-4, 1.495),
        ];
        let runs = ["A", "B", "C"].map(|id| run(id, id, "air", None, 2.0)).to_vec();
        let mut campaign = campaign();
        campaign.samples = ["A", "B", "C"].map(|id| sample(id, "CNaf")).into_iter().collect();
        (found, runs, campaign)
    }

    #[test]
    fn a_contact_that_broke_in_two_samples_is_no_cause_that_they_share() {
        let (mut found, runs, campaign) = three();
        for one in &mut found {
            one.effects[0].effect = "contact-break".to_owned();
            one.effects[0].parameters.push(parameter("run", known(1.0, 0.0)));
        }
        assert_eq!(shared_effects(&found, &runs, &campaign), []);
    }

    #[test]
    fn one_onset_and_strengths_of_their_own() {
        let (found, runs, campaign) = three();
        let shared = shared_effects(&found, &runs, &campaign);
        assert_eq!(shared.len(), 1);
        let [strength, onset] = &shared[0].parameters[..] else {
            panic!("{shared:?}")
        };
        assert!(!strength.is_one() && onset.is_one(), "{shared:#?}");
        let mean = strength.mean.unwrap();
        assert!((mean.value / 2.0e-4 - 1.0).abs() < 1e-3, "{mean:?}");
        // Logarithms differ by ln 2 from one to the next.
        let spread = mean.between_samples.unwrap() / mean.value;
        assert!((spread - 0.69).abs() < 0.02, "{spread}");
    }

    #[test]
    fn a_sample_is_left_out_of_what_is_said_of_it() {
        let (found, runs, campaign) = three();
        let shared = shared_effects(&found, &runs, &campaign);
        let others = values_without(&shared[0], "C", &found, &runs, &campaign).unwrap();
        assert_eq!(others.samples, ["A", "B"]);
        let values = others.values;
        assert!(
            (values[0].1 / 2.0_f64.sqrt() / 1e-4 - 1.0).abs() < 1e-2,
            "{values:?}"
        );
        assert_eq!(values[1].0, "onset_v");
    }

    #[test]
    fn one_sample_shares_nothing() {
        let (mut found, runs, campaign) = three();
        found.truncate(1);
        assert!(shared_effects(&found, &runs, &campaign).is_empty());
    }
}
