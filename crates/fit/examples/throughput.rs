//! How many runs a second are fitted, and in how much memory: a few simulated runs, fitted over and over on
//! every core. `cargo run --release --example throughput -- 100000 3600 variable-projection between`; the last word puts the
//! step between two readings, so that where it was is fitted, too.

use std::sync::Arc;
use std::time::Instant;

use ieap_domain::{Channel, Drive, Edge, Level, Quantity, Segment};
use ieap_fit::{FitInput, FitOptions, fit_run};
use ieap_model::{Branch, LumpedModel};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// R1, C1, R2, C2, R_ss, alpha, lambda and step voltage of rows of the thesis's table 5.
const ROWS: [[f64; 8]; 4] = [
    [521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4, 2.0],
    [92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5, 2.5],
    [158.1, 0.146, 638.1, 0.17, 1910.0, 12.28, 1.8e-3, 2.5],
    [20.7, 0.067, 37.8, 1.87, 1000.0, 3.41, 1.1e-4, 2.0],
];
const AREA_CM2: f64 = 0.1;

/// An hour of current and curvature with noise of 1 % of the peak.
fn run(row: &[f64; 8], samples: usize, seed: u64) -> Vec<Channel> {
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: row[2 * k],
        capacitance_f_per_cm2: row[2 * k + 1],
    };
    let model = LumpedModel {
        branches: vec![branch(0), branch(1)],
        steady_state_resistance_ohm_cm2: row[4],
        charge_to_curvature_per_c_cm: row[5],
        relaxation_rate_per_s: row[6],
    };
    let time_s: Arc<[f64]> = (0..samples).map(|k| 3600.0 * k as f64 / samples as f64).collect();
    let drive = Drive::step(row[7]);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut channel = |quantity, exact: Vec<f64>| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noisy = exact.into_iter().map(|v| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            v + 0.01 * peak * noise
        });
        Channel::new(quantity, time_s.clone(), noisy.collect())
    };
    vec![
        channel(Quantity::Current, model.current_a(&drive, AREA_CM2, &time_s)),
        channel(
            Quantity::Curvature,
            model.curvature_per_cm(&drive, AREA_CM2, &time_s),
        ),
    ]
}

/// The line of /proc/self/status that begins with `key`, where there is one.
fn status_line(key: &str) -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status
        .lines()
        .find(|line| line.starts_with(key))
        .map(str::to_owned)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let runs: usize = arguments.next().as_deref().unwrap_or("10000").parse()?;
    let samples: usize = arguments.next().as_deref().unwrap_or("3600").parse()?;
    let method = arguments
        .next()
        .unwrap_or_else(|| "variable-projection".to_owned());
    let edge = match arguments.next().as_deref() {
        Some("between") => Edge::between(-1.0, 0.0),
        _ => Edge::at(0.0),
    };
    let options = FitOptions::default().with_method(&method)?;
    let measured: Vec<(Vec<Channel>, Drive)> = (0..16)
        .map(|k| {
            let level = Level::Voltage(ROWS[k % 4][7]);
            let drive = Drive {
                baseline_v: 0.0,
                segments: vec![Segment { edge, level }],
            };
            (run(&ROWS[k % 4], samples, k as u64), drive)
        })
        .collect();
    let start = Instant::now();
    let (converged, quickest_s) = (0..runs)
        .into_par_iter()
        .map(|k| {
            let (channels, drive) = &measured[k % measured.len()];
            let input = FitInput {
                channels,
                drive,
                area_cm2: AREA_CM2,
            };
            let begun = Instant::now();
            let converged = fit_run(&input, &options).is_ok_and(|fit| fit.converged);
            (usize::from(converged), begun.elapsed().as_secs_f64())
        })
        .reduce(|| (0, f64::INFINITY), |a, b| (a.0 + b.0, a.1.min(b.1)));
    let taken_s = start.elapsed().as_secs_f64();
    println!(
        "{runs} runs of {samples} x 2 readings with {method} on {} threads: {taken_s:.2} s, {:.0} runs/s, quickest {:.0} us, {converged} converged",
        rayon::current_num_threads(),
        runs as f64 / taken_s,
        1e6 * quickest_s
    );
    println!(
        "{}",
        status_line("VmHWM").unwrap_or_else(|| "peak memory not known".to_owned())
    );
    Ok(())
}
