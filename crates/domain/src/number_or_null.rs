//! Numbers that JSON cannot hold, such as infinity, are written as null: null is read back as "not a number".

use serde::{Deserialize, Deserializer};

/// A number, or null.
pub(super) fn one<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// Numbers, any of them null.
pub(super) fn many<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    let numbers = Vec::<Option<f64>>::deserialize(deserializer)?;
    Ok(numbers.into_iter().map(|n| n.unwrap_or(f64::NAN)).collect())
}

/// Named numbers, any of them null.
pub(super) fn named<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(String, f64)>, D::Error> {
    let numbers = Vec::<(String, Option<f64>)>::deserialize(deserializer)?;
    let number = |(name, n): (String, Option<f64>)| (name, n.unwrap_or(f64::NAN));
    Ok(numbers.into_iter().map(number).collect())
}

#[cfg(test)]
mod tests {
    use crate::{FromOthers, GroupDiagnosis, ParameterShift, ResidualCurve};

    #[test]
    fn a_finding_with_a_number_that_json_cannot_hold_is_read_back() {
        let mut found = GroupDiagnosis::data_problem("g", vec!["r".into()], "lumped-2", "s".into());
        found.shifts.push(ParameterShift {
            key: "alpha_per_c_cm".into(),
            before: 1.0,
            after: f64::INFINITY,
            standard_error: f64::NAN,
        });
        found.residuals.push(ResidualCurve {
            run: "r".into(),
            channel: "current".into(),
            time_s: vec![1.0, 2.0],
            before_sigma: vec![0.5, f64::NAN],
            after_sigma: Vec::new(),
            measured: vec![1e-3, f64::NAN],
            base: vec![1e-3, 2e-3],
            extended: Vec::new(),
        });
        found.from_others.push(FromOthers {
            effect: "contact-break".into(),
            variant: None,
            samples: vec!["s".into()],
            parameters: vec![("run".into(), f64::NAN)],
            fall: 0.0,
            standard_error: 0.0,
            fall_own_strength: 0.0,
            made_of: String::new(),
        });
        let text = serde_json::to_string(&found).unwrap();
        let back: GroupDiagnosis = serde_json::from_str(&text).unwrap();
        assert!(back.shifts[0].after.is_nan() && back.shifts[0].before == 1.0);
        assert!(back.from_others[0].parameters[0].1.is_nan());
        assert!(back.residuals[0].before_sigma[1].is_nan());
    }
}
