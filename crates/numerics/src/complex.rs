//! Complex numbers, as far as impedances need them.

use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// Zero.
    pub const ZERO: Complex = Complex::new(0.0, 0.0);
    /// One.
    pub const ONE: Complex = Complex::new(1.0, 0.0);

    /// The number `re + j im`.
    pub const fn new(re: f64, im: f64) -> Complex {
        Complex { re, im }
    }

    /// Distance from zero.
    pub fn magnitude(self) -> f64 {
        self.re.hypot(self.im)
    }

    /// One over it; infinite for zero.
    pub fn reciprocal(self) -> Complex {
        if self == Complex::ZERO {
            return Complex::new(f64::INFINITY, 0.0);
        }
        Complex::ONE / self
    }

    /// Principal power with a real exponent of `j x`, for `x` not below 0.
    pub fn power_of_imaginary(x: f64, exponent: f64) -> Complex {
        let (sin, cos) = (exponent * std::f64::consts::FRAC_PI_2).sin_cos();
        let size = x.powf(exponent);
        Complex::new(size * cos, size * sin)
    }

    /// Hyperbolic tangent; 1 with the sign of the real part where that is large.
    pub fn tanh(self) -> Complex {
        /// Beyond it the tangent is 1 to the last digit.
        const SATURATED: f64 = 20.0;
        if self.re.abs() > SATURATED {
            return Complex::new(self.re.signum(), 0.0);
        }
        let below = (2.0 * self.re).cosh() + (2.0 * self.im).cos();
        Complex::new((2.0 * self.re).sinh() / below, (2.0 * self.im).sin() / below)
    }
}

impl Add for Complex {
    type Output = Complex;

    fn add(self, other: Complex) -> Complex {
        Complex::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Complex;

    fn sub(self, other: Complex) -> Complex {
        Complex::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Complex;

    fn mul(self, other: Complex) -> Complex {
        Complex::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }
}

impl Mul<f64> for Complex {
    type Output = Complex;

    fn mul(self, factor: f64) -> Complex {
        Complex::new(self.re * factor, self.im * factor)
    }
}

impl Div for Complex {
    type Output = Complex;

    /// Scaled by the larger part of the divisor, so that squares neither overflow nor vanish (Smith 1962).
    fn div(self, by: Complex) -> Complex {
        if by.re.abs() >= by.im.abs() {
            let ratio = by.im / by.re;
            let below = by.re + by.im * ratio;
            return Complex::new(
                (self.re + self.im * ratio) / below,
                (self.im - self.re * ratio) / below,
            );
        }
        let ratio = by.re / by.im;
        let below = by.re * ratio + by.im;
        Complex::new(
            (self.re * ratio + self.im) / below,
            (self.im * ratio - self.re) / below,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Complex, b: Complex) -> bool {
        (a - b).magnitude() < 1e-12 * b.magnitude().max(1.0)
    }

    #[test]
    fn division_undoes_multiplication_also_far_from_one() {
        for (a, b) in [((1.0, -2.0), (3.0, 0.5)), ((1e200, 1.0), (1e-3, 1e200))] {
            let (a, b) = (Complex::new(a.0, a.1), Complex::new(b.0, b.1));
            let quotient = a / b;
            assert!(close(quotient * b, a) || (quotient * b - a).magnitude() < 1e-12 * a.magnitude());
        }
        assert_eq!(Complex::ZERO.reciprocal().re, f64::INFINITY);
        assert_eq!(Complex::ZERO.reciprocal().reciprocal(), Complex::ZERO);
        assert!(close(
            Complex::new(0.0, 2.0).reciprocal(),
            Complex::new(0.0, -0.5)
        ));
    }

    #[test]
    fn powers_of_j_and_the_tangent() {
        let root = Complex::power_of_imaginary(4.0, 0.5);
        assert!(close(root * root, Complex::new(0.0, 4.0)));
        // tanh(z) = z - z^3/3 + 2 z^5/15 - 17 z^7/315 near zero.
        let z = Complex::new(0.01, -0.02);
        let cube = z * z * z;
        let fifth = cube * z * z;
        let series = z - cube * (1.0 / 3.0) + fifth * (2.0 / 15.0) - fifth * z * z * (17.0 / 315.0);
        assert!((z.tanh() - series).magnitude() < 1e-15);
        assert!(close(
            Complex::new(0.0, 0.7).tanh(),
            Complex::new(0.0, 0.7_f64.tan())
        ));
        assert_eq!(Complex::new(400.0, 3.0).tanh(), Complex::ONE);
    }
}
