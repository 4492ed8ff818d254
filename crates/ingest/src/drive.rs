//! Finds the piecewise-constant drive of a run in its voltage channel, or takes it from the voltage tag. A voltage that moves
//! all the time becomes the staircase of its readings.

use crate::drive::policy::{
    FEW_LEVELS, HELD_READINGS, HELD_SHARE, MANY_STRETCHES, MOST_PULSES_SHARE, MOST_STEPS_SHARE,
};
use ieap_domain::range_of;
use ieap_domain::{Channel, Drive, Edge, Issue, Level, Quantity, Segment};
use ieap_numerics::robust::{SD_PER_MEDIAN_DISTANCE, upper_median};

/// Version of what counts as a drive: raised when the same readings would give another, so that runs are asked again.
pub const VERSION: u32 = 12;

mod found;
mod held_current;
pub mod jumps;
mod moving;
pub(crate) mod policy;
mod start;
mod stated;
mod step;
mod unseen;

pub use found::{FoundDrive, MOVES, NO_STEPS};
pub use start::ASSUMED;
pub use stated::contradicted;
pub use unseen::PAUSES;

use start::{Start, before_steps, held_throughout};
use step::{step_threshold, told_levels};

/// Finds the drive.
///
/// With a voltage channel the steps are found in it, each after the last reading that shows the old level and no later than
/// the first that shows the new one, whatever the clock says there; what the source was told to apply, where a file states it
/// for every reading, goes before what was measured unless that contradicts it. Readings before the first step are the
/// baseline; a channel that holds one voltage from its first reading on is a step from the discharged state before it.
/// Without a voltage channel `tag_v` is applied where the current jumps, else beside time zero where that may be the step
/// (a plain table), else before the first reading. `open_s` lists stretches of open circuit (start, end), s, beside those of an
/// open-circuit channel.
pub fn find(
    channels: &[Channel],
    zero_may_be_step: bool,
    tag_v: Option<f64>,
    open_s: &[(f64, f64)],
) -> FoundDrive {
    let of = |quantity| channels.iter().find(|c| c.is_whole(quantity));
    let mut open: Vec<(f64, f64)> = open_s.to_vec();
    open.extend(of(Quantity::OpenCircuit).map(stretches_open).unwrap_or_default());
    open.sort_by(|a, b| a.0.total_cmp(&b.0));
    let found = match (stated::driving(channels), tag_v) {
        (Some(voltage), _) => stated::found(voltage, channels, |voltage| {
            from_channel(voltage, channels, zero_may_be_step, &open)
        }),
        (None, Some(tag_v)) => start::of_tag(tag_v, zero_may_be_step, channels),
        (None, None) => FoundDrive {
            drive: None,
            issues: Vec::new(),
        },
    };
    with_open_circuit(held_current::told(found, channels), &open)
}

/// Whether a channel says what voltage was applied.
pub fn has_voltage(channels: &[Channel]) -> bool {
    stated::driving(channels).is_some()
}

fn from_channel(
    voltage: &Channel,
    channels: &[Channel],
    zero_may_be_step: bool,
    open: &[(f64, f64)],
) -> FoundDrive {
    let (time_s, values) = voltage.included();
    let is_open = |t: f64| open.iter().any(|&(from, to)| t >= from && t < to);
    let closed: Vec<usize> = (0..values.len()).filter(|&i| !is_open(time_s[i])).collect();
    let readings = |values: &[f64]| -> Vec<f64> { closed.iter().map(|&i| values[i]).collect() };
    let (levels, unanswered) = match told_levels(voltage, &closed, channels) {
        Ok(told) => told,
        Err(NoLevels::Moves) => {
            return moving::staircase(&readings(&time_s), &readings(&values), channels, open);
        }
        Err(NoLevels::Steps(issue)) => {
            return FoundDrive {
                drive: None,
                issues: vec![issue],
            };
        }
    };
    let Some((first, rest)) = levels.split_first() else {
        return FoundDrive {
            drive: None,
            issues: vec![no_readings()],
        };
    };
    if let Some(issue) = unseen::alternating(&readings(&time_s), &readings(&values)) {
        return FoundDrive {
            drive: None,
            issues: vec![issue],
        };
    }
    let mut found = if rest.is_empty() {
        held_throughout(*first, zero_may_be_step, &time_s)
    } else {
        let threshold_v = step_threshold(&values, &closed, change_noise_v(&values, &closed));
        let closed_s = readings(&time_s);
        let start = before_steps(
            *first,
            rest[0],
            threshold_v,
            zero_may_be_step,
            (&closed_s, channels),
        );
        stepped(start, rest)
    };
    found.issues.extend(unanswered);
    if let Some(drive) = &found.drive {
        let told = unseen::pauses((&time_s, &values), is_open, drive);
        found.issues.extend(told);
    }
    found
}

