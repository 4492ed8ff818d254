//! More than two branches: fitted where the current shows them, left out with the reason where it does not.

use super::*;
use ieap_domain::testing::branch;

/// Three branches, a factor of ten apart in their time constants.
fn three() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(100.0, 0.05), branch(500.0, 0.1), branch(2000.0, 0.3)],
        steady_state_resistance_ohm_cm2: 4000.0,
        charge_to_curvature_per_c_cm: 12.0,
        relaxation_rate_per_s: 5e-4,
    }
}

fn truth_of(model: &LumpedModel) -> Vec<(String, f64)> {
    let mut truth = Vec::new();
    for (k, branch) in model.branches.iter().enumerate() {
        let (r, c) = (branch.resistance_ohm_cm2, branch.capacitance_f_per_cm2);
        truth.push((format!("r{}_ohm_cm2", k + 1), r));
        truth.push((format!("c{}_f_per_cm2", k + 1), c));
        truth.push((format!("tau{}_s", k + 1), r * c));
    }
    truth.push(("rss_ohm_cm2".to_owned(), model.steady_state_resistance_ohm_cm2));
    truth.push((
        "c_total_f_per_cm2".to_owned(),
        model.total_capacitance_f_per_cm2(),
    ));
    truth.push(("alpha_per_c_cm".to_owned(), model.charge_to_curvature_per_c_cm));
    truth.push(("lambda_per_s".to_owned(), model.relaxation_rate_per_s));
    truth
}

fn fitted_with(id: &str, channels: &[Channel], drive: &Drive) -> Fit {
    let input = FitInput {
        channels,
        drive,
        area_cm2: AREA_CM2,
    };
    fit_run(&input, &FitOptions::for_model(id).unwrap()).unwrap()
}

fn uneven(n: usize) -> Arc<[f64]> {
    (0..n)
        .map(|k| 0.2 * (18_000.0_f64).powf(k as f64 / (n - 1) as f64))
        .collect()
}

#[test]
fn three_noiseless_branches_come_back_however_many_are_allowed() {
    let (model, drive) = (three(), Drive::step(2.0));
    for time_s in [times(0.0, 7200.0, 7201), uneven(2000)] {
        let channels = channels(&model, &drive, &time_s, 0.0, 0.0, 1);
        for id in ["lumped-3", "lumped-4"] {
            let fit = fitted_with(id, &channels, &drive);
            assert!(fit.converged, "{}", fit.why_stopped);
            for (key, expected) in truth_of(&model) {
                let estimate = fit.parameter(&key).unwrap();
                let value = estimate
                    .value
                    .unwrap_or_else(|| panic!("{id} {key}: {estimate:?}"));
                assert!(
                    (value / expected - 1.0).abs() < 1e-4,
                    "{id} {key}: {value} {expected}"
                );
            }
        }
        let fourth = fitted_with("lumped-4", &channels, &drive);
        let estimate = fourth.parameter("r4_ohm_cm2").unwrap();
        assert!(
            estimate.value.is_none() && estimate.reason.is_some(),
            "{estimate:?}"
        );
    }
}

#[test]
fn intervals_of_three_branches_hold_the_truth_and_the_choice_says_why() {
    let (model, drive) = (three(), Drive::step(2.0));
    let (mut held, mut stated) = (0, 0);
    for seed in 0..counted(6, 60) {
        for time_s in [times(0.0, 7200.0, 7201), uneven(6000)] {
            let channels = channels(&model, &drive, &time_s, 1e-3, 0.3, seed);
            let fit = fitted_with("lumped-3", &channels, &drive);
            let choice = fit
                .issues
                .iter()
                .find(|issue| issue.code == "model-choice")
                .unwrap();
            assert!(choice.message.starts_with("three branches"), "{}", choice.message);
            for (key, expected) in truth_of(&model) {
                let estimate = fit.parameter(&key).unwrap();
                if let (Some(_), Some(low), Some(high)) = (estimate.value, estimate.low_95, estimate.high_95)
                {
                    stated += 1;
                    held += u64::from((low..=high).contains(&expected));
                }
            }
        }
    }
    assert!(stated >= 13 * counted(6, 60), "{stated}");
    let share = held as f64 / stated as f64;
    assert!((0.9..=0.985).contains(&share), "{held} of {stated}");
}

