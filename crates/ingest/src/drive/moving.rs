//! A voltage that moves all the time, as a sine, a chirp or a triangle does: the staircase of its own readings.
//!
//! Each reading's voltage is held from midway to the reading before to midway to the one after, and so is what lies between
//! readings that are too far apart for that. What it makes of the parameters falls with the square of the steps in a
//! period: docs/moving-voltage.md has the numbers.

use ieap_domain::drive::jumps;
use ieap_domain::number::{fixed, plain, significant, to_digits};
use ieap_domain::{Channel, Drive, Issue, Quantity, range_of};
use ieap_numerics::robust::{SD_PER_MEDIAN_DISTANCE, upper_median};
use ieap_numerics::waveform::{LEAST_TURN, Waveform, between, finer, recognise, turns};

use super::{FoundDrive, MOVES, NO_STEPS};
use crate::drive::policy::{
    ALONE_FACTOR, FEWEST_OF_COURSE, LEAST_STEP_NOISE, LEAST_STEP_V, LEAST_WAVE_V, MOST_SCATTER, MOVING_PAUSE,
    READINGS_IN_HALF_PERIOD, READINGS_OF_REST, SHORT_SHARE, STEPS_IN_HALF_PERIOD, WAVE_OF_VOLTAGE,
    WAVE_OVER_SCATTER,
};

/// Standard deviation of fourth differences of noise, in its own.
const FOURTH: f64 = 8.366_600_265_340_756;

/// The drive of those readings; none, with what is wrong, where they do not carry the voltage's course.
pub(super) fn staircase(
    time_s: &[f64],
    volts: &[f64],
    channels: &[Channel],
    open: &[(f64, f64)],
) -> FoundDrive {
    match course(time_s, volts, open) {
        Err(issue) => FoundDrive {
            drive: None,
            issues: vec![issue.at("column voltage_v")],
        },
        Ok(course) => {
            let start = course.start;
            let (time_s, volts) = fine(&time_s[start..], &volts[start..], &course.turns, channels);
            FoundDrive {
                drive: Some(Drive::staircase(&time_s, &volts, course.rest_v.unwrap_or(0.0))),
                issues: course.issues(),
            }
        }
    }
}

/// Whether readings that lie within `within_v` of each other at one level are a wave: most changes from reading to reading, of
/// the size of `change_noise_v` if they were noise, are far larger than what scatters about a smooth course.
pub(super) fn is_wave(volts: &[f64], change_noise_v: f64, within_v: f64) -> bool {
    let (low, high) = range_of(volts.iter().copied());
    let matters = within_v > (WAVE_OF_VOLTAGE * low.abs().max(high.abs())).max(LEAST_WAVE_V);
    volts.len() >= FEWEST_OF_COURSE && matters && change_noise_v > WAVE_OVER_SCATTER * scatter(volts)
}

/// What the voltage does.
struct Course {
    kind: Waveform,
    scatter_v: f64,
    range_v: (f64, f64),
    /// The first reading of the course: the last one of the rest, the one that jumps from it, or the first where there is none.
    start: usize,
    /// Readings from there on at which it turns round.
    turns: Vec<usize>,
    /// Voltage of the rest before it; none where the record starts with the movement.
    rest_v: Option<f64>,
    first_v: f64,
}

