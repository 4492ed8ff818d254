//! The fit as it is stored: parameters per area and per square, noise, curves, what a reader must know.

use ieap_domain::thinning::{DRAWN_BUCKETS, drawn_indices};
use ieap_domain::{ChannelNoise, Fit, NoiseCharacter, Quantity, RunCurve};
use ieap_numerics::correlation::lag_one;
use ieap_numerics::sums::{mean, square_about};

use super::contact_break::ContactBreak;
use super::decision::Decision;
use super::estimates::parameters;
use super::identified::Identified;
use super::readings::{Kind, SeriesGroup};
use super::{MODEL_ID, along, response};
use crate::outcome::parameter_issues;

pub(super) fn fit(found: &Identified, decision: &Decision) -> Fit {
    let described = found.described();
    let mechanical = found.mechanical.as_ref();
    let parameters = parameters(found);
    let fitted: Vec<(&SeriesGroup, Vec<f64>)> = found
        .readings
        .groups
        .iter()
        .filter(|group| group.kind != Kind::Curvature || mechanical.is_some())
        .map(|group| (group, response::predicted(&described, found.input.drive, group)))
        .collect();
    let electrical = &found.electrical;
    let stops = mechanical.map(|m| m.fitted.stop);
    let converged = electrical.stop.converged() && stops.is_none_or(|stop| stop.converged());
    let words = stops.map_or("not fitted", |stop| stop.words());
    let mut issues = parameter_issues(&parameters);
    issues.push(decision.issue());
    issues.extend(found.contact_break.as_ref().map(ContactBreak::issue));
    Fit {
        extended: None,
        model: MODEL_ID.to_owned(),
        model_version: ieap_model::fit_model(MODEL_ID).map_or(1, |model| model.version),
        method: found.method.to_owned(),
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
            .filter_map(|(group, values)| curve(group, values, found.readings.step_s))
            .collect(),
        along: along::along(&found.input, &found.readings, &described, &fitted),
        evaluations: electrical.evaluations + mechanical.map_or(0, |m| m.fitted.evaluations),
        parameters,
        nuisances: Vec::new(),
        issues,
    }
}

fn r_squared(fitted: &[(&SeriesGroup, Vec<f64>)], kind: Kind) -> Option<f64> {
    let (mut residual, mut total) = (0.0, 0.0);
    for (group, values) in fitted.iter().filter(|(group, _)| group.kind == kind) {
        for (place, row) in values.chunks_exact(group.time_s.len()).enumerate() {
            let measured = &group.values[place];
            residual += measured
                .iter()
                .zip(row)
                .map(|(m, f)| (m - f).powi(2))
                .sum::<f64>();
            total += square_about(measured, mean(measured));
        }
    }
    (total > 0.0).then(|| 1.0 - residual / total)
}

/// Noise and residual of a kind, over its series.
fn noise(fitted: &[(&SeriesGroup, Vec<f64>)], kind: Kind) -> Option<ChannelNoise> {
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
    (readings > 0).then(|| ChannelNoise {
        quantity: kind.quantity(),
        standard_deviation: f64::sqrt(noise_square / series),
        basis: format!("scatter of neighbouring readings about a smooth curve, mean of {series} places"),
        character: NoiseCharacter::default(),
        residual_autocorrelation: correlation / series,
        residual_rms: f64::sqrt(square / readings as f64),
        readings,
        r_squared: r_squared(fitted, kind),
    })
}

/// The current, and the mean of the curvatures along the strip, as they are drawn.
fn curve(group: &SeriesGroup, values: &[f64], step_s: f64) -> Option<RunCurve> {
    let quantity = group.kind.quantity();
    if quantity == Quantity::Voltage {
        return None;
    }
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
