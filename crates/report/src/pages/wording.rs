//! Wording that several pages share: counts, conditions, estimates, issues, links.

use serde::Serialize;

use crate::number::{
    fixed, interval, lower_bound, measured, measured_stacked, plain, significant, upper_bound, with_unit,
};
use crate::site::Site;
use ieap_analysis::{ParameterInfo, Surroundings};
use ieap_domain::{Estimate, Issue, RunRecord, RunState, Severity};

/// A link to a run's page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunLink {
    /// Address relative to the site's root.
    pub href: String,
    /// The run's name.
    pub name: String,
}

impl RunLink {
    /// The link to run number `run`.
    pub fn to(site: &Site, run: usize) -> RunLink {
        RunLink {
            href: site.run_href(run),
            name: site.run_name(run).to_owned(),
        }
    }
}

/// An issue as pages list it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IssueText {
    /// `note`, `warning`, `error`: word and class.
    pub severity: &'static str,
    /// Where.
    pub place: String,
    /// What.
    pub message: String,
    /// How to mend it.
    pub mend: String,
}

impl From<&Issue> for IssueText {
    fn from(issue: &Issue) -> IssueText {
        IssueText {
            severity: issue.severity.key(),
            place: issue.place.clone(),
            message: issue.message.clone(),
            mend: issue.mend.clone(),
        }
    }
}

/// An estimate as a table cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EstimateText {
    /// `24.62 ± 0.31`, `< 4·10⁻⁵` or a dash.
    pub text: String,
    /// The same for narrow tables: value, and `± 0.31` to stand below it (empty where there is none).
    pub stacked: (String, String),
    /// `23.9 to 25.3`; empty where there is no interval.
    pub interval: String,
    /// Why there is no value or only a bound, or that the value lies at a limit; empty where all is well.
    pub reason: String,
    /// `value`, `bound`, `missing` or `doubtful`: class.
    pub kind: &'static str,
}

impl EstimateText {
    /// `estimate` in the shown unit of its parameter.
    pub fn of(estimate: &Estimate, shown_factor: f64) -> EstimateText {
        let shown = |number: Option<f64>| number.map(|number| number * shown_factor);
        let (low, high) = (shown(estimate.low_95), shown(estimate.high_95));
        let (text, kind) = match (shown(estimate.value), low, high) {
            (Some(value), _, _) => (
                measured(value, shown(estimate.standard_error).unwrap_or(0.0)),
                "value",
            ),
            (None, Some(low), Some(high)) => (
                format!("{} to {}", significant(low, 2), significant(high, 2)),
                "bound",
            ),
            (None, None, Some(high)) => (upper_bound(high), "bound"),
            (None, Some(low), None) => (lower_bound(low), "bound"),
            (None, None, None) => ("–".to_owned(), "missing"),
        };
        let interval = match (low, high) {
            (Some(low), Some(high)) => interval(low, high),
            (None, Some(high)) => format!("below {}", significant(high, 3)),
            (Some(low), None) => format!("above {}", significant(low, 3)),
            (None, None) => String::new(),
        };
        let limit = (estimate.at_bound && estimate.reason.is_none())
            .then(|| "the value lies at a limit of the search".to_owned());
        let stacked = match shown(estimate.value) {
            Some(value) => measured_stacked(value, shown(estimate.standard_error).unwrap_or(0.0)),
            None => (text.clone(), String::new()),
        };
        EstimateText {
            text,
            stacked,
            interval,
            reason: estimate.reason.clone().or(limit).unwrap_or_default(),
            kind,
        }
    }

    /// A dash, for `reason`.
    pub fn missing(reason: impl Into<String>) -> EstimateText {
        EstimateText {
            text: "–".to_owned(),
            stacked: ("–".to_owned(), String::new()),
            interval: String::new(),
            reason: reason.into(),
            kind: "missing",
        }
    }
}

/// Estimate of a parameter in a run, or why the run has none.
pub fn estimate_of(run: &RunRecord, parameter: &ParameterInfo) -> EstimateText {
    match run.fit.as_ref().map(|fit| fit.parameter(parameter.key)) {
        Some(Some(estimate)) => {
            let text = EstimateText::of(estimate, parameter.shown_factor);
            match run.fit.as_ref().is_some_and(|fit| fit.converged) {
                true => text,
                false => EstimateText {
                    reason: NOT_CONVERGED.to_owned(),
                    kind: "doubtful",
                    ..text
                },
            }
        }
        Some(None) => EstimateText::missing("the model of this run has no such parameter"),
        None => EstimateText::missing(why_unfitted(run)),
    }
}

/// What is said of every number of a fit that did not converge.
pub const NOT_CONVERGED: &str = "the fit did not converge, so that its numbers are not to be used";

/// `CNaf-1 in air, 33 % RH` of a group's name, `sample=CNaf-1,environment=air,relative_humidity_percent=33`.
pub fn group_title(name: &str) -> String {
    let (mut title, mut rest) = (String::new(), Vec::new());
    for part in name.split(',') {
        match part.split_once('=') {
            Some(("sample", sample)) => title = sample.to_owned(),
            Some(("environment", environment)) => title += &format!(" in {environment}"),
            Some(("relative_humidity_percent", percent)) => rest.push(format!("{percent} % RH")),
            Some((key, value)) => rest.push(format!("{} {value}", key.replace('_', " "))),
            None => rest.push(part.to_owned()),
        }
    }
    if title.is_empty() {
        return rest.join(", ");
    }
    rest.insert(0, title.trim_start().to_owned());
    rest.join(", ")
}

