//! What is said where the parameters of a group differ between its runs, and nothing else is wrong.

use super::{followed_tag, proof};
use crate::number::significant;
use crate::words::in_a_row;
use crate::{GroupDiagnosis, ParameterInfo, VaryingParameter, VaryingValue};

/// Parameters whose courses are told at most; the others are named. Chosen.
const MOST_COURSES: usize = 2;
/// What is further apart is told as that. Chosen.
const MOST_FOLD: f64 = 1e3;

/// The sentence of runs whose parameters differ.
pub(super) fn sentence(found: &GroupDiagnosis) -> String {
    let differing = told_first(&found.differs);
    let told: Vec<String> = differing
        .iter()
        .take(MOST_COURSES)
        .filter_map(|own| course(own))
        .collect();
    let others: Vec<String> = differing
        .iter()
        .skip(MOST_COURSES)
        .map(|own| symbol(&own.key))
        .collect();
    let further = match others.as_slice() {
        [] => String::new(),
        [_] => format!("; {} differs too", listed(&others)),
        _ => format!("; {} differ too", listed(&others)),
    };
    let share = found.account.map_or_else(String::new, |account| {
        let share = account.share(account.between_runs);
        format!(
            ": parameters of their own take {} % of the error",
            significant(share, 2)
        )
    });
    let with = match differing.first().map_or("", |own| own.with.as_str()) {
        "voltage_v" => ", which differ with the voltage".to_owned(),
        with => followed_tag(with).map_or_else(String::new, |tag| format!(", which differ with {tag}")),
    };
    format!(
        "No one set of parameters describes the {} runs{with}{share}. {}{further}.{}",
        found.runs.len(),
        listed(&told),
        proof(found, "laws of the voltage in their place")
    )
}

/// Parameters that differ, those first that are known best to do so.
pub fn told_first(differs: &[VaryingParameter]) -> Vec<&VaryingParameter> {
    let mut found: Vec<&VaryingParameter> = differs.iter().collect();
    found.sort_by(|a, b| apart(b).total_cmp(&apart(a)));
    found
}

/// How many standard errors the largest value lies above the smallest.
fn apart(parameter: &VaryingParameter) -> f64 {
    let by_value = |a: &&VaryingValue, b: &&VaryingValue| a.value.total_cmp(&b.value);
    let ends = (
        parameter.values.iter().min_by(by_value),
        parameter.values.iter().max_by(by_value),
    );
    let (Some(low), Some(high)) = ends else { return 0.0 };
    (high.value - low.value)
        / low
            .standard_error
            .hypot(high.standard_error)
            .max(f64::MIN_POSITIVE)
}

/// Largest over smallest size of a parameter; endless where one is none.
fn fold(parameter: &VaryingParameter) -> f64 {
    let sizes = parameter.values.iter().map(|own| own.value.abs());
    let (low, high) = sizes.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if high == 0.0 { 1.0 } else { high / low }
}

/// How a parameter goes: with the voltage where it rises or falls all along it, else how far apart its values are. The values
/// stand in the table beside it.
fn course(parameter: &VaryingParameter) -> Option<String> {
    let name = symbol(&parameter.key);
    let mut values: Vec<&VaryingValue> = parameter.values.iter().collect();
    let volts = |own: &VaryingValue| own.step_v.abs();
    values.sort_by(|a, b| volts(a).total_cmp(&volts(b)));
    let (first, last) = (values.first()?, values.last()?);
    let rises = values.windows(2).all(|pair| pair[1].value > pair[0].value);
    let falls = values.windows(2).all(|pair| pair[1].value < pair[0].value);
    let apart = values
        .windows(2)
        .all(|pair| volts(pair[1]) > 1.001 * volts(pair[0]));
    let fold = fold(parameter);
    Some(if apart && (rises || falls) {
        let verb = if rises == (first.value > 0.0) {
            "rises"
        } else {
            "falls"
        };
        let by = times(fold, verb == "falls");
        let (from, to) = (short(volts(first)), short(volts(last)));
        format!("{name} {verb} {by} from {from} to {to} V")
    } else {
        format!("{name} differs {}", times(fold, false))
    })
}

/// By how much: `2.28-fold`, `by 28 %`.
fn times(fold: f64, falls: bool) -> String {
    let part = if falls { 1.0 - fold.recip() } else { fold - 1.0 };
    match fold {
        ..2.0 => format!("by {} %", significant(100.0 * part, 2)),
        2.0..MOST_FOLD => format!("{}-fold", short(fold)),
        _ => format!("more than {MOST_FOLD}-fold"),
    }
}

/// Three digits that count.
pub fn short(value: f64) -> String {
    significant(value, 3)
}

/// Symbol of a parameter; its key where it has none.
pub fn symbol(key: &str) -> String {
    ParameterInfo::of(key).map_or(key, |known| known.ascii).to_owned()
}

/// Things in a row.
pub fn listed(parts: &[String]) -> String {
    if parts.is_empty() {
        "their parameters differ".to_owned()
    } else {
        in_a_row(parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(key: &str, values: &[(&str, f64)]) -> VaryingParameter {
        VaryingParameter {
            key: key.to_owned(),
            with: "voltage_v".to_owned(),
            share_percent: 90.0,
            ratio: None,
            values: values
                .iter()
                .map(|(run, value)| VaryingValue {
                    run: (*run).to_owned(),
                    step_v: run.parse().unwrap(),
                    value: *value,
                    standard_error: 0.02 * value,
                })
                .collect(),
        }
    }

    #[test]
    fn a_course_over_the_voltage_is_said_as_one() {
        let falling = parameter(
            "rss_ohm_cm2",
            &[("2.5", 1_900.0), ("1.2", 17_900.0), ("2", 4_000.0)],
        );
        assert_eq!(
            course(&falling).unwrap(),
            "R_ss falls 9.42-fold from 1.20 to 2.50 V"
        );
        let between = parameter("c1_f_per_cm2", &[("2", 0.004), ("2.5", 0.001), ("1.2", 0.002)]);
        assert_eq!(course(&between).unwrap(), "C1 differs 4.00-fold");
        let repeats = parameter("lambda_per_s", &[("2", 0.015), ("2.0", 0.01)]);
        assert_eq!(course(&repeats).unwrap(), "lambda differs by 50 %");
        let less = parameter("c2_f_per_cm2", &[("2", 0.004), ("2.5", 0.003)]);
        assert_eq!(course(&less).unwrap(), "C2 falls by 25 % from 2.00 to 2.50 V");
    }
}
