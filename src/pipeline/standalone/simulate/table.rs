//! The run table of a simulated run: sampled model, noise, rows.

use std::fmt::Write;

use super::answer_key::told;
use super::run_spec::RunSpec;
use super::sampling::Sampling;
use super::spec::{Spec, hidden_effects};
use super::wave::Wave;
use crate::domain::Level;
use crate::domain::number::{digits, scientific};
use crate::model::LumpedModel;
use crate::model::ode::{Responses, integrate_under};
use crate::truth::noise::NoisyChannel;
use crate::truth::{HiddenEffect, TruthError, TruthResponses, noise, simulate};

/// Local error of the solved equations, of the largest value: far below what noise leaves.
const RELATIVE: f64 = 1e-9;

/// The text of the run table. `number` (the run's place in the spec) and the spec's seed fix the noise.
///
/// # Errors
/// The equations with the run's effects have no solution.
pub fn run_table(spec: &Spec, run: &RunSpec, number: usize) -> Result<String, TruthError> {
    let drive = run.drive();
    let effects = hidden_effects(spec, run);
    let (time_s, camera_s) = (current_times(spec), camera_times(spec));
    let exact = exact_responses(run, &effects, (&time_s, &camera_s), number)?;
    let (seed, stream) = (spec.simulation.seed, 2 * number as u64);
    let current = spec.noise.current().with_effects(NoisyChannel::Current, &effects);
    let current_a = noise(&exact.current_a, &current, seed, stream);
    let curvature = spec
        .noise
        .curvature()
        .with_effects(NoisyChannel::Curvature, &effects);
    let curvature_per_cm = noise(&exact.curvature_per_cm, &curvature, seed, stream + 1);

    let mut text = String::new();
    for line in &spec.simulation.statement {
        let _ = writeln!(text, "# {line}");
    }
    for effect in effects.iter().filter(|_| spec.simulation.tell) {
        let _ = writeln!(text, "# {}", told(effect));
    }
    let has_open_circuit = drive.segments.iter().any(|s| s.level == Level::OpenCircuit);
    let open_column = if has_open_circuit { ",open_circuit" } else { "" };
    let _ = writeln!(text, "time_s,voltage_v,current_a,curvature_per_cm{open_column}");
    for (t, row) in merged(&time_s, &camera_s) {
        let volts = match run.wave.filter(|_| t >= 0.0) {
            Some(wave) => Some(wave.volts(t)),
            None => drive.level_at(t).volts(),
        };
        let voltage = volts.map(|volts| volts.to_string()).unwrap_or_default();
        let current = row
            .current
            .map(|i| scientific(current_a[i], 5))
            .unwrap_or_default();
        let curvature = row
            .curvature
            .map(|i| digits(curvature_per_cm[i], 5))
            .unwrap_or_default();
        let open = if has_open_circuit {
            format!(",{}", u8::from(volts.is_none()))
        } else {
            String::new()
        };
        let _ = writeln!(text, "{},{voltage},{current},{curvature}{open}", printed(t));
    }
    Ok(text)
}

/// What the instruments would read without noise: the closed form, or the truth simulator where effects are named.
/// `number` is the run's place among others, for what happens in one of them only.
///
/// # Errors
/// An effect makes no sense, or the equations have no solution.
pub fn exact_responses(
    run: &RunSpec,
    effects: &[HiddenEffect],
    (time_s, camera_s): (&[f64], &[f64]),
    number: usize,
) -> Result<TruthResponses, TruthError> {
    let drive = run.drive();
    if !effects.is_empty() {
        return simulate(&run.truth(effects.to_vec()), &drive, time_s, camera_s, number);
    }
    let model = run.model();
    if let Some(wave) = run.wave {
        return Ok(TruthResponses {
            current_a: under(&model, wave, run.area_cm2, time_s).current_a,
            curvature_per_cm: under(&model, wave, run.area_cm2, camera_s).curvature_per_cm,
        });
    }
    Ok(TruthResponses {
        current_a: model.current_a(&drive, run.area_cm2, time_s),
        curvature_per_cm: model.curvature_per_cm(&drive, run.area_cm2, camera_s),
    })
}

/// When the potentiostat samples, s.
pub(super) fn current_times(spec: &Spec) -> Vec<f64> {
    times(spec, &spec.sampling)
}

/// When the camera samples, s.
pub(super) fn camera_times(spec: &Spec) -> Vec<f64> {
    let stretches = if spec.camera.is_empty() {
        &spec.sampling
    } else {
        &spec.camera
    };
    times(spec, stretches)
}

/// Sampling times: the baseline, then each stretch.
pub(super) fn times(spec: &Spec, stretches: &[Sampling]) -> Vec<f64> {
    let simulation = &spec.simulation;
    let before = (simulation.baseline_s / simulation.baseline_every_s).floor() as i64;
    let mut time_s: Vec<f64> = (1..=before)
        .rev()
        .map(|k| -(k as f64) * simulation.baseline_every_s)
        .collect();
    let mut from_s = 0.0;
    time_s.push(0.0);
    for stretch in stretches {
        let count = ((stretch.until_s - from_s) / stretch.every_s + 1e-9).floor() as i64;
        time_s.extend((1..=count).map(|k| from_s + k as f64 * stretch.every_s));
        from_s = stretch.until_s;
    }
    time_s
}

/// Which reading of each instrument stands in a row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    current: Option<usize>,
    curvature: Option<usize>,
}

/// Rows in order of time; readings closer than a microsecond share one.
fn merged(time_s: &[f64], camera_s: &[f64]) -> Vec<(f64, Row)> {
    let row = |current, curvature| Row { current, curvature };
    let of_current = time_s.iter().enumerate();
    let mut rows: Vec<(f64, Row)> = of_current.map(|(i, &t)| (t, row(Some(i), None))).collect();
    for (i, &t) in camera_s.iter().enumerate() {
        let at = rows.partition_point(|row| row.0 < t - 1e-6);
        match rows.get_mut(at) {
            Some(row) if (row.0 - t).abs() <= 1e-6 => row.1.curvature = Some(i),
            _ => rows.insert(at, (t, row(None, Some(i)))),
        }
    }
    rows
}

/// The differential equations under the wave itself; nothing before time zero.
fn under(model: &LumpedModel, wave: Wave, area_cm2: f64, time_s: &[f64]) -> Responses {
    let from_zero: Vec<f64> = std::iter::once(0.0)
        .chain(time_s.iter().copied().filter(|t| *t >= 0.0))
        .collect();
    let rest = time_s.len() + 1 - from_zero.len();
    let found = integrate_under(model, |t| wave.volts(t), area_cm2, &from_zero, RELATIVE);
    let whole = |series: Vec<f64>| -> Vec<f64> {
        std::iter::repeat_n(0.0, rest)
            .chain(series.into_iter().skip(1))
            .collect()
    };
    Responses {
        current_a: whole(found.current_a),
        charge_c: whole(found.charge_c),
        curvature_per_cm: whole(found.curvature_per_cm),
    }
}

/// A time without the last bits of its sum.
pub(super) fn printed(time_s: f64) -> String {
    ((time_s * 1e6).round() / 1e6).to_string()
}
