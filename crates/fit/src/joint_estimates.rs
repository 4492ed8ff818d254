//! From intervals of a joint fit to estimates: values, bounds open on one side, or reasons.

use ieap_domain::number::fixed;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::{Drive, Estimate, Level};

use super::electrical::Electrical;
use super::estimates::{counted, in_doubt, ordinal};
use super::joint::branch_evidence::{Branches, Evidence};
use super::joint::feature::Feature;
use super::joint::profile::Interval;
use super::joint::single::Judged;
use crate::interval_rule;

/// The estimate that an interval stands for. `partner` names what the feature trades off against.
pub(super) fn estimate(
    feature: Feature,
    interval: &Interval,
    drive: &Drive,
    partner: Option<(Feature, f64)>,
) -> Estimate {
    match feature {
        Feature::Steady => steady(interval, drive, partner),
        Feature::Coupling => coupling(interval, partner),
        Feature::Rate => rate(interval, partner),
        _ => logarithm(interval, partner),
    }
}

fn trade_off(partner: Option<(Feature, f64)>) -> String {
    let named = partner.and_then(|(feature, correlation)| Some((feature.key()?, correlation)));
    match named {
        Some((key, correlation)) if correlation.abs() > 0.5 => {
            let how = if correlation < 0.0 {
                "one can rise while the other falls"
            } else {
                "both can rise together"
            };
            format!(
                "; it trades off against {key}: {how} (correlation {})",
                fixed(correlation, 2)
            )
        }
        _ => String::new(),
    }
}

fn logarithm(interval: &Interval, partner: Option<(Feature, f64)>) -> Estimate {
    let narrow = |end: &f64| interval_rule::is_narrow_enough((end - interval.value).abs());
    let within = |end: Option<f64>| end.filter(narrow);
    let value = interval.value.exp();
    match (within(interval.low), within(interval.high)) {
        (Some(low), Some(high)) => {
            let relative = as_printed(interval, low, high);
            Estimate::determined(
                value,
                value * relative,
                low.exp().min(value),
                high.exp().max(value),
            )
        }
        (Some(low), None) => open_above(low.exp(), partner),
        (None, Some(high)) => open_below(high.exp(), partner),
        (None, None) => open(interval_rule::TOO_WIDE, partner),
    }
}

fn steady(interval: &Interval, drive: &Drive, partner: Option<(Feature, f64)>) -> Estimate {
    let held = |level: Level| matches!(level, Level::Voltage(v) if v != 0.0);
    if drive.baseline_v == 0.0 && !drive.segments.iter().any(|segment| held(segment.level)) {
        return Estimate::not_determined(interval_rule::NO_HELD_VOLTAGE);
    }
    let Some(high) = interval.high.filter(|high| *high > 0.0) else {
        return open("the current leaves the steady part open", partner);
    };
    interval_rule::resistance(
        1.0,
        interval.value,
        interval.standard_error,
        interval.low.unwrap_or(0.0),
        high,
        format!("{}{}", interval_rule::NO_STEADY_CURRENT, trade_off(partner)),
    )
}

fn coupling(interval: &Interval, partner: Option<(Feature, f64)>) -> Estimate {
    let away = |end: f64| end * interval.value > 0.0;
    match (interval.low, interval.high) {
        (Some(low), Some(high)) if away(low) && away(high) => {
            let error = as_printed(interval, low, high);
            Estimate::determined(
                interval.value,
                error,
                low.min(interval.value),
                high.max(interval.value),
            )
        }
        (Some(low), None) if low > 0.0 => open_above(low, partner),
        (None, Some(high)) if high < 0.0 => open_below(high, partner),
        _ => open(
            "the 95 % interval of the coupling would contain zero or have no end",
            partner,
        ),
    }
}

fn rate(interval: &Interval, partner: Option<(Feature, f64)>) -> Estimate {
    let low = interval.low.filter(|low| *low > 0.0);
    let value = interval.value;
    match (low, interval.high) {
        (Some(low), Some(high)) => {
            let error = as_printed(interval, low, high);
            Estimate::determined(value, error, low.min(value), high.max(value))
        }
        (None, Some(high)) => {
            let reason = format!("{}{}", interval_rule::TOO_SLOW, trade_off(partner));
            interval_rule::from_zero(value, interval.standard_error, 0.0, high, reason)
        }
        (Some(low), None) => Estimate::above(low, "relaxation is faster than the readings tell".to_owned()),
        (None, None) => open("the data leave the rate open", partner),
    }
}

