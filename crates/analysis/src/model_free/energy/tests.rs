//! Against closed forms: a capacitor charged through a resistor takes `C V^2` from the source, half of which it stores and
//! half of which is heat; steps of the voltage leave `C (change)^2 / 2` of heat each.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::super::{ModelFree, model_free};
use super::*;
use ieap_domain::testing::{campaign, known, run};
use ieap_domain::{Channel, Quantity, Segment};

const OHM: f64 = 100.0;
const FARAD: f64 = 0.02;
const MODULUS_MPA: f64 = 55.0;
/// Starts of the levels and their voltages: charged, let down to the half, and shorted.
const LEVELS: [(f64, f64); 3] = [(0.0, 2.0), (60.0, 1.0), (120.0, 0.0)];
const END_S: f64 = 180.0;

/// The charge before a time: of a capacitor that each level charges from where the one before left it.
fn charge(t: f64) -> f64 {
    let mut charge = 0.0;
    for (k, (start_s, volts)) in LEVELS.iter().enumerate() {
        let end_s = LEVELS.get(k + 1).map_or(END_S, |next| next.0).min(t);
        if end_s > *start_s {
            let rest = FARAD * volts;
            charge = rest + (charge - rest) * (-(end_s - start_s) / (OHM * FARAD)).exp();
        }
    }
    charge
}

fn current(t: f64) -> f64 {
    match LEVELS.iter().rev().find(|(start_s, _)| *start_s <= t) {
        Some((start_s, volts)) => {
            (volts - charge(*start_s) / FARAD) / OHM * (-(t - start_s) / (OHM * FARAD)).exp()
        }
        None => 0.0,
    }
}

fn curvature(t: f64) -> f64 {
    if t > 0.0 {
        2.0 * ((-t / 100.0).exp() - (-t / 4.0).exp())
    } else {
        0.0
    }
}

#[derive(Clone, Copy)]
struct Noisy {
    /// Part of the largest current, and of the largest curvature.
    part: f64,
    correlation: f64,
    is_irregular: bool,
}

fn simulated(noisy: Noisy, seed: u64) -> (ModelFree, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // Edges lie anywhere between two readings.
    let beat_s = [0.05, 0.1, 0.3][seed as usize % 3];
    let mut time_s = vec![-5.0 + random.random_range(0.0..beat_s)];
    while time_s[time_s.len() - 1] < END_S - 0.3 {
        let every_s = if noisy.is_irregular {
            random.random_range(0.5..2.0) * beat_s
        } else {
            beat_s
        };
        time_s.push(time_s[time_s.len() - 1] + every_s);
    }
    let first_s = *time_s.iter().find(|t| **t > 0.0).unwrap();
    let mut read = |of: fn(f64) -> f64, size: f64| -> Arc<[f64]> {
        let mut last = 0.0;
        let fresh = (1.0 - noisy.correlation * noisy.correlation).sqrt();
        let value = |t: &f64| {
            let normal: f64 = StandardNormal.sample(&mut random);
            last = noisy.correlation * last + fresh * normal;
            of(*t) + noisy.part * size * last
        };
        time_s.iter().map(value).collect()
    };
    let (ampere, bent) = (read(current, 0.02), read(curvature, 1.6));
    let time: Arc<[f64]> = time_s.into();
    let channels = [
        Channel::new(Quantity::Current, time.clone(), ampere),
        Channel::new(Quantity::Curvature, time, bent),
    ];
    let mut made = run("r", "CNaf-01", "air", None, 2.0);
    let level = |(start_s, volts): (f64, f64)| Segment::at(start_s, ieap_domain::Level::Voltage(volts));
    made.drive = Some(Drive {
        baseline_v: 0.0,
        segments: LEVELS.map(level).to_vec(),
    });
    made.area_cm2 = Some(0.1);
    let sample = campaign().samples[0].clone();
    let found = model_free(&made, &channels, Some(&sample), &known(MODULUS_MPA, 1e-9));
    (found.unwrap(), first_s)
}

/// The numbers in closed form; the first reading is `first_s` after the step.
fn truths(first_s: f64) -> [f64; 9] {
    let peak_s = (100.0f64 / 4.0).ln() / (1.0 / 4.0 - 1.0 / 100.0);
    let sample = campaign().samples[0].clone();
    let (width, thickness, length) = (
        sample.width_mm.unwrap(),
        sample.thickness_mm.unwrap(),
        sample.length_mm.unwrap(),
    );
    // N/mm2 times mm4 / mm is N mm, a thousand uJ.
    let bent_per_mm = curvature(peak_s) / 10.0;
    let elastic_uj =
        1e3 * MODULUS_MPA * width * thickness.powi(3) / 12.0 * length * bent_per_mm * bent_per_mm / 2.0;
    let until_peak_uj = 1e6 * 2.0 * charge(peak_s);
    let volume_dm3 = 0.1 * thickness / 10.0 / 1e3;
    let joule = FARAD * 2.0 * 2.0;
    [
        1e3 * joule,
        1e3 * joule,
        1e3 * FARAD * 1.0 * 1.0,
        // All that stayed is heat: half of C (change)^2 for each step.
        1e3 * 0.5 * FARAD * (2.0f64.powi(2) + 1.0 + 1.0),
        elastic_uj,
        100.0 * elastic_uj / until_peak_uj,
        joule / 3600.0 / volume_dm3,
        joule / 60.0 / volume_dm3,
        2.0 * current(first_s) / volume_dm3,
    ]
}

