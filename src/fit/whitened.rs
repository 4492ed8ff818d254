//! Readings of a channel as a diagnosis sees them: with their noise, found without the model, and made white by it.

use std::sync::Arc;

use crate::domain::{Channel, Drive, NoiseCharacter, Quantity};

use super::joint::noise::Noise;
use super::joint::readings::Response;
use super::joint::whitening::Memory;
use super::sampled::Sampled;

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
    /// noise; fast transients, which no free smooth curve follows, are taken out by the fit.
    ///
    /// `like` lends its memory where the readings' own cannot be told.
    pub fn renoised(&self, fitted: &[f64], like: Option<&WhitenedChannel>) -> WhitenedChannel {
        let sampled = self.response.sampled.clone();
        let rest: Vec<f64> = sampled.values.iter().zip(fitted).map(|(y, f)| y - f).collect();
        let mut left = sampled.clone();
        left.values = rest.into();
        let least = self.response.noise.quantum / 12.0_f64.sqrt();
        let least = least.max(f64::MIN_POSITIVE);
        let noise = match like {
            Some(like) => Noise::of_rest_with(&left, least, &like.response.noise.memory),
            None => Noise::of_rest(&left, least),
        };
        let quantum = self.response.noise.quantum;
        let response = Response::with_noise(sampled, Noise { quantum, ..noise });
        let readings_per_independent = response.sampled.len() as f64 / response.effective_readings();
        WhitenedChannel {
            response,
            readings_per_independent,
        }
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
