//! A step and a spectrum together: narrower than either, and as true; and a difference between both is seen.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::*;
use crate::{StepAndSpectrum, step_and_spectrum};
use ieap_domain::Spectrum;
use ieap_domain::testing::branch;
use rand::RngExt;

fn strip() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(120.0, 0.05), branch(400.0, 0.2)],
        steady_state_resistance_ohm_cm2: 2500.0,
        charge_to_curvature_per_c_cm: 12.0,
        relaxation_rate_per_s: 4e-3,
    }
}

/// A spectrum of the strip, chain by chain, with scatter as a part of |Z|.
fn spectrum(model: &LumpedModel, scatter: f64, seed: u64) -> Spectrum {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { (0..12).map(|_| rng.random_range(-0.5..0.5)).sum() };
    let frequency_hz: Vec<f64> = (0..50)
        .map(|k| 10f64.powf(-3.0 + 5.0 * f64::from(k) / 49.0))
        .collect();
    let mut own = Spectrum {
        frequency_hz: frequency_hz.clone(),
        real_ohm: Vec::new(),
        imaginary_ohm: Vec::new(),
    };
    for hz in frequency_hz {
        let omega = TAU * hz;
        let (mut re, mut im) = (1.0 / model.steady_state_resistance_ohm_cm2, 0.0);
        for branch in &model.branches {
            // 1 / (R + 1 / (i omega C))
            let (r, x) = (
                branch.resistance_ohm_cm2,
                -1.0 / (omega * branch.capacitance_f_per_cm2),
            );
            re += r / (r * r + x * x);
            im -= x / (r * r + x * x);
        }
        let norm = AREA_CM2 * (re * re + im * im);
        let (z, y) = (re / norm, -im / norm);
        let size = z.hypot(y);
        own.real_ohm.push(z + size * scatter * normal());
        own.imaginary_ohm.push(y + size * scatter * normal());
    }
    own
}

/// Moment per charge of the strip where it is held, mN mm / C.
const MU: f64 = 900.0;

/// The step alone, and beside the spectrum; with a run of the same strip held, too.
fn both(of_step: &LumpedModel, of_spectrum: &LumpedModel, seed: u64) -> [(Fit, StepAndSpectrum); 2] {
    let every_s = [0.5, 1.0, 2.0][seed as usize % 3];
    let time_s: Arc<[f64]> = (0..500).map(|k| f64::from(k) * every_s).collect();
    let drive = Drive::step(0.2);
    let relative = [0.003, 0.01][seed as usize % 2];
    let channels = channels(of_step, &drive, &time_s, relative, 0.0, seed);
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let spectrum = spectrum(of_spectrum, 0.003 * (1.0 + (seed % 4) as f64), 900 + seed);
    let pulls = LumpedModel {
        charge_to_curvature_per_c_cm: MU,
        ..of_step.clone()
    };
    let held_channels = super::channels(&pulls, &drive, &time_s, relative, 0.0, 5000 + seed);
    let held = FitInput {
        channels: &held_channels,
        ..input
    };
    let step = fitted(&channels, &drive);
    [None, Some(&held)].map(|held| {
        let found = step_and_spectrum(&input, held, (&spectrum, AREA_CM2), "lumped-2").unwrap();
        (step.clone(), found)
    })
}

#[test]
fn together_they_are_narrower_and_as_true() {
    for with_force in [false, true] {
        together_with(with_force);
    }
}

fn together_with(with_force: bool) {
    let (mut held, mut of, mut refused, mut narrower, mut told) = (0, 0, 0, 0, 0);
    let draws = counted(20, 100);
    for seed in 0..draws {
        let (step, found) = both(&strip(), &strip(), 50 + seed)[usize::from(with_force)].clone();
        refused += usize::from(found.p < 0.05);
        if let Some(moment) = &found.moment_per_c {
            let (low, high) = (moment.low_95.unwrap(), moment.high_95.unwrap());
            held += usize::from((low..=high).contains(&MU));
            of += 1;
        }
        for (key, truth) in truth(&strip()) {
            let own = found
                .parameters
                .iter()
                .find(|parameter| parameter.key == key)
                .unwrap();
            if let (Some(low), Some(high)) = (own.estimate.low_95, own.estimate.high_95) {
                held += usize::from((low..=high).contains(&truth));
                of += 1;
            }
            let errors = own
                .estimate
                .standard_error
                .zip(step.parameter(key).unwrap().standard_error);
            if let Some((both, alone)) = errors {
                told += 1;
                narrower += usize::from(both < 1.02 * alone);
            }
        }
    }
    println!(
        "{held} of {of} intervals hold, {narrower} of {told} narrower than the step's, {refused} of {draws} refused"
    );
    let least = 0.95 - 3.0 * (0.05 * 0.95 / (5.0 * draws as f64)).sqrt();
    assert!(held as f64 / of as f64 > least, "{held} of {of}");
    assert!(narrower as f64 > 0.9 * told as f64, "{narrower} of {told}");
    assert!(
        refused as f64 <= 0.05 * draws as f64 + 3.0 * (0.0475 * draws as f64).sqrt(),
        "{refused}"
    );
}

#[test]
fn a_strip_that_changed_between_them_is_seen() {
    let mut other = strip();
    other.branches[1].capacitance_f_per_cm2 *= 1.2;
    for ((_, found), shared) in both(&strip(), &other, 7).iter().zip([5, 11]) {
        assert_eq!(found.shared, shared);
        assert!(found.p < 1e-3, "{found:?}");
    }
}
