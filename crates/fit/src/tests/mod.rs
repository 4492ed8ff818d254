//! Fits of simulated runs whose parameters are known.

mod bending;
mod branches;
mod calibration;
mod edges;
mod groups;
mod kinds;
mod known;
mod limits;
mod memory;
mod moving;
mod one_fit;
mod outliers;
mod recovery;
mod reductions;
mod step_and_spectrum;
mod stopped;

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use ieap_domain::{Channel, Drive, Level, Quantity, Segment};
use ieap_model::{Branch, LumpedModel};

/// Rows of the thesis's table 5: R1, C1, R2, C2, R_ss, alpha, lambda, and the step voltage.
pub(super) const AIR_2V: [f64; 8] = [521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4, 2.0];
const CPVF_AIR_1V: [f64; 8] = [23.4, 0.060, 43.1, 1.94, 1720.0, 3.02, 2.8e-4, 1.2];
const AREA_CM2: f64 = 0.1;

pub(super) fn model(row: &[f64; 8]) -> LumpedModel {
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

fn times(from_s: f64, to_s: f64, n: usize) -> Arc<[f64]> {
    (0..n)
        .map(|k| from_s + (to_s - from_s) * k as f64 / (n - 1) as f64)
        .collect()
}

/// Noise with lag-1 correlation `rho` and standard deviation `sd`.
fn noise(rng: &mut ChaCha8Rng, n: usize, sd: f64, rho: f64) -> Vec<f64> {
    let mut last: f64 = StandardNormal.sample(rng);
    let mut next = || {
        let fresh: f64 = StandardNormal.sample(rng);
        last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
        sd * last
    };
    (0..n).map(|_| next()).collect()
}

/// Current and curvature of `model`; noise is `relative` of the peak of each.
fn channels(
    model: &LumpedModel,
    drive: &Drive,
    time_s: &Arc<[f64]>,
    relative: f64,
    rho: f64,
    seed: u64,
) -> Vec<Channel> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut channel = |quantity, exact: Vec<f64>| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noise = noise(&mut rng, exact.len(), relative * peak, rho);
        Channel::new(
            quantity,
            time_s.clone(),
            exact.iter().zip(noise).map(|(a, b)| a + b).collect(),
        )
    };
    vec![
        channel(Quantity::Current, model.current_a(drive, AREA_CM2, time_s)),
        channel(
            Quantity::Curvature,
            model.curvature_per_cm(drive, AREA_CM2, time_s),
        ),
    ]
}

fn fitted(channels: &[Channel], drive: &Drive) -> Fit {
    let input = FitInput {
        channels,
        drive,
        area_cm2: AREA_CM2,
    };
    fit_run(&input, &FitOptions::default()).unwrap()
}

fn truth(model: &LumpedModel) -> Vec<(&'static str, f64)> {
    let [a, b] = [model.branches[0], model.branches[1]];
    let conductance = a.resistance_ohm_cm2.recip() + b.resistance_ohm_cm2.recip();
    vec![
        ("r1_ohm_cm2", a.resistance_ohm_cm2),
        ("c1_f_per_cm2", a.capacitance_f_per_cm2),
        ("r2_ohm_cm2", b.resistance_ohm_cm2),
        ("c2_f_per_cm2", b.capacitance_f_per_cm2),
        ("rss_ohm_cm2", model.steady_state_resistance_ohm_cm2),
        ("alpha_per_c_cm", model.charge_to_curvature_per_c_cm),
        ("lambda_per_s", model.relaxation_rate_per_s),
        ("c_total_f_per_cm2", model.total_capacitance_f_per_cm2()),
        ("r_parallel_ohm_cm2", conductance.recip()),
    ]
}

#[track_caller]
fn assert_recovers(fit: &Fit, model: &LumpedModel, within: f64) {
    for (key, expected) in truth(model) {
        let estimate = fit.parameter(key).unwrap();
        let Some(value) = estimate.value else {
            panic!("{key}: {estimate:?}")
        };
        assert!(
            (value / expected - 1.0).abs() < within,
            "{key}: {value} instead of {expected}"
        );
    }
}

/// How many simulated runs a proof takes: few, so that an edit is tested within seconds, or as many as the
/// statement deserves where `IEAP_LONG` is set (`IEAP_LONG=1 cargo test --release --lib fit::tests`).
fn counted(few: u64, many: u64) -> u64 {
    match std::env::var_os("IEAP_LONG") {
        Some(_) => many,
        None => few,
    }
}
