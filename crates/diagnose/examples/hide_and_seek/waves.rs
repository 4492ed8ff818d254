//! Voltages that move all the time, as they truly move and as their readings tell them.

use ieap_domain::Drive;

use crate::case::Drives;

/// Levels of a record of a voltage that truly moves, at least one for each reading: 600 in the fastest period of a chirp.
const TRUE_LEVELS: usize = 9_600;

/// A voltage over the record's part that has passed.
pub type Course = fn(f64) -> f64;

fn sine(part: f64) -> f64 {
    2.0 * (std::f64::consts::TAU * 8.0 * part).sin()
}

fn chirp(part: f64) -> f64 {
    2.0 * (std::f64::consts::TAU * 15.0 / 16.0_f64.ln() * (16.0_f64.powf(part) - 1.0) / 15.0).sin()
}

fn triangle(part: f64) -> f64 {
    let phase = (5.0 * part + 0.25).fract();
    4.0 * (phase - 0.5).abs() - 1.0
}

/// That course in levels about each reading, and about so many places between every two.
pub fn staircase(course: Course, read_s: &[f64], between: usize, lasting_s: f64) -> Drive {
    let read_s: Vec<f64> = std::iter::once(0.0)
        .chain(read_s.iter().copied().filter(|t| *t > 0.0))
        .collect();
    let parts = between + 1;
    let place = |pair: &[f64], part: usize| pair[0] + (pair[1] - pair[0]) * part as f64 / parts as f64;
    let time_s: Vec<f64> = read_s
        .windows(2)
        .flat_map(|pair| (0..parts).map(move |part| place(pair, part)))
        .chain(read_s.last().copied())
        .collect();
    let volts: Vec<f64> = time_s.iter().map(|t| course(t / lasting_s)).collect();
    Drive::staircase(&time_s, &volts, 0.0)
}

/// Levels between two of so many readings of a voltage that truly moves.
pub fn truly_between(readings: usize) -> usize {
    (TRUE_LEVELS / readings.max(1)).saturating_sub(1)
}

/// The courses of the first three runs of a design; none where a run is stepped.
pub fn courses(drives: Drives) -> [Option<Course>; 3] {
    match drives {
        Drives::Moving => [Some(sine), Some(chirp), Some(triangle)],
        Drives::Sine => [Some(sine), None, None],
        Drives::StepsAndSine => [None, None, Some(sine)],
        _ => [None; 3],
    }
}
