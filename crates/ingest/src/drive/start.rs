//! A record that begins under voltage: whether that was applied just before it, to a discharged strip, or held for so long
//! that the strip was at rest.

use ieap_domain::{Channel, Drive, Issue, Level, Quantity, Segment};

use super::{FoundDrive, Stretch};
use crate::drive::policy::{AT_REST_BELOW, HELD_READINGS, JUST_APPLIED_FROM};

/// Codes of what is said of a strip before the record.
pub const ASSUMED: [&str; 2] = ["start-state-assumed", "start-state-unknown"];

/// How the record begins.
pub(super) struct Start {
    /// Voltage before the first segment, V.
    pub baseline_v: f64,
    /// The edge at which the first level was applied; none where it is the baseline.
    pub edge: Option<Segment>,
    /// What is taken for granted.
    pub issue: Option<Issue>,
}

/// One voltage throughout: applied at the start, to a discharged sample.
pub(super) fn held_throughout(held: Stretch, time_zero_is_step: bool, time_s: &[f64]) -> FoundDrive {
    if time_zero_is_step && held.start_s < 0.0 {
        let message = format!(
            "the voltage is {:.4} V before and after time zero: there is no step",
            held.level_v
        );
        let issue = Issue::warning("no-step", message)
            .at("column voltage_v")
            .mend("leave the voltage column out and tag voltage_v, if a step was applied at time zero");
        return FoundDrive {
            drive: None,
            issues: vec![issue],
        };
    }
    let level = Level::Voltage(held.level_v);
    let segment = if time_zero_is_step {
        Segment::at(0.0, level)
    } else {
        just_before(time_s, level)
    };
    let drive = Drive {
        baseline_v: 0.0,
        segments: vec![segment],
    };
    FoundDrive {
        drive: Some(drive),
        issues: vec![assumed(held.level_v)],
    }
}

/// The start of a record that steps later: a first level that is not 0 V was applied at or just before the first reading,
/// unless the readings before a stated step or the current tell that the strip was at rest.
pub(super) fn before_steps(
    first: Stretch,
    next: Stretch,
    threshold_v: f64,
    time_zero_is_step: bool,
    (time_s, channels): (&[f64], &[Channel]),
) -> Start {
    let held = Start {
        baseline_v: first.level_v,
        edge: None,
        issue: None,
    };
    let steps_at_zero = next.last_before_s < 0.0 && 0.0 <= next.start_s;
    if first.level_v.abs() <= threshold_v || time_zero_is_step && steps_at_zero {
        return held;
    }
    let level = Level::Voltage(first.level_v);
    let applied = |edge, issue| Start {
        baseline_v: 0.0,
        edge: Some(edge),
        issue: Some(issue),
    };
    if time_zero_is_step && first.start_s >= 0.0 {
        return applied(Segment::at(0.0, level), assumed(first.level_v));
    }
    let edge = just_before(time_s, level);
    match share_of_an_edge(first, next, channels) {
        Some(share) if share < AT_REST_BELOW => Start {
            issue: Some(at_rest(first.level_v)),
            ..held
        },
        Some(share) if share >= JUST_APPLIED_FROM => applied(edge, assumed(first.level_v)),
        _ => applied(edge, not_told(first.level_v)),
    }
}

/// A level that the first of the readings finds applied: it was applied less than one interval before.
pub(super) fn just_before(time_s: &[f64], level: Level) -> Segment {
    let start_s = time_s.first().copied().unwrap_or(0.0);
    let interval_s = time_s.get(1).map_or(0.0, |next_s| next_s - start_s);
    Segment {
        last_before_s: (interval_s > 0.0).then_some(start_s - interval_s),
        ..Segment::at(start_s, level)
    }
}

/// What the current does per volt at the start of the record, as a share of what it does at the next edge: 1 where the voltage
/// was just applied, 0 where the strip was at rest. None without a current.
fn share_of_an_edge(first: Stretch, next: Stretch, channels: &[Channel]) -> Option<f64> {
    let is_current = |quantity: Quantity| channels.iter().find(|channel| channel.is_whole(quantity));
    let (time_s, values) = is_current(Quantity::Current)
        .or_else(|| is_current(Quantity::CurrentDensity))?
        .included();
    let from = time_s.partition_point(|&time| time < first.start_s);
    let edge = time_s.partition_point(|&time| time < next.start_s);
    let (before, after) = (values.get(from..edge)?, values.get(edge..)?);
    let (&begins, &ends) = (before.first()?, before.last()?);
    // What falls in as many readings after either edge; of too few the height itself, in which a leak is counted as well.
    let (at_start, at_edge) = if before.len() >= HELD_READINGS && after.len() >= before.len() {
        (begins - ends, after[0] - after[before.len() - 1])
    } else {
        (begins, after.first()? - ends)
    };
    let share = (at_start / first.level_v) / (at_edge / (next.level_v - first.level_v));
    share.is_finite().then_some(share)
}

fn assumed(level_v: f64) -> Issue {
    let message = format!(
        "the record starts with {level_v:.4} V already applied; the sample is taken as discharged (0 V) before it"
    );
    Issue::note("start-state-assumed", message)
}

fn at_rest(level_v: f64) -> Issue {
    let message = format!(
        "the record starts with {level_v:.4} V already applied; the current shows no charging by it, so it is taken as held \
         for long before"
    );
    Issue::note("start-state-assumed", message)
}

fn not_told(level_v: f64) -> Issue {
    let message = format!(
        "the record starts with {level_v:.4} V already applied, and the current does not tell since when: it is taken as applied \
         just before the first reading, to a discharged sample (0 V)"
    );
    Issue::warning("start-state-unknown", message)
        .at("column voltage_v")
        .mend(
            "record some seconds before the voltage is applied; or write a plain table (`ieap convert`) whose time zero is the \
             first step, with a row of the voltage before it",
        )
}
