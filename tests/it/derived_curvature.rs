//! Curvature that is made from a displacement, by the reader and by the model.

use std::sync::Arc;

use ieap::domain::{Channel, Drive, Edge, Fit, Level, Quantity, Segment};
use ieap::fit::{FitInput, FitOptions, fit_run};
use ieap::model::{Branch, LumpedModel};

#[test]
fn the_reader_derives_curvature_as_the_model_does() {
    let displacement_mm = [-4.0, 0.0, 0.3, 5.0, 7.5];
    let channel = Channel::new(
        Quantity::TipDisplacement,
        [0.0, 1.0, 2.0, 3.0, 4.0].into(),
        displacement_mm.into(),
    );
    let derived = ieap::ingest::derived::responses(&[channel], Some(0.5), None);
    for (curvature, displacement) in derived[1].values.iter().zip(displacement_mm) {
        let formula = ieap::model::geometry::curvature_from_displacement(displacement, 5.0);
        assert!((curvature - formula).abs() <= 1e-15 * formula.abs().max(1.0));
    }
}

const LENGTH_CM: f64 = 1.0;
const AREA_CM2: f64 = 0.1;
/// Offset of what is read at rest: a fifth of the stroke, mm.
const REST_MM: f64 = 0.5;

fn model() -> LumpedModel {
    let branch = |resistance_ohm_cm2, capacitance_f_per_cm2| Branch {
        resistance_ohm_cm2,
        capacitance_f_per_cm2,
    };
    LumpedModel {
        branches: vec![branch(300.0, 0.05), branch(900.0, 0.11)],
        steady_state_resistance_ohm_cm2: 9000.0,
        charge_to_curvature_per_c_cm: 20.0,
        relaxation_rate_per_s: 2e-4,
    }
}

/// The fit of a step that a laser beside the free end saw, of a strip that was bent at rest or not, by a laser that was zeroed or
/// not; read from before the step or only after it.
fn fit_of(rest_per_cm: f64, laser_mm: f64, from_s: f64) -> Fit {
    let time_s: Arc<[f64]> = (0..)
        .map(|k| from_s + 9.0 * f64::from(k))
        .take_while(|t| *t < 3600.0)
        .collect();
    let exact = Drive::step(1.0);
    let noise = |k: usize, part: f64| part * (1.7 * (k * k) as f64).sin();
    let current = model().current_a(&exact, AREA_CM2, &time_s);
    let current: Vec<f64> = (current.iter().enumerate())
        .map(|(k, i)| i + noise(k, 1e-6))
        .collect();
    let seen_mm = |(k, bent): (usize, &f64)| {
        let curvature = bent + rest_per_cm;
        let seen_cm = if curvature.abs() < 1e-9 {
            0.0
        } else {
            (1.0 - (1.0 - (curvature * LENGTH_CM).powi(2)).sqrt()) / curvature
        };
        10.0 * seen_cm + laser_mm + noise(k, 5e-3)
    };
    let bent = model().curvature_per_cm(&exact, AREA_CM2, &time_s);
    let tip: Vec<f64> = bent.iter().enumerate().map(seen_mm).collect();
    let measured = [
        Channel::new(Quantity::Current, time_s.clone(), current.into()),
        Channel::new(Quantity::TipDisplacement, time_s.clone(), tip.into()),
    ];
    let before_s = time_s
        .iter()
        .copied()
        .filter(|t| *t < 0.0)
        .fold(from_s - 9.0, f64::max);
    let drive = Drive {
        baseline_v: 0.0,
        segments: vec![Segment {
            edge: Edge::between(before_s, before_s + 9.0),
            level: Level::Voltage(1.0),
        }],
    };
    let channels = ieap::ingest::derived::responses(&measured, Some(LENGTH_CM), Some(&drive));
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    fit_run(&input, &FitOptions::for_model("lumped-2").unwrap()).unwrap()
}

#[test]
fn a_zero_that_nothing_tells_is_in_the_intervals() {
    let width = |fit: &Fit| {
        let alpha = fit.parameter("alpha_per_c_cm").unwrap();
        let (low, high) = (alpha.low_95.unwrap(), alpha.high_95.unwrap());
        assert!(low < 20.0 && 20.0 < high, "{alpha:?}");
        let rate = fit.parameter("lambda_per_s").unwrap();
        assert!(
            rate.low_95.unwrap() < 2e-4 && 2e-4 < rate.high_95.unwrap(),
            "{rate:?}"
        );
        high - low
    };
    let is_said = |fit: &Fit| fit.issues.iter().any(|issue| issue.code == "open-zero");
    let known = fit_of(0.0, 0.0, -29.5);
    assert!(!is_said(&known), "{:?}", known.issues);
    // Of a strip of 10 mm what 0.5 mm at rest would be: 2 d / L^2.
    let bent = fit_of(2.0 * REST_MM / 10.0, 0.0, -29.5);
    for open in [fit_of(0.0, REST_MM, -29.5), bent, fit_of(0.0, REST_MM, 0.5)] {
        assert!(is_said(&open), "{:?}", open.issues);
        assert!(width(&open) > 1.5 * width(&known));
    }
}
