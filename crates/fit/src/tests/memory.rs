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

/// Of 27 readings, as many a short record has, 29 of 62 measured ones were said to remember from one reading to the next by more
/// than 0.99, which swallowed the transient: a record shows no memory as long as itself.
#[test]
fn short_records_state_their_time_constants_and_hold() {
    let drive = Drive::step(2.0);
    let time_s: Arc<[f64]> = (0..27).map(|k| 40.0 * f64::from(k)).collect();
    let truth = LumpedModel {
        branches: vec![Branch {
            resistance_ohm_cm2: 400.0,
            capacitance_f_per_cm2: 0.4,
        }],
        ..model(&AIR_2V)
    };
    let (mut stated, mut held, mut longest, mut of) = (0, 0, 0.0_f64, 0);
    for rho in [0.0, 0.6] {
        for seed in 0..counted(15, 100) {
            let mut run = channels(&truth, &drive, &time_s, 0.01, rho, 5000 + seed);
            run.truncate(1);
            let input = FitInput {
                channels: &run,
                drive: &drive,
                area_cm2: AREA_CM2,
            };
            let fit = fit_run(&input, &FitOptions::for_model("lumped-1").unwrap()).unwrap();
            let tau = fit.parameter("tau1_s").unwrap();
            stated += usize::from(tau.value.is_some());
            held += usize::from(tau.low_95 <= Some(160.0) && tau.high_95 >= Some(160.0));
            let memory = &fit.noise[0].character.autoregression;
            longest = longest.max(memory.first().copied().unwrap_or(0.0));
            of += 1;
        }
    }
    println!("{stated} of {of} stated, {held} hold, largest memory {longest}");
    assert!(
        10 * stated >= 9 * of && 10 * held >= 9 * stated && longest < 0.97,
        "{stated} {held} {of} {longest}"
    );
}
