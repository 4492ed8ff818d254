//! Intervals of trends where what scatters about them goes on from run to run.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::series::{Series, Study};
use crate::monitoring::shape::Law;
use ieap_numerics::control_chart;

/// Total drift of a series with one, and the scatter about it.
const DRIFT: f64 = 0.3;
const SCATTER: f64 = 0.05;

/// A series of 60 runs with that total drift, and scatter of that lag-1 correlation.
fn study(drift: f64, correlation: f64, seed: u64) -> Study {
    let seed = 70_000 + seed;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut scatter = normal();
    let x: Vec<f64> = (0..60).map(f64::from).collect();
    let y = x.iter().map(|x| {
        scatter = correlation * scatter + (1.0 - correlation * correlation).sqrt() * normal();
        drift * x / 59.0 + SCATTER * scatter
    });
    let series = Series {
        y: y.collect(),
        variance: vec![1e-6; x.len()],
        is_log: false,
        breaks: Vec::new(),
        x,
    };
    series.study(control_chart::limit(500.0), seed)
}

fn studies(drift: f64, correlation: f64, draws: u64) -> Vec<Study> {
    (0..draws)
        .into_par_iter()
        .map(|seed| study(drift, correlation, seed))
        .collect()
}

/// In how many the interval of the linear trend holds the truth.
fn held(studies: &[Study]) -> usize {
    let holds = |study: &&Study| {
        let linear = study.trends.iter().find(|law| law.law == Law::Linear).unwrap();
        let (low, high) = (linear.size.low_95.unwrap(), linear.size.high_95.unwrap());
        low <= DRIFT && DRIFT <= high
    };
    studies.iter().filter(holds).count()
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn the_interval_of_a_trend_holds_the_truth_where_scatter_goes_on_too() {
    // 95 of 100 are aimed at; the memory is estimated from the same 60 readings. Of 93 in 100 held, fewer than these come
    // by chance in one of 1,000 tries.
    let (correlations, draws, least): (&[f64], u64, usize) = match std::env::var_os("IEAP_LONG") {
        Some(_) => (&[0.0, 0.3, 0.6], 200, 174),
        None => (&[0.6], 40, 32),
    };
    for &correlation in correlations {
        let studies = studies(DRIFT, correlation, draws);
        let (held, both) = (
            held(&studies),
            studies.iter().filter(|study| study.change.is_some()).count(),
        );
        println!("correlation {correlation}: {held} of {draws} held; a step told beside the drift in {both}");
        assert!(held >= least, "correlation {correlation}: {held} of {draws}");
    }
}

#[test]
fn scatter_that_goes_on_is_neither_trend_nor_step() {
    // 1 in 100 is aimed at. The memory is estimated from the same 60 readings, beside the likeliest step, so that steps are
    // found; scatter that goes on is told as something in up to 3 of 100 at 0.3, and 5 at 0.6. More than these come by chance in one of
    // 1,000 tries.
    let (asked, draws): (&[(f64, usize)], u64) = match std::env::var_os("IEAP_LONG") {
        Some(_) => (&[(0.0, 11), (0.3, 23), (0.6, 34)], 400),
        None => (&[(0.6, 7)], 40),
    };
    for &(correlation, most) in asked {
        let studies = studies(0.0, correlation, draws);
        let told = studies.iter().filter(|study| study.is_shown()).count();
        println!("correlation {correlation}: told of nothing in {told} of {draws}");
        assert!(told <= most, "correlation {correlation}: {told} of {draws}");
    }
}
