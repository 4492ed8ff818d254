//! Runs with bending and no current.

use super::*;

const PER_VOLT: [&str; 3] = [
    "curvature1_per_cm_v",
    "curvature2_per_cm_v",
    "curvature_total_per_cm_v",
];

/// What bending alone may tell of that model.
pub(super) fn told(model: &LumpedModel) -> Vec<(&'static str, f64)> {
    let per_volt =
        |k: usize| model.charge_to_curvature_per_c_cm * AREA_CM2 * model.branches[k].capacitance_f_per_cm2;
    let mut told = vec![
        ("lambda_per_s", model.relaxation_rate_per_s),
        ("tau1_s", model.branches[0].time_constant_s()),
        (PER_VOLT[0], per_volt(0)),
        (PER_VOLT[2], (0..model.branches.len()).map(per_volt).sum()),
    ];
    if let Some(slow) = model.branches.get(1) {
        told.push(("tau2_s", slow.time_constant_s()));
        told.push((PER_VOLT[1], per_volt(1)));
    }
    told
}

fn bending(model: &LumpedModel, drive: &Drive, readings: usize, relative: f64, seed: u64) -> Vec<Channel> {
    let time_s = times(0.0, 3600.0, readings);
    channels(model, drive, &time_s, relative, 0.0, seed).split_off(1)
}

fn values(fit: &Fit) -> Vec<(&str, f64)> {
    let known = |parameter: &'_ ieap_domain::Parameter| parameter.estimate.value;
    fit.parameters
        .iter()
        .filter_map(|parameter| Some((parameter.key.as_str(), known(parameter)?)))
        .collect()
}

