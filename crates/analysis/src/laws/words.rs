//! Changes and doubts as sentences.

use super::covariate::Covariate;
use super::doubt::{Doubted, Treatment};
use crate::monitoring::fitted::Interval;
use crate::study::factor;
use ieap_domain::ParameterInfo;
use ieap_domain::number::{rounded_bound, significant};
use ieap_domain::words::{counted, in_a_row};

/// Symbol of a parameter; its key where it has none.
pub fn symbol(key: &str) -> &str {
    ParameterInfo::of(key).map_or(key, |parameter| parameter.symbol)
}

/// `rises 3.5-fold (3.3 to 3.7)`: a change of a logarithm in the words of the study.
pub fn moves(change: Interval, is_log: bool) -> String {
    if !is_log {
        let ends = ends(change.low_95, change.high_95, |x| x);
        return format!("changes by {}{ends}", short(change.value));
    }
    let [low, high] = [change.low_95, change.high_95].map(|end| end.map(f64::exp));
    factor(change.value.exp(), low, high)
}

/// ` [1.5, 2.2]`: the ends of an interval on another scale, where there are any.
pub fn ends(low: Option<f64>, high: Option<f64>, scale: fn(f64) -> f64) -> String {
    match (low.map(scale), high.map(scale)) {
        (Some(low), Some(high)) => {
            let width = 2.0 * (high - low);
            format!(" [{}, {}]", round(low, width), round(high, width))
        }
        (Some(low), None) => format!(" [above {}]", rounded_bound(low, false).value_text()),
        (None, Some(high)) => format!(" [below {}]", rounded_bound(high, true).value_text()),
        (None, None) => String::new(),
    }
}

/// Fits in doubt in a sentence.
pub fn doubted(found: &Doubted) -> String {
    let runs = counted(found.runs.len(), "run");
    let why = match found.causes.as_slice() {
        [] => "no cause of it is known".to_owned(),
        causes => format!("{} explains it", causes.join(" with ")),
    };
    let what = match found.treatment {
        Treatment::Widened => format!(
            "the errors of {runs} hold what the extended model moves each parameter by; `ieap diagnose --adopt` fits it instead"
        ),
        Treatment::LeftOut => format!("{runs} of it take part in no answer of the study"),
    };
    format!(
        "The model is wrong for {}, and {why}: {what}.",
        crate::groups::title(&found.group)
    )
}

/// Labels in a row: `a, b and c`.
pub fn listed(covariates: &[Covariate]) -> String {
    let labels: Vec<&str> = covariates.iter().map(|covariate| covariate.label()).collect();
    in_a_row(&labels)
}

/// A number to the digits that a width of its interval carries: a tenth of it counts.
pub fn round(value: f64, width: f64) -> String {
    let place = (width.abs().max(1e-300) / 10.0).log10().floor() as i32;
    let largest = value.abs().max(1e-300).log10().floor() as i32;
    // Never fewer than two digits nor more than four.
    significant(value, (largest - place + 1).clamp(2, 4))
}

/// Two digits.
pub fn short(value: f64) -> String {
    significant(value, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_read_as_people_say_them() {
        let change = |value: f64, low: f64, high: f64| Interval {
            value: value.ln(),
            low_95: Some(low.ln()),
            high_95: Some(high.ln()),
        };
        assert_eq!(moves(change(1.8, 1.5, 2.2), true), "rises by 80 % (50 to 120 %)");
        assert_eq!(moves(change(0.4, 0.3, 0.5), true), "falls to 40 % (30 to 50 %)");
        let one_end = Interval {
            low_95: None,
            ..change(0.4, 0.3, 0.5)
        };
        assert_eq!(moves(one_end, true), "falls to 40 % (falls to 50 % or less)");
    }

    #[test]
    fn numbers_have_the_digits_that_they_carry() {
        assert_eq!(round(1.8234, 1.4), "1.8");
        assert_eq!(round(19.321, 8.0), "19.3");
        assert_eq!(round(1234.5, 400.0), "1230");
        assert_eq!(short(0.0312), "0.031");
        assert_eq!(round(80.2, 60.0), "80");
    }
}
