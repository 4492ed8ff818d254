//! The fit as it is stored: parameters per area and per square, noise, curves, what a reader must know.

use crate::domain::thinning::{DRAWN_BUCKETS, drawn_indices};
use crate::domain::{ChannelNoise, Estimate, Fit, Issue, NoiseCharacter, Parameter, Quantity, RunCurve};
use crate::numerics::correlation::lag_one;
use crate::numerics::student::quantile_95;

use super::readings::{Group, Kind, Readings};
use super::squares::{Fitted, Mechanical};
use super::{DistributedInput, MODEL_ID, along, model_of, response};

/// A 95 % interval wider than this factor to either side says nothing worth a value.
const WIDEST_FACTOR: f64 = 5.0;
/// The lumped model is called enough where it is wrong by less than this share at the tip.
const LUMPED_TOLERANCE: f64 = 0.05;

pub(super) fn fit(
    input: &DistributedInput,
    readings: &Readings,
    electrical: &Fitted,
    mechanical: Option<&Mechanical>,
) -> Fit {
    let parameters = parameters(input, electrical, mechanical);
    let rate = mechanical.map_or(0.0, |m| m.rate_below_per_s.map_or(m.fitted.at[1].exp(), |_| 0.0));
    let mu = mechanical.map_or(0.0, |m| m.mu_per_c);
    let model = model_of(&input.strip, &electrical.at, rate);
    let predicted = |group: &Group| {
        let mut values = response::predicted(&model, input.drive, group);
        if group.kind == Kind::Curvature {
            values.iter_mut().for_each(|value| *value *= mu);
        }
        values
    };
    let fitted: Vec<(&Group, Vec<f64>)> = readings
        .groups
        .iter()
        .filter(|group| group.kind != Kind::Curvature || mechanical.is_some())
        .map(|group| (group, predicted(group)))
        .collect();
    let stops = mechanical.map(|m| m.fitted.stop);
    let converged = electrical.stop.converged() && stops.is_none_or(|stop| stop.converged());
    let words = stops.map_or("not fitted", |stop| stop.words());
    let mut issues = remarks(&parameters);
    issues.push(criterion(&model));
    Fit {
        model: MODEL_ID.to_owned(),
        model_version: crate::model::fit_model(MODEL_ID).map_or(1, |model| model.version),
        method: "three phases, closed form along the strip".to_owned(),
        converged,
        why_stopped: format!("electrical: {}; curvature: {words}", electrical.stop.words()),
        n_samples: fitted
            .iter()
            .map(|(group, _)| group.time_s.len() * group.values.len())
            .sum(),
        r_squared_current: r_squared(&fitted, Kind::Current),
        r_squared_curvature: r_squared(&fitted, Kind::Curvature),
        noise: [Kind::Current, Kind::Voltage, Kind::Curvature]
            .iter()
            .filter_map(|&kind| noise(&fitted, kind))
            .collect(),
        curves: fitted
            .iter()
            .filter_map(|(group, values)| curve(group, values, readings.step_s))
            .collect(),
        along: along::along(input, readings, &model, &fitted),
        evaluations: electrical.evaluations + mechanical.map_or(0, |m| m.fitted.evaluations),
        parameters,
        issues,
    }
}

fn parameters(
    input: &DistributedInput,
    electrical: &Fitted,
    mechanical: Option<&Mechanical>,
) -> Vec<Parameter> {
    let width_cm = input.strip.width_cm;
    let of = |index: usize, factor: f64| positive(electrical, index, factor);
    let along = match input.strip.electrode_resistance_ohm_per_sq {
        Some(given) => Estimate {
            value: Some(given),
            ..Estimate::not_determined("given with the sample, not fitted")
        },
        None => of(3, width_cm),
    };
    let (mu, rate, alpha) = mechanical_estimates(mechanical, input.strip.length_cm);
    [
        ("re_ohm_per_sq", along),
        ("rc_ohm_cm2", of(0, width_cm)),
        ("c_f_per_cm2", of(1, 1.0 / width_cm)),
        ("rss_ohm_cm2", steady(of(2, width_cm), electrical, width_cm)),
        ("mu_per_c", mu),
        ("lambda_per_s", rate),
        ("alpha_per_c_cm", alpha),
    ]
    .into_iter()
    .map(|(key, estimate)| Parameter {
        key: key.to_owned(),
        estimate,
    })
    .collect()
}

