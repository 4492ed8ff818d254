//! Fits that know what is known: against the information that a reading of the parameter would bring, and how often their
//! intervals hold.

use std::sync::Arc;

use super::*;
use crate::{can_be_known, fit_knowing};
use ieap_domain::testing::branch;
use ieap_domain::{Knowledge, KnownParameter};
use rand::RngExt;

fn known(parameter: &str, knowledge: Knowledge) -> KnownParameter {
    KnownParameter {
        parameter: parameter.to_owned(),
        knowledge,
        source: Some("a spectrum".to_owned()),
        sample: None,
    }
}

pub(super) fn about(parameter: &str, value: f64, standard_error: f64) -> KnownParameter {
    known(
        parameter,
        Knowledge::About {
            value,
            standard_error,
        },
    )
}

fn strip() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(120.0, 0.05), branch(400.0, 0.2)],
        steady_state_resistance_ohm_cm2: 2500.0,
        charge_to_curvature_per_c_cm: 12.0,
        relaxation_rate_per_s: 4e-3,
    }
}

/// A run of so many seconds read about every second, by a clock that strays where it says so.
fn run(seconds: usize, relative: f64, rho: f64, strays: bool, seed: u64) -> (Vec<Channel>, Drive) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut stray = |_| if strays { rng.random_range(-0.3..0.3) } else { 0.0 };
    let times: Vec<f64> = (0..seconds).map(|k| k as f64 + 0.5 + stray(k)).collect();
    let drive = Drive::step(1.5);
    let time_s: Arc<[f64]> = times.into();
    (channels(&strip(), &drive, &time_s, relative, rho, seed), drive)
}

fn fitted_knowing(channels: &[Channel], drive: &Drive, known: &[KnownParameter]) -> Fit {
    let input = FitInput {
        channels,
        drive,
        area_cm2: AREA_CM2,
    };
    fit_knowing(&input, &FitOptions::default(), known).unwrap()
}

#[test]
fn a_short_name_says_what_its_key_says() {
    let (channels, drive) = run(60, 0.01, 0.0, false, 3);
    let with = |name: &str| fitted_knowing(&channels, &drive, &[about(name, 120.0, 1.0)]);
    assert_eq!(with("r1"), with("r1_ohm_cm2"));
    let refused = can_be_known(&[about("tau", 120.0, 1.0)], FitOptions::default().model).unwrap_err();
    assert!(refused.to_string().contains("r1_ohm_cm2"), "{refused}");
}

fn value_and_error(fit: &Fit, key: &str) -> (f64, f64) {
    let estimate = fit.parameter(key).unwrap();
    (estimate.value.unwrap(), estimate.standard_error.unwrap())
}

#[test]
fn what_is_exact_is_held_and_said() {
    let (channels, drive) = run(900, 0.003, 0.0, false, 1);
    let exact = [known("r1_ohm_cm2", Knowledge::Exact { value: 120.0 })];
    let fit = fitted_knowing(&channels, &drive, &exact);
    let held = fit.parameter("r1_ohm_cm2").unwrap();
    assert!((held.value.unwrap() - 120.0).abs() < 1e-9 && held.standard_error == Some(0.0));
    assert_recovers(&fit, &strip(), 0.1);
    let issue = fit
        .issues
        .iter()
        .find(|issue| issue.code == "known-parameter")
        .unwrap();
    assert_eq!(issue.message, "taken as known: 120, held exactly (a spectrum)");
    assert!(fit.method.contains("what is known"));
    assert!(fit.issues.iter().all(|issue| issue.code != "known-contradicted"));
}

#[test]
fn what_has_an_error_counts_as_a_reading_with_that_error() {
    let (channels, drive) = run(900, 0.003, 0.0, false, 2);
    let free = fitted_knowing(
        &channels,
        &drive,
        &[known("r1_ohm_cm2", Knowledge::Within { low: 1.0, high: 1e5 })],
    );
    for key in ["r1_ohm_cm2", "alpha_per_c_cm", "r_parallel_ohm_cm2"] {
        let (value, error) = value_and_error(&free, key);
        // Known as well as the readings tell it, and one standard error beside.
        let with = fitted_knowing(&channels, &drive, &[about(key, value + error, error)]);
        let (drawn, narrower) = value_and_error(&with, key);
        assert!(
            ((drawn - value) / error - 0.5).abs() < 0.1,
            "{key}: {value} to {drawn}, {error}"
        );
        assert!(
            (narrower / error - 0.5_f64.sqrt()).abs() < 0.05,
            "{key}: {error} to {narrower}"
        );
    }
}

