//! A plan says what the fit of the run itself will say.

use super::judged::judged;
use super::*;
use crate::domain::{Channel, Drive, Quantity};
use crate::fit::{FitInput, FitOptions, fit_run};
use crate::model::{Branch, LumpedModel};
use crate::pipeline::Silent;
use crate::truth::{ChannelNoise, Truth, noise, simulate};

const AREA_CM2: f64 = 0.1;

/// A strip whose fast branch takes `fast_s`, and whose slow one 13 s.
fn subject(fast_s: f64) -> Subject {
    let branch = |resistance_ohm_cm2: f64, tau_s: f64| Branch {
        resistance_ohm_cm2,
        capacitance_f_per_cm2: tau_s / resistance_ohm_cm2,
    };
    let of_size = |standard_deviation| ChannelNoise {
        standard_deviation,
        ..ChannelNoise::default()
    };
    Subject {
        told_by: "a test".to_owned(),
        options: FitOptions::for_model("lumped-2").unwrap(),
        model: LumpedModel {
            branches: vec![branch(59.0, fast_s), branch(130.0, 13.0)],
            steady_state_resistance_ohm_cm2: 9e3,
            charge_to_curvature_per_c_cm: 25.0,
            relaxation_rate_per_s: 0.02,
        },
        area_cm2: AREA_CM2,
        current_noise: of_size(2e-6),
        curvature_noise: Some(of_size(0.004)),
        drive: Drive::step(1.2),
        for_s: 100.0,
        start_is_known: false,
        largest_v: 1.2,
        remarks: Vec::new(),
    }
}

fn preflight(fast_s: f64, every_s: f64) -> Preflight {
    let subject = subject(fast_s);
    Preflight {
        trial: Trial {
            drive: subject.drive.clone(),
            every_s,
            bending_every_s: every_s,
            for_s: subject.for_s,
            start_is_known: false,
        },
        max_voltage_v: subject.largest_v,
        draws: 8,
        seed: 3,
        subject,
    }
}

fn of<'a>(parameters: &'a [PlannedParameter], symbol: &str) -> &'a PlannedParameter {
    parameters.iter().find(|of| of.symbol == symbol).unwrap()
}

#[test]
fn a_branch_faster_than_the_readings_is_open_and_faster_readings_are_proposed() {
    let document = preflight(0.059, 0.25).run(&Silent).unwrap();
    let answer = document.answer.join("\n");
    assert!(!of(&document.parameters, "R1").is_determined(), "{answer}");
    for symbol in ["R2", "C2", "R_ss", "lambda"] {
        assert!(
            of(&document.parameters, symbol).is_determined(),
            "{symbol}: {answer}"
        );
    }
    assert!(
        answer.contains("the branch of 59 ms is faster than a reading every 0.25 s"),
        "{answer}"
    );
    let mends =
        |change: &&ChangeEntry| change.kind == "faster" && of(&change.parameters, "R1").is_determined();
    let first = document
        .changes
        .iter()
        .find(mends)
        .expect("a sampling that determines R1");
    // Two readings of the branch, and the bending tells where the edge was.
    assert!(first.every_s <= 0.125, "{}", first.every_s);
    assert!(
        answer.contains(&format!("A reading every {} s", first.every_s)),
        "{answer}"
    );
}

#[test]
fn where_all_is_determined_slower_readings_are_tried_until_something_is_lost() {
    let document = preflight(2.0, 0.1).run(&Silent).unwrap();
    assert!(
        document.answer[0].starts_with("This run determines R1 to "),
        "{:?}",
        document.answer
    );
    assert!(document.parameters.iter().all(PlannedParameter::is_determined));
    assert_eq!(document.changes[0].kind, "slower");
    let added = document.answer.last().unwrap();
    assert!(
        added.starts_with("A stated start of the drive would give R1 to "),
        "{added}"
    );
}

#[test]
fn a_record_that_ends_before_the_strip_relaxes_asks_for_a_longer_one() {
    let mut plan = preflight(0.5, 0.05);
    plan.trial.for_s = 5.0;
    let document = plan.run(&Silent).unwrap();
    let answer = document.answer.join("\n");
    assert!(
        answer.contains("relaxing back takes 50 s, longer than the record"),
        "{answer}"
    );
    assert!(answer.contains("A record of 25 s"), "{answer}");
}

