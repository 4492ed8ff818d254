//! The numbers of one period of a wave.

use std::f64::consts::TAU;

use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::harmonic::harmonic;

use super::of_cycle::{NO_BENDING, NO_CURRENT, Numbers, Readings, missing, ratio};
use super::policy::LEAST_IN_PERIOD;
use crate::levels::symmetric;

/// A period of a wave; `volts` are the voltage's own readings.
pub(super) fn of_wave(
    from_s: f64,
    to_s: f64,
    volts: &Readings,
    current: Option<&Readings>,
    curvature: Option<&Readings>,
) -> Numbers {
    let turn_per_s = TAU / (to_s - from_s);
    // Amplitude and its error, and the angle, about the beginning of the period.
    let wave = |of: &Readings| {
        let range = of.range(from_s, to_s);
        let (t, y) = (&of.time_s[range.clone()], &of.values[range]);
        if t.len() < LEAST_IN_PERIOD {
            return None;
        }
        let phase: Vec<f64> = t.iter().map(|t| turn_per_s * (t - from_s)).collect();
        let found = harmonic(&phase, t, y, 1)?;
        let angle = found.amplitude.im.atan2(found.amplitude.re);
        Some(((found.amplitude.magnitude(), found.half_95 / NORMAL_95), angle))
    };
    let bent = curvature.and_then(wave);
    let amplitude = match bent {
        Some(((size, error), _)) => symmetric(size, error),
        None => missing(NO_BENDING),
    };
    let flowing = current.and_then(|current| Some((current, wave(current)?)));
    let Some((current, (ampere, angle))) = flowing else {
        let none = || missing(NO_CURRENT);
        return [amplitude, none(), none(), none(), none(), none(), none()];
    };
    let range = current.range(from_s, to_s);
    let (mut inward, mut outward, mut energy) = ((0.0, 0.0f64), (0.0, 0.0f64), (0.0, 0.0f64));
    for k in range {
        let step = |a: usize, b: usize| 0.5 * (current.time_s[b] - current.time_s[a]);
        let weight = match (k.checked_sub(1), k + 1 < current.time_s.len()) {
            (Some(before), true) => step(before, k) + step(k, k + 1),
            (Some(before), false) => step(before, k),
            (None, true) => step(k, k + 1),
            (None, false) => 0.0,
        };
        let (t, flow) = (current.time_s[k], current.values[k] * weight);
        let error = current.noise * weight;
        // Which way it flows is told by the wave: noise about zero would be counted as charge both ways.
        let into = if (angle + turn_per_s * (t - from_s)).cos() > 0.0 {
            &mut inward
        } else {
            &mut outward
        };
        into.0 += flow;
        into.1 = into.1.hypot(error);
        let volt = ieap_numerics::waveform::between(volts.time_s, volts.values, t);
        energy.0 += volt * flow;
        energy.1 = energy.1.hypot(volt * error);
    }
    let outward = (-outward.0, outward.1);
    let alpha = match bent {
        // The charge of a wave is its current over the angular frequency.
        Some((size, _)) => ratio(size, (ampere.0 / turn_per_s, ampere.1 / turn_per_s), 1.0),
        None => missing(NO_BENDING),
    };
    let impedance = match wave(volts) {
        Some((volt, _)) => ratio(volt, ampere, 1.0),
        None => missing("the cycle has no readings of the voltage"),
    };
    [
        amplitude,
        symmetric(inward.0, inward.1),
        symmetric(outward.0, outward.1),
        ratio(outward, inward, 100.0),
        symmetric(1e3 * energy.0, 1e3 * energy.1),
        alpha,
        impedance,
    ]
}
