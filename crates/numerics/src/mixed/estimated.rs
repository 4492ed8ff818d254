//! What a mixed model says: numbers as mixtures over its scatters.

use super::likely::Likely;
use super::mixture::Mixture;
use crate::chance::chi_square_chance;
use crate::sums::dot;
use crate::symmetric::Symmetric;

/// What is fixed at one place of the scatters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    weight: f64,
    variances: Vec<f64>,
    coefficients: Vec<f64>,
    covariance: Symmetric,
}

impl Point {
    pub fn new(weight: f64, variances: Vec<f64>, at: Likely) -> Point {
        Point {
            weight,
            variances,
            coefficients: at.coefficients,
            covariance: at.covariance,
        }
    }
}

/// A mixed model with its scatters.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// What is fixed, in the order of the columns of `X`: the mean over the scatters.
    pub coefficients: Vec<f64>,
    /// Covariance of what is fixed, with what the scatters' own uncertainty adds.
    pub covariance: Symmetric,
    /// Variances of the components, and of readings, last: as likely larger as smaller, each by itself.
    pub variances: Vec<f64>,
    points: Vec<Point>,
}

impl Estimated {
    pub(super) fn of(mut points: Vec<Point>) -> Estimated {
        let all: f64 = points.iter().map(|own| own.weight).sum();
        points.iter_mut().for_each(|own| own.weight /= all);
        let fixed = points.first().map_or(0, |own| own.coefficients.len());
        let scatters = points.first().map_or(0, |own| own.variances.len());
        let mean = |k: usize| points.iter().map(|own| own.weight * own.coefficients[k]).sum();
        let coefficients: Vec<f64> = (0..fixed).map(mean).collect();
        let entry = |a: usize, b: usize| {
            let off = |own: &Point, k: usize| own.coefficients[k] - coefficients[k];
            let of = |own: &Point| own.weight * (own.covariance.get(a, b) + off(own, a) * off(own, b));
            points.iter().map(of).sum()
        };
        Estimated {
            covariance: Symmetric::from_fn(fixed, entry),
            variances: (0..scatters).map(|k| middle(&points, k)).collect(),
            coefficients,
            points,
        }
    }

    /// The combination of what is fixed by these factors.
    pub fn combined(&self, factors: &[f64]) -> Mixture {
        Mixture::of(self.points.iter().map(|own| {
            let variance = own.covariance.form(factors, factors);
            (
                own.weight,
                dot(factors, &own.coefficients),
                variance.max(0.0).sqrt(),
            )
        }))
    }

    /// Chance that combinations that are all 0 lie as far from it together; 1 where nothing is left to tell it.
    pub fn joint_chance(&self, combinations: &[Vec<f64>]) -> f64 {
        if let [one] = combinations {
            return self.combined(one).chance_of_none();
        }
        let chance = |own: &Point| {
            let of = |a: usize, b: usize| own.covariance.form(&combinations[a], &combinations[b]);
            let values: Vec<f64> = combinations.iter().map(|of| dot(of, &own.coefficients)).collect();
            let weighed = Symmetric::from_fn(values.len(), of).solve(&values, 1e-12);
            own.weight * chi_square_chance(dot(&values, &weighed), values.len())
        };
        self.points.iter().map(chance).sum::<f64>().clamp(0.0, 1.0)
    }
}

/// The variance that half of the weight is below, between the places at which it was tried.
fn middle(points: &[Point], of: usize) -> f64 {
    let mut sorted: Vec<(f64, f64)> = points.iter().map(|own| (own.variances[of], own.weight)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.dedup_by(|next, own| {
        let is_same = next.0 == own.0;
        own.1 += if is_same { next.1 } else { 0.0 };
        is_same
    });
    // A place stands for as much below it as above.
    let mut below = 0.0;
    let reached: Vec<(f64, f64)> = sorted
        .iter()
        .map(|(variance, weight)| {
            below += weight;
            (variance.sqrt(), below - 0.5 * weight)
        })
        .collect();
    let beyond = reached.partition_point(|(_, reached)| *reached < 0.5);
    let (Some(before), Some(after)) = (beyond.checked_sub(1).map(|at| reached[at]), reached.get(beyond))
    else {
        return sorted[beyond.saturating_sub(1)].0;
    };
    let part = (0.5 - before.1) / (after.1 - before.1);
    let size = if before.0 > 0.0 {
        before.0 * (after.0 / before.0).powf(part)
    } else {
        part * after.0
    };
    size * size
}