/// A parameter whose logarithm was fitted, times `factor`.
fn positive(fitted: &Fitted, index: usize, factor: f64) -> Estimate {
    let (log, error) = (
        fitted.at[index],
        fitted.covariance.get(index, index).max(0.0).sqrt(),
    );
    let half = quantile_95(fitted.freedom) * error;
    let value = log.exp() * factor;
    if !half.is_finite() || half > WIDEST_FACTOR.ln() {
        return Estimate::not_determined(
            "what was measured along the strip does not separate it: its 95 % interval would span more than a factor of five to either side",
        );
    }
    Estimate::determined(value, value * error, value * (-half).exp(), value * half.exp())
}

/// R_ss has a lower bound where no steady current is seen.
fn steady(estimate: Estimate, fitted: &Fitted, width_cm: f64) -> Estimate {
    if estimate.value.is_some() {
        return estimate;
    }
    let error = fitted.covariance.get(2, 2).max(0.0).sqrt();
    let low = (fitted.at[2] - quantile_95(fitted.freedom) * error).exp() * width_cm;
    match low.is_finite() && low > 0.0 {
        true => Estimate::above(low, "the steady current cannot be told from zero"),
        false => estimate,
    }
}

/// mu, lambda, and alpha = mu / L.
fn mechanical_estimates(mechanical: Option<&Mechanical>, length_cm: f64) -> (Estimate, Estimate, Estimate) {
    let Some(found) = mechanical else {
        let none = || Estimate::not_determined("the run has no curvature along the strip");
        return (none(), none(), none());
    };
    let quantile = quantile_95(found.fitted.freedom);
    let error = found.fitted.covariance.get(0, 0).max(0.0).sqrt() * found.scale.abs();
    let signed = |factor: f64| {
        let (value, error) = (found.mu_per_c * factor, error * factor);
        match error.is_finite() && quantile * error < value.abs() {
            true => Estimate::determined(value, error, value - quantile * error, value + quantile * error),
            false => Estimate::not_determined("the curvature cannot be told from noise"),
        }
    };
    let rate = match found.rate_below_per_s {
        Some(bound) => Estimate::below(
            bound,
            "relaxation is too slow for this record: the rate cannot be told from zero",
        ),
        None => positive(&found.fitted, 1, 1.0),
    };
    (signed(1.0), rate, signed(1.0 / length_cm))
}

fn remarks(parameters: &[Parameter]) -> Vec<Issue> {
    let of = |parameter: &Parameter| {
        let estimate = &parameter.estimate;
        let reason = estimate.reason.clone()?;
        let (code, message) = match (estimate.value, estimate.low_95, estimate.high_95) {
            (Some(_), _, _) => return None,
            (None, None, None) => ("parameter-not-determined", format!("not determined: {reason}")),
            (None, low, high) => {
                let side = if low.is_some() { "lower" } else { "upper" };
                let bound = low.or(high).unwrap_or_default();
                (
                    "parameter-bounded",
                    format!("only a {side} bound is known, {bound:.4e}: {reason}"),
                )
            }
        };
        Some(Issue::note(code, message).at(&parameter.key))
    };
    parameters.iter().filter_map(of).collect()
}

/// Lumped or distributed, as a number.
fn criterion(model: &crate::model::distributed::DistributedModel) -> Issue {
    let error = model.lumped_error();
    let verdict = match error.lumped_is_enough(LUMPED_TOLERANCE) {
        true => "the lumped model is enough",
        false => "the strip needs the distributed model",
    };
    let message = format!(
        "{verdict}: with these parameters a lumped model is wrong at the tip by {:.1} % of its first motion and {:.1} % in the end",
        100.0 * error.first_displacement,
        100.0 * error.final_displacement
    );
    Issue::note("lumped-or-distributed", message)
}

