//! A course read at any time from noisy readings, without a model of it.
//!
//! What an actuator does after a step it does over decades of time: parabolas over the logarithm of the time since the step
//! follow it in windows of many readings. At each place the window is as wide as what it says agrees, within the noise, with
//! what every narrower one says (Lepski, Theory of Probability and its Applications 35, 454, 1990).

use crate::correlation::lag_one;
use crate::noise::LocalScatter;
use crate::symmetric::Symmetric;

/// Fewest readings of a window.
const FEWEST: usize = 8;
/// Most readings that are looked at one by one.
const MOST: usize = 4000;
/// Narrowest and widest half width of a window, in the logarithm of the time.
const HALF_WIDTHS: (f64, f64) = (0.02, 1.0);
/// Factor from one width to the next.
const WIDER: f64 = 1.4;
/// Standard errors by which a wider window may differ from a narrower one, so that what it gets wrong stays below its error.
const AGREE: f64 = 1.0;
/// Most of a reading's noise that the next one is taken to share.
pub const MOST_GOES_ON: f64 = 0.98;
/// Noise that no instrument is below, as a share of the range.
const LEAST_NOISE: f64 = 1e-6;

/// Readings of one level of the drive.
pub struct Course {
    /// Logarithm of the time since the step.
    u: Vec<f64>,
    y: Vec<f64>,
    /// Readings that each of these is the mean of.
    weight: Vec<f64>,
    noise: f64,
    /// Lag-1 autocorrelation of the noise.
    goes_on: f64,
}

/// The course at a place: a parabola `level + slope (u - u0) + ...`.
#[derive(Debug, Clone, Copy)]
pub struct Local {
    /// Level, in the unit of the readings.
    pub level: f64,
    /// Slope by the logarithm of the time, in the same unit.
    pub slope: f64,
    covariance: [[f64; 3]; 3],
}

impl Local {
    /// Standard error of the level.
    pub fn error(&self) -> f64 {
        self.covariance[0][0].max(0.0).sqrt()
    }
}

impl Course {
    /// Of readings after `step_s` with their noise. None of too few.
    pub fn of(time_s: &[f64], values: &[f64], step_s: f64, noise: &LocalScatter) -> Option<Course> {
        let after = time_s.iter().zip(values).filter(|(t, _)| **t > step_s);
        let (u, y): (Vec<f64>, Vec<f64>) = after.map(|(t, y)| ((t - step_s).ln(), *y)).unzip();
        let (low, high) = ieap_domain::range_of(y.iter().copied());
        let least = (LEAST_NOISE * (high - low)).max(f64::MIN_POSITIVE);
        let goes_on = noise.correlation.clamp(0.0, MOST_GOES_ON);
        let course = Course {
            weight: vec![1.0; u.len()],
            u,
            y,
            noise: noise.standard_deviation.max(least),
            goes_on,
        };
        match course.u.len() {
            n if n < FEWEST => None,
            n if n > MOST => Some(course.averaged()),
            _ => Some(course),
        }
    }

    /// Readings that stand close together in the logarithm of the time as their mean; what neighbours share of their noise
    /// does not average down, and is in the noise then.
    fn averaged(self) -> Course {
        let width = (self.u[self.u.len() - 1] - self.u[0]) / MOST as f64;
        let mut found = Course {
            u: Vec::new(),
            y: Vec::new(),
            weight: Vec::new(),
            noise: self.noise * ((1.0 + self.goes_on) / (1.0 - self.goes_on)).sqrt(),
            goes_on: 0.0,
        };
        let mut from = 0;
        while from < self.u.len() {
            let to = self
                .u
                .partition_point(|u| *u < self.u[from] + width)
                .max(from + 1);
            let count = (to - from) as f64;
            found.u.push(self.u[from..to].iter().sum::<f64>() / count);
            found.y.push(self.y[from..to].iter().sum::<f64>() / count);
            found.weight.push(count);
            from = to;
        }
        found
    }

    /// First and last place.
    pub fn ends(&self) -> (f64, f64) {
        (self.u[0], self.u[self.u.len() - 1])
    }

