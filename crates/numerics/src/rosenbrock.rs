//! Adaptive integration of stiff differential equations: the L-stable Rosenbrock method RODAS, order 4 with order 3
//! inside.
//!
//! Coefficients: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed. (1996), section IV.7.
//! No equation is iterated: a step costs one Jacobian (by differences), one elimination and six solutions, however
//! short the fastest time constant is against the step.

use thiserror::Error;

use super::sums::add;

const GAMMA: f64 = 0.25;
const NODES: [f64; 6] = [0.0, 0.386, 0.21, 0.63, 1.0, 1.0];
/// Weights of the derivative by time.
const TIME: [f64; 6] = [0.25, -0.1043, 0.1035, -0.036_200_000_000_000_23, 0.0, 0.0];
/// Weights of the earlier stages in a stage's argument.
const ARGUMENT: [[f64; 5]; 6] = [
    [0.0; 5],
    [1.544, 0.0, 0.0, 0.0, 0.0],
    [0.946_678_528_081_582_6, 0.255_701_169_898_328_4, 0.0, 0.0, 0.0],
    [
        3.314_825_187_068_521,
        2.896_124_015_972_201,
        0.998_641_913_997_781_7,
        0.0,
        0.0,
    ],
    [
        1.221_224_509_226_641,
        6.019_134_481_288_629,
        12.537_083_329_320_87,
        -0.687_886_036_105_895,
        0.0,
    ],
    [
        1.221_224_509_226_641,
        6.019_134_481_288_629,
        12.537_083_329_320_87,
        -0.687_886_036_105_895,
        1.0,
    ],
];
/// Weights of the earlier stages on the right-hand side.
const COUPLING: [[f64; 5]; 6] = [
    [0.0; 5],
    [-5.6688, 0.0, 0.0, 0.0, 0.0],
    [-2.430_093_356_833_875, -0.206_359_915_709_191_5, 0.0, 0.0, 0.0],
    [
        -0.107_352_905_815_137_5,
        -9.594_562_251_023_355,
        -20.470_286_148_096_16,
        0.0,
        0.0,
    ],
    [
        7.496_443_313_967_647,
        -10.246_804_314_643_52,
        -33.999_903_528_199_05,
        11.708_908_932_061_6,
        0.0,
    ],
    [
        8.083_246_795_921_522,
        -7.981_132_988_064_893,
        -31.521_594_328_743_71,
        16.319_305_431_231_36,
        -6.058_818_238_834_054,
    ],
];

/// Steps after which an integration is given up.
const MOST_STEPS: usize = 2_000_000;

/// Differential equations `y' = rate(t, y)`.
pub trait Equations {
    /// Writes the derivative at `t` and `y` into `out`.
    fn rate(&mut self, t: f64, y: &[f64], out: &mut [f64]);

    /// A step has ended at `t` with `y`: the place to move what has a memory, such as friction.
    fn accepted(&mut self, _t: f64, _y: &[f64]) {}
}

/// Why an integration was given up.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("the differential equations cannot be integrated beyond {at} s: {why}")]
pub struct Stuck {
    /// Time reached.
    pub at: f64,
    /// What stopped it.
    pub why: &'static str,
}

/// The method with its memory: the step to go on with, the largest magnitude of each component so far.
#[derive(Debug, Clone)]
pub struct Rosenbrock {
    relative: f64,
    absolute: f64,
    step: f64,
    scale: Vec<f64>,
    jacobian: Vec<f64>,
    by_time: Vec<f64>,
    elimination: Elimination,
    stages: [Vec<f64>; 6],
    argument: Vec<f64>,
    start_slope: Vec<f64>,
    slope: Vec<f64>,
    taken: usize,
}

impl Rosenbrock {
    /// For `n` equations, with the local error of each step below `relative` times the largest magnitude that the
    /// component has had, plus `absolute`.
    pub fn new(n: usize, relative: f64, absolute: f64) -> Rosenbrock {
        Rosenbrock {
            relative,
            absolute,
            step: 0.0,
            scale: vec![0.0; n],
            jacobian: vec![0.0; n * n],
            by_time: vec![0.0; n],
            elimination: Elimination {
                matrix: vec![0.0; n * n],
                swaps: vec![0; n],
            },
            stages: std::array::from_fn(|_| vec![0.0; n]),
            argument: vec![0.0; n],
            start_slope: vec![0.0; n],
            slope: vec![0.0; n],
            taken: 0,
        }
    }

    /// Sets the first step to try after the equations or the state have jumped.
    pub fn restart(&mut self, step: f64) {
        self.step = step;
    }

    /// Steps tried so far.
    pub fn steps(&self) -> usize {
        self.taken
    }