fn r_squared(fitted: &[(&Group, Vec<f64>)], kind: Kind) -> Option<f64> {
    let (mut residual, mut total) = (0.0, 0.0);
    for (group, values) in fitted.iter().filter(|(group, _)| group.kind == kind) {
        for (place, row) in values.chunks_exact(group.time_s.len()).enumerate() {
            let measured = &group.values[place];
            let mean = measured.iter().sum::<f64>() / measured.len() as f64;
            residual += measured
                .iter()
                .zip(row)
                .map(|(m, f)| (m - f).powi(2))
                .sum::<f64>();
            total += measured.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        }
    }
    (total > 0.0).then(|| 1.0 - residual / total)
}

/// Noise and residual of a kind, over its series.
fn noise(fitted: &[(&Group, Vec<f64>)], kind: Kind) -> Option<ChannelNoise> {
    let (mut square, mut noise_square, mut readings, mut series, mut correlation) = (0.0, 0.0, 0, 0.0, 0.0);
    for (group, values) in fitted.iter().filter(|(group, _)| group.kind == kind) {
        for (place, row) in values.chunks_exact(group.time_s.len()).enumerate() {
            let residuals: Vec<f64> = group.values[place].iter().zip(row).map(|(m, f)| m - f).collect();
            square += residuals.iter().map(|r| r * r).sum::<f64>();
            readings += residuals.len();
            noise_square += group.noise[place].powi(2);
            correlation += lag_one(&residuals);
            series += 1.0;
        }
    }
    let quantity = match kind {
        Kind::Voltage => Quantity::Voltage,
        Kind::Current => Quantity::Current,
        Kind::Curvature => Quantity::Curvature,
    };
    (readings > 0).then(|| ChannelNoise {
        quantity,
        standard_deviation: f64::sqrt(noise_square / series),
        basis: format!("scatter about parabolas, root mean square over {series} series"),
        character: NoiseCharacter::default(),
        residual_autocorrelation: correlation / series,
        residual_rms: f64::sqrt(square / readings as f64),
        readings,
        r_squared: r_squared(fitted, kind),
    })
}

/// The current, and the mean of the curvatures along the strip, as they are drawn.
fn curve(group: &Group, values: &[f64], step_s: f64) -> Option<RunCurve> {
    let quantity = match group.kind {
        Kind::Current => Quantity::Current,
        Kind::Curvature => Quantity::Curvature,
        Kind::Voltage => return None,
    };
    let (times, places) = (group.time_s.len(), group.values.len() as f64);
    let mean = |at: &dyn Fn(usize, usize) -> f64, time: usize| {
        (0..group.values.len()).map(|place| at(place, time)).sum::<f64>() / places
    };
    let measured: Vec<f64> = (0..times)
        .map(|time| mean(&|place, time| group.values[place][time], time))
        .collect();
    let drawn: Vec<f64> = (0..times)
        .map(|time| mean(&|place, time| values[place * times + time], time))
        .collect();
    let noise = group.noise.iter().map(|noise| noise * noise).sum::<f64>().sqrt() / places;
    let residual: Vec<f64> = measured
        .iter()
        .zip(&drawn)
        .map(|(m, f)| (m - f) / noise)
        .collect();
    let kept = drawn_indices(&group.time_s, &[&measured, &residual], step_s, DRAWN_BUCKETS);
    let pick = |series: &[f64]| kept.iter().map(|&i| series[i]).collect();
    Some(RunCurve {
        quantity,
        time_s: pick(&group.time_s),
        measured: pick(&measured),
        fitted: pick(&drawn),
        residual_sigma: pick(&residual),
        readings: times,
    })
}
