//! Noise whose properties are known is found without the circuit.

use super::*;
use ieap_domain::{Channel, Drive, Quantity};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A decay with noise that the closure makes from the fresh number, the earlier noise and the signal.
fn decaying(time_s: &[f64], seed: u64, mut noise: impl FnMut(f64, &[f64], f64) -> f64) -> Sampled {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut earlier: Vec<f64> = Vec::new();
    let mut values = Vec::new();
    for t in time_s {
        let signal = 1000.0 * (-t / 300.0).exp() + 200.0 * (-t / 20.0).exp() + 30.0;
        earlier.push(noise(StandardNormal.sample(&mut rng), &earlier, signal));
        values.push(signal + earlier[earlier.len() - 1]);
    }
    let channel = Channel::new(Quantity::Current, time_s.into(), values.into());
    Sampled::new(&channel, &Drive::step(1.0), false)
}

fn even(n: usize) -> Vec<f64> {
    (0..n).map(|k| 2000.0 * k as f64 / n as f64).collect()
}

fn lag(earlier: &[f64], k: usize) -> f64 {
    earlier.len().checked_sub(k).map_or(0.0, |place| earlier[place])
}

#[test]
fn first_and_second_order_come_back() {
    let (mut first, mut size, mut second) = (0.0, 0.0, 0);
    for seed in 0..20 {
        let rho = 0.6_f64;
        let sampled = decaying(&even(400), seed, |fresh, earlier, _| {
            rho * lag(earlier, 1) + (1.0 - rho * rho).sqrt() * fresh
        });
        let found = Noise::of(&sampled, 0.0);
        let Autocorrelation::Order(coefficients) = &found.autocorrelation else {
            panic!("{found:?}")
        };
        first += coefficients[0] / 20.0;
        size += found.floor / 20.0;
        let twice = decaying(&even(2000), seed, |fresh, earlier, _| {
            0.3 * lag(earlier, 1) + 0.5 * lag(earlier, 2) + fresh
        });
        let Autocorrelation::Order(coefficients) = Noise::of(&twice, 0.0).autocorrelation else {
            panic!()
        };
        second += usize::from(coefficients.len() == 2 && (coefficients[1] - 0.5).abs() < 0.1);
    }
    assert!(
        (first - 0.6).abs() < 0.04 && (size - 1.0).abs() < 0.05,
        "{first} {size}"
    );
    assert!(second >= 16, "{second} of 20");
}

#[test]
fn memory_by_time_is_told_from_memory_by_order() {
    // Dense at first, then ten times sparser: noise of a process in time forgets more between the sparse ones.
    let mut time_s: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.5).collect();
    time_s.extend((0..400).map(|k| 200.0 + 5.0 * f64::from(k)));
    let (mut by_time, mut times) = (0, 0.0);
    for seed in 0..10 {
        let mut k = 0;
        let sampled = decaying(&time_s, seed, |fresh, earlier, _| {
            let rho: f64 = if k == 0 {
                0.0
            } else {
                (-(time_s[k] - time_s[k - 1]) / 2.0).exp()
            };
            k += 1;
            rho * lag(earlier, 1) + (1.0 - rho * rho).sqrt() * fresh
        });
        if let Autocorrelation::Time { correlation_time_s } = Noise::of(&sampled, 0.0).autocorrelation {
            by_time += 1;
            times += correlation_time_s;
        }
    }
    assert!(by_time >= 9, "{by_time} of 10");
    let mean = times / f64::from(by_time);
    assert!((1.4..2.8).contains(&mean), "{mean}");
}

#[test]
fn growth_and_converter_are_seen_and_not_invented() {
    let growing = decaying(&even(2000), 1, |fresh, _, signal| {
        (1.0 + (0.01 * signal).powi(2)).sqrt() * fresh
    });
    let found = Noise::of(&growing, 0.0);
    assert!(
        (found.proportional / 0.01 - 1.0).abs() < 0.3,
        "{}",
        found.proportional
    );
    assert!((found.floor - 1.0).abs() < 0.3, "{}", found.floor);
    for seed in 0..20 {
        let plain = Noise::of(&decaying(&even(1000), seed, |fresh, _, _| fresh), 0.0);
        assert_eq!((plain.proportional, plain.quantum), (0.0, 0.0));
    }
    let mut coarse = decaying(&even(2000), 2, |fresh, _, _| 0.2 * fresh);
    coarse.values = coarse.values.iter().map(|v| (v / 5.0).round() * 5.0).collect();
    let found = Noise::of(&coarse, 0.0);
    assert!(
        (found.quantum - 5.0).abs() < 1e-9 && found.floor >= 5.0 / 12.0_f64.sqrt(),
        "{found:?}"
    );
}

#[test]
fn noise_that_grows_beside_a_fit_stays_noise_and_what_the_fit_follows_is_none() {
    let growing = decaying(&even(1500), 3, |fresh, _, signal| {
        fresh * (1.0 + (0.01 * signal).powi(2)).sqrt()
    });
    let exact = decaying(&even(1500), 3, |_, _, _| 0.0);
    let left: Vec<f64> = (growing.values.iter().zip(exact.values.iter()))
        .map(|(reading, exact)| reading - exact)
        .collect();
    let kept = Noise::beside_fit(&growing, &left, 0.0).proportional;
    assert!((kept / 0.01 - 1.0).abs() < 0.3, "{kept}");
    let even: Vec<f64> = (left.iter().zip(exact.values.iter()))
        .map(|(left, exact)| left / (1.0 + (0.01 * exact).powi(2)).sqrt())
        .collect();
    assert_eq!(Noise::beside_fit(&growing, &even, 0.0).proportional, 0.0);
}
