//! Offsets that are known, found from records with noise.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use ieap_domain::RunClock;

fn channel(quantity: Quantity, step_s: f64, count: usize, value: impl FnMut(f64) -> f64) -> Channel {
    let time_s: Arc<[f64]> = (0..count).map(|k| k as f64 * step_s).collect();
    let values = time_s.iter().copied().map(value).collect();
    Channel::new(quantity, time_s, values)
}

fn clock(channels: &[Channel]) -> FileClock<'_> {
    FileClock {
        channels,
        stamp: None,
        time_zero_is_step: false,
    }
}

/// Voltage stepped at 10 s; curvature on a clock that shows `late_s` less, with noise.
fn run(late_s: f64, noise: f64, seed: u64) -> ([Channel; 1], [Channel; 1]) {
    let voltage = channel(Quantity::Voltage, 0.1, 600, |t| if t < 10.0 { 0.0 } else { 2.0 });
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    let curvature = channel(Quantity::Curvature, 0.2, 250, |t| {
        let since = (t + late_s - 10.0).max(0.0);
        0.4 * (1.0 - (-since / 20.0).exp()) + normal.sample(&mut random)
    });
    ([voltage], [curvature])
}

#[test]
fn the_onset_of_bending_gives_the_offset_within_its_error() {
    let mut within = 0;
    for seed in 0..40 {
        let (electric, camera) = run(2.5, 1e-3, seed);
        let found = offsets(&[clock(&electric), clock(&camera)]);
        let estimated = &found[1];
        let (offset, error) = (estimated.offset_s.unwrap(), estimated.standard_error_s.unwrap());
        assert!((offset - 2.5).abs() < 1.0 && error < 0.6, "{offset} ± {error}");
        within += usize::from((offset - 2.5).abs() <= 2.0 * error);
    }
    assert!(within >= 36, "{within} of 40 within two standard errors");
}

#[test]
fn what_cannot_be_estimated_says_why() {
    let (electric, _) = run(0.0, 0.0, 1);
    let flat = [channel(Quantity::Curvature, 0.2, 250, |_| 0.0)];
    let at_once = [channel(Quantity::Curvature, 0.2, 250, |t| t)];
    let none = [channel(Quantity::Temperature, 0.2, 250, |_| 20.0)];
    for (file, reason) in [
        (&flat, "does not leave its noise"),
        (&at_once, "not at rest"),
        (&none, "no bending"),
    ] {
        let found = offsets(&[clock(&electric), clock(file)]);
        assert_eq!(found[1].offset_s, None);
        assert!(found[1].detail.contains(reason), "{}", found[1].detail);
    }
    let applied = [channel(Quantity::Voltage, 0.1, 600, |_| 2.0)];
    let (_, camera) = run(0.0, 0.0, 1);
    let found = offsets(&[clock(&camera), clock(&applied)]);
    assert_eq!(found[1].clock, 0, "the clock of the voltage is the reference");
    assert!(
        found[1].detail.contains("its edge is not seen"),
        "{}",
        found[1].detail
    );
}

#[test]
fn a_jump_of_the_current_serves_where_no_voltage_was_recorded() {
    let current = [channel(Quantity::Current, 0.1, 600, |t| {
        if t < 10.0 {
            0.0
        } else {
            1e-3 * (-(t - 10.0) / 5.0).exp()
        }
    })];
    let (_, camera) = run(-1.5, 0.0, 1);
    let found = offsets(&[clock(&current), clock(&camera)]);
    assert!((found[1].offset_s.unwrap() + 1.5).abs() < 0.3, "{found:?}");
}

#[test]
fn start_moments_are_compared_where_both_are_certain() {
    let stamp = |local: &str, offset: Option<&str>| StartedAt {
        raw: local.to_owned(),
        kind: Timestamp::Start,
        local: Some(local.to_owned()),
        offset: offset.map(str::to_owned),
        basis: String::new(),
    };
    let (electric, camera) = run(0.0, 0.0, 1);
    let (early, late) = (
        stamp("2026-05-13T10:00:00", Some("+03:00")),
        stamp("2026-05-13T07:00:04.5", Some("+00:00")),
    );
    let (with, other) = (
        FileClock {
            stamp: Some(&early),
            ..clock(&electric)
        },
        FileClock {
            stamp: Some(&late),
            ..clock(&camera)
        },
    );
    let header = &offsets(&[with, other])[0];
    assert_eq!(
        (header.offset_s, header.standard_error_s, header.applied),
        (Some(4.5), None, false)
    );
    let bare = stamp("2026-05-13T10:00:00", None);
    let without = FileClock {
        stamp: Some(&bare),
        ..clock(&camera)
    };
    assert_eq!(offsets(&[with, without])[0].offset_s, None);
    let table = FileClock {
        time_zero_is_step: true,
        ..other
    };
    assert!(offsets(&[with, table])[0].detail.contains("no clock of its own"));
}

#[test]
fn an_offset_that_is_not_in_use_is_pointed_out() {
    let (electric, camera) = run(2.5, 1e-3, 7);
    let own = |file: &str, is_reference| RunClock {
        file: file.to_owned(),
        is_reference,
        first_channel: 0,
        channels: 1,
        time_column: None,
        time_unit: String::new(),
        printed_column: None,
        stamp: None,
    };
    let origin = RunOrigin {
        clocks: vec![own("a.voltage.csv", true), own("a.curvature.csv", false)],
        offsets: offsets(&[clock(&electric), clock(&camera)]),
        ..RunOrigin::default()
    };
    let issues = remarks(&origin, None);
    assert_eq!((issues.len(), issues[0].code.as_str()), (1, "clock-offset"));
    assert!(
        issues[0].mend.contains("clock_offset_s = 2."),
        "{}",
        issues[0].mend
    );
    assert!(remarks(&origin, Some(2.5)).is_empty());
    let single = RunOrigin {
        clocks: vec![own("a.csv", true)],
        ..RunOrigin::default()
    };
    assert_eq!(remarks(&single, Some(1.0))[0].code, "clock-offset-unused");
}
