//! Where the cycles of a train begin: held voltages that come again and again, or the periods of a sine or a triangle.

use super::policy::{FEWEST_CYCLES, MOST_LEVELS, MOSTLY, SAME};

use ieap_domain::{Drive, Level};
use ieap_numerics::waveform::{LEAST_TURN, Waveform, crossings_s, recognise, turns};

/// A stretch of constant voltage in a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Held {
    pub from_s: f64,
    pub to_s: f64,
    pub voltage_v: f64,
}

/// A train of cycles.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Train {
    /// Levels of each cycle.
    Held(Vec<Vec<Held>>),
    /// Beginnings of the periods, s, and the end of the last.
    Wave(Vec<f64>),
}

/// The train that a drive is; none where it is none.
pub(super) fn train(drive: &Drive, last_s: f64) -> Option<Train> {
    if drive.moves() {
        wave(drive)
    } else {
        held(drive, last_s)
    }
}

/// Stretches of the drive; none for an open circuit, in which charge does not flow and no voltage is known.
fn stretches(drive: &Drive, last_s: f64) -> Option<Vec<Held>> {
    let ends = drive.segments.iter().skip(1).map(|next| next.start_s());
    let stretch = |(segment, to_s): (&ieap_domain::Segment, f64)| match segment.level {
        Level::Voltage(voltage_v) => Some(Held {
            from_s: segment.start_s(),
            to_s,
            voltage_v,
        }),
        Level::OpenCircuit => None,
    };
    drive
        .segments
        .iter()
        .zip(ends.chain([last_s]))
        .map(stretch)
        .collect()
}

fn held(drive: &Drive, last_s: f64) -> Option<Train> {
    let all = stretches(drive, last_s)?;
    let range = ieap_domain::range_of(all.iter().map(|held| held.voltage_v));
    let same = |a: &Held, b: &Held| {
        let (long, short) = (a.to_s - a.from_s, b.to_s - b.from_s);
        (a.voltage_v - b.voltage_v).abs() <= SAME * (range.1 - range.0)
            && (long - short).abs() <= SAME * long.max(short)
    };
    // The last level may be cut short.
    let whole = all.len().checked_sub(1)?;
    let repeats = |period: &usize| {
        let pairs = whole.saturating_sub(*period);
        let alike = (0..pairs).filter(|&k| same(&all[k], &all[k + period])).count();
        pairs >= (FEWEST_CYCLES - 1) * period && alike as f64 >= MOSTLY * pairs as f64
    };
    let period = (2..=MOST_LEVELS).find(repeats)?;
    // A cycle begins where its levels begin to come again.
    let first = (0..whole.saturating_sub(period)).find(|&k| same(&all[k], &all[k + period]))?;
    let model: Vec<Held> = all[first..first + period].to_vec();
    let is_cycle = |levels: &&[Held]| levels.iter().zip(&model).all(|(own, of)| same(own, of));
    let cycles: Vec<Vec<Held>> = all[first..]
        .chunks_exact(period)
        .filter(is_cycle)
        .map(<[Held]>::to_vec)
        .collect();
    (cycles.len() >= FEWEST_CYCLES).then_some(Train::Held(cycles))
}

fn wave(drive: &Drive) -> Option<Train> {
    let pairs = drive.segments.windows(2).filter_map(|pair| match pair[0].level {
        Level::Voltage(volts) => Some((0.5 * (pair[0].start_s() + pair[1].start_s()), volts)),
        Level::OpenCircuit => None,
    });
    let (time_s, volts): (Vec<f64>, Vec<f64>) = pairs.unzip();
    let range = ieap_domain::range_of(volts.iter().copied());
    let turns = turns(&volts, LEAST_TURN * (range.1 - range.0));
    match recognise(&time_s, &volts, &turns) {
        Waveform::Sine { .. } | Waveform::Triangle { .. } => {}
        Waveform::Chirp { .. } | Waveform::Other => return None,
    }
    let crossings = crossings_s(&time_s, &volts, &turns);
    let starts: Vec<f64> = crossings.into_iter().step_by(2).collect();
    (starts.len() > FEWEST_CYCLES).then_some(Train::Wave(starts))
}
