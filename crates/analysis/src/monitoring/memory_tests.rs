//! Intervals of trends where what scatters about them goes on from run to run.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::series::{Limits, Series};
use crate::laws::shape::Law;

/// In how many of `draws` series of 60 runs the interval of the linear trend holds the truth, with scatter of that lag-1
/// correlation.
fn held(correlation: f64, draws: u64) -> usize {
    let total = 0.3;
    let limits = Limits::for_false_alarms(500.0);
    let holds = |seed: &u64| {
        let mut random = ChaCha8Rng::seed_from_u64(*seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut scatter = normal();
        let x: Vec<f64> = (0..60).map(f64::from).collect();
        let y = x.iter().map(|x| {
            scatter = correlation * scatter + (1.0 - correlation * correlation).sqrt() * normal();
            total * x / 59.0 + 0.05 * scatter
        });
        let series = Series {
            y: y.collect(),
            variance: vec![1e-6; x.len()],
            is_log: false,
            breaks: Vec::new(),
            x,
        };
        let study = series.study(limits, *seed);
        let linear = study.trends.iter().find(|law| law.law == Law::Linear).unwrap();
        let (low, high) = (linear.size.low_95.unwrap(), linear.size.high_95.unwrap());
        low <= total && total <= high
    };
    (0..draws).filter(|seed| holds(seed)).count()
}

#[test]
fn the_interval_of_a_trend_holds_the_truth_where_scatter_goes_on_too() {
    // 95 of 100 are aimed at; the memory is estimated from the same 60 readings. Of 93 in 100 held, fewer than these come
    // by chance in one of 1,000 tries.
    let (correlations, draws, least): (&[f64], u64, usize) = match std::env::var_os("IEAP_LONG") {
        Some(_) => (&[0.0, 0.3, 0.6], 200, 174),
        None => (&[0.6], 40, 32),
    };
    for &correlation in correlations {
        let held = held(correlation, draws);
        println!("correlation {correlation}: {held} of {draws} held");
        assert!(held >= least, "correlation {correlation}: {held} of {draws}");
    }
}
