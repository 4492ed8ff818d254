//! Environments and voltages compared parameter by parameter: by what factor one differs from another, in how many
//! samples, and what that does not say.

use ieap_domain::number::rounded_bound;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::words::counted;
use std::collections::{BTreeMap, BTreeSet};

use super::covariate::Covariate;
use super::doubt::Doubts;
use super::facts::RunFacts;
use super::fitted::Interval;
use super::policy::ABOUT_THE_SAME;
use super::words::{round, short, symbol};
use crate::one_fit::SharedEstimate;
use crate::parameters::{COMPARED, usable};
use ieap_domain::{Campaign, Estimate, RunRecord};
use ieap_numerics::student::quantile_95;

/// One condition over another: logarithm of the ratio of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// Where: `2.50` V, or an environment.
    pub place: String,
    /// Logarithm of the ratio; none where a bound stands for one of the values.
    pub log: Option<Interval>,
    /// Least magnitude of the ratio's logarithm where a bound stands for one of them, with its sign.
    pub at_least: Option<f64>,
    /// Samples measured in both.
    pub samples: usize,
    /// Indices of the runs that it is made from.
    pub runs: Vec<usize>,
}

/// What a contrast goes over.
#[derive(Debug, Clone, PartialEq)]
pub enum Over {
    /// One environment over the reference, at each voltage.
    Environment {
        /// Environment.
        environment: String,
        /// The one that it is compared with.
        reference: String,
    },
    /// The highest over the lowest voltage, in each environment.
    Voltage {
        /// Highest voltage, V.
        high: String,
        /// Lowest voltage, V.
        low: String,
    },
}

/// A parameter of a material compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Contrast {
    /// Material.
    pub material: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// What is compared.
    pub over: Over,
    /// In every place where both were measured.
    pub ratios: Vec<Ratio>,
}

/// What is known of a parameter in one condition of one sample.
#[derive(Debug, Clone)]
struct Level {
    sum: f64,
    variance: f64,
    count: f64,
    /// Upper and lower bound of the logarithm, where a run gives no value.
    below: Option<f64>,
    above: Option<f64>,
    /// Identity of a value that it may share with other conditions.
    shared: Option<SharedEstimate>,
    /// Indices of its runs.
    runs: Vec<usize>,
}

type Levels = BTreeMap<(String, String, String), Level>;

/// Compares environments at each voltage, and the ends of the voltages in each environment, for the parameters that
/// figure 26 of the thesis compares. The environment that stands first in the campaign is the reference.
///
/// Fits that a finding doubts enter with `doubts`' errors, or not at all.
pub fn contrasts(
    runs: &[RunRecord],
    campaign: &Campaign,
    facts: &[RunFacts],
    doubts: &Doubts,
) -> Vec<Contrast> {
    let mut materials: Vec<&str> = facts.iter().map(|fact| fact.material.as_str()).collect();
    materials.sort_unstable();
    materials.dedup();
    let mut found = Vec::new();
    for material in materials {
        for key in COMPARED {
            let levels = levels(runs, facts, doubts, (material, key));
            found.extend(of_environments(campaign, &levels, material, key));
            found.extend(of_voltages(campaign, &levels, material, key));
        }
    }
    found
}

fn levels(runs: &[RunRecord], facts: &[RunFacts], doubts: &Doubts, (material, key): (&str, &str)) -> Levels {
    let mut levels = Levels::new();
    let mut shared = BTreeSet::new();
    for fact in facts.iter().filter(|fact| fact.material == material) {
        let name = |covariate| fact.names.get(&covariate).cloned();
        let (Some(environment), Some(volts)) = (name(Covariate::Environment), name(Covariate::Voltage))
        else {
            continue;
        };
        let run = &runs[fact.run];
        let Some(estimate) = usable(run, key) else {
            continue;
        };
        let Some(widened) = doubts.widened(&run.path, key, estimate) else {
            continue;
        };
        let condition = (environment, volts, fact.sample.clone());
        // Repeats that share one parameter set are one measurement of this condition.
        let own = SharedEstimate::of(run, estimate);
        if own.is_some() && !shared.insert((condition.clone(), own.clone())) {
            continue;
        }
        let level = levels.entry(condition).or_insert(Level {
            sum: 0.0,
            variance: 0.0,
            count: 0.0,
            below: None,
            above: None,
            shared: own,
            runs: Vec::new(),
        });
        level.runs.push(fact.run);
        level.add(&widened);
    }
    levels
}

