//! Curves of textbooks over the variable of a law, as weights of its bells: a law that has no name is simple all the same.

use std::sync::LazyLock;

use ieap_numerics::least_squares::Local;

use super::axis::{Axis, Curve, WEIGHTS};

/// A kind of curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A power: linear, by the root, by the square.
    Power,
    /// It ends at a value.
    Saturating,
    /// It begins at a value.
    Threshold,
    /// It grows by the same factor in the same distance.
    Exponential,
    /// It is somewhere alone.
    Bell,
}

/// A kind of curve, and whether it is the same at both signs of its variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Textbook {
    /// The kind.
    pub shape: Shape,
    /// Whether it follows the size of the variable, whatever its sign.
    pub even: bool,
}

impl Shape {
    /// By the size of its variable.
    pub const fn even(self) -> Textbook {
        Textbook {
            shape: self,
            even: true,
        }
    }

    /// By its variable with its sign.
    pub const fn odd(self) -> Textbook {
        Textbook {
            shape: self,
            even: false,
        }
    }
}

/// Powers that are thought of.
const POWERS: [f64; 4] = [0.6, 1.0, 1.7, 2.5];
/// Places on the variable, in parts of its end, and widths of what is somewhere.
const PLACES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const WIDTHS: [f64; 2] = [0.15, 0.3];
/// Distances in which a curve saturates or grows by e, in parts of the end of the variable.
const LENGTHS: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Places at which weights are found, and what keeps the weights of bells that look alike small.
const POINTS: usize = 61;
const RIDGE: f64 = 1e-8;

/// Weights of every curve over a variable of either sign, and of none below zero.
static OF_SIGNED: LazyLock<Vec<(Textbook, Vec<f64>)>> = LazyLock::new(|| every(-1.0));
static OF_SIZE: LazyLock<Vec<(Textbook, Vec<f64>)>> = LazyLock::new(|| every(0.0));

/// Weights of all curves but these, each of size one, over a variable that has a sign or none; none of a spectrum.
pub(super) fn simple(axis: Axis, is_signed: bool, without: &[Textbook]) -> Vec<&'static [f64]> {
    if axis == Axis::Elements {
        return Vec::new();
    }
    let all = if is_signed { &OF_SIGNED } else { &OF_SIZE };
    let others = all.iter().filter(|(curve, _)| !without.contains(curve));
    others.map(|(_, weights)| weights.as_slice()).collect()
}

fn every(low: f64) -> Vec<(Textbook, Vec<f64>)> {
    let of_size = curves().into_iter().map(|(shape, curve)| {
        let weights = weights(low, &|x| curve(x.abs()));
        (shape.even(), weights)
    });
    if low == 0.0 {
        return of_size.collect();
    }
    let signed = curves().into_iter().flat_map(|(shape, curve)| match shape {
        Shape::Power | Shape::Saturating => {
            vec![(shape.odd(), weights(low, &|x| x.signum() * curve(x.abs())))]
        }
        Shape::Threshold | Shape::Bell => [1.0, -1.0]
            .map(|sign| (shape.odd(), weights(low, &|x| curve(sign * x))))
            .to_vec(),
        Shape::Exponential => vec![(shape.odd(), weights(low, &curve))],
    });
    of_size.chain(signed).collect()
}

/// A curve from 0 on.
type Curved = (Shape, Box<dyn Fn(f64) -> f64>);

/// Every curve over a variable from 0 to 1; of one without a beginning or an end below 0 as well.
fn curves() -> Vec<Curved> {
    let mut all: Vec<Curved> = Vec::new();
    for power in POWERS {
        all.push((Shape::Power, Box::new(move |x| x.powf(power))));
    }
    for length in LENGTHS {
        all.push((Shape::Saturating, Box::new(move |x| (x / length).tanh())));
        for sign in [1.0, -1.0] {
            all.push((
                Shape::Exponential,
                Box::new(move |x| (sign * x / length).exp_m1()),
            ));
        }
    }
    for place in PLACES {
        all.push((Shape::Threshold, Box::new(move |x| (x - place).max(0.0))));
        for width in WIDTHS {
            all.push((
                Shape::Bell,
                Box::new(move |x| (-0.5 * ((x - place) / width).powi(2)).exp()),
            ));
        }
    }
    all
}

/// Weights with which bells and line come nearest to a curve from `low` to 1.
fn weights(low: f64, curve: &dyn Fn(f64) -> f64) -> Vec<f64> {
    let place = |k: usize| low + (1.0 - low) * k as f64 / (POINTS - 1) as f64;
    let one = |k: usize| Curve {
        weights: (0..WEIGHTS).map(|j| f64::from(u8::from(j == k))).collect(),
        axis: Axis::Time,
        ends: (low, 1.0),
        time_s: 0.0,
        course: None,
    };
    let bells: Vec<Vec<f64>> = (0..WEIGHTS)
        .map(|k| (0..POINTS).map(|p| one(k).at(place(p))).collect())
        .collect();
    let values: Vec<f64> = (0..POINTS).map(|p| curve(place(p))).collect();
    let mut told = Local::of(&values, &bells);
    (0..WEIGHTS).for_each(|k| told.normal.add(k, k, RIDGE));
    told.normal.solve(&told.descent, 1e-14)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bells follow every curve over most of the variable; only the kink of a threshold is rounded.
    #[test]
    fn bells_follow_the_curves() {
        for low in [0.0, -1.0] {
            let curve = |weights: &[f64]| Curve {
                weights: weights.to_vec(),
                axis: Axis::Time,
                ends: (low, 1.0),
                time_s: 0.0,
                course: None,
            };
            for (weights, expected) in [
                (weights(low, &|x| x), 0.7),
                (weights(low, &|x| x * x), 0.49),
                (weights(low, &|x| (2.0 * x).exp_m1()), 1.4_f64.exp_m1()),
            ] {
                let found = curve(&weights).at(0.7);
                assert!(
                    (found / expected - 1.0).abs() < 0.01,
                    "{low}: {found} for {expected}"
                );
            }
        }
        assert!(simple(Axis::Elements, false, &[]).is_empty());
        let thresholds = simple(Axis::Time, false, &[]).len()
            - simple(Axis::Time, false, &[Shape::Threshold.even()]).len();
        assert_eq!(thresholds, PLACES.len());
    }
}
