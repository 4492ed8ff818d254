//! A mixture of normal laws: what is told of a number whose error is itself uncertain.

use std::f64::consts::{PI, SQRT_2};

use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;

/// Laws whose errors differ by less than this, as a logarithm, are put together: they are one to a part in a thousand.
const ALIKE: f64 = 0.15;
/// Steps towards a quantile at most: eight are usual.
const STEPS: usize = 60;

/// A normal law with its part in a mixture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    weight: f64,
    mean: f64,
    error: f64,
}

/// A mixture of normal laws.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    parts: Vec<Part>,
}

impl Mixture {
    /// One law.
    pub fn normal(mean: f64, error: f64) -> Mixture {
        Mixture::of([(1.0, mean, error)])
    }

    /// Of weights, which add up to one or are brought to it, means and errors.
    pub fn of(laws: impl IntoIterator<Item = (f64, f64, f64)>) -> Mixture {
        let part = |(weight, mean, error): (f64, f64, f64)| Part { weight, mean, error };
        Mixture {
            parts: laws.into_iter().map(part).collect(),
        }
        .put_together()
    }

    /// What a number follows of which readings tell nothing but their scatter, `square` with so many of them left over, where
    /// a scatter of one gives the number an error of `each`: Student's law as a mixture.
    pub fn of_scatter(mean: f64, each: f64, (variance, left): (f64, f64)) -> Mixture {
        // The density 1 over the scatter, times its likelihood, over steps of its logarithm.
        let step = (1.0 / (2.0 * left).sqrt()).min(0.5);
        let place = |k: i32| {
            let log = step * f64::from(k);
            let weight = (-left * log - 0.5 * left * (-2.0 * log).exp_m1()).exp();
            (weight, mean, each * variance.sqrt() * log.exp())
        };
        let is_part = |law: &(f64, f64, f64)| law.0 > 1e-7;
        let below = (1..200).map(|k| place(-k)).take_while(is_part);
        Mixture::of((0..400).map(place).take_while(is_part).chain(below))
    }

    /// Laws of equal error as one, and weights that add up to one.
    fn put_together(mut self) -> Mixture {
        self.parts.sort_by(|a, b| a.error.total_cmp(&b.error));
        let all: f64 = self.parts.iter().map(|part| part.weight).sum();
        let mut kept: Vec<Part> = Vec::new();
        let mut from = f64::NEG_INFINITY;
        for part in self.parts {
            let part = Part {
                weight: part.weight / all,
                ..part
            };
            match kept.last_mut() {
                Some(last) if part.error <= from * ALIKE.exp() => last.take_in(&part),
                _ => {
                    from = part.error;
                    kept.push(part);
                }
            }
        }
        Mixture { parts: kept }
    }

    /// Its mean.
    pub fn mean(&self) -> f64 {
        self.parts.iter().map(|part| part.weight * part.mean).sum()
    }

    /// Its standard deviation.
    pub fn error(&self) -> f64 {
        let mean = self.mean();
        let square = |part: &Part| part.weight * (part.error.powi(2) + (part.mean - mean).powi(2));
        self.parts.iter().map(square).sum::<f64>().sqrt()
    }

    /// The error that half of it is below.
    pub fn middle_error(&self) -> f64 {
        let mut below = 0.0;
        let reaches = |part: &&Part| {
            below += part.weight;
            below >= 0.5
        };
        self.parts.iter().find(reaches).map_or(0.0, |part| part.error)
    }

    /// So many times as large.
    #[must_use]
    pub fn times(&self, factor: f64) -> Mixture {
        let part = |part: &Part| Part {
            mean: factor * part.mean,
            error: factor.abs() * part.error,
            ..*part
        };
        Mixture {
            parts: self.parts.iter().map(part).collect(),
        }
    }

    /// The sum with what does not depend on it.
    #[must_use]
    pub fn plus(&self, other: &Mixture) -> Mixture {
        let sum = |a: &Part| {
            let a = *a;
            other.parts.iter().map(move |b| {
                let error = a.error.hypot(b.error);
                (a.weight * b.weight, a.mean + b.mean, error)
            })
        };
        Mixture::of(self.parts.iter().flat_map(sum))
    }

