//! Z-HIT against closed forms, how far it strays on spectra that do not drift, and what drift it sees.

use ieap_model::impedance::circuit;

use super::of_circuit;
use crate::impedance::kramers_kronig;
use crate::impedance::z_hit::z_hit;
use ieap_domain::{Consistency, Spectrum};

/// Circuits of actuators and of what else lies in an electrode, with their values.
const SAMPLES: [(&str, &[f64]); 8] = [
    ("p(R1-C1,R2-C2,R3)", &[220.0, 4e-3, 1500.0, 1.2e-2, 3e4]),
    ("p(R1-C1,R2-C2,R3)", &[220.0, 4e-3, 1500.0, 1.2e-2, 1e9]),
    ("p(R1-CPE1,R2)", &[220.0, 5e-3, 0.8, 3e4]),
    ("p(R1-Wo1,R2)", &[200.0, 900.0, 1.5e-2, 3e4]),
    ("R0-p(R1,C1)-W1", &[50.0, 300.0, 2e-3, 0.02]),
    (
        "R0-p(R1,CPE1)-p(R2,CPE2)",
        &[50.0, 300.0, 2e-4, 0.9, 2000.0, 3e-3, 0.8],
    ),
    ("R0-TLMQ1", &[50.0, 700.0, 8e-3, 0.9]),
    ("R0-p(R1,C1)", &[50.0, 300.0, 0.2]),
];

/// The modulus grows by a part over the time of the sweep, and the phase stays.
fn drifting(spectrum: &Spectrum, part: f64) -> Spectrum {
    let whole: f64 = spectrum.frequency_hz.iter().map(|hz| hz.recip()).sum();
    let mut past = 0.0;
    let mut drifted = spectrum.clone();
    for k in 0..spectrum.len() {
        past += spectrum.frequency_hz[k].recip() / whole;
        drifted.real_ohm[k] *= 1.0 + part * past;
        drifted.imaginary_ohm[k] *= 1.0 + part * past;
    }
    drifted
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn calibration() {
    for noise in [0.0, 0.005] {
        for (text, values) in SAMPLES {
            let circuit = circuit(text).unwrap();
            print!("{noise:6} {text:26}");
            for drift in [0.0, 0.05, -0.05, 0.1] {
                let mut all: Vec<f64> = Vec::new();
                let (mut violated, mut drifts, mut limit, mut either) = (0, 0, 0.0, 0);
                for seed in 0..100 {
                    let count = [30, 50, 80][seed as usize % 3];
                    let spectrum = drifting(&of_circuit(&circuit, values, noise, 700 + seed, count), drift);
                    let kk = kramers_kronig::test(&spectrum);
                    let zh = z_hit(&spectrum, 0.01 * kk.scatter_percent).unwrap();
                    all.push(zh.lowest_percent);
                    let v = kk.verdict == Consistency::Violated;
                    violated += usize::from(v);
                    drifts += usize::from(zh.drifts);
                    either += usize::from(zh.drifts || v);
                    limit += 0.01 * zh.limit_percent;
                }
                let mean = all.iter().sum::<f64>() / 100.0;
                let sd = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 99.0).sqrt();
                print!(
                    " | {drift:5}: {mean:5.2}+-{sd:4.2} lim {limit:4.2}; zh {drifts} kk {violated} or {either}"
                );
            }
            println!();
        }
    }
}
