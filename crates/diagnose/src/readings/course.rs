//! The staircase of a voltage that moves all the time, made as fine as a diagnosis needs it.
//!
//! A level held about a reading is right at the reading's own time only to the square of its length: the charge of a fast
//! branch has met the level for half of it. What a fit of one run takes up in its parameters, a diagnosis of several runs sees.

use ieap_domain::{Drive, Segment, range_of};
use ieap_numerics::waveform::{LEAST_TURN, finer, turns};

use crate::levels::STEPS_IN_HALF_PERIOD;

/// The same course in levels that are enough; other drives, and those with an open circuit in them, stay what they are. So does
/// a course of levels that are stated, each held until the next: it truly goes in steps.
pub(crate) fn followed(drive: &Drive) -> Drive {
    let levels: Option<Vec<f64>> = drive.levels().map(|(_, volts)| volts).collect();
    match levels {
        Some(levels_v) if drive.moves() => {
            let Some(time_s) = middles_s(drive) else {
                return drive.clone();
            };
            let jumps: Vec<usize> = (1..levels_v.len())
                .filter(|&k| is_jump(&drive.segments[k]))
                .collect();
            let (low, high) = range_of(levels_v.iter().copied());
            let turns = turns(&levels_v, LEAST_TURN * (high - low));
            let (time_s, levels_v) = finer(&time_s, &levels_v, &turns, &jumps, STEPS_IN_HALF_PERIOD);
            Drive::staircase(&time_s, &levels_v, drive.baseline_v)
        }
        _ => drive.clone(),
    }
}

/// The times of the readings that [`Drive::staircase`] made these levels of: each level begins midway between two, or at its own
/// where it is reached by a jump. None where they would lie outside of their levels: no readings made these.
fn middles_s(drive: &Drive) -> Option<Vec<f64>> {
    let mut time_s: Vec<f64> = Vec::with_capacity(drive.segments.len());
    for segment in &drive.segments {
        time_s.push(match time_s.last() {
            Some(before_s) if !is_jump(segment) => 2.0 * segment.start_s() - before_s,
            _ => segment.start_s(),
        });
    }
    let mut ends_s = drive.segments.iter().skip(1).map(|next| next.start_s());
    let is_within = |(segment, t): (&Segment, &f64)| {
        let end_s = ends_s.next().unwrap_or(f64::INFINITY);
        (segment.start_s()..end_s).contains(t)
    };
    drive
        .segments
        .iter()
        .zip(&time_s)
        .all(is_within)
        .then_some(time_s)
}

/// Whether a level of a staircase is reached by a jump, which its readings have between them.
fn is_jump(segment: &Segment) -> bool {
    !segment.edge.is_stated()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Level;

    #[test]
    fn a_finer_staircase_goes_through_the_same_readings_and_jumps_where_it_did() {
        let time_s: Vec<f64> = (0..200)
            .map(|k| 0.5 * f64::from(k) + 0.1 * f64::from(k % 3))
            .collect();
        let course = |t: f64| (t / 6.0).sin() + if t < 40.0 { 0.0 } else { 1.5 };
        let levels_v: Vec<f64> = time_s.iter().map(|t| course(*t)).collect();
        let drive = Drive::staircase(&time_s, &levels_v, 0.0);
        let middles = middles_s(&drive).unwrap();
        assert!(middles.iter().zip(&time_s).all(|(a, b)| (a - b).abs() < 1e-9));
        let fine = followed(&drive);
        assert!(fine.segments.len() > 1000, "{}", fine.segments.len());
        let at = |t: f64| fine.level_at(t).volts().unwrap_or(0.0);
        let off = time_s[1..]
            .iter()
            .map(|t| (at(*t) - course(*t)).abs())
            .fold(0.0, f64::max);
        assert!(off < 1e-9, "{off}");
        let between = (100..900)
            .map(|k| 0.1 * f64::from(k))
            .filter(|t| (t - 40.0).abs() > 0.7);
        let off = between.map(|t| (at(t) - course(t)).abs()).fold(0.0, f64::max);
        assert!(off < 0.02, "{off}");
    }

    #[test]
    fn steps_and_open_circuits_stay_what_they_are() {
        let mut drive = Drive::step(2.0);
        assert_eq!(followed(&drive), drive);
        drive.segments.push(Segment::at(10.0, Level::OpenCircuit));
        assert_eq!(followed(&drive), drive);
        let held = |k: u32| Segment::at(f64::from(k), Level::Voltage((f64::from(k) / 10.0).sin()));
        let stated = Drive {
            baseline_v: 0.0,
            segments: (0..200).map(held).collect(),
        };
        assert!(stated.moves());
        assert_eq!(followed(&stated), stated);
    }
}
