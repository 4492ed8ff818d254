//! Fits of simulated runs whose parameters are known.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::domain::Segment;
use crate::model::{Branch, LumpedModel};

/// Rows of the thesis's table 5: R1, C1, R2, C2, R_ss, alpha, lambda, and the step voltage.
pub(super) const AIR_2V: [f64; 8] = [521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4, 2.0];
const CPVF_AIR_1V: [f64; 8] = [23.4, 0.060, 43.1, 1.94, 1720.0, 3.02, 2.8e-4, 1.2];
const AREA_CM2: f64 = 0.1;

pub(super) fn model(row: &[f64; 8]) -> LumpedModel {
    let branch = |k: usize| Branch {
        resistance_ohm_cm2: row[2 * k],
        capacitance_f_per_cm2: row[2 * k + 1],
    };
    LumpedModel {
        branches: vec![branch(0), branch(1)],
        steady_state_resistance_ohm_cm2: row[4],
        charge_to_curvature_per_c_cm: row[5],
        relaxation_rate_per_s: row[6],
    }
}

fn times(from_s: f64, to_s: f64, n: usize) -> Arc<[f64]> {
    (0..n)
        .map(|k| from_s + (to_s - from_s) * k as f64 / (n - 1) as f64)
        .collect()
}

/// Noise with lag-1 correlation `rho` and standard deviation `sd`.
fn noise(rng: &mut ChaCha8Rng, n: usize, sd: f64, rho: f64) -> Vec<f64> {
    let mut last: f64 = StandardNormal.sample(rng);
    let mut next = || {
        let fresh: f64 = StandardNormal.sample(rng);
        last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
        sd * last
    };
    (0..n).map(|_| next()).collect()
}

/// Current and curvature of `model`; noise is `relative` of the peak of each.
fn channels(
    model: &LumpedModel,
    drive: &Drive,
    time_s: &Arc<[f64]>,
    relative: f64,
    rho: f64,
    seed: u64,
) -> Vec<Channel> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut channel = |quantity, exact: Vec<f64>| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noise = noise(&mut rng, exact.len(), relative * peak, rho);
        Channel::new(
            quantity,
            time_s.clone(),
            exact.iter().zip(noise).map(|(a, b)| a + b).collect(),
        )
    };
    vec![
        channel(Quantity::Current, model.current_a(drive, AREA_CM2, time_s)),
        channel(
            Quantity::Curvature,
            model.curvature_per_cm(drive, AREA_CM2, time_s),
        ),
    ]
}

fn fitted(channels: &[Channel], drive: &Drive) -> Fit {
    let input = FitInput {
        channels,
        drive,
        area_cm2: AREA_CM2,
    };
    fit_run(&input, &FitOptions::default()).unwrap()
}

fn truth(model: &LumpedModel) -> Vec<(&'static str, f64)> {
    let [a, b] = [model.branches[0], model.branches[1]];
    let conductance = a.resistance_ohm_cm2.recip() + b.resistance_ohm_cm2.recip();
    vec![
        ("r1_ohm_cm2", a.resistance_ohm_cm2),
        ("c1_f_per_cm2", a.capacitance_f_per_cm2),
        ("r2_ohm_cm2", b.resistance_ohm_cm2),
        ("c2_f_per_cm2", b.capacitance_f_per_cm2),
        ("rss_ohm_cm2", model.steady_state_resistance_ohm_cm2),
        ("alpha_per_c_cm", model.charge_to_curvature_per_c_cm),
        ("lambda_per_s", model.relaxation_rate_per_s),
        ("c_total_f_per_cm2", model.total_capacitance_f_per_cm2()),
        ("r_parallel_ohm_cm2", conductance.recip()),
    ]
}

#[track_caller]
fn assert_recovers(fit: &Fit, model: &LumpedModel, within: f64) {
    for (key, expected) in truth(model) {
        let estimate = fit.parameter(key).unwrap();
        let Some(value) = estimate.value else {
            panic!("{key}: {estimate:?}")
        };
        assert!(
            (value / expected - 1.0).abs() < within,
            "{key}: {value} instead of {expected}"
        );
    }
}

fn two_levels() -> Drive {
    let mut drive = Drive::step(2.0);
    drive.segments.push(Segment {
        start_s: 900.0,
        level: Level::Voltage(0.0),
    });
    drive.segments.push(Segment {
        start_s: 1500.0,
        level: Level::Voltage(-1.5),
    });
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
    drive.segments.push(Segment {
        start_s: 150.0,
        level: Level::OpenCircuit,
    });
    drive.segments.push(Segment {
        start_s: 900.0,
        level: Level::Voltage(0.5),
    });
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
        for (key, share, of) in coverage(&AIR_2V, 1200, 0.01, rho, 300) {
            // Three standard errors of a share of 95 % in 300 runs are 3.8 %.
            assert!(
                of > 250.0 && (0.912..=0.988).contains(&share),
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
        for seed in 0..200 {
            let fit = fitted(&channels(&one, &drive, &time_s, 0.01, rho, seed), &drive);
            invented += usize::from(fit.parameter("r2_ohm_cm2").unwrap().value.is_some());
            first += usize::from(fit.parameter("r1_ohm_cm2").unwrap().value.is_some());
            let total = fit.parameter("c_total_f_per_cm2").unwrap();
            covered += usize::from(
                total
                    .low_95
                    .is_none_or(|low| low <= 0.098 && 0.098 <= total.high_95.unwrap()),
            );
        }
        println!("rho {rho}: {invented} second branches, {first} first ones, {covered} covered of 200");
        assert!(
            invented <= 4 && first >= 150 && covered >= 180,
            "rho {rho}: {invented} {first} {covered}"
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
    assert!(
        curvature_only
            .parameters
            .iter()
            .all(|parameter| parameter.estimate.value.is_none())
    );
    assert!(!curvature_only.converged && curvature_only.curves[0].fitted.is_empty());
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