#[test]
fn a_third_branch_that_nothing_shows_is_left_out_with_the_reason() {
    let (model, drive) = (model(&AIR_2V), Drive::step(2.0));
    for time_s in [times(0.0, 3600.0, 3600), uneven(3600)] {
        let channels = channels(&model, &drive, &time_s, 0.01, 0.0, 3);
        let (two, three) = (
            fitted_with("lumped-2", &channels, &drive),
            fitted_with("lumped-3", &channels, &drive),
        );
        let third = three.parameter("tau3_s").unwrap();
        let reason = third.reason.as_deref().unwrap();
        assert!(
            third.value.is_none() && reason.contains("two branches are enough"),
            "{reason}"
        );
        for parameter in &two.parameters {
            let (a, b) = (&parameter.estimate, three.parameter(&parameter.key).unwrap());
            let near = |a: Option<f64>, b: Option<f64>| {
                a.zip(b).is_some_and(|(a, b)| (a / b - 1.0).abs() < 2e-3) || a == b
            };
            assert!(
                near(a.value, b.value) && near(a.low_95, b.low_95) && near(a.high_95, b.high_95),
                "{}: {a:?} {b:?}",
                parameter.key
            );
        }
    }
}

#[test]
fn a_group_may_have_three_branches() {
    let (model, drive) = (three(), Drive::step(2.0));
    let time_s = times(0.0, 7200.0, 3601);
    let runs: Vec<_> = (0..2)
        .map(|seed| channels(&model, &drive, &time_s, 1e-3, 0.0, seed))
        .collect();
    let inputs: Vec<_> = (runs.iter())
        .map(|channels| FitInput {
            channels,
            drive: &drive,
            area_cm2: AREA_CM2,
        })
        .collect();
    let options = GroupOptions::sharing_all(FitOptions::for_model("lumped-3").unwrap().model);
    let fit = fit_group(&inputs, &options).unwrap();
    assert!(fit.converged, "{}", fit.why_stopped);
    for (key, expected) in truth_of(&model) {
        let estimate = fit.runs[1].parameter(&key).unwrap();
        let error = estimate
            .standard_error
            .unwrap_or_else(|| panic!("{key}: {estimate:?}"));
        assert!(
            (estimate.value.unwrap() - expected).abs() < 4.0 * error,
            "{key}: {estimate:?} {expected}"
        );
    }
}

/// Pulses with a second branch that decays within a few readings of every edge: parabolas follow none of it.
#[test]
fn what_parabolas_cannot_follow_is_no_noise_and_hides_no_branch() {
    let model = LumpedModel {
        branches: vec![branch(100.0, 0.02), branch(150.0, 0.05)],
        ..three()
    };
    let level = |k: usize| Level::Voltage(if k.is_multiple_of(2) { 2.0 } else { 0.0 });
    let drive = Drive {
        baseline_v: 0.0,
        segments: (0..20).map(|k| Segment::at(15.0 * k as f64, level(k))).collect(),
    };
    let channels = channels(&model, &drive, &times(-10.0, 300.0, 311), 1e-3, 0.0, 1);
    let fit = fitted_with("lumped-2", &channels, &drive);
    let noise = &fit.noise[0];
    assert!(noise.basis.starts_with("residuals of the fit"), "{noise:?}");
    assert!(
        (0.8..1.25).contains(&(noise.residual_rms / noise.standard_deviation)),
        "{noise:?}"
    );
    let tau1_s = fit.parameters.iter().find(|one| one.key == "tau1_s").unwrap();
    let (low, high) = (tau1_s.estimate.low_95.unwrap(), tau1_s.estimate.high_95.unwrap());
    assert!((low..=high).contains(&2.0), "{tau1_s:?}");
}
