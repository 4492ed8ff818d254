//! Z-HIT: the modulus as the phase gives it (Ehm, Göhr, Kaus, Röseler and Schiller, ACH Models Chem. 137, 145, 2000),
//! ln|Z(w)| = const + 2/pi INTEGRAL phase d ln w - pi/6 d phase / d ln w.
//!
//! The last term is the first of a series, which strays by 3 % about a corner. Here stands what the series is of:
//! x coth x with x = pi k / 2 over waves of wave number k, that is the slope of the phase averaged with the weight
//! -ln(1 - exp(-2 |d ln w|)) / pi, whose integral is pi/6.
//!
//! It is an independent look at what the Kramers-Kronig test looks at: the modulus at one frequency depends on the phase
//! near it, so that a modulus that drifts while the lowest frequencies are measured is not taken for another impedance.

use std::f64::consts::{FRAC_PI_2, LN_10, PI, TAU};

use ieap_domain::Spectrum;
use ieap_domain::impedance::ZHit;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{
    Z_HIT_BEYOND_ERROR, Z_HIT_DRIFT_DECADES, Z_HIT_LOWEST_DECADES, Z_HIT_OWN_ERROR, Z_HIT_WINDOW,
};

/// Compares the modulus of a spectrum with that which its phase gives; none of too few frequencies. `scatter` is that of
/// the readings, part of |Z|.
pub fn z_hit(spectrum: &Spectrum, scatter: f64) -> Option<ZHit> {
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
    let given = PhaseToModulus::new(&log_omega);
    let apart = given.apart(&phase, &log_measured);
    let error = scatter * given.lowest_error();
    let limit = Z_HIT_OWN_ERROR + Z_HIT_BEYOND_ERROR * error;
    let lowest = given.lowest(&apart);
    let mut deviation = vec![0.0; n];
    order
        .iter()
        .zip(&apart)
        .for_each(|(&k, apart)| deviation[k] = *apart);
    Some(ZHit {
        drifts: lowest.abs() > limit,
        lowest_percent: 100.0 * lowest,
        limit_percent: 100.0 * limit,
        lowest_hz: (log_omega[0].exp() / TAU, log_omega[given.lowest - 1].exp() / TAU),
        deviation,
    })
}

/// Number of frequencies no more than so many decades above the lowest.
fn count_within(log_omega: &[f64], decades: f64) -> usize {
    log_omega.partition_point(|x| *x <= log_omega[0] + decades * LN_10)
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

/// What leads from phases to moduli at given frequencies.
struct PhaseToModulus<'a> {
    /// Logarithms of the angular frequencies, ascending.
    log_omega: &'a [f64],
    /// Weight between each frequency and each other, for the slope of the phase.
    weights: Vec<Vec<f64>>,
    /// Number of the lowest frequencies, over which a drift is sought.
    lowest: usize,
}