/// A stretch of constant voltage: when the level before was last seen, when this one was first seen, its value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    last_before_s: f64,
    start_s: f64,
    level_v: f64,
}

fn stepped(start: Start, rest: &[Stretch]) -> FoundDrive {
    let segment = |stretch: &Stretch| Segment {
        edge: Edge::between(stretch.last_before_s, stretch.start_s),
        level: Level::Voltage(stretch.level_v),
    };
    FoundDrive {
        drive: Some(Drive {
            baseline_v: start.baseline_v,
            segments: start.edge.into_iter().chain(rest.iter().map(segment)).collect(),
        }),
        issues: start.issue.into_iter().collect(),
    }
}

/// Cuts the readings `closed` (indices) into stretches of constant voltage: changes beyond `threshold`, V, make a new one.
fn levels(
    time_s: &[f64],
    values: &[f64],
    closed: &[usize],
    threshold: f64,
) -> Result<Vec<Stretch>, NoLevels> {
    let Some(&start) = closed.first() else {
        return Ok(Vec::new());
    };
    let noise_v = change_noise_v(values, closed);
    let share = |part: f64| ((closed.len() as f64 * part) as usize).max(20);
    let mut stretches: Vec<Stretch> = Vec::new();
    let (mut begin, mut last_before_s, mut sloping) = (0, time_s[start], 0);
    let mut within_v: f64 = 0.0;
    let mut in_levels = 0;
    for position in 1..=closed.len() {
        let changed = position == closed.len() || {
            let jump = (values[closed[position]] - values[closed[position - 1]]).abs() > threshold;
            let off_level = (values[closed[position]] - values[closed[begin]]).abs() > threshold;
            jump || off_level
        };
        if !changed {
            continue;
        }
        // In a sweep each stretch runs from one edge of the threshold to the other.
        sloping +=
            usize::from((values[closed[position - 1]] - values[closed[begin]]).abs() > 0.5 * threshold);
        let mut readings: Vec<f64> = closed[begin..position].iter().map(|&i| values[i]).collect();
        let (low, high) = range_of(readings.iter().copied());
        within_v = within_v.max(high - low);
        in_levels += if position - begin >= HELD_READINGS {
            position - begin
        } else {
            0
        };
        stretches.push(Stretch {
            last_before_s,
            start_s: time_s[closed[begin]],
            level_v: upper_median(&mut readings).unwrap_or(0.0),
        });
        if position < closed.len() {
            last_before_s = time_s[closed[position - 1]];
            begin = position;
        }
    }
    let seen = stretches.len();
    let is_held = in_levels as f64 >= HELD_SHARE * closed.len() as f64;
    if seen > 2 && 2 * sloping > seen || seen > MANY_STRETCHES && !is_held {
        return Err(NoLevels::Moves);
    }
    // What changes from reading to reading may be no noise, but a wave that few readings follow.
    let whole: Vec<f64> = closed.iter().map(|&i| values[i]).collect();
    if moving::is_wave(&whole, noise_v, within_v) {
        return Err(NoLevels::Moves);
    }
    let held = without_edges(stretches, threshold);
    let most = if distinct_levels(&held, threshold) <= FEW_LEVELS {
        share(MOST_PULSES_SHARE)
    } else {
        share(MOST_STEPS_SHARE)
    };
    match held.len() > most {
        // Levels that are held, but too many and too short.
        true if is_held => Err(NoLevels::Steps(not_constant(held.len(), closed.len()))),
        true => Err(NoLevels::Moves),
        false => Ok(held),
    }
}

/// Why a voltage does not go in levels.
enum NoLevels {
    /// It moves from reading to reading.
    Moves,
    /// It goes in more levels than a drive has.
    Steps(Issue),
}

