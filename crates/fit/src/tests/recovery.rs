//! Parameters that went into a simulated run come out of its fit.

use super::*;

fn two_levels() -> Drive {
    let mut drive = Drive::step(2.0);
    drive.segments.push(Segment::at(900.0, Level::Voltage(0.0)));
    drive.segments.push(Segment::at(1500.0, Level::Voltage(-1.5)));
    drive
}

#[test]
fn noiseless_runs_give_their_parameters_back() {
    for row in [AIR_2V, CPVF_AIR_1V] {
        let drive = Drive::step(row[7]);
        let channels = channels(&model(&row), &drive, &times(-60.0, 3600.0, 3661), 0.0, 0.0, 1);
        let fit = fitted(&channels, &drive);
        assert!(fit.converged, "{}", fit.why_stopped);
        assert_recovers(&fit, &model(&row), 1e-6);
        assert!(fit.r_squared_current.unwrap() > 1.0 - 1e-12);
    }
}

#[test]
fn any_piecewise_constant_drive_and_uneven_sampling() {
    let model = model(&AIR_2V);
    let uneven: Arc<[f64]> = (0..1500).map(|k| 2400.0 * (k as f64 / 1499.0).powi(2)).collect();
    for time_s in [times(0.0, 2400.0, 2401), uneven] {
        let fit = fitted(
            &channels(&model, &two_levels(), &time_s, 0.0, 0.0, 1),
            &two_levels(),
        );
        assert_recovers(&fit, &model, 1e-6);
    }
}

#[test]
fn an_open_circuit_between_two_voltages_is_followed() {
    let mut drive = Drive::step(2.0);
    drive.segments.push(Segment::at(150.0, Level::OpenCircuit));
    drive.segments.push(Segment::at(900.0, Level::Voltage(0.5)));
    let model = model(&AIR_2V);
    let time_s = times(0.0, 2400.0, 2401);
    assert_recovers(
        &fitted(&channels(&model, &drive, &time_s, 0.0, 0.0, 1), &drive),
        &model,
        1e-5,
    );
    let mut inside = 0;
    for seed in 0..20 {
        let fit = fitted(&channels(&model, &drive, &time_s, 0.01, 0.3, seed), &drive);
        for (key, expected) in truth(&model) {
            let estimate = fit.parameter(key).unwrap();
            let (low, high) = (estimate.low_95.unwrap(), estimate.high_95.unwrap());
            inside += usize::from(low <= expected && expected <= high);
        }
    }
    assert!((160..=180).contains(&inside), "{inside} of 180");
    let mut one = model.clone();
    one.branches.truncate(1);
    let fit = fitted(&channels(&one, &drive, &time_s, 0.01, 0.0, 3), &drive);
    assert_eq!(fit.parameter("r2_ohm_cm2").unwrap().value, None);
    assert!((fit.parameter("c1_f_per_cm2").unwrap().value.unwrap() / 0.098 - 1.0).abs() < 0.05);
}

#[test]
fn noise_is_found_and_covered() {
    let drive = Drive::step(2.0);
    let channels = channels(
        &model(&AIR_2V),
        &drive,
        &times(-60.0, 3600.0, 3661),
        0.002,
        0.4,
        7,
    );
    let fit = fitted(&channels, &drive);
    assert_recovers(&fit, &model(&AIR_2V), 0.15);
    for noise in &fit.noise {
        assert!(
            (noise.residual_rms / noise.standard_deviation - 1.0).abs() < 0.1,
            "{noise:?}"
        );
        assert!((noise.residual_autocorrelation - 0.4).abs() < 0.06, "{noise:?}");
    }
    for curve in &fit.curves {
        assert_eq!(curve.time_s.len(), curve.residual_sigma.len());
        assert!(curve.time_s.len() < 1000 && curve.readings == 3661);
        assert!(curve.residual_sigma.iter().all(|r| r.abs() < 6.0));
    }
}

#[test]
fn a_strip_that_is_bent_before_the_step_is_fitted_with_an_offset() {
    let drive = Drive::step(2.0);
    let mut channels = channels(
        &model(&AIR_2V),
        &drive,
        &times(-300.0, 3600.0, 3901),
        0.002,
        0.0,
        5,
    );
    let bent = channels[1].values.iter().map(|v| v + 0.3).collect();
    channels[1] = Channel::new(Quantity::Curvature, channels[1].time_s.clone(), bent);
    let fit = fitted(&channels, &drive);
    assert_recovers(&fit, &model(&AIR_2V), 0.1);
    assert!(fit.issues.iter().any(|issue| issue.code == "initial-curvature"));
}

