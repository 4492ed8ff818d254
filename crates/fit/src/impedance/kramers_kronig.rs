//! The linear Kramers-Kronig test: what is linear, causal, stable and unchanging has an impedance that resistors
//! parallel to capacitors (Voigt elements) at fixed time constants can make, with R, L and C in series (Boukamp,
//! J. Electrochem. Soc. 142, 1885, 1995). Their resistances follow by linear least squares.
//!
//! Their number is that of Schönleber, Klotz and Ivers-Tiffée (Electrochim. Acta 131, 20, 2014): it grows until the
//! share of negative resistances says that noise is fitted, mu = 1 - SUM|R < 0| / SUM|R >= 0| <= 0.85.

use std::f64::consts::TAU;

use ieap_domain::impedance::FEWEST_FREQUENCIES;
use ieap_domain::{Consistency, KramersKronig, Spectrum};
use ieap_numerics::householder::least_squares;
use ieap_numerics::sums::add;

/// Number mu at which no more elements are taken (Schönleber and others).
const STOP_AT_MU: f64 = 0.85;
/// Most elements.
const MOST_ELEMENTS: usize = 50;
/// Elements a decade that the verdict is taken with at least: Schönleber's criterion stops at very few where a
/// spectrum bends in its low end only, and elements further apart leave waves of a percent between them.
const LEAST_PER_DECADE: f64 = 2.0;
/// Neighbouring residuals that are averaged.
const WINDOW: usize = 5;
/// A mean that matters: 1 % of |Z|, the usual limit for residuals of this test.
const MATTERS: f64 = 0.01;
/// A mean that scatter does not make, in standard errors: with about a hundred means, once in two hundred spectra.
const BEYOND_SCATTER: f64 = 4.0;

/// Voigt elements fitted to a spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Voigt {
    /// Resistances of the elements, Ohm, from the shortest time constant to the longest.
    pub resistances_ohm: Vec<f64>,
    /// Share of negative ones.
    pub mu: f64,
    /// Residual of the real part over |Z|.
    pub residual_real: Vec<f64>,
    /// Residual of the imaginary part over |Z|.
    pub residual_imaginary: Vec<f64>,
}

impl Voigt {
    fn rms(&self) -> f64 {
        let all = self.residual_real.iter().chain(&self.residual_imaginary);
        let square: f64 = all.map(|r| r * r).sum();
        (square / (2 * self.residual_real.len()) as f64).sqrt()
    }
}

/// Tests a spectrum.
pub fn test(spectrum: &Spectrum) -> KramersKronig {
    let decades = spectrum
        .range_hz()
        .map_or(0.0, |(low, high)| (high / low).log10());
    let most = MOST_ELEMENTS.min(spectrum.len().saturating_sub(2));
    let mut found = None;
    for elements in 1..=most {
        let next = fit(spectrum, elements);
        let stops = next.as_ref().is_some_and(|voigt| voigt.mu <= STOP_AT_MU);
        found = next.or(found);
        let enough = elements as f64 >= LEAST_PER_DECADE * decades;
        if stops && enough {
            break;
        }
    }
    match found.filter(|_| spectrum.len() >= FEWEST_FREQUENCIES) {
        Some(voigt) => judged(spectrum, voigt),
        None => KramersKronig {
            verdict: Consistency::NotTested,
            elements: 0,
            mu: 1.0,
            scatter_percent: f64::NAN,
            residual_rms_percent: f64::NAN,
            off_hz: None,
            largest_mean_percent: f64::NAN,
            residual_real: Vec::new(),
            residual_imaginary: Vec::new(),
        },
    }
}

