//! Readings of a channel as a diagnosis sees them: with their noise, found without the model, and made white by it.

use std::sync::Arc;

use crate::domain::{Channel, Drive, NoiseCharacter, Quantity};

use super::joint::noise::Noise;
use super::joint::readings::Response;
use super::joint::whitening::Memory;
use super::sampled::Sampled;

/// Readings behind each edge of the drive that say nothing of growth: what a model misses there looks like it.
const AT_EDGE: usize = 1;
/// One channel of a run with its noise.
#[derive(Debug, Clone)]
pub struct WhitenedChannel {
    response: Response,
    readings_per_independent: f64,
}

impl WhitenedChannel {
    /// The usable readings of `channel`; none where fewer than `needed` follow the step. Currents read while the
    /// circuit was open are left out: the drive alone says that they are zero.
    pub fn new(channel: &Channel, drive: &Drive, needed: usize) -> Option<WhitenedChannel> {
        let sampled = Sampled::new(channel, drive, channel.quantity == Quantity::Curvature);
        if sampled.after_step() < needed {
            return None;
        }
        let response = Response::new(sampled);
        let readings_per_independent = response.sampled.len() as f64 / response.effective_readings();
        Some(WhitenedChannel {
            response,
            readings_per_independent,
        })
    }

    /// The same readings with noise found anew from what `fitted` leaves of them. Smooth misfit is not taken for
    /// noise; fast transients, which no free smooth curve follows, are taken out by the fit. The standard deviation
    /// grows with what is fitted as `sqrt(1 + (per_signal fitted)^2)`.
    ///
    /// `like` lends its memory where the readings' own cannot be told.
    pub fn renoised(
        &self,
        fitted: &[f64],
        per_signal: f64,
        like: Option<&WhitenedChannel>,
    ) -> WhitenedChannel {
        let left = self.left(fitted);
        let least = self.response.noise.quantum / 12.0_f64.sqrt();
        let least = least.max(f64::MIN_POSITIVE);
        let scale = growing(fitted, per_signal);
        let noise = match like {
            Some(like) => Noise::of_rest_with(&left, &scale, least, &like.response.noise.memory),
            None => Noise::of_rest(&left, &scale, least),
        };
        let noise = Noise {
            quantum: self.response.noise.quantum,
            proportional: noise.floor * per_signal,
            ..noise
        };
        let response = Response::with_noise(self.response.sampled.clone(), noise);
        let readings_per_independent = response.sampled.len() as f64 / response.effective_readings();
        WhitenedChannel {
            response,
            readings_per_independent,
        }
    }

    /// The same readings with the memory of the noise cut to `longest` readings for an independent one, and to a fifth of
    /// all readings.
    pub fn forgetting(&self, fitted: &[f64], per_signal: f64, longest: f64) -> WhitenedChannel {
        let longest = longest.min(self.len() as f64 / 5.0).max(1.0);
        if self.readings_per_independent <= longest {
            return self.clone();
        }
        let correlation = (longest - 1.0) / (longest + 1.0);
        let mut like = self.clone();
        like.response.noise.memory = Memory::Order(vec![correlation]);
        self.renoised(fitted, per_signal, Some(&like))
    }

    /// Evidence against noise that grows as each of `per_signal` says, beside what `fitted` leaves: minus twice the log
    /// likelihood ratio to even noise, which is below zero where the readings ask for growth.
    pub fn against_growth(&self, fitted: &[f64], per_signal: &[f64]) -> Vec<f64> {
        let mut level = self.response.sampled.clone();
        level.values = fitted.into();
        let level = level.without_edges(AT_EDGE);
        let left = self.left(fitted).without_edges(AT_EDGE);
        let scales: Vec<Vec<f64>> = std::iter::once(&0.0)
            .chain(per_signal)
            .map(|per| growing(&level.values, *per))
            .collect();
        let deviances = Noise::deviances(&left, &scales, &self.response.noise.memory);
        deviances[1..].iter().map(|own| own - deviances[0]).collect()
    }

    fn left(&self, fitted: &[f64]) -> Sampled {
        let mut left = self.response.sampled.clone();
        let rest = left
            .values
            .iter()
            .zip(fitted)
            .map(|(y, f)| y - f)
            .collect::<Vec<f64>>();
        left.values = rest.into();
        left
    }

    /// Times of the readings, s.
    pub fn time_s(&self) -> &Arc<[f64]> {
        &self.response.sampled.time_s
    }

    /// Readings, canonical unit.
    pub fn values(&self) -> &Arc<[f64]> {
        &self.response.sampled.values
    }

    /// Number of readings.
    pub fn len(&self) -> usize {
        self.response.sampled.len()
    }

    /// Whether there is none; never so for one that was made.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Standard deviation of the noise of every reading, canonical unit.
    pub fn standard_deviation(&self) -> &[f64] {
        &self.response.noise.sd
    }

    /// Readings that carry as much as one independent one.
    pub fn readings_per_independent(&self) -> f64 {
        self.readings_per_independent
    }

    /// Degrees of freedom with which the size of slow noise is known.
    pub fn freedom(&self) -> f64 {
        self.response.noise.freedom
    }

    /// What the noise is like.
    pub fn character(&self) -> NoiseCharacter {
        let noise = &self.response.noise;
        let (autoregression, correlation_time_s) = match &noise.memory {
            Memory::Order(coefficients) => (coefficients.clone(), None),
            Memory::Time { correlation_time_s } => (Vec::new(), Some(*correlation_time_s)),
        };
        NoiseCharacter {
            autoregression,
            correlation_time_s,
            proportional: noise.proportional,
            quantum: noise.quantum,
        }
    }

    /// Appends measured minus `fitted`, made white and in standard deviations.
    pub fn residuals(&self, fitted: &[f64], out: &mut Vec<f64>) {
        self.response.whitened(fitted.iter().copied(), out);
    }

    /// Makes a series over the readings white, in standard deviations, in place.
    pub fn whiten(&self, series: &mut [f64]) {
        self.response.whiten(series);
    }
}

/// Standard deviation of every reading in units of that at signal zero.
fn growing(fitted: &[f64], per_signal: f64) -> Vec<f64> {
    fitted
        .iter()
        .map(|level| (per_signal * level).hypot(1.0))
        .collect()
}