#[test]
fn bending_alone_tells_rates_and_curvature_per_volt_and_says_why_nothing_else() {
    for sign in [1.0, -1.0] {
        let mut model = model(&AIR_2V);
        model.charge_to_curvature_per_c_cm *= sign;
        let drive = Drive::step(2.0);
        let run = bending(&model, &drive, 3601, 0.001, 3);
        let fit = fitted(&run, &drive);
        assert!(fit.converged);
        for (key, expected) in told(&model) {
            let estimate = fit.parameter(key).unwrap();
            let value = estimate.value.unwrap_or_else(|| panic!("{key}: {estimate:?}"));
            assert!(
                (value / expected - 1.0).abs() < 0.15,
                "{key}: {value} instead of {expected}"
            );
            assert!(
                estimate.low_95.unwrap() < value && value < estimate.high_95.unwrap(),
                "{key}"
            );
        }
        for key in [
            "r1_ohm_cm2",
            "c2_f_per_cm2",
            "rss_ohm_cm2",
            "alpha_per_c_cm",
            "c_total_f_per_cm2",
        ] {
            let estimate = fit.parameter(key).unwrap();
            assert_eq!(estimate.value, None, "{key}");
            assert!(
                estimate.reason.as_ref().unwrap().contains("no current channel"),
                "{estimate:?}"
            );
            assert!(fit.issues.iter().any(|issue| issue.place == key), "{key}");
        }
        let known = |key: &str| fit.parameter(key).unwrap().value.unwrap();
        let branch = |k: usize| Branch {
            resistance_ohm_cm2: known(&format!("tau{k}_s")) / known(PER_VOLT[k - 1]).abs(),
            capacitance_f_per_cm2: known(PER_VOLT[k - 1]).abs(),
        };
        let stated = LumpedModel {
            branches: vec![branch(1), branch(2)],
            steady_state_resistance_ohm_cm2: f64::INFINITY,
            charge_to_curvature_per_c_cm: sign / AREA_CM2,
            relaxation_rate_per_s: known("lambda_per_s"),
        };
        let predicted = stated.curvature_per_cm(&drive, AREA_CM2, &run[0].time_s);
        let readings = predicted.len() as f64;
        let square: f64 = predicted
            .iter()
            .zip(run[0].values.iter())
            .map(|(f, y)| (y - f).powi(2))
            .sum();
        let rms = (square / readings).sqrt();
        assert!(
            (rms / fit.noise[0].residual_rms - 1.0).abs() < 1e-6,
            "{rms} {:?}",
            fit.noise
        );
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn intervals_of_bending_alone_hold_the_truth() {
    for (row, relative) in [(AIR_2V, 0.003), (AIR_2V, 0.03), (CPVF_AIR_1V, 0.01)] {
        let (model, drive) = (model(&row), Drive::step(row[7]));
        let (mut inside, mut of) = (0, 0);
        let runs = counted(8, 100);
        for seed in 0..runs {
            let fit = fitted(&bending(&model, &drive, 901, relative, seed), &drive);
            for key in ["lambda_per_s", PER_VOLT[2]] {
                let truth = told(&model).iter().find(|(own, _)| *own == key).unwrap().1;
                let estimate = fit.parameter(key).unwrap();
                let low = estimate.low_95.unwrap_or(f64::NEG_INFINITY);
                let high = estimate.high_95.unwrap_or(f64::INFINITY);
                inside += u32::from(low <= truth && truth <= high);
                of += u32::from(estimate.value.is_some());
            }
        }
        println!("{relative}: {inside} inside, {of} with a value, of {}", 2 * runs);
        // The two lean on each other: the spread is that of one.
        let least = 0.95 - 3.0 * (0.05 * 0.95 / runs as f64).sqrt();
        assert!(
            f64::from(inside) >= least * 2.0 * runs as f64,
            "{relative}: {inside} of {}",
            2 * runs
        );
        assert!(of >= runs as u32, "{relative}: {of}");
    }
}

#[test]
fn of_charging_and_relaxation_the_slower_is_taken_for_relaxation_and_it_is_said() {
    let mut one = model(&AIR_2V);
    one.branches.truncate(1);
    let tau_s = one.branches[0].time_constant_s();
    one.relaxation_rate_per_s = 5.0 / tau_s;
    let drive = Drive::step(2.0);
    let fit = fitted(&bending(&one, &drive, 3601, 0.001, 3), &drive);
    let known = |key: &str| fit.parameter(key).unwrap().value.unwrap();
    assert!(
        (known("lambda_per_s") * tau_s - 1.0).abs() < 0.1,
        "{:?}",
        values(&fit)
    );
    assert!(
        (known("tau1_s") * 5.0 / tau_s - 1.0).abs() < 0.1,
        "{:?}",
        values(&fit)
    );
    let note = fit
        .issues
        .iter()
        .find(|issue| issue.code == "bending-alone")
        .unwrap();
    assert!(
        note.message.contains("the slowest of the rates is taken"),
        "{note:?}"
    );
}

#[test]
fn noise_alone_tells_nothing() {
    let mut none = model(&AIR_2V);
    none.charge_to_curvature_per_c_cm = 0.0;
    let drive = Drive::step(2.0);
    let mut run = bending(&none, &drive, 901, 0.0, 1);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let values_: Vec<f64> = noise(&mut rng, 901, 1e-3, 0.3);
    run[0] = Channel::new(Quantity::Curvature, run[0].time_s.clone(), values_.into());
    let fit = fitted(&run, &drive);
    assert_eq!(values(&fit), []);
    let reason = fit.parameter("lambda_per_s").unwrap().reason.clone().unwrap();
    assert!(reason.contains("does not differ from its noise"), "{reason}");
}

/// A current whose charge comes within 1.5 and 12 s, and a bending of its own course that reaches 0.24 1/cm, with noise of 1e-3
/// of that.
fn charged_otherwise(course: impl Fn(f64) -> f64) -> Vec<Channel> {
    let slow = model(&[250.0, 0.006, 5000.0 / 3.0, 0.0072, 10_000.0, 1.0, 0.0, 2.0]);
    let time_s = times(-5.0, 120.0, 501);
    let mut run = channels(&slow, &Drive::step(2.0), &time_s, 1e-4, 0.0, 14);
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let noise = noise(&mut rng, 501, 2.4e-4, 0.0);
    let bent = time_s
        .iter()
        .zip(noise)
        .map(|(t, noise)| 0.24 * course(t.max(0.0)) + noise);
    run[1].values = bent.collect();
    run
}

/// Why what follows from the bending has no value, of a model that has it.
fn reasons(run: &[Channel], id: &str) -> Vec<String> {
    let input = FitInput {
        channels: run,
        drive: &Drive::step(2.0),
        area_cm2: AREA_CM2,
    };
    let fit = fit_run(&input, &FitOptions::for_model(id).unwrap()).unwrap();
    let of = |parameter: &ieap_domain::Parameter| parameter.estimate.reason.clone();
    fit.parameters.iter().filter_map(of).collect()
}

const IS_NOISE: &str = "does not differ from its noise";
const IS_NOT_DESCRIBED: &str = "this model does not describe the bending";

#[test]
fn a_clear_bending_of_another_course_is_never_called_noise() {
    let within_four_seconds = |t: f64| 1.0 - (-t / 4.0).exp();
    let swings = |t: f64| (t / 8.0).sin();
    for id in ["lumped-1", "lumped-2", "kelvin-voigt", "standard-linear-solid"] {
        for sign in [1.0, -1.0] {
            let clear = charged_otherwise(|t| sign * within_four_seconds(t));
            assert!(
                !reasons(&clear, id).iter().any(|why| why.contains(IS_NOISE)),
                "{id}"
            );
            let swinging = reasons(&charged_otherwise(|t| sign * swings(t)), id);
            let said = |words: &str| swinging.iter().filter(|why| why.contains(words)).count();
            assert!(
                said(IS_NOT_DESCRIBED) >= 2 && said(IS_NOISE) == 0,
                "{id}: {swinging:?}"
            );
        }
        let still = reasons(&charged_otherwise(|_| 0.0), id);
        assert!(still.iter().any(|why| why.contains(IS_NOISE)), "{id}: {still:?}");
    }
    // Without the current, too.
    let alone = reasons(&charged_otherwise(swings)[1..], "lumped-2");
    assert!(!alone.iter().any(|why| why.contains(IS_NOISE)), "{alone:?}");
}
