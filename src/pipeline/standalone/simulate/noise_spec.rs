//! The noise of a spec.

use serde::Deserialize;

use super::wrong::{Wrong, from_zero};
use crate::truth::ChannelNoise;

/// Gaussian noise with a lag-1 correlation between neighbouring readings, and what else spoils readings.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Standard deviation of the current where there is none, A.
    pub current_a: f64,
    /// Standard deviation of the curvature where there is none, 1/cm.
    pub curvature_per_cm: f64,
    /// Lag-1 autocorrelation of both channels, 0 to below 1.
    #[serde(default)]
    pub autocorrelation: f64,
    /// That of the current, in place of `autocorrelation`.
    pub current_autocorrelation: Option<f64>,
    /// That of the curvature, in place of `autocorrelation`.
    pub curvature_autocorrelation: Option<f64>,
    /// Share c of the current in its noise: sigma^2 = s0^2 + (c i)^2.
    #[serde(default)]
    pub current_proportional: f64,
    /// Share c of the curvature in its noise.
    #[serde(default)]
    pub curvature_proportional: f64,
    /// Smallest step of the printed current, A; 0: not quantised.
    #[serde(default)]
    pub current_step_a: f64,
    /// Smallest step of the printed curvature, 1/cm; 0: not quantised.
    #[serde(default)]
    pub curvature_step_per_cm: f64,
    /// Share of the readings of both channels that are outliers.
    #[serde(default)]
    pub outlier_fraction: f64,
    /// Distance of an outlier, standard deviations.
    #[serde(default = "eight")]
    pub outlier_size_sigma: f64,
}

fn eight() -> f64 {
    8.0
}

impl Default for Noise {
    /// None at all.
    fn default() -> Noise {
        Noise {
            current_a: 0.0,
            curvature_per_cm: 0.0,
            autocorrelation: 0.0,
            current_autocorrelation: None,
            curvature_autocorrelation: None,
            current_proportional: 0.0,
            curvature_proportional: 0.0,
            current_step_a: 0.0,
            curvature_step_per_cm: 0.0,
            outlier_fraction: 0.0,
            outlier_size_sigma: eight(),
        }
    }
}

impl Noise {
    pub(super) fn check(&self) -> Result<(), Wrong> {
        let correlations = [
            ("noise.autocorrelation", Some(self.autocorrelation)),
            ("noise.current_autocorrelation", self.current_autocorrelation),
            ("noise.curvature_autocorrelation", self.curvature_autocorrelation),
        ];
        let given = correlations
            .into_iter()
            .filter_map(|(place, own)| Some((place, own?)));
        let is_below_one = |part: f64| (0.0..1.0).contains(&part);
        Wrong::unless_all(given, is_below_one, "a number from 0 to below 1")?;
        let outliers = [("noise.outlier_fraction", self.outlier_fraction)];
        let is_part = |part: f64| (0.0..=1.0).contains(&part);
        Wrong::unless_all(outliers, is_part, "a number from 0 to 1")?;
        let sizes = [
            ("noise.current_a", self.current_a),
            ("noise.curvature_per_cm", self.curvature_per_cm),
            ("noise.current_proportional", self.current_proportional),
            ("noise.curvature_proportional", self.curvature_proportional),
            ("noise.current_step_a", self.current_step_a),
            ("noise.curvature_step_per_cm", self.curvature_step_per_cm),
            ("noise.outlier_size_sigma", self.outlier_size_sigma),
        ];
        Wrong::unless_all(sizes, from_zero, "a number of 0 or above")
    }

    /// Noise of the current, A.
    pub fn current(&self) -> ChannelNoise {
        ChannelNoise {
            standard_deviation: self.current_a,
            autocorrelation: self.current_autocorrelation.unwrap_or(self.autocorrelation),
            proportional: self.current_proportional,
            step: self.current_step_a,
            outlier_fraction: self.outlier_fraction,
            outlier_size_sigma: self.outlier_size_sigma,
        }
    }

    /// Noise of the curvature, 1/cm.
    pub fn curvature(&self) -> ChannelNoise {
        ChannelNoise {
            standard_deviation: self.curvature_per_cm,
            autocorrelation: self.curvature_autocorrelation.unwrap_or(self.autocorrelation),
            proportional: self.curvature_proportional,
            step: self.curvature_step_per_cm,
            outlier_fraction: self.outlier_fraction,
            outlier_size_sigma: self.outlier_size_sigma,
        }
    }
}
