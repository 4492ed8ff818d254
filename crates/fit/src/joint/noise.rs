//! Noise of a channel without the circuit: size, memory, growth with the signal, steps of the converter.
//!
//! The smooth part is a free sum of exponentials (of either sign, spread over the record), which follows any
//! relaxation; what it leaves is judged by restricted likelihood, so that the smooth part costs no bias.

mod again;
mod autocorrelation;
mod columns;
mod growth;
mod lagged;
mod memory;
mod shared;
mod short_shapes;
pub(crate) mod slow;
mod smooth;
mod spread;
#[cfg(test)]
mod tests;
mod tried;

use ieap_domain::Estimate;

use crate::sampled::Sampled;

use super::whitening::{Autocorrelation, Whitener};

pub(crate) use again::Again;
use growth::growth;
pub(crate) use lagged::{Products, products, white};
use smooth::Smooth;

/// Noise of one channel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation of every reading.
    pub(crate) sd: Vec<f64>,
    /// Standard deviation where the signal is zero.
    pub(crate) floor: f64,
    /// Part of the standard deviation that goes with the signal, per signal; 0 for even noise.
    pub(crate) proportional: f64,
    /// Memory.
    pub(crate) autocorrelation: Autocorrelation,
    /// Step of the converter, 0 where none is seen.
    pub(crate) quantum: f64,
    /// Degrees of freedom that the size of slow noise is known with.
    pub(crate) freedom: f64,
    /// Minus twice the log likelihood of every correlation that was tried; empty where the memory is of another kind or
    /// was given.
    pub(crate) by_correlation: Vec<f64>,
}

impl Noise {
    /// Noise of the readings; never below `least`, the size of rounding.
    pub(crate) fn of(sampled: &Sampled, least: f64) -> Noise {
        let smooth = Smooth::of(sampled);
        let quantum = quantum(&sampled.values);
        let least = least.max(quantum / 12.0_f64.sqrt()).max(f64::MIN_POSITIVE);
        let shape = growth(&smooth, sampled);
        let noise = Noise::of_smoothed(&smooth, sampled, &shape.scale, least);
        Noise {
            proportional: noise.floor * shape.per_signal,
            quantum,
            ..noise
        }
    }

    /// The same where a fit has `left` so much of the readings. What the readings alone show to grow with the signal may be a
    /// transient that their smooth part does not follow: it is noise only where the fit does not follow it either.
    pub(crate) fn beside_fit(sampled: &Sampled, left: &[f64], least: f64) -> Noise {
        let alone = Noise::of(sampled, least);
        if alone.proportional == 0.0 || left.len() != sampled.len() {
            return alone;
        }
        let mut rest = sampled.clone();
        rest.values = left.into();
        let mut smooth = Smooth::of(&rest);
        let readings = sampled.values.iter().zip(left);
        smooth.level = readings.map(|(reading, left)| reading - left).collect();
        let least = least.max(alone.quantum / 12.0_f64.sqrt()).max(f64::MIN_POSITIVE);
        let shape = growth(&smooth, &rest);
        let noise = Noise::of_smoothed(&smooth, &rest, &shape.scale, least);
        Noise {
            proportional: noise.floor * shape.per_signal,
            quantum: alone.quantum,
            ..noise
        }
    }

    /// Noise of what a fit has left, growing as `scale` says: the smooth part of the rest is misfit, and counts for no
    /// noise.
    pub(crate) fn of_rest(rest: &Sampled, scale: &[f64], least: f64) -> Noise {
        Noise::of_smoothed(&Smooth::of(rest), rest, scale, least)
    }

    /// Minus twice the restricted log likelihood of noise of each of the `scales` and that memory, where a fit has left
    /// `rest`.
    pub(crate) fn deviances(
        rest: &Sampled,
        scales: &[Vec<f64>],
        autocorrelation: &Autocorrelation,
    ) -> Vec<f64> {
        let smooth = Smooth::of(rest);
        let deviance = |scale: &Vec<f64>| smooth.deviance(rest, scale, autocorrelation).0;
        scales.iter().map(deviance).collect()
    }

    /// The one correlation that all these noises have; none where their memories are of different kinds or sizes.
    pub(crate) fn shared_correlation(noises: &[&Noise]) -> Option<f64> {
        let curves: Vec<&[f64]> = noises
            .iter()
            .map(|noise| noise.by_correlation.as_slice())
            .collect();
        if curves.iter().any(|curve| curve.is_empty()) {
            None
        } else {
            shared::shared(&curves)
        }
    }

