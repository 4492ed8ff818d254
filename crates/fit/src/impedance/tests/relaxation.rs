//! The distribution of relaxation times against closed forms, and how often noise alone makes a peak.

use std::f64::consts::PI;

use ieap_domain::Spectrum;
use ieap_domain::impedance::RelaxationTimes;
use ieap_model::impedance::circuit;

use super::{kramers_kronig, of_circuit};
use crate::impedance::relaxation::relaxation_times;

fn found(spectrum: &Spectrum) -> RelaxationTimes {
    relaxation_times(spectrum, &kramers_kronig::test(spectrum)).unwrap()
}

fn of_text(text: &str, values: &[f64], noise: f64, seed: u64) -> RelaxationTimes {
    found(&of_circuit(&circuit(text).unwrap(), values, noise, seed, 50))
}

#[test]
fn a_resistor_beside_a_capacitor_is_one_peak_at_its_time_with_its_resistance() {
    for (noise, near) in [(0.0, 0.02), (0.005, 0.05)] {
        let found = of_text("R0-p(R1,C1)", &[50.0, 300.0, 2e-3], noise, 3);
        let [peak] = found.peaks.as_slice() else {
            panic!("{:?}", found.peaks);
        };
        assert!((peak.tau_s / 0.6 - 1.0).abs() < near, "{peak:?}");
        assert!((peak.resistance_ohm / 300.0 - 1.0).abs() < near, "{peak:?}");
        assert!((found.series_ohm / 50.0 - 1.0).abs() < 2.0 * near, "{found:?}");
        assert!(found.describes);
    }
}

#[test]
fn a_resistor_beside_a_constant_phase_has_the_distribution_of_cole_and_cole() {
    let (r, q, n) = (300.0, 2e-3_f64, 0.75);
    let tau = (r * q).powf(1.0 / n);
    let found = of_text("R0-p(R1,CPE1)", &[50.0, r, q, n], 0.0, 1);
    let exact = |tau_s: f64| {
        let turn = (1.0 - n) * PI;
        r / (2.0 * PI) * turn.sin() / ((n * (tau_s / tau).ln()).cosh() - turn.cos())
    };
    let top = exact(tau);
    for (tau_s, gamma) in found.tau_s.iter().zip(&found.gamma_ohm) {
        let is_told = (10.0 * found.told_s.0..0.1 * found.told_s.1).contains(tau_s);
        assert!(
            !is_told || (gamma - exact(*tau_s)).abs() < 0.05 * top,
            "{tau_s} s: {gamma} for {}",
            exact(*tau_s)
        );
    }
    assert_eq!(found.peaks.len(), 1);
    assert!(
        (found.peaks[0].tau_s / tau - 1.0).abs() < 0.02
            && (found.peaks[0].resistance_ohm / r - 1.0).abs() < 0.02
    );
}

#[test]
fn what_is_slower_or_faster_than_the_frequencies_is_no_peak() {
    // A time of 1000 s, where the lowest frequency tells of 53 s; and a capacitor, which takes charge for ever.
    let slow = of_text(
        "R0-p(R1,C1)-p(R2,C2)",
        &[50.0, 300.0, 2e-3, 2000.0, 0.5],
        0.005,
        5,
    );
    assert_eq!(slow.peaks.len(), 1, "{:?}", slow.peaks);
    assert!(slow.slower_ohm > 300.0 || slow.series_f.is_some(), "{slow:?}");
    let blocking = of_text("R0-p(R1,C1)-C2", &[50.0, 300.0, 2e-3, 0.05], 0.005, 6);
    assert_eq!(blocking.peaks.len(), 1, "{:?}", blocking.peaks);
    assert!(
        (blocking.peaks[0].resistance_ohm / 300.0 - 1.0).abs() < 0.15,
        "{:?}",
        blocking.peaks
    );
}

/// Spectra of a hundred, with noise of 0.2 to 2 %, whose number of peaks is not that of the arcs, and the largest errors of
/// the logarithms of time and resistance in the others.
fn wrong(text: &str, values: &[f64], arcs: &[(f64, f64)], count: u64) -> (u64, f64, f64) {
    let mut outcome = (0, 0.0_f64, 0.0_f64);
    for seed in 0..count {
        let noise = [0.002, 0.005, 0.01, 0.02][seed as usize % 4];
        let found = of_text(text, values, noise, 300 + seed);
        if found.peaks.len() != arcs.len() {
            outcome.0 += 1;
            continue;
        }
        for (peak, (tau, ohm)) in found.peaks.iter().zip(arcs) {
            outcome.1 = outcome.1.max((peak.tau_s / tau).ln().abs());
            outcome.2 = outcome.2.max((peak.resistance_ohm / ohm).ln().abs());
        }
    }
    println!(
        "{text}: {} of {count} wrong, tau within {:.3}, resistance within {:.3}",
        outcome.0, outcome.1, outcome.2
    );
    outcome
}

/// A circuit with its values, and the time (s) and resistance (Ohm) of its arcs.
type Case<'a> = (&'a str, &'a [f64], &'a [(f64, f64)]);

/// As many peaks as arcs, in as many spectra.
fn peaks_are_as_many_as_arcs(count: u64) {
    let spread = |product: f64, n: f64| product.powf(n.recip());
    let cases: [Case<'_>; 7] = [
        ("R0-p(R1,C1)", &[50.0, 300.0, 2e-3], &[(0.6, 300.0)]),
        (
            "R0-p(R1,C1)-p(R2,C2)",
            &[50.0, 100.0, 2e-5, 300.0, 2e-3],
            &[(2e-3, 100.0), (0.6, 300.0)],
        ),
        (
            "R0-p(R1,C1)-p(R2,C2)",
            &[50.0, 200.0, 3e-4, 300.0, 2e-3],
            &[(0.06, 200.0), (0.6, 300.0)],
        ),
        (
            "R0-p(R1,CPE1)",
            &[50.0, 300.0, 2e-3, 0.8],
            &[(spread(0.6, 0.8), 300.0)],
        ),
        (
            "R0-p(R1,CPE1)",
            &[50.0, 300.0, 2e-3, 0.65],
            &[(spread(0.6, 0.65), 300.0)],
        ),
        // A sharp arc beside a broad one, which the regularisation alone breaks into seven peaks.
        (
            "R0-p(R1,CPE1)-p(R2,C2)",
            &[100.0, 500.0, 4e-4, 0.5, 200.0, 8e-7],
            &[(1.6e-4, 200.0), (0.04, 500.0)],
        ),
        (
            "R0-p(R1,CPE1)-p(R2,CPE2)",
            &[50.0, 300.0, 2e-5, 0.8, 600.0, 4e-3, 0.8],
            &[(spread(6e-3, 0.8), 300.0), (spread(2.4, 0.8), 600.0)],
        ),
    ];
    for (text, values, arcs) in cases {
        let (wrong, time, resistance) = wrong(text, values, arcs, count);
        assert!(wrong * 10 <= count, "{text}: {wrong} of {count}");
        assert!(time < 0.5 && resistance < 0.35, "{text}: {time} {resistance}");
    }
}

#[test]
fn peaks_are_as_many_as_arcs_in_twenty_spectra() {
    peaks_are_as_many_as_arcs(20);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn peaks_are_as_many_as_arcs_in_a_hundred_spectra() {
    peaks_are_as_many_as_arcs(100);
}