    /// The part of it below a number.
    pub fn below(&self, x: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.below(x)).sum()
    }

    /// Its density at a number.
    pub fn density(&self, x: f64) -> f64 {
        let at = |part: &Part| {
            let error = part.error.max(f64::MIN_POSITIVE);
            let off = (x - part.mean) / error;
            part.weight * (-0.5 * off * off).exp() / (error * (2.0 * PI).sqrt())
        };
        self.parts.iter().map(at).sum()
    }

    /// Twice the part of it on the side of 0 where less of it lies: the chance of a number as far from none.
    pub fn chance_of_none(&self) -> f64 {
        let above = self.times(-1.0).below(0.0);
        (2.0 * self.below(0.0).min(above)).min(1.0)
    }

    /// What it stays below with chance `p`.
    pub fn quantile(&self, p: f64) -> f64 {
        let Ok(normal) = Normal::new(0.0, 1.0) else {
            return f64::NAN;
        };
        let far = normal.inverse_cdf(p);
        let of_parts = || self.parts.iter().map(|part| part.mean + far * part.error);
        let mut low = of_parts().fold(f64::INFINITY, f64::min);
        let mut high = of_parts().fold(f64::NEG_INFINITY, f64::max);
        let tail = |x: f64| {
            if p > 0.5 {
                1.0 - p - self.times(-1.0).below(-x)
            } else {
                self.below(x) - p
            }
        };
        // Newton's steps, the range halved where one leaves it.
        let mut x = 0.5 * (low + high);
        for _ in 0..STEPS {
            let off = tail(x);
            if off < 0.0 {
                low = x;
            } else {
                high = x;
            }
            let step = off / self.density(x);
            let next = x - step;
            if step.abs() <= 1e-10 * (high - low) || high - low <= 1e-12 * (low.abs() + high.abs()) {
                break;
            }
            x = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
        }
        x
    }

    /// Its 95 % interval.
    pub fn ends_95(&self) -> (f64, f64) {
        (self.quantile(0.025), self.quantile(0.975))
    }

    /// What its size stays below with a chance of 95 %, on the side where more of it lies.
    pub fn most_95(&self) -> f64 {
        self.quantile(0.95).max(-self.quantile(0.05))
    }
}

impl Part {
    fn below(&self, x: f64) -> f64 {
        if self.error > 0.0 {
            0.5 * erfc((self.mean - x) / (self.error * SQRT_2))
        } else {
            f64::from(u8::from(x >= self.mean))
        }
    }

    /// The law of both, by their means and variances.
    fn take_in(&mut self, other: &Part) {
        let weight = self.weight + other.weight;
        let (a, b) = (self.weight / weight, other.weight / weight);
        let mean = a * self.mean + b * other.mean;
        let square = |of: &Part| of.error.powi(2) + (of.mean - mean).powi(2);
        let error = (a * square(self) + b * square(other)).sqrt();
        *self = Part { weight, mean, error };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::student::{quantile_95, two_sided_chance};

    #[test]
    fn a_scatter_that_few_readings_tell_gives_students_law() {
        for left in [1.0, 2.0, 5.0, 30.0, 400.0] {
            let own = Mixture::of_scatter(0.0, 1.0, (4.0, left));
            let (low, high) = own.ends_95();
            let expected = 2.0 * quantile_95(left);
            assert!(
                (high / expected - 1.0).abs() < 0.01 && (low + high).abs() < 1e-6 * high,
                "{left}: {high} {expected}"
            );
            let moved = Mixture::of_scatter(5.0, 1.0, (4.0, left)).chance_of_none();
            assert!(
                (moved / two_sided_chance(2.5, left) - 1.0).abs() < 0.03,
                "{left}: {moved}"
            );
        }
    }

    #[test]
    fn sums_and_quantiles_are_those_of_the_laws() {
        let own = Mixture::normal(1.0, 3.0).plus(&Mixture::normal(2.0, 4.0));
        assert!((own.mean() - 3.0).abs() < 1e-12 && (own.error() - 5.0).abs() < 1e-12);
        let (low, high) = own.ends_95();
        assert!((low - 3.0 + 5.0 * 1.959964).abs() < 1e-4 && (high - 3.0 - 5.0 * 1.959964).abs() < 1e-4);
        assert!((own.most_95() - 3.0 - 5.0 * 1.644854).abs() < 1e-4);
        let both = Mixture::of([(1.0, 0.0, 1.0), (1.0, 0.0, 10.0)]);
        assert!((both.below(1.0) - 0.5 * (0.841345 + 0.539828)).abs() < 1e-5);
        assert!((both.below(both.quantile(0.975)) - 0.975).abs() < 1e-9);
        assert!((Mixture::normal(0.0, 2.0).density(0.0) - 0.19947).abs() < 1e-4);
    }
}
