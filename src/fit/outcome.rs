//! The identified parameters as a `Fit`: estimates, noise, curves and issues.

use crate::domain::thinning::drawn_indices;
use crate::domain::{
    ChannelNoise, Drive, Estimate, Fit, Issue, Level, NoiseCharacter, Parameter, Quantity, RunCurve,
};
use crate::model::FitModel;
use crate::numerics::correlation::lag_one;
use crate::numerics::levenberg::Stop;
use crate::numerics::sums;

use super::estimates::{bending_estimate, electrical_estimate};
use super::group::Found;
use super::joint::feature::Feature;
use super::joint::noise::Noise;
use super::joint::readings::RunReadings;
use super::joint::single::Judged;
use super::joint::whitening::Memory;
use super::joint_estimates::{self, choice_in_words, judged_estimate};
use super::sampled::Sampled;
use super::uncertainty::Residuals;
use super::{FitInput, FitOptions, Identified};

/// Readings that tell memory, growth and steps of noise to a few percent.
const ENOUGH: usize = 3000;
/// Stretches of time in which the drawn readings are chosen.
const DRAWN_STRETCHES: usize = 120;

/// Puts everything together.
pub(super) fn fit(
    input: &FitInput,
    options: &FitOptions,
    identified: &Identified,
    judged: Option<&Judged>,
) -> Fit {
    let model = options.model;
    let parameters = parameters(input, model, identified, judged);
    let step_s = input
        .drive
        .segments
        .first()
        .map_or(0.0, |segment| segment.start_s);
    let current = identified.current.as_ref().ok();
    let curvature = identified.curvature.as_ref().ok();
    let describes_noise = options.describes_noise;
    let mut responses: Vec<Response> = Vec::new();
    if let Some((sampled, electrical)) = current {
        responses.push(Response::new(
            Quantity::Current,
            sampled,
            Some(&electrical.residuals),
            step_s,
            describes_noise,
        ));
    }
    if let Some((sampled, bending)) = curvature {
        responses.push(Response::new(
            Quantity::Curvature,
            sampled,
            Some(&bending.residuals),
            step_s,
            describes_noise,
        ));
    }
    let n_samples = responses.iter().map(|response| response.noise.readings).sum();
    if let Some(sampled) = identified
        .unfitted_curvature
        .as_ref()
        .filter(|sampled| sampled.len() > 0)
    {
        responses.push(Response::new(
            Quantity::Curvature,
            sampled,
            None,
            step_s,
            describes_noise,
        ));
    }
    let r_squared = |quantity: Quantity| {
        responses
            .iter()
            .find(|response| response.noise.quantity == quantity)?
            .noise
            .r_squared
    };
    Fit {
        model: model.id.to_owned(),
        model_version: model.version,
        method: format!("two-step {}", options.method.name()),
        converged: current.is_none_or(|(_, e)| e.stop.converged())
            && curvature.is_none_or(|(_, b)| b.stop.converged())
            && (current.is_some() || curvature.is_some()),
        why_stopped: why_stopped(identified),
        n_samples,
        r_squared_current: r_squared(Quantity::Current),
        r_squared_curvature: r_squared(Quantity::Curvature),
        issues: issues(input.drive, identified, &parameters, judged),
        evaluations: judged.map_or(0, |judged| judged.evaluations)
            + current.map_or(0, |(_, e)| e.evaluations)
            + curvature.map_or(0, |(_, b)| b.evaluations),
        parameters,
        noise: responses.iter().map(|response| response.noise.clone()).collect(),
        curves: responses.into_iter().map(|response| response.curve).collect(),
    }
}

fn parameters(
    input: &FitInput,
    model: &FitModel,
    identified: &Identified,
    judged: Option<&Judged>,
) -> Vec<Parameter> {
    let estimate = |key: &str| {
        if let Some(estimate) = judged.and_then(|judged| judged_estimate(key, judged, input.drive)) {
            return Some(estimate);
        }
        let bending = identified
            .curvature
            .as_ref()
            .map(|(_, bending)| bending)
            .map_err(String::as_str);
        let electrical = || match &identified.current {
            Ok((_, electrical)) => electrical_estimate(key, electrical, input.drive),
            Err(reason) => Some(Estimate::not_determined(reason.as_str())),
        };
        bending_estimate(key, bending).or_else(electrical)
    };
    let with_estimate = |key: &str| {
        Some(Parameter {
            key: key.to_owned(),
            estimate: estimate(key)?,
        })
    };
    model
        .parameters
        .iter()
        .filter_map(|description| with_estimate(description.key))
        .collect()
}

/// Parameters of a joint fit in the model's order.
pub(super) fn joint_parameters(model: &FitModel, features: &[Found], drive: &Drive) -> Vec<Parameter> {
    let of = |key: &str| {
        let feature = Feature::of_key(key, model.branches)?;
        let found = features.iter().find(|(own, ..)| *own == feature);
        let missing = || Estimate::not_determined("nothing in the run tells of it");
        Some(Parameter {
            key: key.to_owned(),
            estimate: found.map_or_else(missing, |(_, interval, partner)| {
                joint_estimates::estimate(feature, interval, drive, *partner)
            }),
        })
    };
    model
        .parameters
        .iter()
        .filter_map(|description| of(description.key))
        .collect()
}