/// That many Voigt elements, with R, L and C in series; none where there are too many for the readings.
pub fn fit(spectrum: &Spectrum, elements: usize) -> Option<Voigt> {
    let (low, high) = spectrum.range_hz()?;
    let (shortest, longest) = ((TAU * high).recip(), (TAU * low).recip());
    let time_constant = |k: usize| match elements {
        1 => shortest,
        _ => shortest * (longest / shortest).powf(k as f64 / (elements - 1) as f64),
    };
    let weights: Vec<f64> = spectrum.magnitude_ohm().iter().map(|size| size.recip()).collect();
    let omegas: Vec<f64> = spectrum.frequency_hz.iter().map(|hz| TAU * hz).collect();
    // Real parts above imaginary ones.
    let column = |part: &dyn Fn(f64) -> (f64, f64)| -> Vec<f64> {
        let weighted = |real: bool| {
            omegas.iter().zip(&weights).map(move |(&omega, weight)| {
                let (re, im) = part(omega);
                weight * if real { re } else { im }
            })
        };
        weighted(true).chain(weighted(false)).collect()
    };
    let mut columns = vec![column(&|_| (1.0, 0.0))];
    for k in 0..elements {
        let tau = time_constant(k);
        columns.push(column(&|omega| {
            let turn = omega * tau;
            let below = 1.0 + turn * turn;
            (below.recip(), -turn / below)
        }));
    }
    columns.push(column(&|omega| (0.0, omega)));
    columns.push(column(&|omega| (0.0, -omega.recip())));
    let weighted = |values: &[f64]| -> Vec<f64> { values.iter().zip(&weights).map(|(v, w)| v * w).collect() };
    let mut readings = weighted(&spectrum.real_ohm);
    readings.extend(weighted(&spectrum.imaginary_ohm));
    let coefficients = least_squares(&columns, &readings)?;
    for (column, coefficient) in columns.iter().zip(&coefficients) {
        add(&mut readings, -coefficient, column);
    }
    let resistances_ohm = coefficients[1..=elements].to_vec();
    let residual_imaginary = readings.split_off(spectrum.len());
    Some(Voigt {
        mu: mu(&resistances_ohm),
        resistances_ohm,
        residual_real: readings,
        residual_imaginary,
    })
}

fn mu(resistances: &[f64]) -> f64 {
    let sum = |keep: &dyn Fn(f64) -> bool| -> f64 {
        resistances.iter().filter(|r| keep(**r)).map(|r| r.abs()).sum()
    };
    match sum(&|r| r >= 0.0) {
        0.0 => f64::NEG_INFINITY,
        positive => 1.0 - sum(&|r| r < 0.0) / positive,
    }
}

/// The verdict: means of neighbouring residuals that are larger than matters and than scatter makes.
fn judged(spectrum: &Spectrum, voigt: Voigt) -> KramersKronig {
    let mut order: Vec<usize> = (0..spectrum.len()).collect();
    order.sort_by(|a, b| spectrum.frequency_hz[*a].total_cmp(&spectrum.frequency_hz[*b]));
    let sorted = |values: &[f64]| -> Vec<f64> { order.iter().map(|&k| values[k]).collect() };
    let parts = [sorted(&voigt.residual_real), sorted(&voigt.residual_imaginary)];
    let scatter = scatter(&parts);
    let limit = MATTERS.max(BEYOND_SCATTER * scatter / (WINDOW as f64).sqrt());
    let (mut largest, mut off) = (0.0_f64, None::<(usize, usize)>);
    for part in &parts {
        for (first, window) in part.windows(WINDOW).enumerate() {
            let mean = window.iter().sum::<f64>() / WINDOW as f64;
            largest = largest.max(mean.abs());
            if mean.abs() > limit {
                let (low, high) = off.unwrap_or((first, first));
                off = Some((low.min(first), high.max(first + WINDOW - 1)));
            }
        }
    }
    let hz = |k: usize| spectrum.frequency_hz[order[k]];
    KramersKronig {
        verdict: match off {
            Some(_) => Consistency::Violated,
            None => Consistency::Consistent,
        },
        elements: voigt.resistances_ohm.len(),
        mu: voigt.mu,
        scatter_percent: 100.0 * scatter,
        residual_rms_percent: 100.0 * voigt.rms(),
        off_hz: off.map(|(low, high)| (hz(low), hz(high))),
        largest_mean_percent: 100.0 * largest,
        residual_real: voigt.residual_real,
        residual_imaginary: voigt.residual_imaginary,
    }
}

/// Standard deviation of residuals as their successive differences show it (von Neumann 1941), which waves over many
/// frequencies hardly raise.
fn scatter(parts: &[Vec<f64>]) -> f64 {
    let differences = parts
        .iter()
        .flat_map(|part| part.windows(2).map(|pair| pair[1] - pair[0]));
    let (sum, count) = differences.fold((0.0, 0usize), |(sum, count), d| (sum + d * d, count + 1));
    (sum / (2 * count.max(1)) as f64).sqrt()
}
