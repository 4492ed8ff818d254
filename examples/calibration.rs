//! Coverage of the 95 % intervals by simulation: `cargo run --release --example calibration -- 1000`
//!
//! Runs over the conditions of the thesis's table 5 (numbers as in campaigns/thesis/simulation.toml), sampled
//! with 60 to 36,000 points, under white and first-order autocorrelated noise, from 40 dB down to 10 dB.

use std::sync::Arc;

use ieap::domain::{Channel, Drive, Fit, Quantity};
use ieap::fit::{FitInput, FitOptions, Steps, fit_run};
use ieap::model::{Branch, LumpedModel};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Table 5: step voltage, R1, C1, R2, C2, R_ss, alpha, lambda.
const ROWS: [[f64; 8]; 18] = [
    [1.2, 64.4, 0.039, 130.3, 0.10, 64050.0, 24.62, 9.4e-5],
    [2.0, 107.6, 0.026, 124.3, 0.13, 61080.0, 26.56, 1.1e-4],
    [2.5, 92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5],
    [1.2, 173.1, 0.033, 316.2, 0.11, 109860.0, 21.50, 1.2e-4],
    [2.0, 128.2, 0.049, 305.8, 0.10, 76020.0, 22.15, 1.4e-4],
    [2.5, 124.1, 0.075, 694.7, 0.08, 76760.0, 23.14, 4.8e-5],
    [1.2, 1544.9, 0.010, 844.1, 0.22, 18510.0, 12.46, 1.6e-4],
    [2.0, 521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4],
    [2.5, 158.1, 0.146, 638.1, 0.17, 1910.0, 12.28, 1.8e-3],
    [1.2, 37.6, 0.039, 81.5, 1.22, 1730.0, 1.97, 1.8e-4],
    [2.0, 35.4, 0.031, 63.9, 1.44, 1850.0, 2.06, 6.4e-5],
    [2.5, 34.3, 0.027, 55.3, 1.63, 1700.0, 2.02, 0.0],
    [1.2, 35.3, 0.055, 87.6, 1.56, 2360.0, 4.33, 8.5e-5],
    [2.0, 38.6, 0.030, 72.0, 1.35, 930.0, 4.74, 4.9e-6],
    [2.5, 37.8, 0.039, 68.7, 1.46, 1450.0, 4.31, 0.0],
    [1.2, 23.4, 0.060, 43.1, 1.94, 1720.0, 3.02, 2.8e-4],
    [2.0, 20.7, 0.067, 37.8, 1.87, 1000.0, 3.41, 1.1e-4],
    [2.5, 19.6, 0.053, 34.2, 1.90, 630.0, 3.07, 6.0e-5],
];
const CORRELATIONS: [f64; 4] = [0.0, 0.3, 0.6, 0.8];
const KEYS: [&str; 11] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "tau1_s",
    "tau2_s",
];
const AREA_CM2: f64 = 0.1;
const DURATION_S: f64 = 3600.0;

/// What one simulated run is like.
struct Case {
    row: usize,
    points: usize,
    correlation: f64,
    noise_db: f64,
    seed: u64,
}

impl Case {
    /// Conditions in turn, the rest drawn from the seed: points evenly in their logarithm, noise evenly in dB.
    fn of(index: usize) -> Case {
        let mut rng = ChaCha8Rng::seed_from_u64(index as u64);
        let (least, most) = (60.0_f64.ln(), 36_000.0_f64.ln());
        Case {
            row: index % ROWS.len(),
            points: (least + (most - least) * rng.random::<f64>()).exp().round() as usize,
            correlation: CORRELATIONS[index / ROWS.len() % CORRELATIONS.len()],
            noise_db: 10.0 + 30.0 * rng.random::<f64>(),
            seed: rng.random(),
        }
    }
}

fn model(row: &[f64; 8]) -> LumpedModel {
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: row[1 + 2 * k],
        capacitance_f_per_cm2: row[2 + 2 * k],
    };
    LumpedModel {
        branches: vec![branch(0), branch(1)],
        steady_state_resistance_ohm_cm2: row[5],
        charge_to_curvature_per_c_cm: row[6],
        relaxation_rate_per_s: row[7],
    }
}

fn truth(row: &[f64; 8]) -> [f64; 11] {
    let [_, r1, c1, r2, c2, rss, alpha, lambda] = *row;
    let tau = [r1 * c1, r2 * c2];
    let mut fast = [r1, c1, r2, c2];
    if tau[0] > tau[1] {
        fast = [r2, c2, r1, c1];
    }
    let parallel = 1.0 / (1.0 / r1 + 1.0 / r2);
    let [r1, c1, r2, c2] = fast;
    [
        r1,
        c1,
        r2,
        c2,
        rss,
        alpha,
        lambda,
        c1 + c2,
        parallel,
        r1 * c1,
        r2 * c2,
    ]
}

/// Exact values plus noise with that lag-1 correlation; the signal's mean square is `noise_db` above it.
fn noisy(exact: &[f64], case: &Case, rng: &mut ChaCha8Rng) -> Arc<[f64]> {
    let power = exact.iter().map(|v| v * v).sum::<f64>() / exact.len() as f64;
    let sd = (power / 10.0_f64.powf(case.noise_db / 10.0)).sqrt();
    let rho = case.correlation;
    let mut last: f64 = StandardNormal.sample(rng);
    let mut next = |value: &f64| {
        let fresh: f64 = StandardNormal.sample(rng);
        last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
        value + sd * last
    };
    exact.iter().map(&mut next).collect()
}

