//! Curvature along the strip as a cubic spline on equal intervals.

/// Intervals of the spline, whatever the length: the finest that is asked for is a twentieth of the strip.
pub const INTERVALS: usize = 20;
/// Coefficients of a cubic spline on that many intervals.
pub const COEFFICIENTS: usize = INTERVALS + 3;

/// Curvature as a function of the arc length from 0 to `length`.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// Length on which it is defined, pixels; beyond, it keeps its last value.
    pub length: f64,
    /// Coefficients of the basis, 1/pixel.
    pub coefficients: Vec<f64>,
}

impl Spline {
    /// A straight line.
    pub fn straight(length: f64) -> Spline {
        Spline {
            length,
            coefficients: vec![0.0; COEFFICIENTS],
        }
    }

    /// First coefficient that matters at `s`, and the weights of it and the three after it.
    pub fn weights(&self, s: f64) -> (usize, [f64; 4]) {
        let u = (s / self.length * INTERVALS as f64).clamp(0.0, INTERVALS as f64);
        let first = (u as usize).min(INTERVALS - 1);
        let t = u - first as f64;
        let (t2, t3) = (t * t, t * t * t);
        let weights = [
            (1.0 - t).powi(3) / 6.0,
            (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
            (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
            t3 / 6.0,
        ];
        (first, weights)
    }

    /// Value at `s`; beyond the ends, that of the end.
    pub fn at(&self, s: f64) -> f64 {
        let (first, weights) = self.weights(s);
        weights
            .iter()
            .zip(&self.coefficients[first..])
            .map(|(w, c)| w * c)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_a_constant_stays_one() {
        let mut spline = Spline::straight(37.0);
        spline.coefficients.fill(0.25);
        for k in 0..=100 {
            let s = 0.37 * f64::from(k);
            assert!((spline.weights(s).1.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((spline.at(s) - 0.25).abs() < 1e-12);
        }
    }

    #[test]
    fn a_straight_course_is_kept() {
        let mut spline = Spline::straight(20.0);
        for (k, c) in spline.coefficients.iter_mut().enumerate() {
            *c = k as f64 - 1.0;
        }
        for s in [0.0, 3.3, 10.0, 19.9, 20.0] {
            assert!((spline.at(s) - s).abs() < 1e-12, "{s}");
        }
    }
}