/// The strip in the truth simulator, which solves its equations by itself and shares nothing with the plan or the fit but
/// the generator of noise: intervals that are promised are as wide as its fits scatter.
#[test]
fn intervals_are_as_wide_as_fits_of_another_simulator_scatter() {
    for start_is_known in [false, true] {
        are_as_wide(start_is_known);
    }
}

fn are_as_wide(start_is_known: bool) {
    const SEEDS: u64 = 20;
    let mut plan = preflight(2.0, 0.2);
    plan.trial.start_is_known = start_is_known;
    let planned = judged(&plan.subject, &plan.trial, (20, 0), &Silent);
    let model = plan.subject.model.clone();
    let truth = Truth {
        branches: model.branches,
        steady_state_resistance_ohm_cm2: model.steady_state_resistance_ohm_cm2,
        charge_to_curvature_per_c_cm: model.charge_to_curvature_per_c_cm,
        relaxation_rate_per_s: model.relaxation_rate_per_s,
        area_cm2: AREA_CM2,
        length_cm: None,
        width_cm: None,
        effects: Vec::new(),
    };
    let fit_of_seed = |seed: u64| {
        let time_s = plan.trial.times(0.2, (seed as f64 + 0.5) / SEEDS as f64);
        let exact = simulate(&truth, &plan.trial.drive, &time_s, &time_s, 0).unwrap();
        let current = noise(&exact.current_a, &plan.subject.current_noise, 1000 + seed, 0);
        let bending = plan.subject.curvature_noise.unwrap();
        let curvature = noise(&exact.curvature_per_cm, &bending, 1000 + seed, 1);
        let channel =
            |quantity, values: Vec<f64>| Channel::new(quantity, time_s.clone().into(), values.into());
        let channels = [
            channel(Quantity::Current, current),
            channel(Quantity::Curvature, curvature),
        ];
        let input = FitInput {
            channels: &channels,
            drive: &plan.trial.told(&time_s),
            area_cm2: AREA_CM2,
        };
        fit_run(&input, &FitOptions::default()).unwrap()
    };
    let fits: Vec<_> = (0..SEEDS).map(fit_of_seed).collect();
    for of in &planned {
        let values: Vec<f64> = fits
            .iter()
            .map(|fit| fit.parameter(of.key).unwrap().value.unwrap())
            .collect();
        let square = |value: &f64| (value / of.value - 1.0).powi(2);
        let scatter_percent = 196.0 * (values.iter().map(square).sum::<f64>() / SEEDS as f64).sqrt();
        let promised = of.interval_percent.unwrap();
        // A standard deviation of 20 values is itself known to 16 %: three of these, and as much for the median.
        let ratio = scatter_percent / promised;
        assert!(
            (0.5..1.7).contains(&ratio),
            "{}: {scatter_percent} %, promised {promised} %",
            of.key
        );
        assert!(of.held >= 16, "{}: {} of 20 hold it", of.key, of.held);
    }
}

#[test]
fn the_same_seed_gives_the_same_plan() {
    let plan = preflight(2.0, 0.5);
    assert_eq!(plan.run(&Silent).unwrap(), plan.run(&Silent).unwrap());
}

#[test]
fn what_no_run_can_have_is_refused_with_what_is_needed() {
    let refused = |change: &dyn Fn(&mut Preflight)| {
        let mut plan = preflight(2.0, 0.5);
        change(&mut plan);
        plan.run(&Silent).unwrap_err().to_string()
    };
    let cases: [(String, &str); 7] = [
        (
            refused(&|plan| plan.trial.every_s = -0.25),
            "--every: found -0.25 s",
        ),
        (
            refused(&|plan| plan.trial.bending_every_s = f64::NAN),
            "--bending-every",
        ),
        (
            refused(&|plan| plan.trial.for_s = 0.7),
            "two readings at least: 1 s or more",
        ),
        (refused(&|plan| plan.trial.every_s = 1e-6), "a longer --every"),
        (refused(&|plan| plan.draws = 0), "--draws: found 0"),
        (
            refused(&|plan| plan.subject.current_noise.standard_deviation = -1.0),
            "--current-noise: found -1",
        ),
        (
            refused(&|plan| plan.trial.drive = Drive::step(0.0)),
            "a step, as 1.2V",
        ),
    ];
    for (message, needed) in cases {
        assert!(message.contains(needed), "{message}");
    }
}
