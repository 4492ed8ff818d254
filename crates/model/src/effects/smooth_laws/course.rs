//! What the drive or a sensor beside the strip says ahead of a variable in a run, as a law follows it.

use ieap_domain::{ClimateQuantity, Segment};

use crate::extended::RunContext;

/// Times at which a course is kept: finer than sensors of the air answer in any run.
const PLACES: usize = 241;

/// A variable over a run; times are since the start of its drive, s.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Course {
    /// At evenly spaced times from the first on, along straight lines between them.
    Even {
        first_s: f64,
        step_s: f64,
        values: Vec<f64>,
    },
    /// From each time on; 0 before.
    Steps(Vec<(f64, f64)>),
}

impl Course {
    /// The course of a quantity over a run, coming `late_s` behind what the sensor read; none where none read it.
    pub(super) fn logged(run: &RunContext, quantity: ClimateQuantity, late_s: f64) -> Option<Course> {
        let (time_s, values) = run.logged(quantity)?.included();
        // What came before the run is still felt in it: as long before as it lasts, where that was read.
        let earliest_s = 2.0 * run.start_s() - run.duration_s;
        let first_s = time_s.first()?.max(earliest_s).min(run.start_s());
        let step_s = (run.duration_s - first_s) / (PLACES - 1) as f64;
        let read = |k: usize| read_at(&time_s, &values, first_s + step_s * k as f64);
        let read: Vec<f64> = (0..PLACES).map(read).collect();
        Some(Course::Even {
            first_s: first_s - run.start_s(),
            step_s,
            values: if late_s > 0.0 {
                late(&read, step_s / late_s)
            } else {
                read
            },
        })
    }

    /// What each change of the voltage makes of a value: `next` of the volts that it goes to and the value before; under an open circuit it
    /// goes nowhere.
    pub(super) fn of_edges(run: &RunContext, next: impl Fn(f64, f64) -> f64) -> Course {
        let mut value = 0.0;
        let segments = run.drive.segments.iter();
        let step = |segment: &Segment| {
            value = segment.level.volts().map_or(value, |volts| next(volts, value));
            (segment.start_s() - run.start_s(), value)
        };
        Course::Steps(segments.map(step).collect())
    }

    /// Its value at a time since the start of the drive, s; beyond its ends that at the end.
    pub(super) fn at(&self, clock_s: f64) -> f64 {
        match self {
            Course::Even {
                first_s,
                step_s,
                values,
            } => {
                let place = ((clock_s - first_s) / step_s).clamp(0.0, (PLACES - 1) as f64);
                let below = (place as usize).min(PLACES - 2);
                let part = place - below as f64;
                values[below] + part * (values[below + 1] - values[below])
            }
            Course::Steps(steps) => {
                let begun = steps.partition_point(|(from_s, _)| *from_s <= clock_s);
                begun.checked_sub(1).map_or(0.0, |last| steps[last].1)
            }
        }
    }
}

/// A reading between those that it lies between; beyond them the nearest.
fn read_at(time_s: &[f64], values: &[f64], at_s: f64) -> f64 {
    let next = time_s.partition_point(|t| *t < at_s);
    if next == 0 || next == time_s.len() {
        return values[next.min(time_s.len() - 1)];
    }
    let part = (at_s - time_s[next - 1]) / (time_s[next] - time_s[next - 1]);
    values[next - 1] + part * (values[next] - values[next - 1])
}

/// The solution y of y' = x - y from y = x on, where x goes along straight lines between values `step` apart.
fn late(x: &[f64], step: f64) -> Vec<f64> {
    let kept = (-step).exp();
    let mut behind = 0.0;
    let mut each = x.to_vec();
    for (pair, own) in x.windows(2).zip(&mut each[1..]) {
        let rise = (pair[1] - pair[0]) / step;
        behind = rise + (behind - rise) * kept;
        *own -= behind;
    }
    each
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside the closed forms of a ramp and of a sine, from rest.
    #[test]
    fn what_comes_late_obeys_its_equation() {
        let step = 0.02;
        let t = |k: usize| step * k as f64;
        let ramp: Vec<f64> = (0..400).map(t).collect();
        for (k, own) in late(&ramp, step).iter().enumerate() {
            assert!((own - (t(k) - 1.0 + (-t(k)).exp())).abs() < 1e-9, "{k}: {own}");
        }
        let sine: Vec<f64> = (0..400).map(|k| t(k).sin()).collect();
        for (k, own) in late(&sine, step).iter().enumerate() {
            let exact = 0.5 * (t(k).sin() - t(k).cos() + (-t(k)).exp());
            assert!((own - exact).abs() < 1e-4, "{k}: {own} for {exact}");
        }
    }

    #[test]
    fn readings_hold_beyond_their_ends() {
        let read = |at| read_at(&[1.0, 2.0, 4.0], &[10.0, 20.0, 10.0], at);
        assert_eq!([0.0, 1.5, 3.0, 9.0].map(read), [10.0, 15.0, 15.0, 10.0]);
    }
}