#[test]
fn limits_end_an_interval_that_the_readings_leave_open() {
    // Two minutes tell no relaxation of four.
    let (channels, drive) = run(60, 0.01, 0.0, false, 3);
    let open = fitted(&channels, &drive);
    assert!(open.parameter("lambda_per_s").unwrap().value.is_none());
    let limits = [known(
        "lambda_per_s",
        Knowledge::Within {
            low: 2e-3,
            high: 6e-3,
        },
    )];
    let fit = fitted_knowing(&channels, &drive, &limits);
    let lambda = fit.parameter("lambda_per_s").unwrap();
    let ends = (lambda.low_95.unwrap(), lambda.high_95.unwrap());
    assert!(
        ends.0 >= 2e-3 && ends.1 <= 6e-3 && lambda.value.is_some(),
        "{lambda:?}"
    );
}

#[test]
fn a_contradiction_is_said_with_what_the_readings_say() {
    let (channels, drive) = run(900, 0.003, 0.0, false, 4);
    let fit = fitted_knowing(&channels, &drive, &[about("r1_ohm_cm2", 200.0, 5.0)]);
    let said = fit
        .issues
        .iter()
        .find(|issue| issue.code == "known-contradicted")
        .unwrap();
    assert!(
        said.message.contains("the readings alone say 1") && said.message.contains("200 ± 5"),
        "{said:?}"
    );
    assert!(!said.mend.is_empty());
}

#[test]
fn what_cannot_be_known_is_refused_with_what_can() {
    let model = FitOptions::default().model;
    let refused = |known: KnownParameter| can_be_known(&[known], model).unwrap_err().to_string();
    assert!(refused(about("r9_ohm_cm2", 1.0, 0.1)).contains("it has r1_ohm_cm2, c1_f_per_cm2"));
    assert!(refused(about("r1_ohm_cm2", -1.0, 0.1)).contains("positive"));
    assert!(refused(known("tau1_s", Knowledge::Exact { value: 3.0 })).contains("give it a standard error"));
    assert!(can_be_known(&[about("tau1_s", 3.0, 0.1)], model).is_ok());
    let rival = FitOptions::for_model("kelvin-voigt").unwrap().model;
    assert!(can_be_known(&[about("r1_ohm_cm2", 1.0, 0.1)], rival).is_err());
}

/// How many intervals of short runs hold, of how many, where R_ss or lambda is known to 10 % from elsewhere; and how often
/// a contradiction is said though there is none.
#[test]
fn intervals_hold_with_what_is_known_and_nothing_is_contradicted() {
    let (mut held, mut of, mut contradicted) = (0, 0, 0);
    let runs = counted(12, 60);
    for seed in 0..runs {
        let mut rng = ChaCha8Rng::seed_from_u64(7_000 + seed);
        let relative = rng.random_range(0.002..0.01);
        let (channels, drive) = run(
            rng.random_range(150..600),
            relative,
            [0.0, 0.5][seed as usize % 2],
            seed % 3 == 0,
            500 + seed,
        );
        let drawn = |rng: &mut ChaCha8Rng, value: f64| {
            let spread: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
            value * (1.0 + 0.1 * spread)
        };
        let rss = drawn(&mut rng, 2500.0);
        let lambda = drawn(&mut rng, 4e-3);
        let known = [
            about("rss_ohm_cm2", rss, 250.0),
            about("lambda_per_s", lambda, 4e-4),
        ];
        let fit = fitted_knowing(&channels, &drive, &known);
        contradicted += usize::from(fit.issues.iter().any(|issue| issue.code == "known-contradicted"));
        for (key, truth) in truth(&strip()) {
            let estimate = fit.parameter(key).unwrap();
            if let (Some(low), Some(high)) = (estimate.low_95, estimate.high_95) {
                held += usize::from((low..=high).contains(&truth));
                of += 1;
            }
        }
    }
    println!("{held} of {of} intervals hold; {contradicted} of {runs} contradicted");
    // Nine numbers of a run are about five independent ones.
    let least = 0.95 - 3.0 * (0.05 * 0.95 / (5.0 * runs as f64)).sqrt();
    assert!(held as f64 / of as f64 > least, "{held} of {of}");
    assert!(contradicted <= 1 + runs as usize / 20, "{contradicted}");
}
