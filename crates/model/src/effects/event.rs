//! What an event that no drive caused does to readings: the courses that both channels share.

use super::{Limits, Scale, Search};
use crate::extended::Written;

/// Forms of an event.
pub(super) const COURSES: [&str; 2] = ["step", "kick"];
/// Place of the run among the parameters: size, instant, width, run.
pub(super) const RUN: usize = 3;

/// Instants looked at in every run, and the widths there in terms of the run: of the rise of a step, of the fall of a kick.
const INSTANTS: usize = 3;
const WIDTHS: [f64; 2] = [0.03, 0.1];
/// A kick rises so many times faster than it falls.
const STEEPER: f64 = 10.0;
/// Largest value of the course of a kick as it stands below.
const PEAK: f64 = 0.696_837_314_0;

/// The course of an event at a time since it in terms of its width: 0 before it, then to 1 and there, or to 1 and back.
pub(super) fn course(form: usize, x: f64) -> f64 {
    match (x > 0.0, form) {
        (false, _) => 0.0,
        (true, 0) => -(-x).exp_m1(),
        (true, _) => ((-x).exp() - (-STEEPER * x).exp()) / PEAK,
    }
}

/// What is written down with an event of that size, instant and width.
pub(super) fn written(form: usize, parameters: &[f64]) -> Written {
    let [size, at_s, width_s] = [parameters[0], parameters[1], parameters[2]];
    Box::new(move |t, value| value + size * course(form, (t - at_s) / width_s))
}

/// Where an event is sought of which the largest value of the channel is `peak`.
pub(super) fn search(form: usize, scale: &Scale, peak: f64) -> Search {
    if peak <= 0.0 {
        return Search::none();
    }
    let longest_s = scale.longest_s();
    let low_s = (0.3 * scale.shortest_s).min(longest_s / 100.0);
    let limits = vec![
        Limits::linear(-peak, peak),
        Limits::linear(0.0, longest_s),
        Limits::logarithmic(low_s, longest_s),
        Limits::held(),
    ];
    let of_run = |(run, &duration_s): (usize, &f64)| {
        let instant = move |k: usize| duration_s * (k as f64 + 0.5) / INSTANTS as f64;
        let width_s = (WIDTHS[form] * duration_s).max(low_s);
        (0..INSTANTS).map(move |k| vec![0.01 * peak, instant(k), width_s, run as f64])
    };
    Search {
        limits,
        probes: scale.durations_s.iter().enumerate().flat_map(of_run).collect(),
        absent: 0.0,
    }
}

/// Whether an event of these parameters is in that run.
pub(super) fn is_in(parameters: &[f64], run: usize) -> bool {
    parameters[RUN].round() as usize == run
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn courses_begin_at_the_event_and_reach_one() {
        for form in 0..COURSES.len() {
            let ways: Vec<f64> = (0..5000)
                .map(|k| course(form, 0.01 * f64::from(k) - 1.0))
                .collect();
            assert!(ways[..=100].iter().all(|way| *way == 0.0));
            let most = ways.iter().copied().fold(0.0, f64::max);
            assert!((most - 1.0).abs() < 1e-4, "{form}: {most}");
            assert!((ways[4999] - [1.0, 0.0][form]).abs() < 1e-9);
        }
    }
}
