//! A parameter brought from one humidity, temperature or age to another, by the model that laws are told from: linear in its
//! logarithm, with a bend where it was measured at four places, with two from five on.

use ieap_numerics::symmetric::Symmetric;

use super::evidence::{Evidence, measure};
use super::laws::{of_humidity, over_conditions, over_humidity, stating};
use super::placed::Placed;
use super::policy::{MOST_POWERS, MOST_STRIPS};
use super::slope::{Followed, Over};
use crate::conditions::conditions_of_materials;
use crate::laws::Covariate;
use crate::laws::facts::facts;
use crate::laws::values::keys;

/// How a parameter of a material goes with what it follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Stored key of the parameter.
    pub parameter: String,
    /// What else changed with it, so that the course may be of that.
    pub tied: Vec<Covariate>,
    middle: f64,
    half: f64,
    /// Of the distance from the middle, in halves of the range, of its square, and of its cube.
    coefficients: Vec<f64>,
    /// Their errors in directions that do not depend on each other, each one standard error.
    errors: Vec<Vec<f64>>,
}

impl Course {
    /// The factor from one place to another.
    pub fn factor(&self, from: f64, to: f64) -> f64 {
        self.factor_with(&self.coefficients, from, to)
    }

    /// In how many directions its coefficients may be off.
    pub fn directions(&self) -> usize {
        self.errors.len()
    }

    /// The same, each with the coefficients off by one standard error in one direction: what they differ by adds in squares.
    pub fn factors_one_error_off(&self, from: f64, to: f64) -> Vec<f64> {
        let off = |error: &Vec<f64>| {
            let own: Vec<f64> = self.coefficients.iter().zip(error).map(|(a, b)| a + b).collect();
            self.factor_with(&own, from, to)
        };
        self.errors.iter().map(off).collect()
    }

    fn factor_with(&self, coefficients: &[f64], from: f64, to: f64) -> f64 {
        let at = |x: f64| {
            let u = (x - self.middle) / self.half;
            let terms = coefficients.iter().zip(1..);
            terms.map(|(own, power)| own * u.powi(power)).sum::<f64>()
        };
        (at(to) - at(from)).exp()
    }

    fn of(parameter: &str, over: &Over) -> Option<Course> {
        // Through as many places as a curve has coefficients, its level counted, goes any: one place more tells of it.
        let powers = over.places().saturating_sub(2).clamp(1, MOST_POWERS);
        let column = |power: usize| over.columns.x.iter().map(|x| x.powi(power as i32)).collect();
        let columns: Vec<Vec<f64>> = (1..=powers).map(column).collect();
        let count = columns.len();
        let (told, at) = if over.columns.samples <= MOST_STRIPS {
            over.columns.with_levels(columns)?
        } else {
            over.columns.by_chance(columns)?
        };
        let of = told.of.estimated().filter(|_| at.len() == count)?;
        let keep: Vec<usize> = at.clone().collect();
        Some(Course {
            parameter: parameter.to_owned(),
            tied: over.tied.clone(),
            middle: over.mean,
            half: over.half,
            coefficients: of.coefficients[at].to_vec(),
            errors: directions(&of.covariance.part(&keep)),
        })
    }
}

/// Columns whose products add up to a covariance.
fn directions(covariance: &Symmetric) -> Vec<Vec<f64>> {
    let (values, vectors) = covariance.eigen();
    let direction = |(at, value): (usize, &f64)| {
        let size = value.max(0.0).sqrt();
        vectors.iter().map(|row| size * row[at]).collect()
    };
    values.iter().enumerate().map(direction).collect()
}

/// How every parameter of a material goes with the humidity, the temperature or the age, where the runs tell.
pub fn courses(evidence: &Evidence, material: &str, of: Covariate) -> Vec<Course> {
    let conditions = conditions_of_materials(evidence.runs, evidence.campaign);
    let facts = facts(evidence.runs, evidence.campaign);
    let Some(at) = conditions.materials.iter().position(|own| own == material) else {
        return Vec::new();
    };
    let placed = Placed::new(&conditions, &facts, at);
    let places: Vec<usize> = placed.cells.keys().copied().collect();
    let course = |key: &String| {
        let measured = measure(evidence, &placed, key)?.ok()?;
        if of == Covariate::RelativeHumidity {
            let values = of_humidity(&measured, &conditions)?;
            return Course::of(key, &over_humidity(&values, &conditions, &facts)?);
        }
        let (values, numbers) = stating(&measured, &facts, of);
        Course::of(key, &over_conditions(&values, &Followed { of, numbers }, &facts)?)
    };
    keys(evidence.runs, &facts, &places)
        .iter()
        .filter_map(course)
        .collect()
}
