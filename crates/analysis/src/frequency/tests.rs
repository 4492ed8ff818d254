//! Waves of known amplitude and phase.

use std::f64::consts::TAU;

use super::*;
use ieap_domain::testing::run;

const AMPERE_PER_VOLT: f64 = 2e-4;
const PER_CM_VOLT: f64 = 0.3;

/// A response that leads by 40 degrees and one that trails by 70, with a trend and noise, under a voltage of that phase.
fn record(phase: impl Fn(f64) -> f64, every_s: f64, until_s: f64) -> FrequencyRun {
    let time_s: Vec<f64> = (0..=(until_s / every_s) as usize)
        .map(|k| k as f64 * every_s)
        .collect();
    // Of no chance: the same in every run, and hardly correlated.
    let noise = |k: usize, size: f64| size * (((k * 7919) % 1009) as f64 / 504.5 - 1.0);
    let series = |size: f64, angle: f64, trend: f64, scatter: f64| -> Vec<f64> {
        let one = |(k, t): (usize, &f64)| {
            size * (phase(*t) + angle.to_radians()).sin() + trend * t + noise(k, scatter)
        };
        time_s.iter().enumerate().map(one).collect()
    };
    let volts = series(2.0, 0.0, 0.0, 1e-3);
    let channel = |quantity, values: Vec<f64>| Channel::new(quantity, time_s.clone().into(), values.into());
    let channels = [
        channel(Quantity::Current, series(2.0 * AMPERE_PER_VOLT, 40.0, 1e-7, 4e-6)),
        channel(Quantity::Curvature, series(2.0 * PER_CM_VOLT, -70.0, 1e-4, 6e-3)),
    ];
    let mut run = run("wave.csv", "S1", "air", None, 2.0);
    run.drive = Some(Drive::staircase(&time_s, &volts, 0.0));
    frequency_run(&run, &channels, None).unwrap()
}

#[track_caller]
fn holds(point: &FrequencyPoint, allowed: f64) {
    let pairs = [
        (point.current.unwrap(), AMPERE_PER_VOLT, 40.0),
        (point.curvature.unwrap(), PER_CM_VOLT, -70.0),
    ];
    for (found, amplitude, phase_deg) in pairs {
        assert!((found.amplitude() / amplitude - 1.0).abs() < allowed, "{point:?}");
        assert!(
            (found.phase_deg() - phase_deg).abs() < 60.0 * allowed,
            "{point:?}"
        );
        assert!(
            found.half_95 > 0.0 && found.half_95 < 0.02 * amplitude,
            "{point:?}"
        );
    }
}

#[test]
fn a_sine_gives_one_point_with_amplitude_and_phase() {
    let found = record(|t| TAU * 0.1 * t, 0.2, 120.0);
    assert_eq!((found.waveform, found.measured.len()), ("sine", 1));
    assert!((found.measured[0].frequency_hz - 0.1).abs() < 1e-4);
    holds(&found.measured[0], 3e-3);
}

#[test]
fn a_chirp_gives_a_point_for_every_two_periods() {
    let slow_s = 1200.0 / 50.0_f64.ln();
    let found = record(|t| TAU * 0.01 * slow_s * (t / slow_s).exp_m1(), 0.1, 1200.0);
    assert_eq!(found.waveform, "chirp");
    assert!(found.measured.len() > 50, "{}", found.measured.len());
    let (first, last) = (&found.measured[0], &found.measured[found.measured.len() - 1]);
    assert!(
        first.frequency_hz < 0.02 && last.frequency_hz > 0.45,
        "{first:?} {last:?}"
    );
    for point in &found.measured {
        holds(point, 0.02);
    }
}

#[test]
fn a_step_has_no_frequency() {
    let mut step = run("step.csv", "S1", "air", None, 2.0);
    step.drive = Some(Drive::step(2.0));
    assert_eq!(frequency_run(&step, &[], None), None);
}