impl Level {
    fn add(&mut self, estimate: &Estimate) {
        let positive = |x: Option<f64>| x.filter(|x| *x > 0.0).map(f64::ln);
        match (positive(estimate.value), estimate.standard_error) {
            (Some(y), Some(error)) => {
                let ends = positive(estimate.low_95).zip(positive(estimate.high_95));
                let error = ends.map_or(error / y.exp(), |(low, high)| (high - low) / (2.0 * NORMAL_95));
                self.sum += y;
                self.variance += error * error;
                self.count += 1.0;
            }
            _ => {
                self.below = positive(estimate.high_95).or(self.below);
                self.above = positive(estimate.low_95).or(self.above);
            }
        }
    }

    /// Mean of the logarithm and its variance by the fits.
    fn mean(&self) -> Option<(f64, f64)> {
        (self.count > 0.0).then(|| (self.sum / self.count, self.variance / self.count.powi(2)))
    }
}

fn of_environments(campaign: &Campaign, levels: &Levels, material: &str, key: &str) -> Vec<Contrast> {
    let environments = in_campaign_order(
        campaign,
        levels.keys().map(|(environment, ..)| environment.as_str()),
    );
    let Some((reference, others)) = environments.split_first() else {
        return Vec::new();
    };
    let voltages = distinct(levels.keys().map(|(_, volts, _)| volts.as_str()));
    let contrast = |environment: &String| Contrast {
        material: material.to_owned(),
        parameter: key.to_owned(),
        over: Over::Environment {
            environment: environment.clone(),
            reference: reference.clone(),
        },
        ratios: voltages
            .iter()
            .filter_map(|volts| ratio(levels, (environment, volts), (reference, volts), volts))
            .collect(),
    };
    others
        .iter()
        .map(contrast)
        .filter(|contrast| !contrast.ratios.is_empty())
        .collect()
}

fn of_voltages(campaign: &Campaign, levels: &Levels, material: &str, key: &str) -> Option<Contrast> {
    let environments = in_campaign_order(
        campaign,
        levels.keys().map(|(environment, ..)| environment.as_str()),
    );
    let voltages = distinct(levels.keys().map(|(_, volts, _)| volts.as_str()));
    let (low, high) = (voltages.first()?, voltages.last()?);
    if voltages.len() < 2 {
        return None;
    }
    let ratios: Vec<Ratio> = environments
        .iter()
        .filter_map(|environment| ratio(levels, (environment, high), (environment, low), environment))
        .collect();
    (!ratios.is_empty()).then(|| Contrast {
        material: material.to_owned(),
        parameter: key.to_owned(),
        over: Over::Voltage {
            high: high.clone(),
            low: low.clone(),
        },
        ratios,
    })
}

/// One condition over another in the samples measured in both.
fn ratio(levels: &Levels, upper: (&str, &str), lower: (&str, &str), place: &str) -> Option<Ratio> {
    let samples = distinct(levels.keys().map(|(.., sample)| sample.as_str()));
    let level = |condition: (&str, &str), sample: &str| {
        levels.get(&(condition.0.to_owned(), condition.1.to_owned(), sample.to_owned()))
    };
    let pairs: Vec<(&Level, &Level)> = samples
        .iter()
        .filter_map(|sample| Some((level(upper, sample)?, level(lower, sample)?)))
        .collect();
    let mut used = Vec::new();
    let mut known: Vec<(f64, f64)> = Vec::new();
    for (upper, lower) in &pairs {
        // One parameter set fitted to both says nothing of their difference.
        let is_one = upper.shared.is_some() && upper.shared == lower.shared;
        if let (Some((a, va)), Some((b, vb)), false) = (upper.mean(), lower.mean(), is_one) {
            known.push((a - b, va + vb));
            used.extend(upper.runs.iter().chain(&lower.runs));
        }
    }
    let blank = Ratio {
        place: place.to_owned(),
        log: None,
        at_least: None,
        samples: pairs.len(),
        runs: used,
    };
    if known.is_empty() {
        let of_pair = |(upper, lower): &(&Level, &Level)| {
            let runs = upper.runs.iter().chain(&lower.runs).copied();
            Some((bound(upper, lower)?, runs.collect()))
        };
        let (at_least, runs) = pairs.iter().find_map(of_pair)?;
        return Some(Ratio {
            at_least: Some(at_least),
            runs,
            ..blank
        });
    }
    let n = known.len() as f64;
    let mean = known.iter().map(|(difference, _)| difference).sum::<f64>() / n;
    let by_fits = known.iter().map(|(_, variance)| variance).sum::<f64>().sqrt() / n * NORMAL_95;
    let by_samples = match known.len() {
        1 => 0.0,
        _ => {
            let square: f64 = known
                .iter()
                .map(|(difference, _)| (difference - mean).powi(2))
                .sum();
            (square / (n - 1.0) / n).sqrt() * quantile_95(n - 1.0)
        }
    };
    let reach = by_fits.max(by_samples);
    Some(Ratio {
        log: Some(Interval {
            value: mean,
            low_95: Some(mean - reach),
            high_95: Some(mean + reach),
        }),
        samples: known.len(),
        ..blank
    })
}

