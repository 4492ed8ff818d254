//! Coverage of the 95 % intervals by simulation: for rows of the thesis's table 5 and noise of several
//! correlations, how often the interval holds the true value. `cargo run --release --example calibration -- 400`

use std::sync::Arc;

use ieap::domain::{Channel, Drive, Quantity};
use ieap::fit::{FitInput, FitOptions, fit_run};
use ieap::model::{Branch, LumpedModel};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Name; R1, C1, R2, C2, R_ss, alpha, lambda; step voltage.
const ROWS: [(&str, [f64; 7], f64); 5] = [
    (
        "CNaf vacuum 1.2 V",
        [64.4, 0.039, 130.3, 0.10, 64050.0, 24.62, 9.4e-5],
        1.2,
    ),
    (
        "CNaf vacuum 2.5 V",
        [92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5],
        2.5,
    ),
    (
        "CNaf air 2.0 V",
        [521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4],
        2.0,
    ),
    (
        "CNaf air 2.5 V",
        [158.1, 0.146, 638.1, 0.17, 1910.0, 12.28, 1.8e-3],
        2.5,
    ),
    (
        "CPvf air 2.0 V",
        [20.7, 0.067, 37.8, 1.87, 1000.0, 3.41, 1.1e-4],
        2.0,
    ),
];
const AREA_CM2: f64 = 0.1;
const DURATION_S: f64 = 3600.0;

fn model(row: &[f64; 7]) -> LumpedModel {
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: row[2 * k],
        capacitance_f_per_cm2: row[2 * k + 1],
    };
    LumpedModel {
        branches: vec![branch(0), branch(1)],
        steady_state_resistance_ohm_cm2: row[4],
        charge_to_curvature_per_c_cm: row[5],
        relaxation_rate_per_s: row[6],
    }
}

/// Exact values plus noise of `relative` times the peak with lag-1 correlation `rho`.
fn noisy(exact: &[f64], relative: f64, rho: f64, rng: &mut ChaCha8Rng) -> Arc<[f64]> {
    let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let mut last: f64 = StandardNormal.sample(rng);
    let mut next = |value: &f64| {
        let fresh: f64 = StandardNormal.sample(rng);
        last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
        value + relative * peak * last
    };
    exact.iter().map(&mut next).collect()
}

fn main() {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let runs = numbers.next().and_then(Result::ok).unwrap_or(400);
    let samples = numbers.next().and_then(Result::ok).unwrap_or(1800);
    println!(
        "{runs} runs of {samples} samples each; share of 95 % intervals that hold the true value, and how many intervals or bounds were given"
    );
    for relative in [0.003, 0.03] {
        for rho in [0.0, 0.3, 0.6] {
            for (name, row, level_v) in &ROWS {
                let line = coverage(row, *level_v, samples, relative, rho, runs);
                println!("noise {relative} rho {rho} {name:18} {line}");
            }
        }
    }
}

fn coverage(row: &[f64; 7], level_v: f64, samples: usize, relative: f64, rho: f64, runs: usize) -> String {
    let (model, drive) = (model(row), Drive::step(level_v));
    let time_s: Arc<[f64]> = (0..samples)
        .map(|k| DURATION_S * k as f64 / samples as f64)
        .collect();
    let current_a = model.current_a(&drive, AREA_CM2, &time_s);
    let curvature_per_cm = model.curvature_per_cm(&drive, AREA_CM2, &time_s);
    let parallel = 1.0 / (1.0 / row[0] + 1.0 / row[2]);
    let truth = [
        ("r1_ohm_cm2", row[0]),
        ("c1_f_per_cm2", row[1]),
        ("r2_ohm_cm2", row[2]),
        ("c2_f_per_cm2", row[3]),
        ("rss_ohm_cm2", row[4]),
        ("alpha_per_c_cm", row[5]),
        ("lambda_per_s", row[6]),
        ("c_total_f_per_cm2", row[1] + row[3]),
        ("r_parallel_ohm_cm2", parallel),
    ];
    let mut counts = [(0_usize, 0_usize); 9];
    for seed in 0..runs {
        let mut rng = ChaCha8Rng::seed_from_u64(seed as u64);
        let channels = [
            Channel::new(
                Quantity::Current,
                time_s.clone(),
                noisy(&current_a, relative, rho, &mut rng),
            ),
            Channel::new(
                Quantity::Curvature,
                time_s.clone(),
                noisy(&curvature_per_cm, relative, rho, &mut rng),
            ),
        ];
        let input = FitInput {
            channels: &channels,
            drive: &drive,
            area_cm2: AREA_CM2,
        };
        let Ok(fit) = fit_run(&input, &FitOptions::default()) else {
            continue;
        };
        for ((key, expected), count) in truth.iter().zip(&mut counts) {
            let Some(estimate) = fit.parameter(key) else {
                continue;
            };
            // A bound is an interval that is open to one side; where nothing is stated nothing can be wrong.
            if estimate.low_95.is_some() || estimate.high_95.is_some() {
                let low = estimate.low_95.unwrap_or(f64::NEG_INFINITY);
                let high = estimate.high_95.unwrap_or(f64::INFINITY);
                count.1 += 1;
                count.0 += usize::from(low <= *expected && *expected <= high);
            }
        }
    }
    let cells = truth.iter().zip(counts).map(|((key, _), (inside, of))| {
        let short = key.split('_').take(2).collect::<Vec<_>>().join("_");
        if of == 0 {
            format!("{short} -")
        } else {
            format!("{short} {:.1}/{of}", 100.0 * inside as f64 / of as f64)
        }
    });
    cells.collect::<Vec<_>>().join("  ")
}