    /// Integrates `y` in place from `start` to `end`, which may not lie before it.
    ///
    /// # Errors
    /// The equations give numbers that are none, or the steps become too many.
    pub fn advance(
        &mut self,
        equations: &mut impl Equations,
        start: f64,
        end: f64,
        y: &mut [f64],
    ) -> Result<(), Stuck> {
        let mut t = start;
        if self.step <= 0.0 {
            self.step = 1e-3 * (end - start);
        }
        let mut have_jacobian = false;
        while t < end {
            let left = end - t;
            let h = if self.step > 0.99 * left { left } else { self.step };
            let cut_short = h < self.step;
            if !have_jacobian {
                self.differentiate(equations, t, h, y);
                have_jacobian = true;
            }
            let error = self.try_step(equations, t, h, y);
            self.taken += 1;
            let too_small = t + 0.01 * h <= t;
            if self.taken > MOST_STEPS || (too_small && !error.is_finite()) {
                let why = if error.is_finite() {
                    "the steps become too many"
                } else {
                    "the rates are no numbers"
                };
                return Err(Stuck { at: t, why });
            }
            let taken = error <= 1.0 || (too_small && error.is_finite());
            let change = if error.is_finite() {
                (0.9 * error.max(1e-12).powf(-0.25)).clamp(0.15, 6.0)
            } else {
                0.1
            };
            if taken {
                t = if h >= left { end } else { t + h };
                for (k, value) in y.iter_mut().enumerate() {
                    *value = self.argument[k];
                    self.scale[k] = self.scale[k].max(value.abs());
                }
                equations.accepted(t, y);
                have_jacobian = false;
            }
            let next = h * change;
            self.step = if taken && cut_short {
                next.max(self.step)
            } else {
                next
            };
        }
        Ok(())
    }

    /// The derivatives of the rate by state and by time, by differences.
    fn differentiate(&mut self, equations: &mut impl Equations, t: f64, h: f64, y: &mut [f64]) {
        let n = y.len();
        equations.rate(t, y, &mut self.start_slope);
        for column in 0..n {
            let kept = y[column];
            let apart = 1e-7 * kept.abs().max(self.scale[column]).max(1e-4);
            y[column] = kept + apart;
            let exactly = y[column] - kept;
            equations.rate(t, y, &mut self.argument);
            y[column] = kept;
            for row in 0..n {
                self.jacobian[row * n + column] = (self.argument[row] - self.start_slope[row]) / exactly;
            }
        }
        let later = t + 1e-4 * h;
        let exactly = later - t;
        if exactly > 0.0 {
            equations.rate(later, y, &mut self.argument);
            for row in 0..n {
                self.by_time[row] = (self.argument[row] - self.start_slope[row]) / exactly;
            }
        } else {
            self.by_time.fill(0.0);
        }
    }

    /// One step of length `h` into `self.argument`; gives its error in units of what is allowed.
    fn try_step(&mut self, equations: &mut impl Equations, t: f64, h: f64, y: &[f64]) -> f64 {
        let n = y.len();
        self.elimination.prepare(&self.jacobian, 1.0 / (GAMMA * h), n);
        for stage in 0..6 {
            let (earlier, this) = self.stages.split_at_mut(stage);
            self.argument.copy_from_slice(y);
            for (weight, k) in ARGUMENT[stage].iter().zip(earlier.iter()) {
                add(&mut self.argument, *weight, k);
            }
            let right = &mut this[0];
            if stage == 0 {
                right.copy_from_slice(&self.start_slope);
            } else {
                equations.rate(t + NODES[stage] * h, &self.argument, &mut self.slope);
                right.copy_from_slice(&self.slope);
            }
            for (weight, k) in COUPLING[stage].iter().zip(earlier.iter()) {
                add(right, weight / h, k);
            }
            add(right, h * TIME[stage], &self.by_time);
            self.elimination.solve(right);
        }
        let mut worst: f64 = 0.0;
        let mut finite = true;
        for (k, before) in y.iter().enumerate() {
            let error = self.stages[5][k];
            self.argument[k] += error;
            let size = self.scale[k].max(self.argument[k].abs()).max(before.abs());
            finite &= error.is_finite() && self.argument[k].is_finite();
            worst = worst.max(error.abs() / (self.relative * size + self.absolute));
        }
        if finite { worst } else { f64::INFINITY }
    }
}

/// A matrix eliminated with row exchanges.
#[derive(Debug, Clone)]
struct Elimination {
    matrix: Vec<f64>,
    swaps: Vec<usize>,
}