/// Why a run has no fit, in words.
pub fn why_unfitted(run: &RunRecord) -> &'static str {
    match run.state {
        RunState::Ready => "the run is not fitted yet",
        RunState::Untagged => "a needed tag is missing",
        RunState::NotFitted => "the run is not a step response that the model describes",
        RunState::NoSteps => "the voltage does not go in steps",
    }
}

/// `1 run`, `3 runs`
pub fn counted(n: usize, noun: &str) -> String {
    match n {
        1 => format!("1 {noun}"),
        _ => format!("{n} {noun}s"),
    }
}

/// `a`, `a and b`, `a, b and c`
pub fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `28–38 % RH`; empty where no humidity is known.
pub fn humidity_label(surroundings: &Surroundings) -> String {
    let Some(level) = surroundings.humidity else {
        return String::new();
    };
    let (low, high) = (fixed(level.low_percent, 0), fixed(level.high_percent, 0));
    match low == high {
        true => format!("{low} % RH"),
        false => format!("{low}–{high} % RH"),
    }
}

/// `air` or, where the humidity varies, `air at 28–38 % RH`
pub fn surroundings_label(surroundings: &Surroundings) -> String {
    let humidity = humidity_label(surroundings);
    match surroundings.humidity_varies && !humidity.is_empty() {
        true => format!("{} at {humidity}", surroundings.environment),
        false => surroundings.environment.clone(),
    }
}

/// Voltages of a table with the same number of decimals: `1.2`, `2.0`.
pub fn voltage_labels(voltages_v: &[f64]) -> Vec<String> {
    let needed = voltages_v
        .iter()
        .any(|v| ((v * 10.0) - (v * 10.0).round()).abs() > 1e-6);
    voltages_v
        .iter()
        .map(|&v| fixed(v, if needed { 2 } else { 1 }))
        .collect()
}

/// `2.5 V`, not broken across lines
pub fn voltage_label(voltage_v: f64) -> String {
    let shortest = plain(voltage_v);
    match shortest.contains(['.', '·']) || voltage_v == 0.0 {
        true => format!("{shortest}\u{a0}V"),
        false => format!("{shortest}.0\u{a0}V"),
    }
}

/// A number with its unit; volts, amperes and bytes take an SI prefix, the others stay as tables print them.
pub fn in_unit(value: f64, unit: &str) -> String {
    match unit {
        "V" | "A" | "B" => with_unit(value, unit),
        "" => significant(value, 4),
        "1/cm" => format!("{} cm⁻¹", significant(value, 3)),
        unit => format!("{} {unit}", significant(value, 4)),
    }
}

/// Whether a run or its fit carries a warning or an error.
pub fn has_warnings(run: &RunRecord) -> bool {
    let worrying = |issues: &[Issue]| issues.iter().any(|issue| issue.severity >= Severity::Warning);
    let fit_worries = |fit: &ieap_domain::Fit| !fit.converged || worrying(&fit.issues);
    worrying(&run.issues) || run.fit.as_ref().is_some_and(fit_worries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_is_named_as_one_says_it() {
        let said = |name| group_title(name);
        assert_eq!(said("sample=CNaf-1,environment=air"), "CNaf-1 in air");
        assert_eq!(
            said("sample=S,environment=air,relative_humidity_percent=35.2"),
            "S in air, 35.2 % RH"
        );
        assert_eq!(
            said("sample=S,environment=air,started_at=2020-02-03"),
            "S in air, started at 2020-02-03"
        );
        assert_eq!(said("a run"), "a run");
    }

    #[test]
    fn estimates_in_every_state() {
        let of = |estimate: Estimate| EstimateText::of(&estimate, 1e-3).text;
        assert_eq!(
            of(Estimate::determined(64_050.0, 310.0, 63_400.0, 64_700.0)),
            "64.05 ± 0.31"
        );
        assert_eq!(of(Estimate::below(0.04, "r")), "< 4·10⁻⁵");
        assert_eq!(of(Estimate::above(2000.0, "r")), "> 2");
        assert_eq!(of(Estimate::not_determined("r")), "–");
        let open = Estimate {
            low_95: Some(1000.0),
            ..Estimate::below(3000.0, "r")
        };
        assert_eq!(of(open), "1.0 to 3.0");
    }

    #[test]
    fn a_value_at_a_limit_says_so() {
        let mut estimate = Estimate::determined(1.0, 0.1, 0.8, 1.2);
        estimate.at_bound = true;
        assert_eq!(
            EstimateText::of(&estimate, 1.0).reason,
            "the value lies at a limit of the search"
        );
    }

    #[test]
    fn words() {
        assert_eq!(
            (counted(1, "run"), counted(0, "run")),
            ("1 run".to_owned(), "0 runs".to_owned())
        );
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        assert_eq!(voltage_labels(&[-0.7, -0.65]), ["−0.70", "−0.65"]);
        assert_eq!(voltage_labels(&[1.2, 2.0]), ["1.2", "2.0"]);
    }
}
