//! Whether samples follow a law alike, and whether they differ at all.

use super::fitted::{Fitted, Interval, Material};
use super::policy::FEWEST_OF_A_KIND;
use super::shape::progress;
use crate::policy::DIFFERS_BELOW;
use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::student::quantile_95;

/// Widens the interval of a law's size where samples follow it with sizes that differ by more than their errors:
/// samples then are a random effect on the size too (DerSimonian and Laird 1986, with the interval of Hartung and
/// Knapp 2001). Tells whether they differ.
pub fn widen(material: &Material, law: &mut Fitted) -> bool {
    let along: Vec<f64> = material
        .x
        .iter()
        .map(|&x| progress(law.law, x, material.span, law.bend))
        .collect();
    let column = material.nuisance.residual(&along);
    let left = material.nuisance.residual(material.y);
    let samples = material.sample.iter().max().map_or(0, |last| last + 1);
    let (mut square, mut product) = (vec![0.0; samples], vec![0.0; samples]);
    for ((c, y), &sample) in column.iter().zip(&left).zip(material.sample) {
        square[sample] += c * c;
        product[sample] += c * y;
    }
    let whole: f64 = square.iter().sum();
    let own: Vec<(f64, f64)> = square
        .iter()
        .zip(&product)
        .filter(|(square, _)| **square > 1e-6 * whole)
        .map(|(square, product)| (product / square, 1.0 / square))
        .collect();
    if own.len() < FEWEST_OF_A_KIND {
        return false;
    }
    let freedom = own.len() - 1;
    let scatter = heterogeneity(&own);
    if chi_square_chance(scatter, freedom) >= DIFFERS_BELOW {
        return false;
    }
    let weights: Vec<f64> = own.iter().map(|(_, variance)| variance.recip()).collect();
    let sum: f64 = weights.iter().sum();
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    let between = ((scatter - freedom as f64) / (sum - squares / sum)).max(0.0);
    let weights: Vec<f64> = own
        .iter()
        .map(|(_, variance)| (variance + between).recip())
        .collect();
    let sum: f64 = weights.iter().sum();
    let mean = own
        .iter()
        .zip(&weights)
        .map(|((size, _), weight)| size * weight)
        .sum::<f64>()
        / sum;
    let spread: f64 = own
        .iter()
        .zip(&weights)
        .map(|((size, _), weight)| weight * (size - mean).powi(2))
        .sum::<f64>()
        / (freedom as f64 * sum);
    let reach = quantile_95(freedom as f64) * spread.sqrt();
    let wider = |one: Option<f64>, other: f64, pick: fn(f64, f64) -> f64| one.map(|one| pick(one, other));
    let value = law.size.value;
    let size = Interval {
        value,
        low_95: wider(law.size.low_95, value - reach, f64::min),
        high_95: wider(law.size.high_95, value + reach, f64::max),
    };
    law.coefficient =
        size.map(|size| super::shape::coefficient(law.law, size, material.span, law.bend, material.is_log));
    law.size = size;
    true
}

fn heterogeneity(own: &[(f64, f64)]) -> f64 {
    let sum: f64 = own.iter().map(|(_, variance)| variance.recip()).sum();
    let mean = own.iter().map(|(size, variance)| size / variance).sum::<f64>() / sum;
    own.iter()
        .map(|(size, variance)| (size - mean).powi(2) / variance)
        .sum()
}