fn course(time_s: &[f64], volts: &[f64], open: &[(f64, f64)]) -> Result<Course, Issue> {
    if volts.len() < FEWEST_OF_COURSE {
        let found = format!("the voltage moves all the time, in {} readings", volts.len());
        return Err(refused(found).mend(format!("record {FEWEST_OF_COURSE} readings or more")));
    }
    let (low, high) = range_of(volts.iter().copied());
    let range_v = high - low;
    let scatter_v = scatter(volts);
    if scatter_v > MOST_SCATTER * range_v {
        let found = format!(
            "the voltage scatters by {} V from reading to reading, within {} V: neither steps nor a course",
            significant(scatter_v, 3),
            fixed(range_v, 3)
        );
        return Err(refused(found).mend("check the voltmeter's range and wiring; it is kept and not fitted"));
    }
    let turns = turns(volts, (LEAST_TURN * range_v).max(LEAST_STEP_NOISE * scatter_v));
    let mut spacings: Vec<(usize, f64)> = turns
        .windows(2)
        .map(|pair| (pair[1] - pair[0], time_s[pair[1]] - time_s[pair[0]]))
        .collect();
    spacings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    if let Some(&(readings, half_s)) = spacings.get((SHORT_SHARE * spacings.len() as f64) as usize)
        && readings < READINGS_IN_HALF_PERIOD
    {
        let found = format!(
            "the voltage turns round every {} s where it is fastest, and is read {readings} times in that time: \
             {READINGS_IN_HALF_PERIOD} are needed",
            fixed(half_s, 3)
        );
        let mend = format!(
            "record voltage, current and bending every {} s or faster, or drive more slowly; it is kept and not fitted",
            significant(half_s / READINGS_IN_HALF_PERIOD as f64, 3)
        );
        return Err(refused(found).mend(mend));
    }
    let found_jumps = jumps(time_s, volts);
    if is_staircase(volts, scatter_v) || found_jumps.len() > jumps_of_wave(turns.len()) {
        let found = "the voltage steps and moves in between, or steps too often: neither steps nor a course, as where an open circuit is \
                     not stated";
        let mend = "say when the circuit was open, by a column open_circuit or the tag of that name; hold each of many voltages for \
                    twenty readings or more; it is kept and not fitted";
        return Err(refused(found.to_owned()).mend(mend));
    }
    if let Some(pause_s) = pause(time_s, volts, scatter_v, open) {
        let found = format!("the voltage moves, and is not read for a while after {pause_s} s");
        return Err(refused(found).mend("record it without pauses; the course between readings is not known"));
    }
    let half_period = spacings.get(spacings.len() / 2).map_or(0, |spacing| spacing.0);
    let near_v = (LEAST_STEP_NOISE * scatter_v).max(LEAST_STEP_V);
    let rest = volts
        .iter()
        .take_while(|v| (*v - volts[0]).abs() <= near_v)
        .count();
    let rests = rest >= READINGS_OF_REST.max(half_period / 4);
    // From the last reading of the rest on, unless it ends with a jump: the way from there to the first reading that moved is
    // part of the course.
    let start = match rests {
        true if found_jumps.contains(&rest) => rest,
        true => rest - 1,
        false => 0,
    };
    Ok(Course {
        kind: recognise(time_s, volts, &turns),
        scatter_v,
        range_v: (low, high),
        start,
        turns: turns.iter().filter_map(|turn| turn.checked_sub(start)).collect(),
        rest_v: rests.then(|| volts[..rest].iter().sum::<f64>() / rest as f64),
        first_v: volts[0],
    })
}

/// Whether most of the way of the voltage is made in single changes with none beside them.
fn is_staircase(volts: &[f64], scatter_v: f64) -> bool {
    let changes: Vec<f64> = volts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let counts = |change: f64| change > LEAST_STEP_NOISE * scatter_v;
    let is_alone = |three: &&[f64]| counts(three[1]) && three[1] > ALONE_FACTOR * three[0].max(three[2]);
    let alone: f64 = changes.windows(3).filter(is_alone).map(|three| three[1]).sum();
    let whole: f64 = changes.iter().filter(|change| counts(**change)).sum();
    alone > 0.5 * whole
}

/// Jumps that a voltage may have beside its turns: a ramp has none, a wave may ride on a step that comes and goes.
fn jumps_of_wave(turns: usize) -> usize {
    match turns {
        0..4 => 0,
        _ => 1 + turns / 4,
    }
}

fn refused(found: String) -> Issue {
    Issue::warning(NO_STEPS, found)
}

/// Standard deviation of the readings about a course that they follow closely, V: from fourth differences.
fn scatter(volts: &[f64]) -> f64 {
    let fourth = |v: &[f64]| (v[0] - 4.0 * v[1] + 6.0 * v[2] - 4.0 * v[3] + v[4]).abs();
    let mut sizes: Vec<f64> = volts.windows(5).map(fourth).collect();
    SD_PER_MEDIAN_DISTANCE * upper_median(&mut sizes).unwrap_or(0.0) / FOURTH
}

