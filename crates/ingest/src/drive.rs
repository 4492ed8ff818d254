//! Finds the piecewise-constant drive of a run in its voltage channel, or takes it from the voltage tag. A voltage that moves
//! all the time becomes the staircase of its readings.

use ieap_domain::{Channel, Drive, Edge, Issue, Level, Quantity, Segment};

/// Version of what counts as a drive: raised when the same readings would give another, so that runs are asked again.
pub const VERSION: u32 = 12;

mod found;
mod held_current;
pub mod jumps;
mod levels;
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

use levels::{NoLevels, Stretch, change_noise_v};
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
            let begun = drive.segments.iter().rfind(|s| s.start_s() <= time_s);
            begun.map(|s| s.level)
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
