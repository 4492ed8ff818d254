//! Stretches of a wave with the phase that the voltage itself has in them, and the response per volt in each.

use std::f64::consts::{PI, TAU};

use ieap_numerics::harmonic::harmonic;
use ieap_numerics::symmetric::Symmetric;
use ieap_numerics::waveform::crossings_s;

use super::PerVolt;

/// Degree of the slow trend beside the wave, which takes up the way from rest into the lasting wave.
const TREND: usize = 3;
/// Readings of a response that a window needs in a period.
const LEAST_IN_PERIOD: f64 = 8.0;

/// Some periods of a wave.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    from_s: f64,
    to_s: f64,
    /// Middle of it, s, and the phase (radians) about it: by powers of the time from there.
    middle_s: f64,
    phase: Vec<f64>,
    pub(super) frequency_hz: f64,
}

impl Window {
    fn phase_at(&self, t: f64) -> f64 {
        let x = t - self.middle_s;
        self.phase.iter().rev().fold(0.0, |sum, term| sum * x + term)
    }
}

/// Windows of so many whole periods one after the other; none: one of all periods but the first, in which the wave sets in.
pub(super) fn windows(time_s: &[f64], volts: &[f64], turns: &[usize], periods: Option<usize>) -> Vec<Window> {
    let crossings = crossings_s(time_s, volts, turns);
    match periods {
        Some(periods) => {
            let at = |first: usize| window(crossings.get(first..=first + 2 * periods)?, 3);
            (0..crossings.len()).step_by(2 * periods).filter_map(at).collect()
        }
        None => {
            // Whole periods: an odd number of crossings.
            let last = crossings.len() - 1;
            let first = if last > 4 { 2 + last % 2 } else { last % 2 };
            window(&crossings[first..], 1).into_iter().collect()
        }
    }
}

/// The window of these crossings, at each of which half a period is over, with a phase of that degree in time.
fn window(crossings_s: &[f64], degree: usize) -> Option<Window> {
    let (from_s, to_s) = (*crossings_s.first()?, *crossings_s.last()?);
    let middle_s = 0.5 * (from_s + to_s);
    let half_s = 0.5 * (to_s - from_s);
    let row = |t: &f64| -> Vec<f64> {
        (0..=degree)
            .map(|power| ((t - middle_s) / half_s).powi(power as i32))
            .collect()
    };
    let rows: Vec<Vec<f64>> = crossings_s.iter().map(row).collect();
    let normal = Symmetric::from_fn(degree + 1, |a, b| rows.iter().map(|row| row[a] * row[b]).sum());
    let right: Vec<f64> = (0..=degree)
        .map(|a| {
            rows.iter()
                .enumerate()
                .map(|(k, row)| row[a] * PI * k as f64)
                .sum()
        })
        .collect();
    let scaled = normal.cholesky(1e-12)?.solve(&right);
    let phase: Vec<f64> = scaled
        .iter()
        .enumerate()
        .map(|(power, term)| term / half_s.powi(power as i32))
        .collect();
    Some(Window {
        from_s,
        to_s,
        middle_s,
        frequency_hz: phase[1] / TAU,
        phase,
    })
}

/// The response per volt in a window: both as waves of the voltage's phase beside a trend.
pub(super) fn per_volt(
    window: &Window,
    (time_s, volts): (&[f64], &[f64]),
    (own_s, values): (&[f64], &[f64]),
) -> Option<PerVolt> {
    let of = |time_s: &[f64], values: &[f64]| {
        let range =
            time_s.partition_point(|t| *t < window.from_s)..time_s.partition_point(|t| *t < window.to_s);
        let periods = (window.to_s - window.from_s) * window.frequency_hz;
        if (range.len() as f64) < LEAST_IN_PERIOD * periods {
            return None;
        }
        let phase: Vec<f64> = time_s[range.clone()]
            .iter()
            .map(|t| window.phase_at(*t))
            .collect();
        harmonic(&phase, &time_s[range.clone()], &values[range], TREND)
    };
    let (voltage, own) = (of(time_s, volts)?, of(own_s, values)?);
    let value = own.amplitude / voltage.amplitude;
    let size_v = voltage.amplitude.magnitude();
    let half_95 = (own.half_95 / size_v).hypot(value.magnitude() * voltage.half_95 / size_v);
    value
        .magnitude()
        .is_finite()
        .then_some(PerVolt { value, half_95 })
}
