//! A humidity that wanders while runs go on, and a sensor beside the strip that logs it.

use std::f64::consts::TAU;

use super::*;

/// Relative humidity around a run, percent: a wave, and a drift.
fn humidity(run: usize, t: f64) -> f64 {
    40.0 + 6.0 * (TAU * t / 170.0 + run as f64).sin() + 0.004 * t
}

/// Four runs of a strip that leaks by so much, S/cm2, for each percent of the humidity above 40; the leak is added here by hand.
fn leaking(by: f64, seed: u64) -> Runs {
    let mut runs = Runs::with(None, FOUR, seed);
    for (run, (drive, channels)) in runs.drives.iter().zip(&mut runs.channels).enumerate() {
        let current = &mut channels[0];
        let readings = current.time_s.iter().zip(current.values.iter());
        let read = |(t, i): (&f64, &f64)| {
            let volts = drive.level_at(*t).volts().unwrap_or(0.0);
            i + AREA_CM2 * volts * by * (humidity(run, *t) - 40.0)
        };
        current.values = readings.map(read).collect();
    }
    runs
}

/// With what the sensor says every ten seconds, to a tenth of a percent.
fn logged(mut runs: Runs) -> Runs {
    for (run, channels) in runs.channels.iter_mut().enumerate() {
        let time_s: Vec<f64> = (0..=60).map(|k| 10.0 * f64::from(k)).collect();
        let digits = |t: &f64| (10.0 * humidity(run, *t)).round() / 10.0;
        let values: Vec<f64> = time_s.iter().map(digits).collect();
        channels.push(Channel::new(
            Quantity::RelativeHumidity,
            time_s.into(),
            values.into(),
        ));
    }
    runs
}

#[test]
fn a_leak_that_follows_the_logged_humidity_is_told_with_it() {
    let found = logged(leaking(8e-5, 51)).diagnosed();
    let told: Vec<_> = found
        .missing
        .iter()
        .map(|law| (law.law.as_deref(), law.variable.as_deref()))
        .collect();
    assert_eq!(
        told,
        [(Some("leak"), Some("relative_humidity_percent"))],
        "{}",
        found.sentence
    );
    assert!(found.sentence.contains("relative humidity"), "{}", found.sentence);
    let curve = found.missing[0].curve.as_ref().unwrap();
    // It is a straight line through the humidity that it was made with.
    let (first, last) = (0, curve.x.len() - 1);
    let slope = (curve.y[last] - curve.y[first]) / (curve.x[last] - curve.x[first]);
    assert!((slope / 8e-5 - 1.0).abs() < 0.2, "{slope:e} {curve:?}");
}

#[test]
fn a_humidity_that_does_nothing_is_no_law() {
    let found = logged(leaking(0.0, 52)).diagnosed();
    assert_eq!(found.verdict, Verdict::Right, "{}", found.sentence);
    let unlogged = leaking(8e-5, 51).diagnosed();
    let is_of_air =
        |law: &ieap_domain::MissingLaw| law.variable.as_deref() == Some("relative_humidity_percent");
    assert!(!unlogged.missing.iter().any(is_of_air), "{:?}", unlogged.missing);
}