#[test]
fn excluded_readings_do_not_count() {
    let drive = Drive::step(2.0);
    let mut channels = channels(&model(&AIR_2V), &drive, &times(0.0, 3600.0, 1801), 0.0, 0.0, 5);
    let mut values = channels[0].values.to_vec();
    values[..3].fill(1.0);
    channels[0] = Channel::new(Quantity::Current, channels[0].time_s.clone(), values.into());
    channels[0].excluded = [0, 1, 2].into();
    assert_recovers(&fitted(&channels, &drive), &model(&AIR_2V), 1e-6);
}

#[test]
fn the_same_input_gives_the_same_fit() {
    let drive = two_levels();
    let channels = channels(&model(&AIR_2V), &drive, &times(-60.0, 2400.0, 2000), 0.01, 0.5, 2);
    assert_eq!(
        format!("{:?}", fitted(&channels, &drive)),
        format!("{:?}", fitted(&channels, &drive))
    );
}

#[test]
fn scaling_and_reversal_move_the_parameters_as_physics_says() {
    let drive = Drive::step(2.0);
    let plain = channels(&model(&AIR_2V), &drive, &times(0.0, 3600.0, 1801), 0.003, 0.0, 2);
    let base = fitted(&plain, &drive);
    let scaled = |current: f64, curvature: f64, time: f64| -> Vec<Channel> {
        let by = |channel: &Channel, factor: f64| {
            let time_s = channel.time_s.iter().map(|t| t * time).collect();
            Channel::new(
                channel.quantity,
                time_s,
                channel.values.iter().map(|v| v * factor).collect(),
            )
        };
        vec![by(&plain[0], current), by(&plain[1], curvature)]
    };
    let ratio = |fit: &Fit, key: &str| {
        fit.parameter(key).unwrap().value.unwrap() / base.parameter(key).unwrap().value.unwrap()
    };
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    let louder = fitted(&scaled(4.0, 1.0, 1.0), &drive);
    close(ratio(&louder, "r1_ohm_cm2"), 0.25);
    close(ratio(&louder, "c2_f_per_cm2"), 4.0);
    close(ratio(&louder, "alpha_per_c_cm"), 0.25);
    let slower = fitted(&scaled(1.0, 1.0, 8.0), &drive);
    close(ratio(&slower, "r2_ohm_cm2"), 1.0);
    close(ratio(&slower, "c1_f_per_cm2"), 8.0);
    close(ratio(&slower, "lambda_per_s"), 0.125);
    let reversed = fitted(&scaled(-1.0, -1.0, 1.0), &Drive::step(-2.0));
    for (key, _) in truth(&model(&AIR_2V)) {
        close(ratio(&reversed, key), 1.0);
    }
}

#[test]
fn a_camera_slower_than_the_potentiostat_and_a_relaxation_as_fast_as_the_charging() {
    let mut degenerate = model(&AIR_2V);
    degenerate.relaxation_rate_per_s = 1.0 / degenerate.branches[0].time_constant_s();
    for rate_per_s in [3.8e-4, degenerate.relaxation_rate_per_s, 0.5] {
        degenerate.relaxation_rate_per_s = rate_per_s;
        let drive = Drive::step(2.0);
        let fast = channels(&degenerate, &drive, &times(-10.0, 3600.0, 7221), 0.0, 0.0, 1);
        let slow = channels(&degenerate, &drive, &times(1.3, 3500.0, 700), 0.0, 0.0, 1);
        let fit = fitted(&[fast[0].clone(), slow[1].clone()], &drive);
        assert_recovers(&fit, &degenerate, 1e-5);
        assert_eq!(fit.n_samples, 7221 + 700);
    }
}

#[test]
fn an_instrument_whose_zero_is_off_is_seen_on_a_discharge() {
    let mut drive = Drive::step(0.0);
    drive.baseline_v = 2.0;
    let model = model(&AIR_2V);
    let mut run = channels(&model, &drive, &times(-300.0, 3600.0, 3901), 0.002, 0.0, 5);
    let off: Vec<f64> = run[0].values.iter().map(|i| i - 8e-6).collect();
    run[0] = Channel::new(Quantity::Current, run[0].time_s.clone(), off.into());
    let fit = fitted(&run, &drive);
    assert!(
        fit.issues.iter().any(|issue| issue.code == "current-offset"),
        "{:?}",
        fit.issues
    );
    assert_recovers(&fit, &model, 0.1);
}
