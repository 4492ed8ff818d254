//! What the extended model gains, in the fit and on held-out readings.

use crate::domain::{Gain, Prediction};

use super::fitted::Fitted;
use super::group::Group;
use super::held_out::{self, Part};
use super::quantities::{self, NAMES, Predicted};
use super::select::HeldOut;

/// The gain of `extended` over `base`.
pub(super) fn gain(group: &Group, base: &Fitted, extended: &Fitted, held_out: &HeldOut) -> Gain {
    let falls = held_out.falls();
    let n = falls.len() as f64;
    let deviance: f64 = falls.iter().sum();
    let mean = deviance / n.max(1.0);
    let variance = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let rms = |square: f64| (square / group.rows().max(1) as f64).sqrt();
    let (before, after) = (predicted(&held_out.before), predicted(&held_out.after));
    Gain {
        held_out: held_out::kind(group).to_owned(),
        deviance,
        standard_error: (variance * n).sqrt(),
        parts: held_out
            .after
            .iter()
            .map(|part| part.name.clone())
            .zip(falls)
            .collect(),
        nameless_deviance: held_out.nameless.iter().sum(),
        nrmse_current_before: nrmse(group, &held_out.before, 0),
        nrmse_current_after: nrmse(group, &held_out.after, 0),
        nrmse_curvature_before: nrmse(group, &held_out.before, 1),
        nrmse_curvature_after: nrmse(group, &held_out.after, 1),
        predictions: predictions(&before, &after),
        coverage_before: quantities::coverage(&before),
        coverage_after: quantities::coverage(&after),
        residual_rms_sigma_before: rms(base.square),
        residual_rms_sigma_after: rms(extended.square),
    }
}

fn predicted(parts: &[Part]) -> Vec<Predicted> {
    parts.iter().filter_map(|part| part.predicted.clone()).collect()
}

fn predictions(before: &[Predicted], after: &[Predicted]) -> Vec<Prediction> {
    let of = |(place, name): (usize, &&str)| {
        Some(Prediction {
            quantity: (*name).to_owned(),
            before_percent: quantities::percent(before, place)?,
            after_percent: quantities::percent(after, place)?,
        })
    };
    NAMES.iter().enumerate().filter_map(of).collect()
}

/// Root mean square deviation of a channel's held-out readings over its range.
fn nrmse(group: &Group, parts: &[Part], channel: usize) -> Option<f64> {
    let (square, count) = parts.iter().fold((0.0, 0), |(s, c), part| {
        (s + part.deviations[channel].0, c + part.deviations[channel].1)
    });
    let range = range(group, channel)?;
    (count > 0).then(|| (square / count as f64).sqrt() / range)
}

/// Range of all readings of a channel.
fn range(group: &Group, channel: usize) -> Option<f64> {
    let readings = group.runs.iter().filter_map(|run| run.channels[channel].as_ref());
    let (low, high) = readings.flat_map(|readings| readings.values().to_vec()).fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(low, high): (f64, f64), v| (low.min(v), high.max(v)),
    );
    (high > low).then_some(high - low)
}
