//! What the extended model gains, in the fit and on held-out readings.

use ieap_domain::{Gain, HeldOutGain, Prediction};

use crate::cause::proof::held_out::{self, HeldOut, Part, nrmse, sum};
use crate::cause::proof::later::later_parts;
use crate::fitting::fitted::Fitted;
use crate::missing::look::Lead;
use crate::readings::group::RunGroup;
use crate::readings::quantities::{self, NAMES, Predicted};

/// The gain of `extended` over `base`.
pub(crate) fn gain(group: &RunGroup, base: &Fitted, extended: &Fitted, lead: &Lead) -> Gain {
    let later = [later_parts(base, group), later_parts(extended, group)];
    let [later_before, later_after] = &later;
    Gain {
        later: (!later_after.is_empty()).then(|| of_parts(group, later_before, later_after)),
        ..gain_of_runs(
            group,
            (base.square, extended.square),
            &lead.held_out,
            &lead.between,
        )
    }
}

/// The gain on runs alone, of models that leave these sums of squares of all readings, before and after: on the parts that others
/// lie on both sides of, where there are such, and apart from these on the others.
pub(crate) fn gain_of_runs(
    group: &RunGroup,
    (before, after): (f64, f64),
    held_out: &HeldOut,
    between: &[bool],
) -> Gain {
    let rms = |square: f64| (square / group.rows().max(1) as f64).sqrt();
    let [within, outside] = [true, false].map(|is_so| held_out.only(between, is_so));
    let (held_out, outside) = match (within.after.is_empty(), outside.after.is_empty()) {
        (true, _) => (outside, None),
        (false, is_none) => (within, (!is_none).then_some(outside)),
    };
    Gain {
        held_out: held_out::kind(group).to_owned(),
        proof: of_parts(group, &held_out.before, &held_out.after),
        outside: outside.map(|own| of_parts(group, &own.before, &own.after)),
        predictions: predictions(&predicted(&held_out.before), &predicted(&held_out.after)),
        residual_rms_sigma_before: rms(before),
        residual_rms_sigma_after: rms(after),
        later: None,
    }
}

/// The gain on parts that were held out of both models.
fn of_parts(group: &RunGroup, before: &[Part], after: &[Part]) -> HeldOutGain {
    let pairs = before.iter().zip(after);
    let falls: Vec<f64> = pairs.map(|(b, a)| b.deviance - a.deviance).collect();
    let n = falls.len() as f64;
    let deviance: f64 = falls.iter().sum();
    let mean = deviance / n.max(1.0);
    let variance = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    HeldOutGain {
        deviance,
        standard_error: (variance * n).sqrt(),
        parts: after.iter().map(|part| part.name.clone()).zip(falls).collect(),
        nrmse_current_before: nrmse(group, before, 0),
        nrmse_current_after: nrmse(group, after, 0),
        nrmse_curvature_before: nrmse(group, before, 1),
        nrmse_curvature_after: nrmse(group, after, 1),
        coverage_before: coverage(before),
        coverage_after: coverage(after),
    }
}

fn predicted(parts: &[Part]) -> Vec<Predicted> {
    parts.iter().flat_map(|part| part.predicted.clone()).collect()
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

/// Share of all held-out readings within their 95 % interval.
fn coverage(parts: &[Part]) -> Option<f64> {
    let all = sum(parts.iter().flat_map(|part| part.deviations));
    (all.readings > 0).then(|| all.covered as f64 / all.readings as f64)
}