fn fit(case: &Case, method: Steps) -> Option<Fit> {
    let row = &ROWS[case.row];
    let (model, drive) = (model(row), Drive::step(row[0]));
    let time_s: Arc<[f64]> = (0..case.points)
        .map(|k| DURATION_S * k as f64 / case.points as f64)
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(case.seed);
    let mut channel = |quantity, exact: Vec<f64>| {
        let values = noisy(&exact, case, &mut rng);
        Channel::new(quantity, time_s.clone(), values)
    };
    let channels = [
        channel(Quantity::Current, model.current_a(&drive, AREA_CM2, &time_s)),
        channel(
            Quantity::Curvature,
            model.curvature_per_cm(&drive, AREA_CM2, &time_s),
        ),
    ];
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let options = FitOptions {
        steps: method,
        ..FitOptions::default()
    };
    fit_run(&input, &options).ok()
}

/// What became of one parameter over many runs.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    runs: usize,
    determined: usize,
    inside: usize,
    bounded: usize,
    bound_true: usize,
    deviation: f64,
    deviation_square: f64,
}

impl Count {
    fn add(&mut self, fit: &Fit, key: &str, expected: f64) {
        self.runs += 1;
        let Some(estimate) = fit.parameter(key) else {
            return;
        };
        let low = estimate.low_95.unwrap_or(f64::NEG_INFINITY);
        let high = estimate.high_95.unwrap_or(f64::INFINITY);
        let holds = low <= expected && expected <= high;
        match (estimate.value, estimate.standard_error) {
            (Some(value), Some(error)) => {
                self.determined += 1;
                self.inside += usize::from(holds);
                // Positive parameters by their logarithm, in which their intervals are even.
                let signed = key == "alpha_per_c_cm" || key == "lambda_per_s" || key == "rss_ohm_cm2";
                let deviation = match (signed, key) {
                    (true, "rss_ohm_cm2") => (value / expected - 1.0) / (error / value),
                    (true, _) => (value - expected) / error,
                    (false, _) => (value / expected).ln() / (error / value),
                };
                self.deviation += deviation;
                self.deviation_square += deviation * deviation;
            }
            _ if low.is_finite() || high.is_finite() => {
                self.bounded += 1;
                self.bound_true += usize::from(holds);
            }
            _ => {}
        }
    }

    fn line(&self, key: &str) -> String {
        let share = |part: usize, of: usize| {
            if of == 0 {
                "-".to_owned()
            } else {
                format!("{:.1}", 100.0 * part as f64 / of as f64)
            }
        };
        let n = self.determined.max(1) as f64;
        let bias = self.deviation / n;
        format!(
            "| {key} | {} | {} | {} | {} | {} | {bias:+.2} |",
            share(self.determined, self.runs),
            share(self.inside, self.determined),
            share(self.bounded, self.runs),
            share(self.bound_true, self.bounded),
            share(self.runs - self.determined - self.bounded, self.runs),
        )
    }
}

fn table(title: &str, fits: &[(Case, Option<Fit>)], keep: impl Fn(&Case) -> bool) {
    println!("\n{title}\n");
    println!(
        "| parameter | determined % | covered % | bounded % | bound holds % | open % | bias, standard errors |"
    );
    println!("|---|---|---|---|---|---|---|");
    let kept: Vec<&(Case, Option<Fit>)> = fits.iter().filter(|(case, _)| keep(case)).collect();
    for (k, key) in KEYS.iter().enumerate() {
        let mut count = Count::default();
        for (case, fit) in &kept {
            if let Some(fit) = fit {
                count.add(fit, key, truth(&ROWS[case.row])[k]);
            }
        }
        println!("{}", count.line(key));
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<usize> = words.iter().filter_map(|text| text.parse().ok()).collect();
    let runs = numbers.first().copied().unwrap_or(1000);
    let from = numbers.get(1).copied().unwrap_or(0);
    let method = if words.iter().any(|word| word == "simultaneous") {
        Steps::Simultaneous
    } else {
        Steps::TwoStep
    };
    let start = std::time::Instant::now();
    let fits: Vec<(Case, Option<Fit>)> = (from..from + runs)
        .into_par_iter()
        .map(|index| {
            let case = Case::of(index);
            let fit = fit(&case, method);
            (case, fit)
        })
        .collect();
    let failed = fits.iter().filter(|(_, fit)| fit.is_none()).count();
    let unsettled = fits
        .iter()
        .filter(|(_, fit)| fit.as_ref().is_some_and(|fit| !fit.converged))
        .count();
    println!(
        "{runs} runs from seed {from}, {failed} failed, {unsettled} not converged, {:.1} s",
        start.elapsed().as_secs_f64()
    );
    table("All runs", &fits, |_| true);
    if words.iter().any(|word| word == "parts") {
        for rho in CORRELATIONS {
            table(&format!("Correlation {rho}"), &fits, |case| {
                case.correlation == rho
            });
        }
        for low in [10.0, 20.0, 30.0] {
            table(&format!("{low} to {} dB", low + 10.0), &fits, |case| {
                (low..low + 10.0).contains(&case.noise_db)
            });
        }
        for (low, high) in [(60, 300), (300, 2000), (2000, 36_001)] {
            table(&format!("{low} to {high} points"), &fits, |case| {
                (low..high).contains(&case.points)
            });
        }
    }
}
