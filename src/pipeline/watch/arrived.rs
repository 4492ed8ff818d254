//! A line for every run that is fitted while the watch goes on.

use std::collections::BTreeSet;

use crate::domain::number::{fixed, interval, rounded_bound, significant};
use crate::domain::tag::keys;
use crate::domain::{EstimateState, Fit, RunRecord};
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};

/// Parameters that a line tells, with the unit in which it does.
const TOLD: [(&str, &str, &str); 2] = [
    ("lambda_per_s", "lambda", " 1/s"),
    ("alpha_per_c_cm", "alpha", " 1/(C cm)"),
];

/// Fits that were told, by run and what they were made from.
#[derive(Debug, Default)]
pub struct Told {
    known: Option<BTreeSet<(String, String)>>,
}

impl Told {
    /// Lines of the runs that were fitted since the last time; none the first time, when a whole folder may be new.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn new_lines(&mut self, context: &Context) -> Result<Vec<String>, PipelineError> {
        let runs = standing::speaking(context)?;
        let key = |run: &RunRecord| {
            let fit = run.fit.as_ref()?;
            Some((run.path.clone(), format!("{} {:?}", fit.model, fit.parameters)))
        };
        let now: BTreeSet<(String, String)> = runs.iter().filter_map(key).collect();
        let before = self.known.replace(now);
        let Some(before) = before else {
            return Ok(Vec::new());
        };
        let is_new = |run: &&RunRecord| key(run).is_some_and(|key| !before.contains(&key));
        Ok(runs.iter().filter(is_new).filter_map(line).collect())
    }
}

/// `CNaf-1, air, 33 % RH, 2.0 V: lambda 1.24e-3 1/s, alpha 14.8 1/(C cm), residual 1.0 times the noise (a.csv)`.
fn line(run: &RunRecord) -> Option<String> {
    let fit = run.fit.as_ref()?;
    let tags = [
        (keys::SAMPLE, ""),
        (keys::ENVIRONMENT, ""),
        (keys::RELATIVE_HUMIDITY_PERCENT, " % RH"),
        (keys::VOLTAGE_V, " V"),
    ];
    let place: Vec<String> = tags
        .iter()
        .filter_map(|(key, unit)| Some(format!("{}{unit}", run.tag(key)?)))
        .collect();
    let mut said: Vec<String> = TOLD.iter().filter_map(|told| parameter(fit, *told)).collect();
    let left = fit
        .noise
        .iter()
        .map(|noise| noise.residual_rms / noise.standard_deviation);
    if let Some(most) = left.filter(|ratio| ratio.is_finite()).reduce(f64::max) {
        said.push(format!("residual {} times the noise", fixed(most, 1)));
    }
    if !fit.converged {
        said.push("the fit did not converge".to_owned());
    }
    Some(format!(
        "{}: {} ({})",
        place.join(", "),
        said.join(", "),
        run.path
    ))
}

fn parameter(fit: &Fit, (key, name, unit): (&str, &str, &str)) -> Option<String> {
    let estimate = fit.parameter(key)?;
    Some(match estimate.state() {
        EstimateState::Determined(value) => format!("{name} {}{unit}", significant(value, 3)),
        EstimateState::Between(low, high) => {
            format!("{name} from {}{unit}", interval(low, high))
        }
        EstimateState::Above(low) => format!("{name} above {}{unit}", rounded_bound(low, false).value_text()),
        EstimateState::Below(high) => {
            format!("{name} below {}{unit}", rounded_bound(high, true).value_text())
        }
        EstimateState::Open => format!("{name} not determined"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Estimate;
    use crate::domain::testing::{fit, known, run};

    #[test]
    fn a_run_is_told_in_one_line() {
        let mut arrived = run("a", "CNaf-1", "air", Some(34.0), 2.0);
        arrived.fit = Some(fit(&[
            ("lambda_per_s", known(1.2414e-3, 1e-5)),
            ("alpha_per_c_cm", Estimate::below(14.83, "")),
        ]));
        let said = line(&arrived).unwrap();
        let expected = "CNaf-1, air, 34 % RH, 2 V: lambda 1.24·10⁻³ 1/s, alpha below 15 1/(C cm)";
        assert!(said.starts_with(expected), "{said}");
    }
}