    /// The same with a correlation that `among` channels share, whose memory all of them tell.
    pub(crate) fn of_rest_shared(
        rest: &Sampled,
        scale: &[f64],
        least: f64,
        correlation: f64,
        among: usize,
    ) -> Noise {
        let autocorrelation = Autocorrelation::Order(vec![correlation]);
        let crowding = autocorrelation.readings_per_independent(1.0).max(1.0);
        let noise = Noise::of_rest_with(rest, scale, least, &autocorrelation);
        Noise {
            freedom: noise.freedom * (1.0 + 2.0 * crowding) / (1.0 + 2.0 * crowding / among as f64),
            ..noise
        }
    }

    /// The same with a memory known from elsewhere.
    pub(crate) fn of_rest_with(
        rest: &Sampled,
        scale: &[f64],
        least: f64,
        autocorrelation: &Autocorrelation,
    ) -> Noise {
        let smooth = Smooth::of(rest);
        let variance = smooth.deviance(rest, scale, autocorrelation).1;
        let crowding = crowding(rest, autocorrelation);
        Noise::sized(
            scale,
            variance.sqrt().max(least),
            autocorrelation.clone(),
            (rest.len() as f64 - smooth.terms()) / (1.0 + 2.0 * crowding),
        )
    }

    fn of_smoothed(smooth: &Smooth, sampled: &Sampled, scale: &[f64], least: f64) -> Noise {
        let found = smooth.autocorrelation(sampled, scale);
        // The logarithm of slow noise's variance is known to 2/n from its size and, the correlation being
        // known to (1-rho2)/n, to 4 (1+rho)/(1-rho)/n from its memory.
        let from_size = (sampled.len() as f64 - smooth.terms()).max(1.0);
        let freedom = if found.autocorrelation == Autocorrelation::Order(Vec::new()) {
            from_size
        } else {
            from_size / (1.0 + 2.0 * crowding(sampled, &found.autocorrelation))
        };
        let floor = found.standard_deviation.max(least);
        Noise {
            by_correlation: found.by_correlation,
            ..Noise::sized(scale, floor, found.autocorrelation, freedom)
        }
    }

    /// Of that size at no signal and that memory, growing as `scale` says.
    fn sized(scale: &[f64], floor: f64, autocorrelation: Autocorrelation, freedom: f64) -> Noise {
        Noise {
            sd: scale.iter().map(|scale| floor * scale).collect(),
            floor,
            proportional: 0.0,
            autocorrelation,
            quantum: 0.0,
            by_correlation: Vec::new(),
            freedom: freedom.max(1.0),
        }
    }

    /// Correlation of neighbouring readings, with its interval.
    pub(crate) fn memory(&self) -> Estimate {
        memory::estimate(&self.autocorrelation, &self.by_correlation)
    }

    /// The whitener that belongs to it.
    pub(crate) fn whitener(&self, sampled: &Sampled) -> Whitener {
        Whitener::new(sampled, &self.sd, &self.autocorrelation)
    }
}

/// How many readings carry as much as one independent one.
pub(crate) fn crowding(sampled: &Sampled, autocorrelation: &Autocorrelation) -> f64 {
    let (shortest_s, _) = sampled.time_scales_s();
    autocorrelation.readings_per_independent(shortest_s).max(1.0)
}

/// Step of the converter: the readings are whole multiples of it and few levels are taken; 0 where they are not.
fn quantum(values: &[f64]) -> f64 {
    let mut levels: Vec<f64> = values.to_vec();
    levels.sort_unstable_by(f64::total_cmp);
    let span = levels
        .last()
        .zip(levels.first())
        .map_or(0.0, |(last, first)| last - first);
    let gaps: Vec<f64> = levels
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > 1e-12 * span)
        .collect();
    // Free values hardly ever repeat: a converter's step shows where most readings share their level.
    if gaps.len() * 3 > values.len() * 2 || gaps.is_empty() {
        return 0.0;
    }
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let whole =
        |gap: &f64| (gap / least - (gap / least).round()).abs() < 0.02 * (gap / least).clamp(1.0, 20.0);
    if gaps.iter().all(whole) { least } else { 0.0 }
}