/// Half of the interval in 95 % units: what a table may print as the standard error.
fn as_printed(interval: &Interval, low: f64, high: f64) -> f64 {
    interval
        .standard_error
        .min((high - low) / (2.0 * NORMAL_95_ROUNDED))
}

fn open(why: &str, partner: Option<(Feature, f64)>) -> Estimate {
    Estimate::not_determined(format!("{why}{}", trade_off(partner)))
}

fn open_above(low: f64, partner: Option<(Feature, f64)>) -> Estimate {
    Estimate::above(
        low,
        format!("the data set it no upper limit{}", trade_off(partner)),
    )
}

fn open_below(high: f64, partner: Option<(Feature, f64)>) -> Estimate {
    Estimate::below(
        high,
        format!("the data set it no lower limit{}", trade_off(partner)),
    )
}

/// The estimate of a judged run; none where it was not judged.
pub(super) fn judged_estimate(feature: Feature, judged: &Judged, drive: &Drive) -> Option<Estimate> {
    if let Some(k) = feature.branch() {
        match judged.evidence().map(|evidence| evidence.branches) {
            Some(Branches::OneOrHidden) => {
                return Some(Estimate::not_determined(
                    "one branch describes the current as well as two, but a second one could hide in the noise, \
                     so that the parts of neither are known",
                ));
            }
            Some(Branches::Doubtful) => return Some(Estimate::not_determined(in_doubt(judged.branches))),
            _ if k >= judged.branches => return Some(Estimate::not_determined(not_needed(judged.branches))),
            _ => {}
        }
    }
    let (_, interval) = judged.features.iter().find(|(own, _)| *own == feature)?;
    let partner = judged.partners.iter().find(|(own, ..)| *own == feature);
    let Some(interval) = interval else {
        return Some(Estimate::not_determined(
            "the search met ever deeper minima: no interval can be stated",
        ));
    };
    Some(estimate(
        feature,
        interval,
        drive,
        partner.map(|(_, other, correlation)| (*other, *correlation)),
    ))
}

/// Why there are no more than `n` branches.
fn not_needed(n: usize) -> String {
    match n {
        1 => {
            "one branch is enough, and no second one of a noticeable size could hide in the noise".to_owned()
        }
        _ => format!(
            "{} enough: a {} one describes nothing beyond noise",
            counted(n),
            ordinal(n + 1)
        ),
    }
}

/// Why so many branches, in words.
pub(super) fn choice_in_words(evidence: &Evidence) -> String {
    let n = evidence.weighed;
    let how = match (evidence.branches, n) {
        (Branches::All, _) => format!("{} branches", number(n)),
        (Branches::Doubtful, _) => format!("open whether {} or {} branches", number(n - 1), number(n)),
        (Branches::Fewer, 2) => {
            "one branch (a second one slower than the record would look like steady current)".to_owned()
        }
        (Branches::Fewer, _) => format!("{} enough, without a {} one", counted(n - 1), ordinal(n)),
        (Branches::OneOrHidden, _) => "one branch is enough, a second one could hide".to_owned(),
    };
    format!(
        "{how}: the {} branch lowers the weighted sum of squares by {}; \
         12 are needed, and BIC asks for {} (of {} effective readings)",
        ordinal(n),
        fixed(evidence.gain, 1),
        fixed(evidence.penalty, 1),
        fixed(evidence.effective_readings, 0)
    )
}

/// The same where the two steps alone decided; none where one branch stood against none.
pub(super) fn two_step_choice_in_words(electrical: &Electrical) -> Option<String> {
    let n = electrical.conductances_a_per_v.len();
    let gain = electrical.gain.filter(|_| n > 1)?;
    let how = if electrical.in_doubt {
        format!("open whether {} or {} branches", number(n - 1), number(n))
    } else {
        format!("{} branches", number(n))
    };
    Some(format!(
        "{how}: the {} branch lowers the sum of squares by {} variances of a long sum of the noise; \
         12 are needed",
        ordinal(n),
        fixed(gain, 1)
    ))
}

fn number(n: usize) -> &'static str {
    match n {
        1 => "one",
        2 => "two",
        3 => "three",
        4 => "four",
        _ => "more",
    }
}
