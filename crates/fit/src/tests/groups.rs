//! Groups of runs with shared parameters, simultaneous fits, and the opinions on their uncertainty.

use super::*;
use ieap_domain::testing::drive;

/// Step, discharge, reversal, pulse train and an open circuit between two voltages.
fn drives() -> Vec<Drive> {
    let pulses: Vec<(f64, Option<f64>)> = (0..8)
        .map(|k| (150.0 * f64::from(k), Some(if k % 2 == 0 { 1.5 } else { 0.0 })))
        .collect();
    vec![
        Drive::step(2.0),
        drive(2.0, &[(0.0, Some(0.0))]),
        drive(0.0, &[(0.0, Some(1.2)), (600.0, Some(-1.2))]),
        drive(0.0, &pulses),
        drive(0.0, &[(0.0, Some(2.0)), (300.0, None), (900.0, Some(0.5))]),
    ]
}

fn inputs<'a>(runs: &'a [Vec<Channel>], drives: &'a [Drive]) -> Vec<FitInput<'a>> {
    let input = |(channels, drive): (&'a Vec<Channel>, &'a Drive)| FitInput {
        channels,
        drive,
        area_cm2: AREA_CM2,
    };
    runs.iter().zip(drives).map(input).collect()
}

fn simulated(
    models: &[LumpedModel],
    drives: &[Drive],
    relative: f64,
    rho: f64,
    seed: u64,
) -> Vec<Vec<Channel>> {
    let time_s = times(-30.0, 1800.0, 916);
    let run = |(k, drive): (usize, &Drive)| {
        channels(
            &models[k % models.len()],
            drive,
            &time_s,
            relative,
            rho,
            seed + k as u64,
        )
    };
    drives.iter().enumerate().map(run).collect()
}

#[test]
fn runs_with_any_drive_give_one_set_of_parameters() {
    let (model, drives) = (model(&AIR_2V), drives());
    let runs = simulated(std::slice::from_ref(&model), &drives, 1e-5, 0.0, 1);
    let group = fit_group(&inputs(&runs, &drives), &GroupOptions::default()).unwrap();
    assert!(group.converged, "{}", group.why_stopped);
    for fit in &group.runs {
        assert_recovers(fit, &model, 1e-3);
    }
    assert_eq!(group.common_parameters(FitOptions::default().model).len(), 11);
}

#[test]
fn noisy_groups_cover_the_truth_and_tell_more_than_their_runs() {
    let (model, drives) = (model(&AIR_2V), drives());
    let (mut inside, mut of) = (0, 0);
    let groups = counted(4, 20);
    for seed in 0..groups {
        let runs = simulated(std::slice::from_ref(&model), &drives, 0.02, 0.4, 100 * seed);
        let group = fit_group(&inputs(&runs, &drives), &GroupOptions::default()).unwrap();
        for (key, expected) in truth(&model) {
            let estimate = group.runs[0].parameter(key).unwrap();
            if let (Some(low), Some(high)) = (estimate.low_95, estimate.high_95) {
                inside += usize::from(low <= expected && expected <= high);
                of += 1;
            }
            let alone = fitted(&runs[0], &drives[0]);
            let own = alone
                .parameter(key)
                .unwrap()
                .standard_error
                .unwrap_or(f64::INFINITY);
            assert!(estimate.standard_error.is_none_or(|error| error < own), "{key}");
        }
    }
    // Nine parameters a run; they are correlated, so the spread is that of a third as many.
    assert!(of as u64 * 18 > groups * 9 * 17, "{of}");
    let (inside, of) = (inside as f64, of as f64);
    let spread = 2.5 * (0.05 * 0.95 * of * 3.0).sqrt();
    assert!((inside - 0.95 * of).abs() <= spread, "{inside} of {of}");
}

#[test]
fn what_is_free_differs_from_run_to_run_and_what_is_shared_does_not() {
    let one = model(&AIR_2V);
    let mut other = one.clone();
    other.steady_state_resistance_ohm_cm2 /= 3.0;
    other.relaxation_rate_per_s *= 4.0;
    let drives = vec![Drive::step(2.0), Drive::step(2.5)];
    let runs = simulated(&[one.clone(), other.clone()], &drives, 0.002, 0.2, 5);
    let shared = [
        "r1_ohm_cm2",
        "c1_f_per_cm2",
        "r2_ohm_cm2",
        "c2_f_per_cm2",
        "alpha_per_c_cm",
    ];
    let options = GroupOptions {
        shared: shared.map(str::to_owned).to_vec(),
        ..GroupOptions::default()
    };
    let group = fit_group(&inputs(&runs, &drives), &options).unwrap();
    assert_recovers(&group.runs[0], &one, 0.05);
    assert_recovers(&group.runs[1], &other, 0.05);
    for key in shared {
        assert_eq!(
            group.runs[0].parameter(key),
            group.runs[1].parameter(key),
            "{key}"
        );
    }
    let all = fit_group(&inputs(&runs, &drives), &GroupOptions::default()).unwrap();
    assert!(
        all.chi_square > group.chi_square + 100.0,
        "{} {}",
        all.chi_square,
        group.chi_square
    );
    let per_reading = group.chi_square / group.degrees_of_freedom;
    assert!((0.9..1.1).contains(&per_reading), "{per_reading}");
}