impl PhaseToModulus<'_> {
    fn new(log_omega: &[f64]) -> PhaseToModulus<'_> {
        let weight = |x: f64| x.signum() * one_sided_weight(x.abs());
        let row = |at: &f64| log_omega.iter().map(|x| weight(x - at)).collect();
        PhaseToModulus {
            log_omega,
            weights: log_omega.iter().map(row).collect(),
            lowest: count_within(log_omega, Z_HIT_LOWEST_DECADES),
        }
    }

    /// Logarithm of the modulus, but for a constant.
    fn modulus(&self, phase: &[f64]) -> Vec<f64> {
        let x = self.log_omega;
        let smooth: Vec<(f64, f64)> = (0..phase.len()).map(|k| local(x, phase, k)).collect();
        let mut integral = 0.0;
        let mut all = Vec::with_capacity(phase.len());
        for k in 0..x.len() {
            if k > 0 {
                // The integral of the cubic through both ends with both slopes.
                let (before, step) = (smooth[k - 1], x[k] - x[k - 1]);
                integral +=
                    0.5 * step * (before.0 + smooth[k].0) + step * step / 12.0 * (before.1 - smooth[k].1);
            }
            all.push(integral / FRAC_PI_2 - self.mean_slope(&smooth, &self.weights[k]) / PI);
        }
        all
    }

    /// Integral of -ln(1 - exp(-2 |x|)) times the slope of the phase: its total weight is pi^2/6, nine tenths of it
    /// within a third of a decade. The slope goes on beyond the first and the last frequency.
    fn mean_slope(&self, smooth: &[(f64, f64)], weights: &[f64]) -> f64 {
        let (x, last) = (self.log_omega, smooth.len() - 1);
        let half = PI * PI / 12.0;
        let mut sum = smooth[0].1 * (half + weights[0]) + smooth[last].1 * (half - weights[last]);
        for k in 0..last {
            let step = x[k + 1] - x[k];
            if step > 0.0 {
                sum += (smooth[k + 1].0 - smooth[k].0) / step * (weights[k + 1] - weights[k]);
            }
        }
        sum
    }

    /// Logarithm of the modulus over that which the phase gives; on average zero above the lowest decade, where a sweep
    /// spends most of its time.
    fn apart(&self, phase: &[f64], log_measured: &[f64]) -> Vec<f64> {
        let x = self.log_omega;
        let given = self.modulus(phase);
        let apart: Vec<f64> = log_measured
            .iter()
            .zip(&given)
            .map(|(own, given)| own - given)
            .collect();
        let last = x.len() - 1;
        let decades = Z_HIT_DRIFT_DECADES * LN_10;
        let first = x
            .partition_point(|x| *x < self.log_omega[0] + decades)
            .min(last / 2);
        let (mut sum, mut wide) = (0.0, 0.0);
        for k in first..last {
            let step = x[k + 1] - x[k];
            sum += 0.5 * step * (apart[k] + apart[k + 1]);
            wide += step;
        }
        let constant = if wide > 0.0 { sum / wide } else { apart[last] };
        apart.iter().map(|apart| apart - constant).collect()
    }

    /// Mean over the lowest frequencies.
    fn lowest(&self, apart: &[f64]) -> f64 {
        apart[..self.lowest].iter().sum::<f64>() / self.lowest as f64
    }

    /// Standard error of the mean over the lowest frequencies, for a scatter of one of phases (radians) and of logarithms
    /// of the modulus: it is linear in both.
    fn lowest_error(&self) -> f64 {
        let n = self.log_omega.len();
        let zero = vec![0.0; n];
        let square = (0..n).map(|k| {
            let mut one = zero.clone();
            one[k] = 1.0;
            self.lowest(&self.apart(&one, &zero)).powi(2) + self.lowest(&self.apart(&zero, &one)).powi(2)
        });
        square.sum::<f64>().sqrt()
    }
}

/// Integral of -ln(1 - exp(-2 t)) from 0 to a distance: (pi^2/6 - Li2(exp(-2 distance))) / 2.
fn one_sided_weight(distance: f64) -> f64 {
    0.5 * (PI * PI / 6.0 - dilogarithm((-2.0 * distance).exp()))
}

/// Li2(z) = SUM z^n / n^2, for z from 0 to 1; near 1 by Li2(z) + Li2(1 - z) = pi^2/6 - ln z ln(1 - z).
fn dilogarithm(z: f64) -> f64 {
    const TERMS: u32 = 50;
    let series = |z: f64| -> f64 {
        let mut power = 1.0;
        let term = |n: u32| {
            power *= z;
            power / f64::from(n * n)
        };
        (1..=TERMS).map(term).sum()
    };
    match z {
        z if z >= 1.0 => PI * PI / 6.0,
        z if z > 0.5 => PI * PI / 6.0 - z.ln() * (-z).ln_1p() - series(1.0 - z),
        z => series(z),
    }
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
