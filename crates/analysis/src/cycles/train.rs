//! Where the cycles of a train begin: held voltages that come again and again, or the periods of a sine or a triangle.

use super::policy::{FEWEST_CYCLES, MOST_LEVELS, MOSTLY, SAME};
use crate::levels::{Level, levels};

use ieap_domain::{Drive, Level as Source};
use ieap_numerics::waveform::{LEAST_TURN, Waveform, crossings_s, recognise, turns};

/// A train of cycles.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Train {
    /// Levels of each cycle.
    Held(Vec<Vec<Level>>),
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

fn held(drive: &Drive, last_s: f64) -> Option<Train> {
    // None of an open circuit, in which charge does not flow and no voltage is known.
    let all: Vec<Level> = levels(drive, last_s).into_iter().collect::<Option<_>>()?;
    let range = ieap_domain::range_of(all.iter().map(|level| level.voltage_v));
    let same = |a: &Level, b: &Level| {
        let (long, short) = (a.held_s(), b.held_s());
        // Edges between readings lie anywhere there.
        let open_s = [a.from, a.until, b.from, b.until].map(|edge| 0.5 * edge.open_s());
        (a.voltage_v - b.voltage_v).abs() <= SAME * (range.1 - range.0)
            && (long - short).abs() <= SAME * long.max(short) + open_s.iter().sum::<f64>()
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
    let model: Vec<Level> = all[first..first + period].to_vec();
    let is_cycle = |levels: &&[Level]| levels.iter().zip(&model).all(|(own, of)| same(own, of));
    let cycles: Vec<Vec<Level>> = all[first..]
        .chunks_exact(period)
        .filter(is_cycle)
        .map(<[Level]>::to_vec)
        .collect();
    (cycles.len() >= FEWEST_CYCLES).then_some(Train::Held(cycles))
}

fn wave(drive: &Drive) -> Option<Train> {
    let pairs = drive.segments.windows(2).filter_map(|pair| match pair[0].level {
        Source::Voltage(volts) => Some((0.5 * (pair[0].start_s() + pair[1].start_s()), volts)),
        Source::OpenCircuit => None,
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
