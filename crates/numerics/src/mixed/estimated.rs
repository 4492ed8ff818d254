//! What a mixed model says: numbers with errors and degrees of freedom.

use super::at::{At, Likely};
use crate::chance::f_chance;
use crate::dense::Matrix;
use crate::student::two_sided_chance;
use crate::symmetric::Symmetric;

/// A mixed model with its variances.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// What is fixed, in the order of the columns of `X`.
    pub coefficients: Vec<f64>,
    /// Variances of the components, and of readings, last.
    pub variances: Vec<f64>,
    /// Logarithm of the restricted likelihood, without its constant.
    pub log_likelihood: f64,
    /// Covariance of what is fixed, by these variances.
    pub plain: Symmetric,
    /// The same with what the variances' own uncertainty adds.
    pub covariance: Symmetric,
    /// Change of the covariance with each variance that was estimated.
    slopes: Vec<Symmetric>,
    /// Covariance of these variances; none where all were stated.
    of_variances: Option<Symmetric>,
}

/// A combination of what is fixed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Combined {
    /// Its value.
    pub value: f64,
    /// Its variance.
    pub variance: f64,
    /// Degrees of freedom of that; infinite where variances were stated.
    pub freedom: f64,
}

impl Estimated {
    pub(super) fn stated(at: Likely, variances: Vec<f64>) -> Estimated {
        Estimated {
            coefficients: at.coefficients,
            variances,
            log_likelihood: at.log_likelihood,
            plain: at.covariance.clone(),
            covariance: at.covariance,
            slopes: Vec::new(),
            of_variances: None,
        }
    }

    /// With the errors of Kenward and Roger: `told` are the variances that were estimated.
    pub(super) fn found(at: At, variances: Vec<f64>, told: &[usize]) -> Estimated {
        let of_variances = at.information.part(told).inverse(1e-12);
        let plain = Matrix::from(&at.covariance);
        let fixed = at.coefficients.len();
        let mut lack = Matrix::zero(fixed, fixed);
        for (a, &r) in told.iter().enumerate() {
            for (b, &s) in told.iter().enumerate() {
                let through = at.by_one[r].times(&plain.times(&at.by_one[s]));
                let own = |row, column| {
                    of_variances.get(a, b) * (at.by_two[r][s].get(row, column) - through.get(row, column))
                };
                lack.add_all(&Matrix::from_fn(fixed, fixed, own));
            }
        }
        let added = plain.times(&lack.times(&plain)).symmetric();
        let covariance = Symmetric::from_fn(fixed, |a, b| at.covariance.get(a, b) + 2.0 * added.get(a, b));
        let slope = |&r: &usize| plain.times(&at.by_one[r].times(&plain)).symmetric();
        Estimated {
            slopes: told.iter().map(slope).collect(),
            of_variances: Some(of_variances),
            plain: at.covariance,
            covariance,
            log_likelihood: at.log_likelihood,
            coefficients: at.coefficients,
            variances,
        }
    }

    /// The combination of what is fixed by these factors.
    pub fn combined(&self, factors: &[f64]) -> Combined {
        let value = factors.iter().zip(&self.coefficients).map(|(c, b)| c * b).sum();
        let freedom = self.of_variances.as_ref().map_or(f64::INFINITY, |of| {
            let slopes: Vec<f64> = self
                .slopes
                .iter()
                .map(|slope| slope.form(factors, factors))
                .collect();
            let plain = self.plain.form(factors, factors);
            2.0 * plain * plain / of.form(&slopes, &slopes)
        });
        Combined {
            value,
            variance: self.covariance.form(factors, factors),
            freedom,
        }
    }

    /// Chance that combinations that are all 0 lie as far from it together: Fisher's F over the fewest degrees of freedom of
    /// any of them, Student's t of one. 1 where nothing is left to tell it.
    pub fn joint_chance(&self, combinations: &[Vec<f64>]) -> f64 {
        let each: Vec<Combined> = combinations.iter().map(|own| self.combined(own)).collect();
        let freedom = each.iter().map(|own| own.freedom).fold(f64::INFINITY, f64::min);
        if let [one] = each[..] {
            return two_sided_chance(one.value / one.variance.sqrt(), freedom);
        }
        let of = |a: usize, b: usize| self.covariance.form(&combinations[a], &combinations[b]);
        let values: Vec<f64> = each.iter().map(|own| own.value).collect();
        let weighed = Symmetric::from_fn(each.len(), of).solve(&values, 1e-12);
        let square: f64 = values.iter().zip(weighed).map(|(value, own)| value * own).sum();
        f_chance(square / each.len() as f64, each.len(), freedom.min(1e6) as usize)
    }
}