/// One run of a joint fit.
pub(super) fn joint_fit(
    input: &FitInput,
    model: &'static FitModel,
    run: &RunReadings,
    fitted: [Option<Vec<f64>>; 2],
    parameters: Vec<Parameter>,
    (stop, evaluations): (Stop, u64),
) -> Fit {
    let step_s = input
        .drive
        .segments
        .first()
        .map_or(0.0, |segment| segment.start_s);
    let count = 2 * model.branches + 1;
    let quantities = [(Quantity::Current, count), (Quantity::Curvature, 2)];
    let responses: Vec<Response> = [&run.current, &run.curvature]
        .into_iter()
        .zip(fitted)
        .zip(quantities)
        .filter_map(|((response, fitted), (quantity, count))| {
            let sampled = &response.as_ref()?.sampled;
            let residuals = Residuals::new(sampled, fitted?, count);
            Some(Response::new(quantity, sampled, Some(&residuals), step_s, true))
        })
        .collect();
    let r_squared = |quantity: Quantity| {
        responses
            .iter()
            .find(|response| response.noise.quantity == quantity)?
            .noise
            .r_squared
    };
    let mut issues = parameter_issues(&parameters);
    if !stop.converged() {
        issues.push(not_converged(stop));
    }
    Fit {
        model: model.id.to_owned(),
        model_version: model.version,
        method: "simultaneous least squares, weighted by the noise".to_owned(),
        converged: stop.converged(),
        why_stopped: stop.words().to_owned(),
        n_samples: run.len(),
        r_squared_current: r_squared(Quantity::Current),
        r_squared_curvature: r_squared(Quantity::Curvature),
        issues,
        evaluations,
        parameters,
        noise: responses.iter().map(|response| response.noise.clone()).collect(),
        curves: responses.into_iter().map(|response| response.curve).collect(),
    }
}

fn not_converged(stop: Stop) -> Issue {
    Issue::warning(
        "not-converged",
        format!("the search did not settle: {}", stop.words()),
    )
}

fn why_stopped(identified: &Identified) -> String {
    let current = match &identified.current {
        Ok((_, electrical)) => format!("current: {}", electrical.stop.words()),
        Err(reason) => format!("current: not fitted, {reason}"),
    };
    let curvature = match &identified.curvature {
        Ok((_, bending)) => format!("curvature: {}", bending.stop.words()),
        Err(reason) => format!("curvature: not fitted, {reason}"),
    };
    format!("{current}; {curvature}")
}

/// Notes on parameters without a value.
fn parameter_issues(parameters: &[Parameter]) -> Vec<Issue> {
    let mut issues = Vec::new();
    for parameter in parameters {
        let estimate = &parameter.estimate;
        let Some(reason) = &estimate.reason else { continue };
        let (code, what) = match (estimate.value, estimate.low_95, estimate.high_95) {
            (Some(_), _, _) => continue,
            (None, Some(low), _) => (
                "parameter-bounded",
                format!("only a lower bound is known, {low:.4e}"),
            ),
            (None, _, Some(high)) => (
                "parameter-bounded",
                format!("only an upper bound is known, {high:.4e}"),
            ),
            (None, None, None) => ("parameter-not-determined", "not determined".to_owned()),
        };
        issues.push(Issue::note(code, format!("{what}: {reason}")).at(parameter.key.as_str()));
    }
    issues
}

fn issues(
    drive: &Drive,
    identified: &Identified,
    parameters: &[Parameter],
    judged: Option<&Judged>,
) -> Vec<Issue> {
    let mut issues = parameter_issues(parameters);
    if let Some(judged) = judged.filter(|judged| judged.evidence.gain.is_finite()) {
        issues.push(Issue::note("model-choice", choice_in_words(&judged.evidence)));
    }
    if let Ok((sampled, electrical)) = &identified.current
        && electrical.conductances_a_per_v.is_empty()
        && electrical.steady_a_per_v == 0.0
        && flows_backwards(drive, sampled)
    {
        let message = "the current flows against the voltage: no resistor or capacitor does that";
        let issue = Issue::warning("current-against-voltage", message).at("column current_a");
        issues
            .push(issue.mend(
                "check the sign of current and voltage: instruments differ in what they call positive",
            ));
    }
    if let Ok((_, electrical)) = &identified.current
        && let Some(offset_a) = electrical.offset_a
    {
        let message = format!(
            "the current is off by {offset_a:.4e} A at every voltage, which no resistor explains; fitted as the instrument's zero"
        );
        issues.push(Issue::warning("current-offset", message).at("column current_a"));
    }
    if let Ok((_, bending)) = &identified.curvature
        && let Some(offset_per_cm) = bending.offset_per_cm
    {
        let message =
            format!("the strip is bent by {offset_per_cm:.4e} 1/cm before the step; fitted as an offset");
        issues.push(Issue::note("initial-curvature", message).at("column curvature_per_cm"));
    }
    let unfinished = [
        identified
            .current
            .as_ref()
            .ok()
            .map(|(_, electrical)| electrical.stop),
        identified
            .curvature
            .as_ref()
            .ok()
            .map(|(_, bending)| bending.stop),
    ];
    for stop in unfinished.into_iter().flatten().filter(|stop| !stop.converged()) {
        issues.push(not_converged(stop));
    }
    issues
}

