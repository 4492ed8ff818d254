//! Wording that several pages share: counts, conditions, estimates, issues, links.

pub use ieap_analysis::groups::title as group_title;
pub use ieap_analysis::readable::readable;
use serde::Serialize;

use crate::site::Site;
use ieap_analysis::Surroundings;
use ieap_domain::ParameterInfo;
use ieap_domain::number::{
    fixed, interval, lower_bound, measured, measured_stacked, plain, rounded_bound, significant, upper_bound,
    with_unit,
};
use ieap_domain::{Estimate, EstimateState, Issue, RunRecord, Severity};

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
            place: readable(&issue.place),
            message: readable(&issue.message),
            // What is to be typed stays as it is typed.
            mend: issue.mend.clone(),
        }
    }
}

/// `i₀` of `i_0`, `Eₒₙ` of `E_on`; a symbol whose index has no such letters stays as it is.
pub fn with_index(symbol: &str) -> String {
    const LOWERED: [(char, char); 27] = [
        ('0', '₀'),
        ('1', '₁'),
        ('2', '₂'),
        ('3', '₃'),
        ('4', '₄'),
        ('5', '₅'),
        ('6', '₆'),
        ('7', '₇'),
        ('8', '₈'),
        ('9', '₉'),
        ('a', 'ₐ'),
        ('e', 'ₑ'),
        ('h', 'ₕ'),
        ('i', 'ᵢ'),
        ('j', 'ⱼ'),
        ('k', 'ₖ'),
        ('l', 'ₗ'),
        ('m', 'ₘ'),
        ('n', 'ₙ'),
        ('o', 'ₒ'),
        ('p', 'ₚ'),
        ('r', 'ᵣ'),
        ('s', 'ₛ'),
        ('t', 'ₜ'),
        ('u', 'ᵤ'),
        ('v', 'ᵥ'),
        ('x', 'ₓ'),
    ];
    let lowered = |c: char| LOWERED.iter().find(|(plain, _)| *plain == c).map(|(_, low)| *low);
    let shown = symbol.split_once('_').and_then(|(name, index)| {
        let index: Option<String> = index.chars().map(lowered).collect();
        Some(format!("{name}{}", index?))
    });
    shown.unwrap_or_else(|| symbol.to_owned())
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
        let own = estimate.scaled(shown_factor);
        let error = own.standard_error.unwrap_or(0.0);
        let (text, kind) = match own.state() {
            EstimateState::Determined(value) => (measured(value, error), "value"),
            EstimateState::Between(low, high) => (interval(low, high), "bound"),
            EstimateState::Below(high) => (upper_bound(high), "bound"),
            EstimateState::Above(low) => (lower_bound(low), "bound"),
            EstimateState::Open => ("–".to_owned(), "missing"),
        };
        let interval = match (own.low_95, own.high_95) {
            (Some(low), Some(high)) => interval(low, high),
            (None, Some(high)) => format!("below {}", rounded_bound(high, true).value_text()),
            (Some(low), None) => format!("above {}", rounded_bound(low, false).value_text()),
            (None, None) => String::new(),
        };
        let limit = (estimate.at_bound && estimate.reason.is_none())
            .then(|| "the value lies at a limit of the search".to_owned());
        let stacked = match own.value {
            Some(value) => measured_stacked(value, error),
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

/// Symbol, unit and factor under which a parameter is shown.
pub fn shown_as(key: &str) -> (&str, &'static str, f64) {
    ParameterInfo::of(key).map_or((key, "", 1.0), |known| {
        (known.symbol, known.shown_unit(), known.shown_factor())
    })
}

/// Estimate of a parameter in a run with what a finding says against it, or why the run has none.
pub fn estimate_of(site: &Site, run: &RunRecord, parameter: &ParameterInfo) -> EstimateText {
    match run.fit.as_ref().map(|fit| fit.parameter(parameter.key)) {
        Some(Some(estimate)) => {
            let stated = site.input.doubts.stated(&run.path, parameter.key, estimate);
            let text = EstimateText::of(&stated, parameter.shown_factor());
            if run.fit.as_ref().is_some_and(|fit| fit.converged) {
                text
            } else {
                EstimateText {
                    reason: NOT_CONVERGED.to_owned(),
                    kind: "doubtful",
                    ..text
                }
            }
        }
        Some(None) => EstimateText::missing("the model of this run has no such parameter"),
        None => EstimateText::missing(run.state.why_unfitted()),
    }
}

/// What is said of every number of a fit that did not converge.
pub const NOT_CONVERGED: &str = "the fit did not converge, so that its numbers are not to be used";

/// `28–38 % RH`; empty where no humidity is known.
pub fn humidity_label(surroundings: &Surroundings) -> String {
    surroundings.humidity_said()
}

/// `air` or, where the humidity varies, `air at 28–38 % RH`
pub fn surroundings_label(surroundings: &Surroundings) -> String {
    let humidity = humidity_label(surroundings);
    if surroundings.humidity_varies && !humidity.is_empty() {
        format!("{} at {humidity}", surroundings.environment)
    } else {
        surroundings.environment.clone()
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
    if shortest.contains(['.', '·']) || voltage_v == 0.0 {
        format!("{shortest}\u{a0}V")
    } else {
        format!("{shortest}.0\u{a0}V")
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
    fn indices_are_lowered_where_letters_allow_it() {
        assert_eq!(
            ["i_0", "E_on", "s", "R_c", "k_ab"].map(with_index),
            ["i₀", "Eₒₙ", "s", "R_c", "k_ab"]
        );
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
    fn voltages_have_as_many_decimals_as_tell_them_apart() {
        assert_eq!(voltage_labels(&[-0.7, -0.65]), ["−0.70", "−0.65"]);
        assert_eq!(voltage_labels(&[1.2, 2.0]), ["1.2", "2.0"]);
    }
}
