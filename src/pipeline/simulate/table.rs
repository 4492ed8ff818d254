//! The run table of a simulated run: sampled model, noise, rows.

use std::fmt::Write;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::spec::{RunSpec, Sampling, Spec};
use crate::domain::{Drive, Level};

/// The text of the run table. `number` (the run's place in the spec) and the spec's seed fix the noise.
pub fn run_table(spec: &Spec, run: &RunSpec, number: usize) -> String {
    let (drive, model) = (run.drive(), run.model());
    let time_s = times(spec, &spec.sampling);
    let camera_s = if spec.camera.is_empty() {
        time_s.clone()
    } else {
        times(spec, &spec.camera)
    };
    let noise = |stream: u64, sigma: f64, count: usize| {
        let mut generator = ChaCha8Rng::seed_from_u64(spec.simulation.seed);
        generator.set_stream(2 * number as u64 + stream);
        correlated(&mut generator, sigma, spec.noise.autocorrelation, count)
    };
    let mut current_a = model.current_a(&drive, run.area_cm2, &time_s);
    add(&mut current_a, &noise(0, spec.noise.current_a, time_s.len()));
    if spec.noise.current_step_a > 0.0 {
        current_a
            .iter_mut()
            .for_each(|i| *i = (*i / spec.noise.current_step_a).round() * spec.noise.current_step_a);
    }
    let mut curvature_per_cm = model.curvature_per_cm(&drive, run.area_cm2, &camera_s);
    add(
        &mut curvature_per_cm,
        &noise(1, spec.noise.curvature_per_cm, camera_s.len()),
    );

    let mut text = String::new();
    for line in &spec.simulation.statement {
        let _ = writeln!(text, "# {line}");
    }
    let has_open_circuit = drive.segments.iter().any(|s| s.level == Level::OpenCircuit);
    let open_column = if has_open_circuit { ",open_circuit" } else { "" };
    let _ = writeln!(text, "time_s,voltage_v,current_a,curvature_per_cm{open_column}");
    for (t, row) in merged(&time_s, &camera_s) {
        let (voltage, open) = applied(&drive, t);
        let current = row
            .current
            .map(|i| format!("{:.5e}", current_a[i]))
            .unwrap_or_default();
        let curvature = row
            .curvature
            .map(|i| format!("{:.5}", curvature_per_cm[i]))
            .unwrap_or_default();
        let open = if has_open_circuit {
            format!(",{}", u8::from(open))
        } else {
            String::new()
        };
        let _ = writeln!(text, "{},{voltage},{current},{curvature}{open}", printed(t));
    }
    text
}

/// Sampling times: the baseline, then each stretch.
fn times(spec: &Spec, stretches: &[Sampling]) -> Vec<f64> {
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

/// First-order autoregressive noise of standard deviation `sigma`.
fn correlated(generator: &mut ChaCha8Rng, sigma: f64, autocorrelation: f64, count: usize) -> Vec<f64> {
    let fresh = (1.0 - autocorrelation * autocorrelation).sqrt();
    let mut last: f64 = StandardNormal.sample(generator);
    (0..count)
        .map(|_| {
            let noise = sigma * last;
            let next: f64 = StandardNormal.sample(generator);
            last = autocorrelation * last + fresh * next;
            noise
        })
        .collect()
}

fn add(values: &mut [f64], noise: &[f64]) {
    values
        .iter_mut()
        .zip(noise)
        .for_each(|(value, noise)| *value += noise);
}

/// Which reading of each instrument stands in a row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Row {
    current: Option<usize>,
    curvature: Option<usize>,
}

/// Rows in order of time; readings closer than a microsecond share one.
fn merged(time_s: &[f64], camera_s: &[f64]) -> Vec<(f64, Row)> {
    let mut rows: Vec<(f64, Row)> = time_s
        .iter()
        .enumerate()
        .map(|(i, &t)| {
            (
                t,
                Row {
                    current: Some(i),
                    curvature: None,
                },
            )
        })
        .collect();
    for (i, &t) in camera_s.iter().enumerate() {
        let at = rows.partition_point(|row| row.0 < t - 1e-6);
        match rows.get_mut(at) {
            Some(row) if (row.0 - t).abs() <= 1e-6 => row.1.curvature = Some(i),
            _ => rows.insert(
                at,
                (
                    t,
                    Row {
                        current: None,
                        curvature: Some(i),
                    },
                ),
            ),
        }
    }
    rows
}

/// The voltage cell at a time (empty in an open circuit) and whether the circuit is open.
fn applied(drive: &Drive, time_s: f64) -> (String, bool) {
    let segment = drive
        .segments
        .iter()
        .rev()
        .find(|segment| segment.start_s <= time_s);
    match segment.map_or(Level::Voltage(drive.baseline_v), |segment| segment.level) {
        Level::Voltage(voltage_v) => (voltage_v.to_string(), false),
        Level::OpenCircuit => (String::new(), true),
    }
}

/// A time without the last bits of its sum.
fn printed(time_s: f64) -> String {
    ((time_s * 1e6).round() / 1e6).to_string()
}