impl Elimination {
    /// Eliminates `diagonal` times the identity less `jacobian`.
    fn prepare(&mut self, jacobian: &[f64], diagonal: f64, n: usize) {
        for (to, from) in self.matrix.iter_mut().zip(jacobian) {
            *to = -from;
        }
        for k in 0..n {
            self.matrix[k * n + k] += diagonal;
        }
        for k in 0..n {
            let size = |row: &usize| self.matrix[row * n + k].abs();
            let pivot = (k..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(k);
            self.swaps[k] = pivot;
            if pivot != k {
                for column in 0..n {
                    self.matrix.swap(k * n + column, pivot * n + column);
                }
            }
            let (above, below) = self.matrix.split_at_mut((k + 1) * n);
            let row = &above[k * n..];
            for other in below.chunks_exact_mut(n) {
                if other[k] != 0.0 {
                    let factor = other[k] / row[k];
                    other[k] = factor;
                    add(&mut other[k + 1..], -factor, &row[k + 1..]);
                }
            }
        }
    }

    fn solve(&self, right: &mut [f64]) {
        let n = right.len();
        for (k, &pivot) in self.swaps.iter().enumerate() {
            right.swap(k, pivot);
        }
        for k in 0..n {
            let row = &self.matrix[k * n..k * n + k];
            let known: f64 = row.iter().zip(&right[..k]).map(|(a, b)| a * b).sum();
            right[k] -= known;
        }
        for k in (0..n).rev() {
            let row = &self.matrix[k * n..(k + 1) * n];
            let known: f64 = row[k + 1..].iter().zip(&right[k + 1..]).map(|(a, b)| a * b).sum();
            right[k] = (right[k] - known) / row[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Of<F>(F);
    impl<F: FnMut(f64, &[f64], &mut [f64])> Equations for Of<F> {
        fn rate(&mut self, t: f64, y: &[f64], out: &mut [f64]) {
            (self.0)(t, y, out);
        }
    }

    /// Robertson's reaction; reference values of Hairer and Wanner's test set at t = 40.
    #[test]
    fn a_stiff_reaction_ends_where_it_must() {
        let mut y = [1.0, 0.0, 0.0];
        let mut rates = Of(|_: f64, y: &[f64], out: &mut [f64]| {
            let (slow, fast, pair) = (0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]);
            (out[0], out[1], out[2]) = (fast - slow, slow - fast - pair, pair);
        });
        let mut method = Rosenbrock::new(3, 1e-9, 1e-16);
        method.restart(1e-6);
        method.advance(&mut rates, 0.0, 40.0, &mut y).unwrap();
        let known = [0.715_827_068_7, 9.185_534_764e-6, 0.284_163_745_7];
        for (found, known) in y.iter().zip(known) {
            assert!((found / known - 1.0).abs() < 1e-7, "{found} {known}");
        }
        assert!(method.steps() < 2500, "{}", method.steps());
    }

    /// Steps of fixed length h leave an error that falls as h^4 or faster, also where time enters the rate.
    #[test]
    fn the_order_is_four_at_least() {
        let miss = |steps: usize| {
            let mut method = Rosenbrock::new(2, 1e300, 1e300);
            let mut rates = Of(|t: f64, y: &[f64], out: &mut [f64]| {
                out[0] = -2.0 * y[0] * y[0] * t + y[1];
                out[1] = -y[1] + t.cos() * y[0];
            });
            let mut y = [1.0, 0.5];
            for k in 0..steps {
                let h = 2.0 / steps as f64;
                method.restart(h);
                method
                    .advance(&mut rates, h * k as f64, h * (k + 1) as f64, &mut y)
                    .unwrap();
            }
            y
        };
        let (exact, coarse, fine) = (miss(2000), miss(20), miss(40));
        for k in 0..2 {
            let ratio = (coarse[k] - exact[k]) / (fine[k] - exact[k]);
            assert!(ratio > 14.0, "{ratio}");
        }
    }

    #[test]
    fn a_fast_branch_under_a_long_hold_costs_few_steps() {
        let mut rates = Of(|_: f64, y: &[f64], out: &mut [f64]| {
            out[0] = (1.0 - y[0]) / 0.005;
            out[1] = (1.0 - y[1]) / 60.0;
        });
        let mut y = [0.0, 0.0];
        let mut method = Rosenbrock::new(2, 1e-9, 1e-16);
        method.restart(1e-6);
        method.advance(&mut rates, 0.0, 600.0, &mut y).unwrap();
        assert!((y[0] - 1.0).abs() < 1e-9);
        assert!((y[1] - (1.0 - (-10.0_f64).exp())).abs() < 1e-8);
        assert!(method.steps() < 1500, "{}", method.steps());
    }

    #[test]
    fn rates_that_are_no_numbers_are_told() {
        let mut rates = Of(|t: f64, _: &[f64], out: &mut [f64]| {
            out[0] = if t < 1.0 { 1.0 } else { f64::NAN };
        });
        let stuck = Rosenbrock::new(1, 1e-8, 1e-12).advance(&mut rates, 0.0, 2.0, &mut [0.0]);
        let stuck = stuck.unwrap_err();
        assert!((0.9..=1.0).contains(&stuck.at), "{stuck:?}");
    }
}
