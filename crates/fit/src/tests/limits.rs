//! What a fit says where the data say little, and whether its intervals are true.

use super::*;

/// Share of seeds for which each 95 % interval holds the true value.
fn coverage(
    row: &[f64; 8],
    readings: usize,
    relative: f64,
    rho: f64,
    runs: u64,
) -> Vec<(&'static str, f64, f64)> {
    let (model, drive) = (model(row), Drive::step(row[7]));
    let time_s = times(0.0, 3600.0, readings);
    let mut counts: Vec<(&'static str, f64, f64)> =
        truth(&model).iter().map(|(key, _)| (*key, 0.0, 0.0)).collect();
    for seed in 0..runs {
        let fit = fitted(&channels(&model, &drive, &time_s, relative, rho, seed), &drive);
        for ((key, expected), count) in truth(&model).iter().zip(&mut counts) {
            let estimate = fit.parameter(key).unwrap();
            if estimate.value.is_some() {
                let inside = estimate.low_95.unwrap() <= *expected && *expected <= estimate.high_95.unwrap();
                count.1 += f64::from(inside);
                count.2 += 1.0;
            }
        }
    }
    counts
        .into_iter()
        .map(|(key, inside, of)| (key, inside / of, of))
        .collect()
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    for rho in [0.0, 0.6] {
        let runs = counted(30, 300);
        for (key, share, of) in coverage(&AIR_2V, 1200, 0.01, rho, runs) {
            let spread = 3.0 * (0.05 * 0.95 / of).sqrt();
            assert!(
                of > 0.83 * runs as f64 && (0.95 - spread..=0.95 + spread).contains(&share),
                "rho {rho}, {key}: {share} of {of}"
            );
        }
    }
}

#[test]
fn a_resistor_and_one_capacitor_get_no_second_branch() {
    let mut one = model(&AIR_2V);
    one.branches.truncate(1);
    let drive = Drive::step(2.0);
    for (relative, seed) in [(0.0, 1), (1e-6, 2), (0.01, 3), (0.01, 4), (0.01, 5)] {
        let fit = fitted(
            &channels(&one, &drive, &times(0.0, 1000.0, 2000), relative, 0.3, seed),
            &drive,
        );
        assert_eq!(
            fit.parameter("r2_ohm_cm2").unwrap().value,
            None,
            "noise {relative}"
        );
        assert!(fit.parameter("c2_f_per_cm2").unwrap().reason.is_some());
        let total = fit.parameter("c_total_f_per_cm2").unwrap().value.unwrap();
        assert!((total / 0.098 - 1.0).abs() < 0.05);
        assert!(fit.issues.iter().any(|issue| issue.place == "r2_ohm_cm2"));
    }
}

#[test]
fn chance_rarely_makes_a_second_branch() {
    let mut one = model(&AIR_2V);
    one.branches.truncate(1);
    let (drive, time_s) = (Drive::step(2.0), times(0.0, 1000.0, 1000));
    for rho in [0.0, 0.6] {
        let (mut invented, mut first, mut covered) = (0, 0, 0);
        let runs = counted(24, 200);
        for seed in 0..runs {
            let fit = fitted(&channels(&one, &drive, &time_s, 0.01, rho, seed), &drive);
            invented += usize::from(fit.parameter("r2_ohm_cm2").unwrap().value.is_some());
            first += usize::from(fit.parameter("r1_ohm_cm2").unwrap().value.is_some());
            let total = fit.parameter("c_total_f_per_cm2").unwrap();
            let low_holds = total.low_95.is_none_or(|low| low <= 0.098);
            covered += usize::from(low_holds && total.high_95.is_none_or(|high| 0.098 <= high));
        }
        let runs = runs as usize;
        println!("rho {rho}: {invented} second branches, {first} first ones, {covered} covered of {runs}");
        assert!(
            invented * 50 <= runs.max(50) && first * 4 >= runs * 3 && (covered + 1) * 10 >= runs * 9,
            "rho {rho}: {invented} {first} {covered} of {runs}"
        );
    }
}

#[test]
fn what_the_record_cannot_show_is_bounded_or_left_open() {
    let drive = Drive::step(2.0);
    let mut slow = model(&AIR_2V);
    slow.relaxation_rate_per_s = 1e-9;
    slow.steady_state_resistance_ohm_cm2 = 1e12;
    let fit = fitted(
        &channels(&slow, &drive, &times(0.0, 3600.0, 3601), 0.01, 0.0, 5),
        &drive,
    );
    let (rate, steady) = (
        fit.parameter("lambda_per_s").unwrap(),
        fit.parameter("rss_ohm_cm2").unwrap(),
    );
    assert!(
        rate.value.is_none() && rate.high_95.unwrap() > 1e-9 && rate.high_95.unwrap() < 1e-3,
        "{rate:?}"
    );
    assert!(
        steady.value.is_none() && steady.low_95.unwrap() > 1e3 && steady.high_95.is_none(),
        "{steady:?}"
    );
    let current_only = fitted(
        &channels(&slow, &drive, &times(0.0, 3600.0, 3601), 0.01, 0.0, 5)[..1],
        &drive,
    );
    assert_eq!(current_only.parameter("alpha_per_c_cm").unwrap().value, None);
    let curvature_only = fitted(
        &channels(&slow, &drive, &times(0.0, 3600.0, 3601), 0.01, 0.0, 5)[1..],
        &drive,
    );
    for key in ["r1_ohm_cm2", "c_total_f_per_cm2", "rss_ohm_cm2", "alpha_per_c_cm"] {
        assert_eq!(curvature_only.parameter(key).unwrap().value, None, "{key}");
    }
    let rate = curvature_only.parameter("lambda_per_s").unwrap();
    assert!(
        rate.value.is_none() && rate.high_95.unwrap() > 1e-9 && rate.high_95.unwrap() < 1e-3,
        "{rate:?}"
    );
}

#[test]
fn flat_curvature_leaves_coupling_and_rate_open() {
    let drive = Drive::step(2.0);
    let mut channels = channels(&model(&AIR_2V), &drive, &times(0.0, 3600.0, 1801), 0.01, 0.0, 5);
    let flat = noise(&mut ChaCha8Rng::seed_from_u64(9), 1801, 0.01, 0.0);
    channels[1] = Channel::new(Quantity::Curvature, channels[1].time_s.clone(), flat.into());
    let fit = fitted(&channels, &drive);
    for key in ["alpha_per_c_cm", "lambda_per_s"] {
        let estimate = fit.parameter(key).unwrap();
        assert!(estimate.value.is_none() && estimate.reason.as_deref().unwrap().contains("noise"));
    }
}

#[test]
fn degenerate_input_neither_panics_nor_hangs_nor_invents() {
    let time_s = times(0.0, 100.0, 200);
    let constant = |value: f64| Channel::new(Quantity::Current, time_s.clone(), vec![value; 200].into());
    for drive in [Drive::step(0.0), Drive::step(2.0)] {
        for value in [0.0, 1e-6, -1e-6, 1e99] {
            let fit = fitted(&[constant(value)], &drive);
            for parameter in &fit.parameters {
                let estimate = &parameter.estimate;
                assert!(
                    estimate.value.is_none() || parameter.key == "rss_ohm_cm2",
                    "{parameter:?}"
                );
                assert!(estimate.value.is_none_or(f64::is_finite));
            }
        }
    }
    let short = |n: usize| {
        Channel::new(
            Quantity::Current,
            times(0.0, 1.0, 200)[..n].into(),
            vec![1.0; n].into(),
        )
    };
    let refused = |channels: &[Channel]| {
        let input = FitInput {
            channels,
            drive: &Drive::step(1.0),
            area_cm2: 0.1,
        };
        fit_run(&input, &FitOptions::default()).unwrap_err()
    };
    for n in [0, 1, 3] {
        assert!(matches!(refused(&[short(n)]), FitError::TooFewReadings { found, .. } if found == n));
    }
    let mut excluded = constant(1.0);
    excluded.excluded = (0..200).collect();
    assert!(matches!(
        refused(&[excluded]),
        FitError::TooFewReadings { found: 0, .. }
    ));
    assert!(matches!(refused(&[]), FitError::NoResponse { .. }));
    assert!(
        FitOptions::for_model("lumped-9")
            .unwrap_err()
            .to_string()
            .contains("lumped-2")
    );
}

#[test]
fn a_current_of_the_wrong_sign_is_named() {
    let run = channels(
        &model(&AIR_2V),
        &Drive::step(2.0),
        &times(0.0, 3600.0, 1801),
        0.01,
        0.0,
        2,
    );
    let fit = fitted(&run, &Drive::step(-2.0));
    assert!(
        fit.issues
            .iter()
            .any(|issue| issue.code == "current-against-voltage" && !issue.mend.is_empty())
    );
    assert!(
        fit.parameters
            .iter()
            .all(|parameter| parameter.estimate.value.is_none())
    );
}

/// A branch of 1.4 s, read every second and later every 10 s.
#[test]
fn a_fast_transient_is_no_noise_that_grows_with_the_signal() {
    let model = model(&CPVF_AIR_1V);
    let drive = Drive::step(1.2);
    let time_s: Arc<[f64]> = (-20..300)
        .map(f64::from)
        .chain((30..200).map(|k| 10.0 * f64::from(k)))
        .collect();
    let channels = channels(&model, &drive, &time_s, 2e-4, 0.0, 98_000_600);
    let plain = fitted(&channels, &drive);
    assert_eq!(plain.noise[0].character.proportional, 0.0);
    let r1 = plain.parameter("r1_ohm_cm2").unwrap();
    let (low, high) = (r1.low_95.unwrap(), r1.high_95.unwrap());
    assert!((low..=high).contains(&23.4) && high - low < 0.2, "{r1:?}");
}