/// What a bound leaves: the ratio is at least that far from 1, or nothing is known.
fn bound(upper: &Level, lower: &Level) -> Option<f64> {
    let rises = upper
        .mean()
        .map(|(y, _)| y)
        .or(upper.above)
        .zip(lower.below)
        .map(|(a, b)| a - b);
    let falls = upper
        .below
        .zip(lower.mean().map(|(y, _)| y).or(lower.above))
        .map(|(a, b)| a - b);
    rises
        .filter(|rise| *rise > 0.0)
        .or(falls.filter(|fall| *fall < 0.0))
}

fn in_campaign_order<'a>(campaign: &Campaign, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names = distinct(names);
    let place = |name: &String| campaign.environments.iter().position(|known| known.id == *name);
    names.sort_by_key(|name| place(name).unwrap_or(usize::MAX));
    names
}

/// Distinct names; numbers by size.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    let number = |name: &String| name.parse::<f64>().unwrap_or(0.0);
    names.sort_by(|a, b| number(a).total_cmp(&number(b)).then_with(|| a.cmp(b)));
    names.dedup();
    names
}

/// The comparison in a sentence, with the number of samples behind it.
pub fn sentence(contrast: &Contrast) -> String {
    let symbol = symbol(&contrast.parameter);
    let material = &contrast.material;
    let samples = contrast
        .ratios
        .iter()
        .map(|ratio| ratio.samples)
        .max()
        .unwrap_or(0);
    let ratios: Vec<String> = contrast
        .ratios
        .iter()
        .map(|one| said(one, &contrast.over))
        .collect();
    let lead = match &contrast.over {
        Over::Environment {
            environment,
            reference,
        } => {
            format!("{symbol} of {material}, {environment} against {reference}")
        }
        Over::Voltage { high, low } => format!("{symbol} of {material}, {high} V against {low} V"),
    };
    let scope = match samples {
        1 => "1 sample: the intervals are those of the fits, and how far another sample would differ is not known"
            .to_owned(),
        several => counted(several, "sample"),
    };
    format!("{lead}: {} ({scope}).", ratios.join("; "))
}

/// A ratio in short: the factor, its interval, and whether a difference is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ShortRatio {
    /// `4.2`, `> 12`, `?`.
    pub factor: String,
    /// `3.9 to 4.5`; empty where there is none.
    pub interval: String,
    /// Logarithm of the factor, where a difference is shown.
    pub log: Option<f64>,
}

/// A ratio in short.
pub fn in_short(ratio: &Ratio) -> ShortRatio {
    match (ratio.log, ratio.at_least) {
        (
            Some(Interval {
                value,
                low_95: Some(low),
                high_95: Some(high),
            }),
            _,
        ) => {
            let width = 2.0 * (high.exp() - low.exp());
            ShortRatio {
                factor: round(value.exp(), width),
                interval: format!("{} to {}", round(low.exp(), width), round(high.exp(), width)),
                log: (low * high > 0.0).then_some(value),
            }
        }
        (_, Some(least)) => ShortRatio {
            factor: format!("{} {}", if least >= 0.0 { ">" } else { "<" }, short(least.exp())),
            interval: String::new(),
            log: Some(least),
        },
        _ => ShortRatio {
            factor: "?".to_owned(),
            interval: String::new(),
            log: None,
        },
    }
}

