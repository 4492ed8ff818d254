//! Ratios of every condition to a reference condition.
//!
//! Samples differ more than conditions do, so that a ratio is taken within samples wherever samples were measured in
//! both: the logarithm of a sample's mean in the condition less that in the reference, and of these differences the
//! random-effects mean. Where no sample was measured in both, means over different samples are compared, and said so.

use std::collections::{BTreeMap, BTreeSet};

use crate::conditions::{Condition, Conditions, HUMIDITY_GAP_PERCENT, VOLTAGE_STEP_V};
use crate::laws::doubt::Doubts;
use crate::laws::facts::RunFacts;
use crate::laws::values::values;
use crate::one_fit::SharedEstimate;
use crate::parameters::usable;
use crate::pooling::{Averaging, Pooled, Repeat, pooled};
use ieap_domain::tag::keys;
use ieap_domain::{CompareRules, RunRecord};

/// The reference: what it fixes. What it leaves open is held equal to the condition that is compared with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Whether campaign.toml names it; else it is the condition with the most runs.
    pub is_named: bool,
    /// Environment.
    pub environment: Option<String>,
    /// Relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Step voltage, V.
    pub voltage_v: Option<f64>,
    /// Index in [`Conditions::surroundings`] where the reference was chosen by the runs.
    surroundings: Option<usize>,
}

/// A parameter in a condition over that in the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratio {
    /// Stored key of the parameter.
    pub parameter: String,
    /// Index in [`Conditions::measured`].
    pub condition: usize,
    /// Index of the reference in [`Conditions::measured`].
    pub reference: usize,
    /// Ratio.
    pub value: f64,
    /// Standard error of its logarithm.
    pub log_standard_error: f64,
    /// Lower end of its 95 % interval.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Samples measured in both; 0 where different samples are compared.
    pub samples_in_both: usize,
    /// Runs in the condition and in the reference that the ratio rests on.
    pub runs: (usize, usize),
}

impl Ratio {
    /// Whether only fits speak of its uncertainty: one run on either side, so that neither the spread between runs
    /// nor that between samples is known.
    pub fn is_by_fits_alone(&self) -> bool {
        self.runs == (1, 1)
    }
}

/// The reference that campaign.toml states, else the condition with the most runs over all materials. None where
/// nothing was measured.
pub fn reference(conditions: &Conditions, rules: &CompareRules) -> Option<Reference> {
    let stated = |key: &str| {
        rules
            .reference
            .iter()
            .find(|(known, _)| known == key)
            .map(|(_, value)| value)
    };
    let number = |key| stated(key).and_then(|value| value.parse().ok());
    if !rules.reference.is_empty() {
        return Some(Reference {
            is_named: true,
            environment: stated(keys::ENVIRONMENT).cloned(),
            relative_humidity_percent: number(keys::RELATIVE_HUMIDITY_PERCENT),
            voltage_v: number(keys::VOLTAGE_V),
            surroundings: None,
        });
    }
    let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for condition in &conditions.measured {
        *counts
            .entry((condition.surroundings, condition.voltage))
            .or_default() += condition.runs.len();
    }
    // Of equals the first in the order of the campaign.
    let most = counts
        .iter()
        .max_by_key(|(place, count)| (**count, std::cmp::Reverse(**place)))?;
    let (surroundings, voltage) = *most.0;
    let known = &conditions.surroundings[surroundings];
    Some(Reference {
        is_named: false,
        environment: Some(known.environment.clone()),
        relative_humidity_percent: known
            .humidity
            .map(|level| 0.5 * (level.low_percent + level.high_percent)),
        voltage_v: Some(conditions.voltages_v[voltage]),
        surroundings: Some(surroundings),
    })
}

