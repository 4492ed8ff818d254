//! Cuts the readings of a voltage into stretches of one level.

use super::found::NO_STEPS;
use super::moving;
use crate::drive::policy::{
    FEW_LEVELS, HELD_READINGS, HELD_SHARE, MANY_STRETCHES, MOST_PULSES_SHARE, MOST_STEPS_SHARE,
};
use ieap_domain::{Issue, range_of};
use ieap_numerics::robust::{SD_PER_MEDIAN_DISTANCE, upper_median};

/// A stretch of constant voltage: when the level before was last seen, when this one was first seen, its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) last_before_s: f64,
    pub(super) start_s: f64,
    pub(super) level_v: f64,
}

/// Cuts the readings `closed` (indices) into stretches of constant voltage: changes beyond `threshold`, V, make a new one.
pub(super) fn levels(
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
pub(super) enum NoLevels {
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
pub(super) fn change_noise_v(values: &[f64], closed: &[usize]) -> f64 {
    let mut changes: Vec<f64> = closed
        .windows(2)
        .map(|pair| (values[pair[1]] - values[pair[0]]).abs())
        .collect();
    SD_PER_MEDIAN_DISTANCE / std::f64::consts::SQRT_2 * upper_median(&mut changes).unwrap_or(0.0)
}
