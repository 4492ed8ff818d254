//! Circuits as texts: found again without noise, and how often their intervals hold the truth.

use ieap_model::impedance::circuit;

use super::{circuits, of_circuit};

/// Circuits of porous electrodes and of cells, with their values.
const TEXTS: [(&str, &[f64]); 9] = [
    ("R0-p(R1,CPE1)-W1", &[50.0, 900.0, 2e-4, 0.85, 0.02]),
    (
        "R0-p(R1,CPE1)-p(R2,CPE2)",
        &[50.0, 300.0, 2e-5, 0.9, 2000.0, 2e-3, 0.8],
    ),
    ("R0-TLMQ1", &[50.0, 700.0, 8e-3, 0.9]),
    ("R0-p(TLMQ1,R1)", &[50.0, 700.0, 8e-3, 0.9, 2e4]),
    ("L0-R0-p(C1,R1-Wo1)", &[2e-4, 20.0, 1e-4, 100.0, 400.0, 0.02]),
    ("R0-p(CPE1,R1-Ws1)", &[20.0, 2e-4, 0.9, 100.0, 400.0, 5.0]),
    ("R0-p(R1,C1)-p(R2,C2)-C3", &[50.0, 100.0, 2e-5, 300.0, 2e-3, 0.05]),
    ("p(R1-C1,R2-C2,R3-C3)", &[220.0, 4e-3, 1500.0, 1.2e-2, 3e3, 0.05]),
    ("R0-p(R1,CPE1)-Wo1", &[30.0, 80.0, 3e-5, 0.85, 500.0, 0.03]),
];

#[test]
fn circuits_as_texts_are_found_again_without_noise() {
    for (text, truth) in TEXTS {
        let circuit = circuit(text).unwrap();
        let spectrum = of_circuit(&circuit, truth, 0.0, 1, 50);
        let (fit, _) = circuits::fit(&circuit, &spectrum).unwrap();
        assert!(
            fit.residual_rms_percent < 1e-3,
            "{text}: {} %",
            fit.residual_rms_percent
        );
        for (parameter, expected) in fit.parameters.iter().zip(truth) {
            let value = parameter.estimate.value;
            let near = value.is_some_and(|value| (value / expected - 1.0).abs() < 1e-3);
            assert!(near, "{text} {}: {value:?} for {expected}", parameter.key);
        }
    }
}

#[test]
fn intervals_of_texts_hold_the_truth_in_twenty_spectra() {
    for (text, truth) in TEXTS {
        let circuit = circuit(text).unwrap();
        let mut held = vec![0; truth.len()];
        let mut told = vec![0; truth.len()];
        for seed in 0..20 {
            let noise = [0.002, 0.005, 0.01, 0.02][seed as usize % 4];
            let count = [30, 50, 80][seed as usize % 3];
            let spectrum = of_circuit(&circuit, truth, noise, 400 + seed, count);
            let (fit, _) = circuits::fit(&circuit, &spectrum).unwrap();
            for (k, (parameter, truth)) in fit.parameters.iter().zip(truth).enumerate() {
                let estimate = &parameter.estimate;
                let inside = estimate.low_95.is_none_or(|low| low <= *truth)
                    && estimate.high_95.is_none_or(|high| *truth <= high);
                held[k] += usize::from(inside);
                told[k] += usize::from(estimate.value.is_some());
            }
        }
        println!("{text}: {held:?} determined {told:?}");
        // Of 20 intervals of 95 %, fewer than 16 hold it once in 400 times.
        assert!(held.iter().all(|held| *held >= 16), "{text}: {held:?}");
    }
}