/// When a pause of the record starts in which the voltage moves, s.
fn pause(time_s: &[f64], volts: &[f64], scatter_v: f64, open: &[(f64, f64)]) -> Option<f64> {
    let near_v = (LEAST_STEP_NOISE * scatter_v).max(LEAST_STEP_V);
    let moves = |a: usize, b: usize| (volts[a] - volts[b]).abs() > near_v;
    let is_open = |k: usize| {
        open.iter()
            .any(|&(from, to)| from < time_s[k + 1] && to > time_s[k])
    };
    (1..volts.len().saturating_sub(2))
        .find(|&k| {
            let (before, own, after) = (
                time_s[k] - time_s[k - 1],
                time_s[k + 1] - time_s[k],
                time_s[k + 2] - time_s[k + 1],
            );
            own > MOVING_PAUSE * before.max(after) && !is_open(k) && moves(k - 1, k) && moves(k + 1, k + 2)
        })
        .map(|k| time_s[k])
}

/// The course from its start on, so finely that its staircase errs by less than the readings do: between the readings,
/// and at the times of a current that is read at others, since its answer within a step would be off by the step.
fn fine(time_s: &[f64], volts: &[f64], turns: &[usize], channels: &[Channel]) -> (Vec<f64>, Vec<f64>) {
    let breaks = jumps(time_s, volts);
    let (mut fine_s, mut fine_v) = finer(time_s, volts, turns, &breaks, STEPS_IN_HALF_PERIOD);
    let current = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::Current));
    let is_new = |t: &f64| {
        let after = fine_s.partition_point(|own| own < t);
        let (Some(before), Some(next)) = (after.checked_sub(1).map(|k| fine_s[k]), fine_s.get(after)) else {
            return false;
        };
        // Clocks of one instrument agree to less.
        (t - before).min(next - t) > 0.01 * (next - before)
    };
    let new: Vec<f64> = current.map_or(Vec::new(), |current| {
        current.time_s.iter().copied().filter(is_new).collect()
    });
    if !new.is_empty() {
        let mut all: Vec<(f64, f64)> = new.iter().map(|&t| (t, between(&fine_s, &fine_v, t))).collect();
        all.extend(fine_s.iter().copied().zip(fine_v));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        (fine_s, fine_v) = all.into_iter().unzip();
    }
    (fine_s, fine_v)
}

impl Course {
    fn issues(&self) -> Vec<Issue> {
        let (low, high) = self.range_v;
        let what = match self.kind {
            Waveform::Sine {
                frequency_hz,
                amplitude,
            } => {
                format!(
                    "{} Hz sine of {} V amplitude",
                    short(frequency_hz),
                    short(amplitude)
                )
            }
            Waveform::Triangle {
                frequency_hz,
                amplitude,
            } => {
                format!(
                    "{} Hz triangle of {} V amplitude",
                    short(frequency_hz),
                    short(amplitude)
                )
            }
            Waveform::Chirp {
                from_hz,
                to_hz,
                amplitude,
            } => format!(
                "a chirp of {2} V amplitude, whose half periods go from those of {0} Hz to those of {1} Hz",
                short(from_hz),
                short(to_hz),
                short(amplitude)
            ),
            Waveform::Other => format!("between {} V and {} V", short(low), short(high)),
        };
        let message = format!(
            "the voltage moves all the time: {what}; its readings scatter by {} of their range; the distributed \
             model and fits of whole groups leave the run out",
            significant(self.scatter_v / (high - low), 2)
        );
        let mut issues = vec![Issue::note(MOVES, message).at("column voltage_v")];
        if self.rest_v.is_none() && self.first_v.abs() > LEAST_TURN * (high - low) {
            let message = format!(
                "the record starts with {} V already applied; the sample is taken as discharged (0 V) before it",
                fixed(self.first_v, 4)
            );
            issues.push(Issue::note("start-state-assumed", message));
        }
        issues
    }
}

/// Three digits, without zeros that say nothing.
fn short(value: f64) -> String {
    plain(to_digits(value, 3))
}
