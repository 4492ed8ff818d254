//! The current of a run, and the charge that flows over a stretch of it.

use std::sync::Arc;

use ieap_domain::Channel;
use ieap_numerics::noise::{LocalScatter, scatter_between};
use ieap_numerics::sums::square;

use super::held::Held;
use super::policy::TOLD;
use ieap_numerics::local_parabola::MOST_GOES_ON;

/// The current with its noise.
pub(super) struct Flow {
    time_s: Arc<[f64]>,
    amperes: Arc<[f64]>,
    noise: LocalScatter,
}

impl Flow {
    /// Of a channel of currents that may jump at those times; none of too few readings.
    pub fn of(channel: &Channel, edges_s: &[f64]) -> Option<Flow> {
        let (time_s, amperes) = channel.included();
        let noise = scatter_between(&time_s, &amperes, edges_s)?;
        Some(Flow {
            time_s,
            amperes,
            noise,
        })
    }

    /// When the current is first and last read, s.
    pub fn ends_s(&self) -> (f64, f64) {
        (self.time_s[0], self.time_s[self.time_s.len() - 1])
    }

    fn readings(&self, held: &Held) -> (&[f64], &[f64]) {
        let from = self.time_s.partition_point(|t| *t < held.step_s);
        let to = self.time_s.partition_point(|t| *t <= held.end_s).max(from);
        (&self.time_s[from..to], &self.amperes[from..to])
    }

    /// The integral of the current over a level by trapezia, and its standard error: that of the noise and, by Richardson,
    /// that of the distance between the readings. What flowed before the first reading and after the last is half known,
    /// and so is all of it where there are fewer than three. None without a reading.
    pub fn charge(&self, held: &Held) -> Option<(f64, f64)> {
        let (t, i) = self.readings(held);
        let (first, last) = (*t.first()?, *t.last()?);
        let all: Vec<usize> = (0..t.len()).collect();
        let mut half: Vec<usize> = all.iter().copied().step_by(2).collect();
        if half.last() != all.last() {
            half.push(t.len() - 1);
        }
        let weights = trapezia(t, &all);
        let sum = |weights: &[f64], of: &[usize]| of.iter().zip(weights).map(|(&k, w)| w * i[k]).sum::<f64>();
        let whole = sum(&weights, &all);
        let of_spacing = match t.len() {
            0..3 => 0.5 * whole,
            _ => (whole - sum(&trapezia(t, &half), &half)) / 3.0,
        };
        let before = i[0] * (first - held.step_s);
        let after = i[t.len() - 1] * (held.end_s - last);
        let goes_on = self.noise.correlation.clamp(0.0, MOST_GOES_ON);
        let of_noise =
            self.noise.standard_deviation * (square(&weights) * (1.0 + goes_on) / (1.0 - goes_on)).sqrt();
        let error = of_noise
            .hypot(of_spacing)
            .hypot(0.5 * before)
            .hypot(0.5 * after)
            .hypot(i[0] * held.step_error_s);
        Some((whole + before + after, error))
    }

    /// The largest current of a level and its standard error: that of the first reading, where no later one is surely
    /// larger; the largest of many would be one of noise.
    pub fn largest(&self, held: &Held) -> Option<(f64, f64)> {
        let (_, i) = self.readings(held);
        let error = self.noise.standard_deviation;
        let largest = *i.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let is_later = largest.abs() > i[0].abs() + TOLD * error;
        Some((if is_later { largest } else { i[0] }, error))
    }
}

/// Weights of the trapezium rule over the readings of those numbers.
fn trapezia(time_s: &[f64], of: &[usize]) -> Vec<f64> {
    let mut weights = vec![0.0; of.len()];
    for k in 1..of.len() {
        let half = 0.5 * (time_s[of[k]] - time_s[of[k - 1]]);
        weights[k - 1] += half;
        weights[k] += half;
    }
    weights
}
