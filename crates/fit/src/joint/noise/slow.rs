//! Slow noise beside white: a correlation that dies away over many readings, in a part of the noise.
//!
//! An autoregression of low order knows neighbours only. What an amplifier, a lamp or a room does over minutes is seen beside
//! the white noise of the readings alone, and makes smooth residuals that no model owes an answer to.

use crate::joint::policy::{
    FLICKER_FROM_READINGS, FLICKER_TO_RECORDS, SLOW_FROM_READINGS, SLOW_PARTS, SLOW_TO_RECORDS,
};
use crate::joint::whitening::{Autocorrelation, Process};
use crate::sampled::Sampled;

use super::smooth::Smooth;

/// Correlation times that are tried: each so many times the one before.
const RATIO: f64 = 2.5;
/// Noise of which every octave has as much (1/f) is made of processes of which each lasts so many times as long as the one
/// before.
const OCTAVES: f64 = 4.0;

/// The memories that are tried on a channel.
pub(crate) fn tried(of: &Sampled) -> Vec<Autocorrelation> {
    let count = of.len();
    let lasting_s = of.time_s[count - 1] - of.time_s[0];
    let step_s = lasting_s / count as f64;
    let times = |from_s: f64, ratio: f64, to_s: f64| {
        (0..)
            .map(move |k| from_s * ratio.powi(k))
            .take_while(move |time_s| *time_s <= to_s)
    };
    let of_processes = |times_s: Vec<f64>| {
        let count = times_s.len().max(1) as f64;
        SLOW_PARTS.map(|part| {
            let process = |&correlation_time_s: &f64| Process {
                correlation_time_s,
                part: part / count,
            };
            Autocorrelation::Slow(times_s.iter().map(process).collect())
        })
    };
    let single =
        times(SLOW_FROM_READINGS * step_s, RATIO, SLOW_TO_RECORDS * lasting_s).map(|time_s| vec![time_s]);
    let flicker: Vec<f64> = times(
        FLICKER_FROM_READINGS * step_s,
        OCTAVES,
        FLICKER_TO_RECORDS * lasting_s,
    )
    .collect();
    single.chain([flicker]).flat_map(of_processes).collect()
}

/// Minus twice the restricted log likelihood of each of these memories, where a fit has left `rest`.
pub(crate) fn deviances(rest: &Sampled, scale: &[f64], memories: &[Autocorrelation]) -> Vec<f64> {
    let smooth = Smooth::of(rest);
    memories
        .iter()
        .map(|memory| smooth.deviance(rest, scale, memory).0)
        .collect()
}