#[test]
fn without_noise_the_energies_are_those_of_the_closed_forms() {
    let quiet = Noisy {
        part: 1e-7,
        correlation: 0.0,
        is_irregular: false,
    };
    let (found, first_s) = simulated(quiet, 1);
    for ((estimate, truth), figure) in found.energies.iter().zip(truths(first_s)).zip(ENERGIES) {
        let value = estimate
            .value
            .unwrap_or_else(|| panic!("{}: {estimate:?}", figure.key));
        assert!(
            (value / truth - 1.0).abs() < 0.005,
            "{}: {value} for {truth}",
            figure.key
        );
    }
}

/// Intervals of 95 % over 20 seeds, three rates, edges anywhere between readings: white noise, noise that goes on, and a clock
/// that does not beat evenly.
#[test]
fn intervals_hold_the_energies() {
    for (part, correlation, is_irregular) in [(0.01, 0.0, false), (0.01, 0.6, false), (0.02, 0.0, true)] {
        let noisy = Noisy {
            part,
            correlation,
            is_irregular,
        };
        let (mut held, seeds) = ([0usize; 9], 20);
        for seed in 0..seeds {
            let (found, first_s) = simulated(noisy, 300 + seed);
            for ((estimate, truth), held) in found.energies.iter().zip(truths(first_s)).zip(&mut held) {
                let (low, high) = estimate.low_95.zip(estimate.high_95).unwrap();
                *held += usize::from(low <= truth && truth <= high);
            }
        }
        eprintln!("noise {part}, correlation {correlation}, irregular {is_irregular}: {held:?} of {seeds}");
        // Of 20 at 95 % fewer than 16 are found in one of four hundred.
        for (held, figure) in held.iter().zip(ENERGIES) {
            assert!(*held >= 16, "{}: {held} of {seeds}", figure.key);
        }
    }
}

/// By hand: 200 MPa on 2 mm x 0.3 mm has E I = 0.9 N mm2; bent to 2/cm over 10 mm it holds 0.9 x 10 x 0.2^2 / 2 = 0.18 N mm.
#[test]
fn a_bent_strip_holds_what_a_ruler_and_a_pencil_say() {
    let sample = Sample {
        length_mm: Some(10.0),
        width_mm: Some(2.0),
        thickness_mm: Some(0.3),
        ..campaign().samples[0].clone()
    };
    let strip = Strip {
        sample: Some(&sample),
        area_cm2: Some(0.2),
        modulus_mpa: &known(200.0, 1e-9),
    };
    let elastic_uj = strip.elastic_uj(&known(2.0, 1e-9)).value.unwrap();
    assert!((elastic_uj - 180.0).abs() < 1e-6, "{elastic_uj}");
}

#[test]
fn what_is_not_known_is_named() {
    let sample = campaign().samples[0].clone();
    let thin = Sample {
        thickness_mm: None,
        ..sample.clone()
    };
    let modulus_mpa = known(MODULUS_MPA, 0.02);
    let strip = |sample| Strip {
        sample: Some(sample),
        area_cm2: Some(0.1),
        modulus_mpa: &modulus_mpa,
    };
    let reason = |estimate: Estimate| estimate.reason.unwrap();
    let peak = known(1.5, 0.01);
    assert_eq!(
        reason(strip(&thin).elastic_uj(&peak)),
        "needs thickness_mm of the sample"
    );
    assert_eq!(
        reason(strip(&thin).per_dm3(&peak, 1.0)),
        "needs thickness_mm of the sample"
    );
    assert!(reason(strip(&sample).elastic_uj(&known(1.5, 1.0))).contains("noise"));
    let open = Estimate::not_determined("no modulus log");
    let without = Strip {
        modulus_mpa: &open,
        ..strip(&sample)
    };
    assert_eq!(reason(without.elastic_uj(&peak)), "no modulus log");
    // 2 % of the modulus, and 1 % of the curvature twice.
    let stiff = known(MODULUS_MPA, 0.02);
    let known_to = Strip {
        modulus_mpa: &stiff,
        ..strip(&sample)
    };
    let elastic = known_to.elastic_uj(&known(1.5, 0.01));
    let error = elastic.standard_error.unwrap() / elastic.value.unwrap();
    assert!((error - 0.02f64.hypot(0.02)).abs() < 1e-9, "{error}");
}

#[test]
fn of_a_strip_that_may_bend_on_what_it_took_to_bend_it_counts() {
    let quiet = Noisy {
        part: 1e-3,
        correlation: 0.0,
        is_irregular: false,
    };
    let (found, _) = simulated(quiet, 1);
    let mut time_s: Vec<f64> = Vec::new();
    time_s.extend((0..600).map(|k| 0.05 + 0.1 * f64::from(k)));
    // A leak goes on while nothing bends any more.
    let leaky = |t: f64| current(t) + 1e-3;
    let ampere: Arc<[f64]> = time_s.iter().map(|t| leaky(*t)).collect();
    let channel = Channel::new(Quantity::Current, time_s.into(), ampere);
    let first = Level {
        voltage_v: 2.0,
        change_v: 2.0,
        from: Edge::at(0.0),
        until: Edge::at(60.0),
    };
    let flow = Flow::of(&channel, &[Some(first)]).unwrap();
    let open = Estimate::above(12.0, "the curvature may still grow when the level ends");
    let share = efficiency(&flow, &first, &found.energies[4], &open, Some(15.0));
    let taken_mj = 2e3 * (charge(15.0) + 1e-3 * 15.0);
    let expected = 100.0 * found.energies[4].value.unwrap() / (1e3 * taken_mj);
    assert!((share.value.unwrap() / expected - 1.0).abs() < 0.01, "{share:?}");
    assert!(share.reason.unwrap().contains("first is what it is"));
}