impl Reference {
    /// Index of the condition that `of` is compared with; none where it was not measured, or is `of` itself.
    pub fn of(&self, conditions: &Conditions, of: &Condition) -> Option<usize> {
        let fits = |condition: &Condition| {
            let (here, there) = (
                &conditions.surroundings[condition.surroundings],
                &conditions.surroundings[of.surroundings],
            );
            let environment = match &self.environment {
                Some(wanted) => here.environment == *wanted,
                None => here.environment == there.environment,
            };
            let humidity = match (self.surroundings, self.relative_humidity_percent, here.humidity) {
                (Some(chosen), ..) => condition.surroundings == chosen,
                (None, Some(wanted), Some(level)) => {
                    let room = 0.5 * HUMIDITY_GAP_PERCENT;
                    (level.low_percent - room..=level.high_percent + room).contains(&wanted)
                }
                (None, Some(_), None) => false,
                // Another environment has other levels: any of them.
                (None, None, _) => self.environment.is_some() || condition.surroundings == of.surroundings,
            };
            let voltage = match self.voltage_v {
                Some(wanted) => (conditions.voltages_v[condition.voltage] - wanted).abs() < VOLTAGE_STEP_V,
                None => condition.voltage == of.voltage,
            };
            condition.material == of.material && environment && humidity && voltage
        };
        let found = conditions.measured.iter().position(fits)?;
        (conditions.measured[found] != *of).then_some(found)
    }
}

/// Ratios of `parameters` (stored keys) in every condition that has a reference and where both sides are determined. Fits
/// that a finding doubts enter with `doubts`' errors, or not at all.
pub fn ratios(
    runs: &[RunRecord],
    (facts, doubts): (&[RunFacts], &Doubts),
    conditions: &Conditions,
    reference: &Reference,
    parameters: &[&str],
) -> Vec<Ratio> {
    let mut place_of: BTreeMap<usize, usize> = BTreeMap::new();
    for (place, fact) in facts.iter().enumerate() {
        place_of.insert(fact.run, place);
    }
    let places = |condition: usize| -> Vec<usize> {
        let runs = conditions.measured[condition].runs.iter();
        runs.filter_map(|run| place_of.get(run).copied()).collect()
    };
    let mut found = Vec::new();
    for (index, condition) in conditions.measured.iter().enumerate() {
        let Some(base) = reference.of(conditions, condition) else {
            continue;
        };
        for key in parameters {
            // One parameter set fitted to both says nothing of their difference.
            if share_an_estimate(
                runs,
                &conditions.measured[index].runs,
                &conditions.measured[base].runs,
                key,
            ) {
                continue;
            }
            let upper = Side::new(runs, (facts, doubts), &places(index), key);
            let lower = Side::new(runs, (facts, doubts), &places(base), key);
            let ratio = upper.zip(lower).and_then(|(upper, lower)| ratio(&upper, &lower));
            found.extend(ratio.map(|(log, samples_in_both, runs)| Ratio {
                parameter: (*key).to_owned(),
                condition: index,
                reference: base,
                value: log.value.exp(),
                log_standard_error: log.standard_error,
                low_95: log.low_95.exp(),
                high_95: log.high_95.exp(),
                samples_in_both,
                runs,
            }));
        }
    }
    found
}

/// Whether a run of each side holds the same estimate, found from both.
fn share_an_estimate(runs: &[RunRecord], upper: &[usize], lower: &[usize], key: &str) -> bool {
    let shared = |side: &[usize]| -> BTreeSet<SharedEstimate> {
        let of = |&run: &usize| SharedEstimate::of(&runs[run], usable(&runs[run], key)?);
        side.iter().filter_map(of).collect()
    };
    !shared(upper).is_disjoint(&shared(lower))
}

/// Logarithms of a parameter in one condition, by sample.
struct Side<'a>(BTreeMap<&'a str, Vec<Repeat>>);

impl<'a> Side<'a> {
    /// None where a value is not positive: such values have no ratio.
    fn new(
        runs: &[RunRecord],
        (facts, doubts): (&'a [RunFacts], &Doubts),
        places: &[usize],
        key: &str,
    ) -> Option<Side<'a>> {
        let values = values(runs, facts, places, key).in_doubt(doubts, runs, facts);
        if !values.is_log {
            return None;
        }
        let mut of_sample: BTreeMap<&str, Vec<Repeat>> = BTreeMap::new();
        for value in &values.values {
            let of = of_sample.entry(&facts[value.place].sample).or_default();
            of.push(Repeat {
                sample: 0,
                value: value.y,
                standard_error: value.variance.sqrt(),
            });
        }
        Some(Side(of_sample))
    }

