//! Z-HIT: the modulus as the phase gives it (Ehm, Göhr, Kaus, Röseler and Schiller, ACH Models Chem. 137, 145, 2000),
//! ln|Z(w)| = const + 2/pi INTEGRAL phase d ln w - pi/6 d phase / d ln w.
//!
//! It is an independent look at what the Kramers-Kronig test looks at: the phase at one frequency depends on what lies
//! near it, so that a modulus that drifts while the lowest frequencies are measured is not taken for another impedance.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use ieap_domain::Spectrum;
use ieap_domain::impedance::ZHit;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{Z_HIT_LOWEST, Z_HIT_WINDOW};

/// Compares the modulus of a spectrum with that which its phase gives; none of too few frequencies.
pub fn z_hit(spectrum: &Spectrum) -> Option<ZHit> {
    let n = spectrum.len();
    if n < Z_HIT_WINDOW {
        return None;
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| spectrum.frequency_hz[*a].total_cmp(&spectrum.frequency_hz[*b]));
    let log_omega: Vec<f64> = order
        .iter()
        .map(|&k| (TAU * spectrum.frequency_hz[k]).ln())
        .collect();
    let phase = unwrapped(
        order
            .iter()
            .map(|&k| spectrum.imaginary_ohm[k].atan2(spectrum.real_ohm[k])),
    );
    let log_measured: Vec<f64> = (order.iter())
        .map(|&k| spectrum.real_ohm[k].hypot(spectrum.imaginary_ohm[k]).ln())
        .collect();
    let log_given = modulus(&log_omega, &phase);
    let apart: Vec<f64> = log_measured
        .iter()
        .zip(&log_given)
        .map(|(own, given)| own - given)
        .collect();
    // The time of a sweep goes into its lowest frequencies, and leads disturb the highest: the middle has neither.
    let mut middle = apart[n / 3..n - n / 3].to_vec();
    middle.sort_by(f64::total_cmp);
    let constant = middle[middle.len() / 2];
    let apart: Vec<f64> = apart.iter().map(|apart| (apart - constant).exp_m1()).collect();
    let lowest = apart[..Z_HIT_LOWEST].iter().sum::<f64>() / Z_HIT_LOWEST as f64;
    let mut deviation = vec![0.0; n];
    order
        .iter()
        .zip(&apart)
        .for_each(|(&k, apart)| deviation[k] = *apart);
    Some(ZHit {
        lowest_percent: 100.0 * lowest,
        deviation,
    })
}

/// Phases without jumps by a whole turn.
fn unwrapped(phases: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut last: Option<f64> = None;
    phases
        .map(|phase| {
            let turns = last.map_or(0.0, |last| ((phase - last) / TAU).round());
            let own = phase - turns * TAU;
            last = Some(own);
            own
        })
        .collect()
}

/// Logarithm of the modulus, but for a constant, from phases in the order of their frequencies.
fn modulus(log_omega: &[f64], phase: &[f64]) -> Vec<f64> {
    let smooth: Vec<(f64, f64)> = (0..phase.len()).map(|k| local(log_omega, phase, k)).collect();
    let mut integral = 0.0;
    let mut all = Vec::with_capacity(phase.len());
    for (k, (_, slope)) in smooth.iter().enumerate() {
        if k > 0 {
            // The integral of the cubic through both ends with both slopes.
            let (before, step) = (smooth[k - 1], log_omega[k] - log_omega[k - 1]);
            integral += 0.5 * step * (before.0 + smooth[k].0) + step * step / 12.0 * (before.1 - smooth[k].1);
        }
        all.push(integral / FRAC_PI_2 - PI / 6.0 * slope);
    }
    all
}

/// Value and slope of the parabola through the phases about a place.
fn local(log_omega: &[f64], phase: &[f64], at: usize) -> (f64, f64) {
    let first = at
        .saturating_sub(Z_HIT_WINDOW / 2)
        .min(phase.len() - Z_HIT_WINDOW);
    let window = first..first + Z_HIT_WINDOW;
    let powers: Vec<[f64; 3]> = window
        .clone()
        .map(|k| log_omega[k] - log_omega[at])
        .map(|x| [1.0, x, x * x])
        .collect();
    let sum = |a: usize, b: usize| powers.iter().map(|p| p[a] * p[b]).sum::<f64>();
    let right: Vec<f64> = (0..3)
        .map(|a| {
            powers
                .iter()
                .zip(&phase[window.clone()])
                .map(|(p, phase)| p[a] * phase)
                .sum()
        })
        .collect();
    let found = Symmetric::from_fn(3, sum)
        .cholesky(1e-14)
        .map(|matrix| matrix.solve(&right));
    // Frequencies that are measured again and again determine no parabola.
    found.map_or((phase[at], 0.0), |found| (found[0], found[1]))
}