#[test]
fn a_simultaneous_fit_agrees_with_the_two_steps() {
    let (model, drive) = (model(&AIR_2V), Drive::step(2.0));
    let channels = channels(&model, &drive, &times(0.0, 3600.0, 1801), 0.005, 0.3, 3);
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let options = FitOptions {
        steps: Steps::Simultaneous,
        ..FitOptions::default()
    };
    let both = fit_run(&input, &options).unwrap();
    let steps = fitted(&channels, &drive);
    assert_ne!(both.method, steps.method);
    for (key, expected) in truth(&model) {
        let (a, b) = (both.parameter(key).unwrap(), steps.parameter(key).unwrap());
        let apart = (a.value.unwrap() - b.value.unwrap()).abs();
        assert!(apart < 2.0 * b.standard_error.unwrap(), "{key}: {a:?} {b:?}");
        assert!((a.value.unwrap() / expected - 1.0).abs() < 0.1);
        assert!(
            a.standard_error.unwrap() < 1.2 * b.standard_error.unwrap(),
            "{key}: {a:?} {b:?}"
        );
    }
}

#[test]
fn covariance_profile_and_bootstrap_agree_where_all_hold() {
    let (model, drives) = (model(&AIR_2V), vec![Drive::step(2.0)]);
    let runs = simulated(std::slice::from_ref(&model), &drives, 0.01, 0.3, 9);
    let inputs = inputs(&runs, &drives);
    let with = |intervals, bootstrap| {
        let options = GroupOptions {
            intervals,
            bootstrap,
            ..GroupOptions::default()
        };
        fit_group(&inputs, &options).unwrap()
    };
    let seeded = Some(Bootstrap {
        seed: 7,
        replicates: counted(60, 200) as usize,
    });
    let plain = with(Intervals::Automatic, None);
    let profiled = with(Intervals::Profile, seeded);
    assert_eq!(
        profiled,
        with(Intervals::Profile, seeded),
        "the same seed gives the same"
    );
    for resampled in &profiled.bootstrap[0] {
        let error = plain.runs[0]
            .parameter(&resampled.key)
            .unwrap()
            .standard_error
            .unwrap();
        let ratio = resampled.standard_deviation / error;
        assert!((0.65..1.5).contains(&ratio), "{}: {ratio}", resampled.key);
    }
    assert_eq!(profiled.bootstrap[0].len(), 11);
    for (a, b) in plain.runs[0].parameters.iter().zip(&profiled.runs[0].parameters) {
        let width = |e: &ieap_domain::Estimate| e.high_95.unwrap() - e.low_95.unwrap();
        let ratio = width(&a.estimate) / width(&b.estimate);
        assert!((0.85..1.18).contains(&ratio), "{}: {ratio}", a.key);
    }
}

#[test]
fn what_cannot_be_shared_or_started_is_named() {
    let (model, drives) = (model(&AIR_2V), vec![Drive::step(2.0)]);
    let runs = simulated(&[model], &drives, 0.01, 0.0, 1);
    let options = GroupOptions {
        shared: vec!["tau1_s".to_owned()],
        ..GroupOptions::default()
    };
    let error = fit_group(&inputs(&runs, &drives), &options).unwrap_err();
    assert!(
        matches!(&error, FitError::SharedParameter { found, .. } if found == "tau1_s"),
        "{error}"
    );
    assert_eq!(
        fit_group(&[], &GroupOptions::default()),
        Err(FitError::EmptyGroup)
    );
    let curvature_only = vec![runs[0][1..].to_vec()];
    let error = fit_group(&inputs(&curvature_only, &drives), &GroupOptions::default()).unwrap_err();
    assert!(matches!(error, FitError::GroupRun { index: 0, .. }), "{error}");
}

#[test]
fn what_is_open_names_what_it_trades_off_against() {
    // Half a minute of a sample whose time constants are 51 and 342 s: their first resistance shows, the rest does not.
    let (model, drive) = (model(&AIR_2V), Drive::step(2.0));
    let channels = channels(&model, &drive, &times(0.0, 30.0, 600), 0.01, 0.0, 4);
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let options = FitOptions {
        steps: Steps::Simultaneous,
        ..FitOptions::default()
    };
    let fit = fit_run(&input, &options).unwrap();
    let steady = fit.parameter("rss_ohm_cm2").unwrap();
    assert_eq!((steady.value, steady.high_95), (None, None), "{steady:?}");
    let reason = steady.reason.as_deref().unwrap();
    assert!(
        reason.contains("trades off against") && reason.contains("correlation"),
        "{reason}"
    );
    assert!(steady.low_95.is_none_or(|low| low < 5660.0), "{steady:?}");
    let parallel = fit.parameter("r_parallel_ohm_cm2").unwrap();
    // From below a branch faster than the sampling may add to it.
    let low_holds = parallel.low_95.is_none_or(|low| low < 435.1);
    assert!(low_holds && 435.1 < parallel.high_95.unwrap(), "{parallel:?}");
}