    fn count<'b>(&self, samples: impl Iterator<Item = &'b &'b str>) -> usize {
        samples
            .filter_map(|sample| self.0.get(*sample))
            .map(Vec::len)
            .sum()
    }

    /// Mean over all samples.
    fn mean(&self) -> Option<Pooled> {
        let numbered = self.0.values().enumerate();
        let repeats: Vec<Repeat> = numbered
            .flat_map(|(sample, repeats)| repeats.iter().map(move |repeat| Repeat { sample, ..*repeat }))
            .collect();
        pooled(&repeats, Averaging::Linear)
    }
}

/// Logarithm of the ratio, samples in both, and runs on either side.
fn ratio(upper: &Side, lower: &Side) -> Option<(Pooled, usize, (usize, usize))> {
    let both: Vec<&str> = upper
        .0
        .keys()
        .filter(|sample| lower.0.contains_key(*sample))
        .copied()
        .collect();
    if both.is_empty() {
        let (above, below) = (upper.mean()?, lower.mean()?);
        let value = above.value - below.value;
        let reach = (above.high_95 - above.value).hypot(below.high_95 - below.value);
        let difference = Pooled {
            value,
            standard_error: above.standard_error.hypot(below.standard_error),
            low_95: value - reach,
            high_95: value + reach,
            ..above
        };
        return Some((difference, 0, (above.runs, below.runs)));
    }
    let difference = |(sample, name): (usize, &&str)| {
        let above = pooled(&upper.0[*name], Averaging::Linear)?;
        let below = pooled(&lower.0[*name], Averaging::Linear)?;
        let reach = (above.high_95 - above.value).hypot(below.high_95 - below.value);
        let repeat = Repeat {
            sample,
            value: above.value - below.value,
            standard_error: above.standard_error.hypot(below.standard_error),
        };
        Some((repeat, reach))
    };
    let differences: Vec<(Repeat, f64)> = both.iter().enumerate().filter_map(difference).collect();
    let repeats: Vec<Repeat> = differences.iter().map(|(repeat, _)| *repeat).collect();
    let mut mean = pooled(&repeats, Averaging::Linear)?;
    if let [(only, reach)] = differences.as_slice() {
        // Few runs of one sample know their spread badly: their own interval is the wider one.
        (mean.low_95, mean.high_95) = (only.value - reach, only.value + reach);
    }
    let runs = (upper.count(both.iter()), lower.count(both.iter()));
    Some((mean, both.len(), runs))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::conditions;
    use crate::laws::facts::facts;
    use ieap_domain::Sample;
    use ieap_domain::testing::{campaign, fit, known, run};

    /// A run whose lambda is `value`, known to 1 %.
    fn measured(name: &str, sample: &str, environment: &str, voltage_v: f64, value: f64) -> RunRecord {
        let mut run = run(name, sample, environment, None, voltage_v);
        run.fit = Some(fit(&[("lambda_per_s", known(value, 0.01))]));
        run
    }

    fn found(runs: &[RunRecord], rules: &CompareRules) -> (Reference, Vec<Ratio>) {
        found_in_doubt(runs, rules, &Doubts::default())
    }

    fn found_in_doubt(runs: &[RunRecord], rules: &CompareRules, doubts: &Doubts) -> (Reference, Vec<Ratio>) {
        let mut campaign = campaign();
        let second = Sample {
            id: "CNaf-02".to_owned(),
            ..campaign.samples[0].clone()
        };
        campaign.samples.push(second);
        let facts = facts(runs, &campaign, &[]);
        let table = conditions(runs, &campaign);
        let reference = reference(&table, rules).unwrap();
        let ratios = ratios(runs, (&facts, doubts), &table, &reference, &["lambda_per_s"]);
        (reference, ratios)
    }

    #[test]
    fn one_parameter_set_of_two_conditions_is_seen() {
        let of = |model: &str, volts: f64| {
            let mut run = ieap_domain::testing::run("r", "CNaf-01", "air", None, volts);
            let lambda = ieap_domain::testing::known(1e-3, 0.1);
            let mut found = ieap_domain::testing::fit(&[("lambda_per_s", lambda)]);
            found.model = model.to_owned();
            run.fit = Some(found);
            run
        };
        let extended = "lumped-2 + faradaic-leak";
        let runs = [
            of(extended, 1.2),
            of(extended, 2.5),
            of("lumped-2", 1.2),
            of("lumped-2", 2.5),
        ];
        assert!(share_an_estimate(&runs, &[0], &[1], "lambda_per_s"));
        assert!(!share_an_estimate(&runs, &[2], &[3], "lambda_per_s"));
    }

    #[test]
    fn the_condition_with_the_most_runs_is_the_reference_and_samples_are_compared_with_themselves() {
        // The samples differ threefold, the conditions by 2 in both.
        let runs = [
            measured("a", "CNaf-01", "vacuum", 2.0, 1e-3),
            measured("b", "CNaf-01", "air", 2.0, 2e-3),
            measured("c", "CNaf-02", "vacuum", 2.0, 3e-3),
            measured("d", "CNaf-02", "air", 2.0, 6e-3),
            measured("e", "CNaf-02", "vacuum", 2.0, 3e-3),
        ];
        let (reference, ratios) = found(&runs, &CompareRules::default());
        assert_eq!(reference.environment.as_deref(), Some("vacuum"));
        assert_eq!(ratios.len(), 1);
        let ratio = &ratios[0];
        assert!((ratio.value - 2.0).abs() < 1e-9, "{ratio:?}");
        assert_eq!((ratio.samples_in_both, ratio.runs), (2, (2, 3)));
        assert!(ratio.low_95 < 2.0 && ratio.high_95 > 2.0 && ratio.high_95 < 2.6);
    }

    #[test]
    fn a_fit_in_doubt_widens_its_ratio_and_one_that_nobody_can_mend_has_none() {
        use crate::laws::doubt::Findings;
        use ieap_domain::{GroupDiagnosis, ParameterShift, Verdict};
        let runs = [
            measured("a", "CNaf-01", "vacuum", 2.0, 1e-3),
            measured("b", "CNaf-01", "air", 2.0, 2e-3),
        ];
        let of = |verdict: Verdict| {
            let mut group =
                GroupDiagnosis::data_problem("g", vec![runs[1].path.clone()], "lumped-2", String::new());
            group.verdict = verdict;
            group.q_misfit = Some(0.001);
            group.shifts = vec![ParameterShift {
                key: "lambda_per_s".to_owned(),
                before: 2e-3,
                after: 1e-3,
                standard_error: 1e-5,
            }];
            let findings = Findings {
                groups: &[group],
                runs: &[],
            };
            let doubts = Doubts::new(findings, &runs);
            found_in_doubt(&runs, &CompareRules::default(), &doubts).1
        };
        let (plain, wide) = (found(&runs, &CompareRules::default()).1, of(Verdict::Law));
        assert!(plain[0].low_95 > 1.9, "{plain:?}");
        assert!(
            wide[0].low_95 < 1.0 && (wide[0].value - 2.0).abs() < 1e-9,
            "{wide:?}"
        );
        assert!(of(Verdict::Unexplained).is_empty());
    }

    #[test]
    fn what_a_named_reference_leaves_open_is_held_equal() {
        let runs = [
            measured("a", "CNaf-01", "vacuum", 1.2, 1e-3),
            measured("b", "CNaf-01", "air", 1.2, 3e-3),
            measured("c", "CNaf-01", "vacuum", 2.0, 2e-3),
            measured("d", "CNaf-01", "air", 2.0, 8e-3),
        ];
        let rules = CompareRules {
            reference: vec![("environment".to_owned(), "vacuum".to_owned())],
            by: None,
        };
        let (_, ratios) = found(&runs, &rules);
        let values: Vec<f64> = ratios.iter().map(|ratio| ratio.value.round()).collect();
        assert_eq!(values, [3.0, 4.0]);
        assert!(ratios.iter().all(Ratio::is_by_fits_alone));
    }

    #[test]
    fn different_samples_are_compared_where_no_sample_saw_both_and_it_is_said() {
        let runs = [
            measured("a", "CNaf-01", "vacuum", 2.0, 1e-3),
            measured("b", "CNaf-02", "air", 2.0, 2e-3),
        ];
        let (_, ratios) = found(&runs, &CompareRules::default());
        assert_eq!(ratios[0].samples_in_both, 0);
        // Two errors of 1 %: the factor is known to 2.8 %.
        assert!(
            (ratios[0].high_95 / ratios[0].value - 1.028).abs() < 1e-3,
            "{:?}",
            ratios[0]
        );
    }
}
