//! A broken strip is what the ladder and Laplace transforms of its two lines say, and an even one where nothing breaks.

use super::*;
use crate::coupling::CurvaturePerLineCharge;
use crate::distributed::Ladder;
use ieap_domain::Drive;

fn strip() -> DistributedModel {
    DistributedModel {
        electrode_resistance_ohm_per_cm: 15.0,
        branch_resistance_ohm_cm: 10.0,
        capacitance_f_per_cm: 0.00591,
        steady_state_resistance_ohm_cm: 143.0,
        length_cm: 4.5,
        coupling: CurvaturePerLineCharge(132.75),
        relaxation_rate_per_s: 0.29,
    }
}

#[test]
fn without_a_break_it_is_the_series() {
    for (model, place) in [(strip(), 1.3), (strip(), 4.2)] {
        let sealed = DistributedModel {
            steady_state_resistance_ohm_cm: f64::INFINITY,
            ..model
        };
        for model in [model, sealed] {
            let broken = BrokenStrip::new(&model, place, 1.0);
            let s = [0.0, 0.2, 1.3, 2.9, 4.5];
            let t = [-1.0, 0.0, 0.003, 0.06, 0.5, 3.0, 60.0];
            let pairs = [
                (broken.voltage_v(1.5, &s, &t), model.voltage_v(1.5, &s, &t), 1.5),
                (
                    broken.curvature_per_cm(1.5, &s, &t),
                    model.curvature_per_cm(1.5, &s, &t),
                    1.2,
                ),
            ];
            for (found, series, scale) in pairs {
                for (a, b) in found.values.iter().zip(&series.values) {
                    assert!((a - b).abs() < 1e-6 * scale, "{a} {b}");
                }
            }
            let currents = broken.clamp_current_a(1.5, &t);
            for (a, b) in currents.iter().zip(model.clamp_current_a(1.5, &t)) {
                assert!((a - b).abs() < 1e-7, "{a} {b}");
            }
        }
    }
}

#[test]
fn with_a_break_it_is_the_ladder() {
    for (place, beyond) in [(2.25, 4.0), (0.9, 0.3), (3.6, 15.0)] {
        let model = strip();
        let t = [0.01, 0.1, 0.6, 4.0];
        let cells = 600;
        let ladder = Ladder::new(&model, cells).unwrap().broken(place, beyond);
        let truth = ladder.respond(&Drive::step(1.0), &t, 1e-8);
        let broken = BrokenStrip::new(&model, place, beyond);
        let voltage = broken.voltage_v(1.0, &truth.arc_length_cm, &t);
        let curvature = broken.curvature_per_cm(1.0, &truth.arc_length_cm, &t);
        for (found, truth, scale) in [
            (&voltage, &truth.voltage_v, 1.0),
            (&curvature, &truth.curvature_per_cm, 0.78),
        ] {
            for (a, b) in found.values.iter().zip(&truth.values) {
                assert!((a - b).abs() < 3e-4 * scale, "{place} {beyond}: {a} {b}");
            }
        }
        let currents = broken.clamp_current_a(1.0, &t);
        for (a, b) in currents.iter().zip(&truth.clamp_current_a) {
            assert!((a / b - 1.0).abs() < 1e-3, "{place} {beyond}: {a} {b}");
        }
    }
}

/// Transforms by Stehfest's rule: `f(t) = ln 2 / t SUM V_k F(k ln 2 / t)`.
fn inverted(transform: impl Fn(f64) -> f64, t: f64) -> f64 {
    const HALF: usize = 7;
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let weight = |k: usize| {
        let sum: f64 = (k.div_ceil(2)..=k.min(HALF))
            .map(|j| {
                (j as f64).powi(HALF as i32) * factorial(2 * j)
                    / (factorial(HALF - j)
                        * factorial(j)
                        * factorial(j - 1)
                        * factorial(k - j)
                        * factorial(2 * j - k))
            })
            .sum();
        if (k + HALF).is_multiple_of(2) { sum } else { -sum }
    };
    let step = std::f64::consts::LN_2 / t;
    (1..=2 * HALF)
        .map(|k| weight(k) * transform(k as f64 * step))
        .sum::<f64>()
        * step
}

#[test]
fn with_a_break_it_is_two_lines_end_to_end() {
    let model = strip();
    let (place, beyond) = (2.0, 5.0);
    let broken = BrokenStrip::new(&model, place, beyond);
    // Voltage at s for a step of 1 V, transformed: two lines with a common admittance per length.
    let voltage = |s: f64, p: f64| {
        let tau = model.branch_resistance_ohm_cm * model.capacitance_f_per_cm;
        let across =
            1.0 / model.steady_state_resistance_ohm_cm + model.capacitance_f_per_cm * p / (1.0 + p * tau);
        let line = |resistance: f64| ((resistance * across).sqrt(), (resistance / across).sqrt());
        let first = line(model.electrode_resistance_ohm_per_cm);
        let second = line(model.electrode_resistance_ohm_per_cm * beyond);
        let rest = model.length_cm - place;
        let load = first.1 * (second.0 * rest).tanh() / second.1;
        let at = |s: f64| (first.0 * (place - s)).cosh() + load * (first.0 * (place - s)).sinh();
        let over_first = at(s.min(place)) / at(0.0) / p;
        if s <= place {
            over_first
        } else {
            over_first * (second.0 * (model.length_cm - s)).cosh() / (second.0 * rest).cosh()
        }
    };
    for s in [0.5, 1.9, 2.1, 4.4] {
        for t in [0.02, 0.2, 1.0, 8.0] {
            let expected = inverted(|p| voltage(s, p), t);
            let found = broken.voltage_v(1.0, &[s], &[t]).at(0, 0);
            assert!((found - expected).abs() < 2e-4, "{s} {t}: {found} {expected}");
            let strain = |p: f64| {
                let tau = model.branch_resistance_ohm_cm * model.capacitance_f_per_cm;
                let charge = model.capacitance_f_per_cm * voltage(s, p) / (1.0 + p * tau);
                model.coupling.0 * charge * p / (p + model.relaxation_rate_per_s)
            };
            let expected = inverted(strain, t);
            let found = broken.curvature_per_cm(1.0, &[s], &[t]).at(0, 0);
            assert!((found - expected).abs() < 2e-4, "{s} {t}: {found} {expected}");
        }
    }
}
