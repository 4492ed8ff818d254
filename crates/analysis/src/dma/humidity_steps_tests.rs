//! Tests of finding humidity steps.

use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;

/// First-order autoregressive noise.
fn noise(seed: u64, n: usize, sigma: f64, rho: f64) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut last: f64 = StandardNormal.sample(&mut generator);
    (0..n)
        .map(|_| {
            let fresh: f64 = StandardNormal.sample(&mut generator);
            last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
            sigma * last
        })
        .collect()
}

/// Levels (percent, seconds) sampled every `every_s`, approached with that time constant.
fn program(levels: &[(f64, f64)], every_s: f64, approach_s: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut time_s, mut percent) = (Vec::new(), Vec::new());
    let (mut start_s, mut from) = (0.0, levels[0].0);
    for &(level, lasts_s) in levels {
        let count = (lasts_s / every_s) as usize;
        for k in 0..count {
            let since_s = k as f64 * every_s;
            let left = if approach_s > 0.0 {
                (-since_s / approach_s).exp()
            } else {
                0.0
            };
            time_s.push(start_s + since_s);
            percent.push(level + (from - level) * left);
        }
        let end = percent[percent.len() - 1];
        (start_s, from) = (start_s + count as f64 * every_s, end);
    }
    (time_s, percent)
}

fn add(percent: &mut [f64], noise: &[f64]) {
    percent
        .iter_mut()
        .zip(noise)
        .for_each(|(value, noise)| *value += noise);
}

#[test]
fn the_steps_of_the_thesis_are_found_to_a_reading() {
    for (every_s, approach_s) in [
        (1.0, 90.0),
        (30.0, 90.0),
        (30.0, 0.0),
        (30.0, 400.0),
        (60.0, 60.0),
    ] {
        let (time_s, mut percent) = program(
            &[(0.0, 3600.0), (40.0, 7200.0), (0.0, 7200.0)],
            every_s,
            approach_s,
        );
        let noise = noise(5, percent.len(), 0.2, 0.5);
        add(&mut percent, &noise);
        let found = find(&time_s, &percent);
        assert_eq!(found.steps.len(), 2, "{every_s} {approach_s}: {found:?}");
        for (step, start_s, from, to) in [
            (found.steps[0], 3600.0, 0.0, 40.0),
            (found.steps[1], 10_800.0, 40.0, 0.0),
        ] {
            let late = step.start_s - start_s;
            assert!(
                (-1.01 * every_s..=1.5 * every_s.max(0.1 * approach_s)).contains(&late),
                "{every_s} {approach_s}: {step:?}"
            );
            assert!((step.before_percent - from).abs() < 0.3 && (step.after_percent - to).abs() < 0.3);
            let settling = step.settled_s - step.start_s;
            assert!(
                (0.0..=4.0 * approach_s + 3.0 * every_s).contains(&settling),
                "{step:?}"
            );
        }
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_flat_humidity_has_no_steps() {
    for seed in 0..100 {
        for (sigma, rho) in [
            (0.0, 0.0),
            (0.3, 0.0),
            (1.0, 0.0),
            (2.5, 0.0),
            (0.5, 0.9),
            (1.0, 0.8),
            (1.0, 0.97),
        ] {
            for n in [20, 200, 3000] {
                let (time_s, mut percent) = program(&[(35.0, 30.0 * n as f64)], 30.0, 0.0);
                let noise = noise(seed, percent.len(), sigma, rho);
                add(&mut percent, &noise);
                let found = find(&time_s, &percent);
                assert_eq!(found.steps, [], "seed {seed}, {sigma} {rho} {n}");
            }
        }
    }
}

#[test]
fn drift_waves_doors_and_ramps_are_no_steps() {
    let n = 2000;
    let time_s: Vec<f64> = (0..n).map(|k| 30.0 * k as f64).collect();
    let cases: [(&str, Vec<f64>); 5] = [
        (
            "slow drift",
            (0..n).map(|k| 30.0 + 3.5 * k as f64 / n as f64).collect(),
        ),
        (
            "daily wave",
            (0..n).map(|k| 35.0 + 2.5 * (k as f64 / 400.0).sin()).collect(),
        ),
        (
            "large wave",
            (0..n).map(|k| 40.0 + 15.0 * (k as f64 / 320.0).sin()).collect(),
        ),
        (
            "doors",
            (0..n).map(|k| if k % 500 == 250 { 60.0 } else { 20.0 }).collect(),
        ),
        ("ramp", (0..n).map(|k| 80.0 * k as f64 / n as f64).collect()),
    ];
    for (name, mut percent) in cases {
        let noise = noise(9, n, 0.2, 0.5);
        add(&mut percent, &noise);
        let found = find(&time_s, &percent);
        assert_eq!(found.steps, [], "{name}");
        if name == "ramp" {
            assert_eq!(found.issue.unwrap().code, "humidity-drifts");
        }
    }
}

#[test]
fn a_staircase_up_and_down_is_found_whole() {
    let levels = [5.0, 20.0, 40.0, 60.0, 80.0, 60.0, 40.0, 20.0, 5.0];
    let stairs: Vec<(f64, f64)> = levels.iter().map(|&level| (level, 5400.0)).collect();
    let (time_s, mut percent) = program(&stairs, 20.0, 200.0);
    let noise = noise(2, percent.len(), 0.4, 0.3);
    add(&mut percent, &noise);
    let found = find(&time_s, &percent);
    assert_eq!(found.steps.len(), 8, "{found:?}");
    for (step, pair) in found.steps.iter().zip(levels.windows(2)) {
        assert!((step.before_percent - pair[0]).abs() < 0.5 && (step.after_percent - pair[1]).abs() < 0.5);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn steps_lie_in_order_inside_the_channel_whatever_it_holds(
        percent in prop::collection::vec(-5.0..110.0f64, 0..300),
        every_s in 0.1..600.0f64,
    ) {
        let time_s: Vec<f64> = (0..percent.len()).map(|k| k as f64 * every_s).collect();
        let found = find(&time_s, &percent).steps;
        for step in &found {
            prop_assert!(step.start_s <= step.settled_s);
            prop_assert!(time_s.contains(&step.start_s) && time_s.contains(&step.settled_s));
        }
        prop_assert!(found.windows(2).all(|pair| pair[0].start_s < pair[1].start_s));
    }

    #[test]
    fn a_clear_step_is_found_anywhere(
        at in 0.15..0.85f64, size in 8.0..80.0f64, n in 60usize..2000, seed in 0u64..1000, falls in any::<bool>(),
    ) {
        let first = ((n as f64 * at) as usize).max(8);
        let (low, high) = (5.0, 5.0 + size);
        let mut percent: Vec<f64> =
            (0..n).map(|k| if (k < first) != falls { low } else { high }).collect();
        add(&mut percent, &noise(seed, n, 0.3, 0.3));
        let time_s: Vec<f64> = (0..n).map(|k| 10.0 * k as f64).collect();
        let found = find(&time_s, &percent).steps;
        prop_assert_eq!(found.len(), 1);
        prop_assert!((found[0].start_s - 10.0 * (first as f64 - 1.0)).abs() <= 10.0, "{:?} {}", found, first);
    }
}
