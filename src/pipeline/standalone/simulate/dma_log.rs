//! The table of a simulated modulus log: humidity program, modulus that follows it, noise, rows.

use crate::domain::number::digits;
use std::fmt::Write;

use super::dma_spec::{DmaSpec, LogSpec};
use crate::truth::{ChannelNoise, noise};

/// Random streams of runs stand below this number, those of logs above.
const FIRST_STREAM: u64 = 1 << 32;

/// The text of the log. `number` (the log's place in the spec) and the spec's seed fix the noise.
///
/// The modulus relaxes to its equilibrium at the humidity of the generator with one time constant for a rise and one
/// for a fall of the humidity; the chamber follows the generator with its own. Both are exact between holds.
pub fn dma_log(spec: &DmaSpec, log: &LogSpec, number: usize, seed: u64) -> String {
    let duration_s: f64 = spec.humidity.iter().map(|hold| hold.for_s).sum();
    let count = (duration_s / spec.every_s + 1e-9).floor() as usize + 1;
    let errors = |stream: u64, standard_deviation: f64| {
        let of_channel = ChannelNoise {
            standard_deviation,
            autocorrelation: spec.noise.autocorrelation,
            ..ChannelNoise::default()
        };
        let stream = FIRST_STREAM + 4 * number as u64 + stream;
        noise(&vec![0.0; count], &of_channel, seed, stream)
    };
    let modulus = errors(0, spec.noise.modulus_percent / 100.0 * log.dry_mpa);
    let loss = errors(1, spec.noise.loss_factor);
    let humidity = errors(2, spec.noise.relative_humidity_percent);
    let temperature = errors(3, spec.noise.temperature_c);
    let mut text = String::new();
    for line in &spec.statement {
        let _ = writeln!(text, "# {line}");
    }
    let _ = writeln!(
        text,
        "time_s,temperature_c,relative_humidity_percent,frequency_hz,storage_modulus_mpa,loss_modulus_mpa"
    );
    for k in 0..count {
        let time_s = k as f64 * spec.every_s;
        let state = state_at(spec, log, time_s);
        let complex_mpa = state.complex_mpa + modulus[k];
        let tan = state.loss_factor + loss[k];
        let storage_mpa = complex_mpa / (1.0 + tan * tan).sqrt();
        // A sensor shows no humidity below zero.
        let percent = (state.relative_humidity_percent + humidity[k]).max(0.0);
        let _ = writeln!(
            text,
            "{time_s},{},{},{},{},{}",
            digits(spec.temperature_c + temperature[k], 2),
            digits(percent, 2),
            spec.frequency_hz,
            digits(storage_mpa, 3),
            digits(storage_mpa * tan, 4)
        );
    }
    text
}

/// What the log shows at a time, without noise.
#[derive(Debug, Clone, Copy)]
struct State {
    relative_humidity_percent: f64,
    complex_mpa: f64,
    loss_factor: f64,
}

fn state_at(spec: &DmaSpec, log: &LogSpec, time_s: f64) -> State {
    let levels = spec.humidity.iter().map(|hold| hold.relative_humidity_percent);
    let low = levels.clone().fold(f64::INFINITY, f64::min);
    let high = levels.fold(f64::NEG_INFINITY, f64::max);
    // Where a humidity lies between the lowest and the highest, 0 to 1.
    let part = |percent: f64| {
        if high > low {
            (percent - low) / (high - low)
        } else {
            0.0
        }
    };
    let mut chamber = spec.humidity[0].relative_humidity_percent;
    let mut wetness = part(chamber);
    let mut start_s = 0.0;
    for hold in &spec.humidity {
        let goal = hold.relative_humidity_percent;
        let since_s = (time_s - start_s).clamp(0.0, hold.for_s);
        let tau_s = if part(goal) > wetness {
            log.wetting_s
        } else {
            log.drying_s
        };
        let lag = |tau_s: f64| {
            if tau_s > 0.0 {
                (-since_s / tau_s).exp()
            } else {
                0.0
            }
        };
        chamber = goal + (chamber - goal) * lag(spec.humidity_lag_s);
        wetness = part(goal) + (wetness - part(goal)) * lag(tau_s);
        start_s += hold.for_s;
        if time_s <= start_s {
            break;
        }
    }
    State {
        relative_humidity_percent: chamber,
        complex_mpa: log.dry_mpa + (log.humid_mpa - log.dry_mpa) * wetness,
        loss_factor: log.loss_factor[0] + (log.loss_factor[1] - log.loss_factor[0]) * wetness,
    }
}
