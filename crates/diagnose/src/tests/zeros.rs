//! Zeros and drifts of instruments, which the readings at rest show.

use super::*;

/// Readings before the drive, s.
const AT_REST: usize = 40;

/// Runs with readings at rest; `added` to the channels of each run by its place, the quantity, and the part of the record.
fn resting(added: impl Fn(usize, Quantity, f64) -> f64) -> Runs {
    let mut runs = Runs::with(None, FOUR, 21);
    let mut random = ChaCha8Rng::seed_from_u64(22);
    for (run, channels) in runs.channels.iter_mut().enumerate() {
        for channel in channels {
            let quiet: Vec<f64> = channel.values.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let sd = (quiet.iter().map(|d| d * d).sum::<f64>() / (2 * quiet.len()) as f64).sqrt();
            let peak = channel.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            let rest = (0..AT_REST).map(|k| {
                let own: f64 = StandardNormal.sample(&mut random);
                (k as f64 - AT_REST as f64, sd * own)
            });
            let all: Vec<(f64, f64)> = rest
                .chain(channel.time_s.iter().copied().zip(channel.values.iter().copied()))
                .collect();
            let span_s = all[all.len() - 1].0 - all[0].0;
            let value =
                |(t, v): &(f64, f64)| v + peak * added(run, channel.quantity, (t + AT_REST as f64) / span_s);
            *channel = Channel::new(
                channel.quantity,
                all.iter().map(|(t, _)| *t).collect(),
                all.iter().map(value).collect(),
            );
        }
    }
    runs
}

#[test]
fn a_zero_of_each_run_and_a_drift_of_the_laser_are_no_misfit() {
    let none = resting(|_, _, _| 0.0).diagnosed();
    let zeros = resting(|run, quantity, _| match quantity {
        Quantity::Current => [0.004, -0.003, 0.002, -0.005][run],
        _ => 0.0,
    });
    let drifts = resting(|run, quantity, part| match quantity {
        Quantity::Current => 0.0,
        _ => [0.012, -0.008, -0.015, 0.01][run] * part,
    });
    for found in [none, zeros.diagnosed(), drifts.diagnosed()] {
        assert!(!found.verdict.is_misfit(), "{}", found.sentence);
    }
}
