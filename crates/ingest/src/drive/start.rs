//! A record that begins under voltage: between which times that was applied to a discharged strip, or whether the strip was at
//! rest under it.

use ieap_domain::number::fixed;
use ieap_domain::{Channel, Drive, Edge, Issue, Level, Quantity, Segment};

use super::found::FoundDrive;
use super::jumps;
use super::levels::Stretch;
use crate::drive::policy::{AT_REST_BELOW, EDGE_STAYS, HELD_READINGS, JUST_APPLIED_FROM};

/// Code of what is said of a strip before the record.
pub const ASSUMED: &str = "start-state-assumed";

/// How the record begins.
pub(super) struct Start {
    /// Voltage before the first segment, V.
    pub baseline_v: f64,
    /// The edge at which the first level was applied; none where it is the baseline.
    pub edge: Option<Segment>,
    /// What is taken for granted.
    pub issue: Option<Issue>,
}

/// One voltage throughout: applied before the first reading, to a discharged sample.
pub(super) fn held_throughout(held: Stretch, zero_may_be_step: bool, time_s: &[f64]) -> FoundDrive {
    let edge = before_record(time_s, zero_may_be_step);
    applied_at(edge, held.level_v)
}

/// A voltage that is stated beside no readings of it, applied to a discharged sample: where the current jumps, or before the
/// response begins.
pub(super) fn of_tag(level_v: f64, zero_may_be_step: bool, channels: &[Channel]) -> FoundDrive {
    let whole = |quantity: Quantity| channels.iter().find(|channel| channel.is_whole(quantity));
    let current = whole(Quantity::Current).or_else(|| whole(Quantity::CurrentDensity));
    // Where there is a current its clock is the run's; bending may be read by another instrument.
    let Some(response) = current.or_else(|| channels.iter().find(|channel| channel.is_response())) else {
        return applied_at(Edge::at(0.0), level_v);
    };
    let (time_s, values) = response.included();
    let beside_zero = || {
        let after = time_s.partition_point(|t| *t < 0.0);
        let before_s = *time_s.get(after.checked_sub(1)?)?;
        Some(Edge::between(before_s, *time_s.get(after)?)).filter(|_| zero_may_be_step)
    };
    let edge = current.and_then(jump_that_stays).or_else(beside_zero);
    let is_current = current.is_some();
    match edge {
        Some(edge) if is_current => found_at(answered(edge, &time_s, &values), level_v, Vec::new()),
        Some(edge) => found_at(edge, level_v, Vec::new()),
        None => {
            let before = before_record(&time_s, zero_may_be_step);
            let edge = if is_current {
                answered(before, &time_s, &values)
            } else {
                before
            };
            applied_at(edge, level_v)
        }
    }
}

/// The edge, or the next interval where the current shows that it comes behind the first reading that could have seen it: a
/// reading beside the ones before, and far from the next.
fn answered(edge: Edge, time_s: &[f64], current: &[f64]) -> Edge {
    let at = time_s.partition_point(|t| *t < edge.no_later_s);
    let before = at.checked_sub(1).map_or(0.0, |before| current[before]);
    match (current.get(at), current.get(at + 1), time_s.get(at + 1)) {
        (Some(own), Some(next), Some(&next_s)) if (own - before).abs() < (next - own).abs() => {
            Edge::between(time_s[at], next_s)
        }
        _ => edge,
    }
}

/// Where the current jumps from rest; none where it comes back at once, as a reading does that went astray.
fn jump_that_stays(current: &Channel) -> Option<Edge> {
    let edge = jumps::from_rest(current).ok()?;
    let (time_s, values) = current.included();
    let before = time_s.partition_point(|t| *t < edge.no_earlier_s);
    let [at_rest, jumped, later] = *values.get(before..before + 3)? else {
        return None;
    };
    ((later - at_rest) / (jumped - at_rest) > EDGE_STAYS).then_some(edge)
}

fn applied_at(edge: Edge, level_v: f64) -> FoundDrive {
    found_at(edge, level_v, vec![assumed(edge, level_v)])
}

fn found_at(edge: Edge, level_v: f64, issues: Vec<Issue>) -> FoundDrive {
    let level = Level::Voltage(level_v);
    let drive = Drive {
        baseline_v: 0.0,
        segments: vec![Segment { edge, level }],
    };
    FoundDrive {
        drive: Some(drive),
        issues,
    }
}

/// The start of a record that steps later: a first level that is not 0 V was applied before the first reading, unless the
/// current, or where it does not tell a table that counts its time from the next step, says that the strip was at rest.
pub(super) fn before_steps(
    first: Stretch,
    next: Stretch,
    threshold_v: f64,
    zero_may_be_step: bool,
    (time_s, channels): (&[f64], &[Channel]),
) -> Start {
    let held = Start {
        baseline_v: first.level_v,
        edge: None,
        issue: None,
    };
    if first.level_v.abs() <= threshold_v {
        return held;
    }
    let level = Level::Voltage(first.level_v);
    let applied = |edge: Edge| Start {
        baseline_v: 0.0,
        edge: Some(Segment { edge, level }),
        issue: Some(assumed(edge, first.level_v)),
    };
    let before = before_record(time_s, zero_may_be_step);
    let counts_from_next = zero_may_be_step && next.last_before_s < 0.0 && 0.0 <= next.start_s;
    match share_of_an_edge(first, next, channels) {
        Some(share) if share < AT_REST_BELOW && counts_from_next => held,
        Some(share) if share < AT_REST_BELOW => Start {
            issue: Some(at_rest(first.level_v)),
            ..held
        },
        // The current tells that it was applied just now.
        Some(share) if share >= JUST_APPLIED_FROM => applied(before),
        _ if counts_from_next => held,
        // Neither: the record began late. What was held before it for as long as in it is at rest by its measure.
        Some(_) => applied(Edge {
            no_earlier_s: before.no_earlier_s.min(2.0 * before.no_later_s - next.start_s),
            ..before
        }),
        None => applied(before),
    }
}

/// When the level was applied that the first of the readings finds, and what is said of it ([`Edge::before_readings`]).
fn before_record(time_s: &[f64], zero_may_be_step: bool) -> Edge {
    Edge::before_readings(time_s, zero_may_be_step).unwrap_or_else(|| Edge::at(0.0))
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

fn assumed(edge: Edge, level_v: f64) -> Issue {
    let message = format!(
        "the record starts with {} V already applied: taken as applied between {} s and {} s, to a discharged sample (0 V)",
        fixed(level_v, 4),
        fixed(edge.no_earlier_s, 4),
        fixed(edge.no_later_s, 4)
    );
    Issue::note(ASSUMED, message)
        .at("column voltage_v")
        .mend("keep the rows before the voltage was applied: they tell when it was, and where the zeros are")
}

fn at_rest(level_v: f64) -> Issue {
    let message = format!(
        "the record starts with {} V already applied; the current shows no charging by it, so it is taken as held \
         for long before",
        fixed(level_v, 4)
    );
    Issue::note(ASSUMED, message)
}