/// Whether the current after the step is on the whole opposite to the first change of the voltage.
fn flows_backwards(drive: &Drive, sampled: &Sampled) -> bool {
    let held = drive.segments.iter().find_map(|segment| match segment.level {
        Level::Voltage(level_v) if level_v != drive.baseline_v => Some(level_v - drive.baseline_v),
        _ => None,
    });
    let after = &sampled.values[sampled.before_step()..];
    held.is_some_and(|change_v| change_v * after.iter().sum::<f64>() < 0.0)
}

/// One response with its noise and the curve to draw.
struct Response {
    noise: ChannelNoise,
    curve: RunCurve,
}

impl Response {
    fn new(
        quantity: Quantity,
        sampled: &Sampled,
        residuals: Option<&Residuals>,
        step_s: f64,
        describes_noise: bool,
    ) -> Response {
        let (standard_deviation, basis) = noise(sampled);
        let rms = residuals.map_or(0.0, |r| (r.square / sampled.len().max(1) as f64).sqrt());
        // Noise of exactly zero (a channel that was computed) cannot be a unit; the residual then is its own.
        let unit = [standard_deviation, rms]
            .into_iter()
            .find(|unit| *unit > 0.0)
            .unwrap_or(1.0);
        let left: &[f64] = residuals.map_or(&[], |r| &r.residuals);
        let fitted: &[f64] = residuals.map_or(&[], |r| &r.fitted);
        let series: &[&[f64]] = if left.is_empty() {
            &[&sampled.values]
        } else {
            &[&sampled.values, left]
        };
        let drawn = drawn_indices(&sampled.time_s, series, step_s, DRAWN_STRETCHES);
        let at =
            |column: &[f64]| -> Vec<f64> { drawn.iter().filter_map(|&k| column.get(k).copied()).collect() };
        Response {
            noise: ChannelNoise {
                quantity,
                standard_deviation,
                basis,
                character: if describes_noise {
                    character(sampled)
                } else {
                    NoiseCharacter::default()
                },
                residual_autocorrelation: lag_one(left),
                residual_rms: rms,
                readings: if residuals.is_some() { sampled.len() } else { 0 },
                r_squared: residuals.and_then(|r| r_squared(sampled, &r.residuals)),
            },
            curve: RunCurve {
                quantity,
                time_s: at(&sampled.time_s),
                measured: at(&sampled.values),
                fitted: at(fitted),
                residual_sigma: at(left).iter().map(|r| r / unit).collect(),
                readings: sampled.len(),
            },
        }
    }
}

/// Memory, growth and steps of the noise.
fn character(sampled: &Sampled) -> NoiseCharacter {
    let peak = sampled.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let ends = (sampled.len() > 2 * ENOUGH).then(|| sampled.ends(ENOUGH));
    let noise = Noise::of(ends.as_ref().unwrap_or(sampled), 1e-9 * peak);
    let (autoregression, correlation_time_s) = match noise.memory {
        Memory::Order(coefficients) => (coefficients, None),
        Memory::Time { correlation_time_s } => (Vec::new(), Some(correlation_time_s)),
    };
    NoiseCharacter {
        autoregression,
        correlation_time_s,
        proportional: noise.proportional,
        quantum: noise.quantum,
    }
}

/// Noise standard deviation without the model, and how it was found.
fn noise(sampled: &Sampled) -> (f64, String) {
    match &sampled.scatter {
        Some(scatter) => (
            scatter.standard_deviation,
            format!(
                "scatter about parabolas over {} readings, lag-1 autocorrelation {:.2}",
                scatter.window, scatter.correlation
            ),
        ),
        None => {
            let differences = sampled
                .values
                .windows(3)
                .map(|three| three[2] - 2.0 * three[1] + three[0]);
            let (square, count) = differences.fold((0.0, 0.0), |(s, c), d| (s + d * d, c + 1.0));
            let variance = if count > 0.0 { square / count / 6.0 } else { 0.0 };
            (
                variance.sqrt(),
                "second differences, for want of longer stretches".to_owned(),
            )
        }
    }
}

/// 1 - SUM r^2 / SUM (y - mean)^2 over the readings from the step on, as the thesis prints it; none where
/// those do not vary.
fn r_squared(sampled: &Sampled, residuals: &[f64]) -> Option<f64> {
    let start = sampled.before_step();
    let (values, residuals) = (&sampled.values[start..], &residuals[start..]);
    let total = sums::square_about(values, sums::sum(values) / values.len() as f64);
    let left = sums::square(residuals);
    (total > 0.0).then(|| 1.0 - left / total)
}
