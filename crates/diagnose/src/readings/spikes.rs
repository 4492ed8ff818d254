//! Single readings far off their neighbours: a fault of the reading, not of the model. Those near an edge of the drive are
//! left to [`super::outliers`], which knows a model; so are all under a moving voltage, whose corners make such readings.

use crate::readings::policy::{
    FEWEST_FOR_SPREAD, READINGS_AFTER_EDGE, READINGS_BEFORE_EDGE, READINGS_OF_SURROUNDINGS, SPIKE_SIGMAS,
};
use std::sync::Arc;

use ieap_domain::{Channel, Drive};
use ieap_numerics::robust::sd_about_zero;

/// The channel with its spikes excluded, and how many there were.
pub(crate) fn without_spikes(channel: &Channel, drive: &Drive) -> (Channel, usize) {
    let (time_s, values) = channel.included();
    let n = values.len();
    if n < FEWEST_FOR_SPREAD || drive.moves() {
        return (channel.clone(), 0);
    }
    let off: Vec<f64> = (0..n)
        .map(|k| match k {
            0 => 0.0,
            k if k + 1 == n => 0.0,
            k => values[k] - (values[k - 1] + values[k + 1]) / 2.0,
        })
        .collect();
    if sd_about_zero(&off) <= 0.0 {
        return (channel.clone(), 0);
    }
    let spread = spreads(&off);
    let near_edge = |k: usize| {
        drive.segments.iter().any(|segment| {
            let first = time_s.partition_point(|&t| t < segment.start_s());
            (first.saturating_sub(READINGS_BEFORE_EDGE)..first + READINGS_AFTER_EDGE).contains(&k)
        })
    };
    let is_spike = |k: &usize| {
        let own = off[*k].abs();
        own > SPIKE_SIGMAS * spread[*k]
            && own >= off[*k - 1].abs()
            && own >= off[*k + 1].abs()
            && !near_edge(*k)
    };
    let spikes: Vec<usize> = (1..n - 1).filter(is_spike).collect();
    if spikes.is_empty() {
        return (channel.clone(), 0);
    }
    let keep: Vec<usize> = (0..n).filter(|k| spikes.binary_search(k).is_err()).collect();
    let mut cleaned = channel.clone();
    cleaned.excluded = Arc::from([]);
    cleaned.time_s = keep.iter().map(|&k| time_s[k]).collect();
    cleaned.values = keep.iter().map(|&k| values[k]).collect();
    (cleaned, spikes.len())
}

/// Spread around every value: that of its surroundings where it is wider than the whole's, for noise may grow.
pub(crate) fn spreads(values: &[f64]) -> Vec<f64> {
    let whole = sd_about_zero(values);
    let around = |stretch: usize| {
        let first = (stretch * READINGS_OF_SURROUNDINGS).saturating_sub(READINGS_OF_SURROUNDINGS);
        let end = ((stretch + 2) * READINGS_OF_SURROUNDINGS).min(values.len());
        sd_about_zero(&values[first..end]).max(whole)
    };
    let per_stretch: Vec<f64> = (0..values.len().div_ceil(READINGS_OF_SURROUNDINGS))
        .map(around)
        .collect();
    (0..values.len())
        .map(|k| per_stretch[k / READINGS_OF_SURROUNDINGS])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    #[test]
    fn a_spike_goes_and_a_step_stays() {
        let drive = Drive::step(1.0);
        let time_s: Arc<[f64]> = (-20..100).map(f64::from).collect();
        let wiggle = |t: f64| 0.01 * (t * 1.7).sin() * (t * 0.37).cos();
        let mut values: Vec<f64> = time_s
            .iter()
            .map(|&t| f64::from(u8::from(t >= 0.0)) + wiggle(t))
            .collect();
        values[70] += 0.5;
        let channel = Channel::new(Quantity::Current, time_s.clone(), values.into());
        let (cleaned, spikes) = without_spikes(&channel, &drive);
        assert_eq!(spikes, 1);
        assert!(!cleaned.time_s.contains(&50.0) && cleaned.time_s.len() == 119);
    }
}
