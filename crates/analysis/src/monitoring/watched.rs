//! What is watched.

use super::series::{Reaches, Series, Study};
use crate::laws::covariate::Covariate;
use ieap_domain::Limit;

/// One parameter of one sample in the reference condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// Material.
    pub material: String,
    /// Sample.
    pub sample: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// What the series goes over.
    pub axis: Covariate,
    /// Runs of the readings.
    pub runs: Vec<usize>,
    /// When they were started, s since 1970 UTC; empty where one does not say it.
    pub starts_s: Vec<f64>,
    /// Readings.
    pub series: Series,
    /// What is made of them.
    pub study: Study,
    /// The humidity and the temperature to which its values were brought by a law.
    pub brought: Vec<(Covariate, f64)>,
    /// The limit that holds for it, with when it is reached.
    pub limit: Option<(Limit, Reaches)>,
    /// Runs that give a bound or nothing.
    pub left_out: usize,
}

impl Watched {
    /// The date, UTC, at which the line through the starts of the runs reaches a place of the axis. None where a run does not
    /// say when it was started, or where later runs do not come later.
    pub fn date_at(&self, x: f64) -> Option<String> {
        let (axis, starts_s) = (&self.series.x, &self.starts_s);
        if starts_s.len() != axis.len() || axis.len() < 2 {
            return None;
        }
        let n = axis.len() as f64;
        let mean = |of: &[f64]| of.iter().sum::<f64>() / n;
        let (mean_x, mean_s) = (mean(axis), mean(starts_s));
        let square: f64 = axis.iter().map(|x| (x - mean_x).powi(2)).sum();
        let product: f64 = axis
            .iter()
            .zip(starts_s)
            .map(|(x, s)| (x - mean_x) * (s - mean_s))
            .sum();
        let at_s = mean_s + product / square * (x - mean_x);
        if !(product > 0.0 && at_s.is_finite()) {
            return None;
        }
        let moment = jiff::Timestamp::from_second(at_s as i64).ok()?;
        Some(moment.to_zoned(jiff::tz::TimeZone::UTC).date().to_string())
    }
}