    /// The course at a place.
    pub fn at(&self, u0: f64) -> Local {
        let level = |local: &Local| (local.level, local.error());
        let best = self.in_widest_window(u0, &level);
        best.or_else(|| self.parabola(u0, 0, self.u.len()))
            .unwrap_or(Local {
                level: self.y[self.nearest(u0)],
                slope: 0.0,
                covariance: [[self.noise * self.noise, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            })
    }

    /// The slope of the course at a place and its standard error.
    pub fn slope_at(&self, u0: f64) -> (f64, f64) {
        let slope = |local: &Local| (local.slope, local.covariance[1][1].max(0.0).sqrt());
        let best = self.in_widest_window(u0, &slope);
        best.as_ref().map_or((0.0, f64::INFINITY), slope)
    }

    /// The parabola in a window that is a step narrower than the widest one in which a number of it, with its error, agrees
    /// with that of every narrower window: what a window gets wrong then stays well below its error.
    fn in_widest_window(&self, u0: f64, of: &dyn Fn(&Local) -> (f64, f64)) -> Option<Local> {
        let mut agreed: Vec<(Local, f64, f64)> = Vec::new();
        let (mut readings, mut half) = (0, HALF_WIDTHS.0);
        while half <= HALF_WIDTHS.1 {
            let (from, to) = self.window(u0, half);
            half *= WIDER;
            if to - from <= readings {
                continue;
            }
            readings = to - from;
            let Some(local) = self.parabola(u0, from, to) else {
                continue;
            };
            let (value, error) = of(&local);
            let next = (local, value, error);
            let off = |(_, value, error): &(Local, f64, f64)| {
                (next.1 - value).abs() > AGREE * (error * error - next.2 * next.2).max(0.0).sqrt()
            };
            if agreed.iter().any(off) {
                break;
            }
            agreed.push(next);
        }
        let narrower = agreed.len().saturating_sub(2);
        agreed.get(narrower).map(|(local, ..)| *local)
    }

    fn nearest(&self, u0: f64) -> usize {
        self.u.partition_point(|u| *u < u0).min(self.u.len() - 1)
    }

    /// Readings within a half width of a place, at least [`FEWEST`] of them.
    fn window(&self, u0: f64, half: f64) -> (usize, usize) {
        let mut from = self.u.partition_point(|u| *u < u0 - half);
        let mut to = self.u.partition_point(|u| *u <= u0 + half);
        while to - from < FEWEST {
            let below = from.checked_sub(1).map(|k| u0 - self.u[k]);
            let above = self.u.get(to).map(|u| u - u0);
            match (below, above) {
                (Some(below), Some(above)) if below <= above => from -= 1,
                (Some(_), None) => from -= 1,
                (_, Some(_)) => to += 1,
                (None, None) => break,
            }
        }
        (from, to)
    }

    /// Least squares of a parabola; its errors allow for residuals that go on from one reading to the next.
    fn parabola(&self, u0: f64, from: usize, to: usize) -> Option<Local> {
        let (u, y, weight) = (&self.u[from..to], &self.y[from..to], &self.weight[from..to]);
        let reach = u.iter().fold(0.0f64, |reach, u| reach.max((u - u0).abs()));
        if u.len() < FEWEST || reach <= 0.0 {
            return None;
        }
        let row = |u: f64| {
            let x = (u - u0) / reach;
            [1.0, x, x * x]
        };
        // The normal equations of a parabola hold sums of five powers only.
        let (mut powers, mut right) = ([0.0; 5], [0.0; 3]);
        for ((u, y), weight) in u.iter().zip(y).zip(weight) {
            let [_, x, square] = row(*u);
            let powered = [1.0, x, square, square * x, square * square];
            for (sum, power) in powers.iter_mut().zip(powered) {
                *sum += weight * power;
            }
            for (sum, power) in right.iter_mut().zip(powered) {
                *sum += weight * power * y;
            }
        }
        let normal = Symmetric::from_fn(3, |a, b| powers[a + b]);
        let found = normal.solve(&right, 1e-12);
        let inverse = normal.inverse(1e-12);
        let left: Vec<f64> = u
            .iter()
            .zip(y)
            .map(|(u, y)| y - row(*u).iter().zip(&found).map(|(x, b)| x * b).sum::<f64>())
            .collect();
        let goes_on = lag_one(&left).clamp(self.goes_on, MOST_GOES_ON);
        let variance = self.noise * self.noise * (1.0 + goes_on) / (1.0 - goes_on);
        let scale = [1.0, reach, reach * reach];
        let mut covariance = [[0.0; 3]; 3];
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = variance * inverse.get(i, j) / (scale[i] * scale[j]);
            }
        }
        Some(Local {
            level: found[0],
            slope: found[1] / scale[1],
            covariance,
        })
    }
}
