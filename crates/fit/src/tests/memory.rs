//! Noise with a longer memory than to the reading before.

use super::*;

/// Second-order autoregression of unit variance with coefficients 0.5 and 0.3: its long sums vary 11 times as much as
/// those of white noise, while lag 1 alone says 6 times.
fn second_order(rng: &mut ChaCha8Rng, n: usize) -> Vec<f64> {
    let share = 0.91 * (1.0 - (5.0_f64 / 7.0).powi(2));
    let (mut one, mut two) = (0.0, 0.0);
    let mut next = || {
        let fresh: f64 = StandardNormal.sample(rng);
        (one, two) = (0.5 * one + 0.3 * two + share.sqrt() * fresh, one);
        one
    };
    (0..100).for_each(|_| {
        next();
    });
    (0..n).map(|_| next()).collect()
}

#[test]
fn intervals_hold_under_noise_of_second_order() {
    let (model, drive, time_s) = (model(&AIR_2V), Drive::step(2.0), times(0.0, 3600.0, 2401));
    let exact = channels(&model, &drive, &time_s, 0.0, 0.0, 0);
    let (mut held, mut stated) = (0, 0);
    for seed in 0..counted(40, 400) {
        let mut rng = ChaCha8Rng::seed_from_u64(900 + seed);
        let noisy: Vec<Channel> = (exact.iter())
            .map(|channel| {
                let peak = channel.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                let noise = second_order(&mut rng, channel.values.len());
                let values = channel.values.iter().zip(noise).map(|(v, e)| v + 3e-3 * peak * e);
                Channel::new(channel.quantity, time_s.clone(), values.collect())
            })
            .collect();
        let fit = fitted(&noisy, &drive);
        for (key, expected) in truth(&model) {
            let estimate = fit.parameter(key).unwrap();
            if let (Some(_), Some(low), Some(high)) = (estimate.value, estimate.low_95, estimate.high_95) {
                stated += 1;
                held += u64::from((low..=high).contains(&expected));
            }
        }
    }
    let share = held as f64 / stated as f64;
    println!("{held} of {stated}: {share:.3}");
    assert!(stated >= 8 * counted(40, 400), "{stated}");
    // Nine estimates of a run lean on each other: the spread is that of a third as many.
    assert!(
        (share - 0.95).abs() <= 2.5 * (0.05 * 0.95 * 3.0 / stated as f64).sqrt(),
        "{held} of {stated}"
    );
}