/// Number of levels that differ from each other by a step.
fn distinct_levels(stretches: &[Stretch], threshold: f64) -> usize {
    let mut levels: Vec<f64> = stretches.iter().map(|stretch| stretch.level_v).collect();
    levels.sort_by(f64::total_cmp);
    let steps = levels.windows(2).filter(|pair| pair[1] - pair[0] > threshold);
    1 + steps.count()
}

fn not_constant(changes: usize, readings: usize) -> Issue {
    let message =
        format!("the voltage changes {changes} times or more in {readings} readings: a sweep, not steps");
    Issue::warning(NO_STEPS, message).at("column voltage_v").mend(
        "hold each voltage for twenty readings or more if these are steps, and for three if these are pulses between a \
         few levels; it is kept and not fitted",
    )
}

/// A reading caught while the source was still rising is no level of its own: a stretch of one reading
/// between two others is joined to the one after it.
fn without_edges(stretches: Vec<Stretch>, threshold: f64) -> Vec<Stretch> {
    let mut kept: Vec<Stretch> = Vec::new();
    let mut pending: Option<Stretch> = None;
    for (index, stretch) in stretches.iter().enumerate() {
        let next = stretches.get(index + 1);
        let between = next.zip(kept.last()).is_some_and(|(next, last)| {
            let inside = (stretch.level_v - last.level_v) * (next.level_v - stretch.level_v) > 0.0;
            inside && next.last_before_s == stretch.start_s && (next.level_v - last.level_v).abs() > threshold
        });
        if between {
            pending.get_or_insert(*stretch);
            continue;
        }
        let edge = pending.take().unwrap_or(*stretch);
        kept.push(Stretch {
            last_before_s: edge.last_before_s,
            start_s: edge.start_s,
            level_v: stretch.level_v,
        });
    }
    kept
}

/// Noise as the changes from reading to reading have it, V.
fn change_noise_v(values: &[f64], closed: &[usize]) -> f64 {
    let mut changes: Vec<f64> = closed
        .windows(2)
        .map(|pair| (values[pair[1]] - values[pair[0]]).abs())
        .collect();
    SD_PER_MEDIAN_DISTANCE / std::f64::consts::SQRT_2 * upper_median(&mut changes).unwrap_or(0.0)
}

/// Stretches (start, end) in which an open-circuit channel is not 0.
fn stretches_open(channel: &Channel) -> Vec<(f64, f64)> {
    let mut stretches = Vec::new();
    let mut since = None;
    for (&time_s, &open) in channel.time_s.iter().zip(channel.values.iter()) {
        match (since, open != 0.0) {
            (None, true) => since = Some(time_s),
            (Some(start), false) => {
                stretches.push((start, time_s));
                since = None;
            }
            _ => {}
        }
    }
    stretches.extend(since.map(|start| (start, f64::INFINITY)));
    stretches
}

/// Puts open-circuit segments into a drive; after each the level that was due goes on.
fn with_open_circuit(mut found: FoundDrive, open: &[(f64, f64)]) -> FoundDrive {
    let Some(drive) = found.drive.as_mut() else {
        return found;
    };
    for &(from, to) in open {
        let due = |time_s: f64| {
            drive
                .segments
                .iter()
                .rev()
                .find(|s| s.start_s() <= time_s)
                .map(|s| s.level)
        };
        let after = to.is_finite().then(|| due(to)).flatten();
        drive.segments.retain(|s| s.start_s() < from || s.start_s() > to);
        // The last reading of a voltage before the next level may lie before the circuit was open.
        let later = drive
            .segments
            .iter_mut()
            .filter(|s| s.start_s() > to && !s.edge.is_stated());
        later.for_each(|s| s.edge.no_earlier_s = s.edge.no_earlier_s.max(to));
        drive.segments.push(Segment::at(from, Level::OpenCircuit));
        drive.segments.extend(after.map(|level| Segment::at(to, level)));
        drive.segments.sort_by(|a, b| a.start_s().total_cmp(&b.start_s()));
    }
    found
}

fn no_readings() -> Issue {
    Issue::warning("no-voltage", "the voltage column holds no reading").at("column voltage_v")
}

#[cfg(test)]
mod tests;
