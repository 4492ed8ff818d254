//! What a row of results tells people in columns of their own. Its checksum is of the fit in full, from which all of them follow,
//! so that none may say something else.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::domain::{Estimate, Issue};
use crate::pipeline::fits::result::FitResult;

/// A column that says something else than what the checksum is of; none where all agree. Columns that are left away, or that
/// are somebody's own, are no contradiction.
pub fn other_told(columns: &BTreeMap<String, Value>, result: &FitResult) -> Option<&'static str> {
    let told = told(result).into_iter();
    let is_other = |(name, value): &(&str, Value)| columns.get(*name).is_some_and(|found| found != value);
    told.into_iter().find(is_other).map(|(name, _)| name)
}

/// Columns of a fit, and of why there is none; null, or a list of nothing, where there is nothing to say.
fn told(result: &FitResult) -> [(&'static str, Value); 14] {
    let (fit, issue) = (result.fit.as_ref(), result.issue.as_ref());
    let parameters = fit.iter().flat_map(|fit| &fit.parameters);
    let nuisances = fit.iter().flat_map(|fit| &fit.nuisances);
    let issues = fit.iter().flat_map(|fit| &fit.issues);
    [
        ("model", json!(fit.map(|fit| &fit.model))),
        ("model_version", json!(fit.map(|fit| fit.model_version))),
        ("converged", json!(fit.map(|fit| fit.converged))),
        ("why_stopped", json!(fit.map(|fit| &fit.why_stopped))),
        ("method", json!(fit.map(|fit| &fit.method))),
        ("n_samples", json!(fit.map(|fit| fit.n_samples))),
        (
            "parameters",
            parameters
                .map(|own| told_estimate(&own.key, &own.estimate))
                .collect(),
        ),
        (
            "nuisances",
            nuisances
                .map(|own| told_estimate(&own.key, &own.estimate))
                .collect(),
        ),
        (
            "r_squared_current",
            json!(fit.and_then(|fit| fit.r_squared_current)),
        ),
        (
            "r_squared_curvature",
            json!(fit.and_then(|fit| fit.r_squared_curvature)),
        ),
        ("issues", issues.map(told_issue).collect()),
        ("refused_place", json!(issue.map(|issue| &issue.place))),
        ("refused_reason", json!(issue.map(|issue| &issue.message))),
        ("refused_remedy", json!(issue.map(|issue| &issue.mend))),
    ]
}

fn told_estimate(key: &str, of: &Estimate) -> Value {
    json!({
        "key": key,
        "value": of.value,
        "standard_error": of.standard_error,
        "low_95": of.low_95,
        "high_95": of.high_95,
        "at_bound": of.at_bound,
        "reason": of.reason,
    })
}

fn told_issue(issue: &Issue) -> Value {
    json!({
        "severity": issue.severity.key(),
        "code": issue.code,
        "place": issue.place,
        "message": issue.message,
        "mend": issue.mend,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::AskedFit;
    use crate::domain::testing::{fit, known};

    #[test]
    fn a_column_for_people_that_says_something_else_is_named() {
        let made = fit(&[("r1_ohm_cm2", known(120.0, 6.0))]);
        let made = FitResult::of("a", "d", "i", &AskedFit::default(), Ok(made));
        let refused = Issue::warning("not-fitted", "too few readings").mend("read more");
        let refused = FitResult::of("a", "d", "i", &AskedFit::default(), Err(refused));
        for result in [made, refused] {
            let columns: BTreeMap<String, Value> = told(&result)
                .into_iter()
                .map(|(name, value)| (name.to_owned(), value))
                .collect();
            assert_eq!(other_told(&columns, &result), None);
            assert_eq!(other_told(&BTreeMap::new(), &result), None);
            for (name, _) in told(&result) {
                let mut forged = columns.clone();
                forged.insert(name.to_owned(), json!("9"));
                assert_eq!(other_told(&forged, &result), Some(name));
            }
        }
    }

    #[test]
    fn a_parameter_that_is_another_in_one_digit_is_noticed() {
        let made = fit(&[("r1_ohm_cm2", known(120.0, 6.0))]);
        let result = FitResult::of("a", "d", "i", &AskedFit::default(), Ok(made));
        let mut columns: BTreeMap<String, Value> = told(&result)
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value))
            .collect();
        let parameters = columns.get_mut("parameters").unwrap();
        parameters[0]["value"] = json!(120.00000000000001);
        assert_eq!(other_told(&columns, &result), Some("parameters"));
    }
}
