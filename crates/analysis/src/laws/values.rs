//! The fitted values of one parameter over the runs of a material, on the scale on which laws are sought.

use ieap_domain::quantiles::NORMAL_95;
use std::collections::BTreeSet;

use super::doubt::Doubts;
use super::facts::RunFacts;
use crate::one_fit::SharedEstimate;
use crate::parameters::usable;
use ieap_domain::{Fit, RunRecord};

/// One value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Index in the facts.
    pub place: usize,
    /// Its logarithm; the value itself where some are not positive.
    pub y: f64,
    /// Its variance by the fit, and by what a claimed misfit may do to it.
    pub variance: f64,
}

impl Value {
    /// With a further error of this size.
    fn widened(self, shift: f64) -> Value {
        Value {
            variance: self.variance + shift * shift,
            ..self
        }
    }
}

/// Values of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Stored key of the parameter.
    pub key: String,
    /// Whether `y` is logarithms.
    pub is_log: bool,
    /// Values of the runs that determine it.
    pub values: Vec<Value>,
    /// Places of runs that were fitted but give a bound, nothing, or no uncertainty.
    pub left_out: Vec<usize>,
}

/// Keys of the parameters that the fits of these runs hold. Time constants are products of others, and are left out
/// but where bending alone tells them.
pub fn keys(runs: &[RunRecord], facts: &[RunFacts], places: &[usize]) -> Vec<String> {
    let mut keys: Vec<String> = Vec::new();
    for &place in places {
        if let Some(fit) = &runs[facts[place].run].fit {
            let with_times = is_of_bending_alone(fit);
            for parameter in &fit.parameters {
                let is_asked = with_times || !parameter.key.starts_with("tau");
                if is_asked && !keys.contains(&parameter.key) {
                    keys.push(parameter.key.clone());
                }
            }
        }
    }
    keys
}

/// Whether the fit is one of bending alone, which has curvatures per volt in place of resistances and capacitances.
fn is_of_bending_alone(fit: &Fit) -> bool {
    fit.parameter("curvature_total_per_cm_v").is_some()
}

/// Values of the parameter `key` over `places`. A bound is no value: it is left out and counted. Of runs that share one
/// parameter set the first stands for all.
pub fn values(runs: &[RunRecord], facts: &[RunFacts], places: &[usize], key: &str) -> Values {
    let mut known = Vec::new();
    let mut left_out = Vec::new();
    let mut shared = BTreeSet::new();
    for &place in places {
        let run = &runs[facts[place].run];
        if run.fit.as_ref().and_then(|fit| fit.parameter(key)).is_none() {
            continue;
        }
        let estimate = usable(run, key).filter(|estimate| !estimate.at_bound);
        let own = estimate.and_then(|estimate| SharedEstimate::of(run, estimate));
        if own.is_some_and(|own| !shared.insert(own)) {
            continue;
        }
        let numbers = estimate.and_then(|estimate| {
            let value = estimate.value?;
            let error = estimate
                .standard_error
                .filter(|error| error.is_finite() && *error >= 0.0)?;
            value
                .is_finite()
                .then_some((value, error, estimate.low_95, estimate.high_95))
        });
        match numbers {
            Some(numbers) => known.push((place, numbers)),
            None => left_out.push(place),
        }
    }
    let is_log = known.iter().all(|(_, (value, ..))| *value > 0.0);
    let values = known
        .into_iter()
        .map(|(place, (value, error, low, high))| {
            if is_log {
                Value {
                    place,
                    y: value.ln(),
                    variance: log_error(value, error, low, high).powi(2),
                }
            } else {
                Value {
                    place,
                    y: value,
                    variance: error * error,
                }
            }
        })
        .collect();
    Values {
        key: key.to_owned(),
        is_log,
        values,
        left_out,
    }
}

impl Values {
    /// The same with what claimed misfits may do to each value in its variance; where nobody knows what that is, the
    /// value is left out.
    #[must_use]
    pub fn in_doubt(mut self, doubts: &Doubts, runs: &[RunRecord], facts: &[RunFacts]) -> Values {
        let all = std::mem::take(&mut self.values);
        for value in all {
            match self.shift(doubts, &value, runs, facts) {
                Some(shift) => self.values.push(value.widened(shift)),
                None => self.left_out.push(value.place),
            }
        }
        self
    }

    /// The same with all values kept: over the life of one sample in one condition a misfit that nobody can name is the
    /// same from run to run, and a change of the parameter is seen beside it.
    #[must_use]
    pub fn in_doubt_of_one_series(
        mut self,
        doubts: &Doubts,
        runs: &[RunRecord],
        facts: &[RunFacts],
    ) -> Values {
        let widened = |value: &Value| {
            let shift = self.shift(doubts, value, runs, facts);
            value.widened(shift.unwrap_or(0.0))
        };
        self.values = self.values.iter().map(widened).collect();
        self
    }

    fn shift(&self, doubts: &Doubts, value: &Value, runs: &[RunRecord], facts: &[RunFacts]) -> Option<f64> {
        let run = &runs[facts[value.place].run];
        doubts.shift(&run.path, &self.key, self.is_log)
    }
}

/// Standard error of the logarithm: from the interval, which need not lie evenly about the value.
fn log_error(value: f64, error: f64, low: Option<f64>, high: Option<f64>) -> f64 {
    match (low.filter(|low| *low > 0.0), high) {
        (Some(low), Some(high)) if high > low => (high / low).ln() / (2.0 * NORMAL_95),
        _ => error / value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::facts;
    use ieap_domain::Estimate;
    use ieap_domain::testing::{campaign, fit, known, run};

    #[test]
    fn bounds_are_left_out_and_counted() {
        let mut runs: Vec<RunRecord> = ["a", "b", "c"]
            .iter()
            .map(|name| run(name, "CNaf-01", "air", Some(34.0), 2.0))
            .collect();
        for (run, estimate) in runs.iter_mut().zip([
            known(2.0, 0.1),
            Estimate::below(1e-4, "search limit"),
            Estimate::not_determined("flat"),
        ]) {
            run.fit = Some(fit(&[("lambda_per_s", estimate), ("tau1_s", known(1.0, 0.1))]));
        }
        let facts = facts(&runs, &campaign());
        assert_eq!(keys(&runs, &facts, &[0, 1, 2]), ["lambda_per_s"]);
        let found = values(&runs, &facts, &[0, 1, 2], "lambda_per_s");
        assert_eq!((found.values.len(), found.left_out.as_slice()), (1, &[1, 2][..]));
        runs[0]
            .fit
            .as_mut()
            .unwrap()
            .parameters
            .push(ieap_domain::Parameter {
                key: "curvature_total_per_cm_v".to_owned(),
                estimate: known(0.3, 0.01),
            });
        assert!(
            keys(&runs, &facts, &[0]).contains(&"tau1_s".to_owned()),
            "of bending alone"
        );
        assert!(found.is_log && (found.values[0].variance.sqrt() - 0.1).abs() < 5e-3);
    }
}