fn said(ratio: &Ratio, over: &Over) -> String {
    let place = match over {
        Over::Environment { .. } => format!("at {} V", ratio.place),
        Over::Voltage { .. } => format!("in {}", ratio.place),
    };
    match (ratio.log, ratio.at_least) {
        (
            Some(Interval {
                value,
                low_95: Some(low),
                high_95: Some(high),
            }),
            _,
        ) => {
            let (near, far) = if value >= 0.0 { (low, high) } else { (-high, -low) };
            if near <= 0.0 {
                let width = 2.0 * (high.exp() - low.exp());
                return format!(
                    "{place} no difference is shown (factor {} [{}, {}])",
                    round(value.exp(), width),
                    round(low.exp(), width),
                    round(high.exp(), width)
                );
            }
            let width = 2.0 * (far.exp() - near.exp());
            if value.abs() < ABOUT_THE_SAME {
                return format!(
                    "{place} about the same (factor {})",
                    round(value.exp(), value.exp())
                );
            }
            let word = if value >= 0.0 { "higher" } else { "lower" };
            format!(
                "{place} {word} by a factor of {} [{}, {}]",
                round(value.abs().exp(), width),
                round(near.exp(), width),
                round(far.exp(), width)
            )
        }
        (_, Some(least)) => {
            let word = if least >= 0.0 { "higher" } else { "lower" };
            format!(
                "{place} {word} by a factor of at least {}",
                rounded_bound(least.abs().exp(), false).value_text()
            )
        }
        _ => format!("{place} not known"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::facts;
    use ieap_domain::testing::{campaign, fit, known, run};

    fn compared(values: &[(&str, &str, f64, Estimate)]) -> Vec<String> {
        let runs: Vec<RunRecord> = values
            .iter()
            .map(|(sample, environment, volts, estimate)| {
                let mut run = run("r", sample, environment, None, *volts);
                run.fit = Some(fit(&[("lambda_per_s", estimate.clone())]));
                run
            })
            .collect();
        let facts = facts(&runs, &campaign(), &vec![None; runs.len()]);
        contrasts(&runs, &campaign(), &facts, &Doubts::default())
            .iter()
            .map(sentence)
            .collect()
    }

    #[test]
    fn a_ratio_in_short_shows_a_difference_only_where_there_is_one() {
        let ratio = |value: f64, low: f64, high: f64, at_least| Ratio {
            place: "2.00".to_owned(),
            log: (value > 0.0).then(|| Interval {
                value: value.ln(),
                low_95: Some(low.ln()),
                high_95: Some(high.ln()),
            }),
            at_least,
            samples: 1,
            runs: Vec::new(),
        };
        let shown = in_short(&ratio(4.2, 3.9, 4.5, None));
        assert_eq!(
            (shown.factor.as_str(), shown.interval.as_str()),
            ("4.2", "3.9 to 4.5")
        );
        assert!(shown.log.is_some_and(|log| (log - 4.2_f64.ln()).abs() < 1e-12));
        assert_eq!(in_short(&ratio(1.1, 0.8, 1.5, None)).log, None);
        assert_eq!(
            in_short(&ratio(0.0, 0.0, 0.0, Some(-(12.0_f64.ln())))).factor,
            "< 0.083"
        );
        assert_eq!(in_short(&ratio(0.0, 0.0, 0.0, None)).factor, "?");
    }

    #[test]
    fn one_sample_says_so() {
        let said = compared(&[
            ("CNaf-01", "vacuum", 1.2, known(1e-4, 0.05)),
            ("CNaf-01", "air", 1.2, known(1.02e-4, 0.05)),
            ("CNaf-01", "vacuum", 2.5, known(1e-4, 0.05)),
            ("CNaf-01", "air", 2.5, known(1.8e-3, 0.05)),
        ]);
        assert!(
            said[0].starts_with("λ of CNaf, air against vacuum: at 1.20 V no difference is shown"),
            "{}",
            said[0]
        );
        assert!(
            said[0].contains("at 2.50 V higher by a factor of 18 [16, 21]"),
            "{}",
            said[0]
        );
        assert!(said[0].contains("is not known"), "{}", said[0]);
        assert!(
            said[1].contains("2.50 V against 1.20 V: in vacuum no difference"),
            "{}",
            said[1]
        );
    }

    #[test]
    fn a_bound_gives_a_least_factor() {
        let said = compared(&[
            ("CNaf-01", "vacuum", 2.5, Estimate::below(3e-5, "search limit")),
            ("CNaf-01", "air", 2.5, known(3e-4, 0.05)),
        ]);
        assert!(
            said[0].contains("higher by a factor of at least 10"),
            "{}",
            said[0]
        );
    }
}
