//! One damped step in a box, and how the damping learns from what became of it.

use super::{Bounds, Local};
use crate::sums::peak;
use crate::symmetric::Symmetric;

/// How steps are kept short where the local model does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// By a region of trust: for sums of squares that are searched to their last digits.
    Region {
        /// Longest first step, in parts of the start's distance from zero; infinite where the first step is trusted.
        first_radius: f64,
    },
    /// By a part of the diagonal of J'J, ten times more or less after a bad or a good step: for many coordinates, some of
    /// which the readings may not tell.
    Diagonal,
}

impl Damping {
    /// The damping of the first step.
    pub(super) fn begin(self, at: &[f64], local: &Local) -> Damped {
        match self {
            Damping::Region { first_radius } => Damped::Region(Region::new(at, local, first_radius)),
            Damping::Diagonal => Damped::Diagonal(FIRST_PART),
        }
    }
}

/// Part of the diagonal that is added for the first step; the least, the least after a bad step, and the one beyond which
/// no step is tried.
const FIRST_PART: f64 = 1e-4;
const LEAST_PART: f64 = 1e-10;
const LEAST_PART_AFTER_RISE: f64 = 1e-6;
const MOST_PART: f64 = 1e10;
/// Relative pivot at which directions that the readings do not tell are held.
const LOST_PIVOT: f64 = 1e-14;

/// The damping while a search goes on.
pub(super) enum Damped {
    Region(Region),
    /// Part of the diagonal that is added.
    Diagonal(f64),
}

impl Damped {
    /// The next step; none where every coordinate is held by its bound.
    pub(super) fn step(&mut self, at: &[f64], local: &Local, bounds: &Bounds) -> Option<Step> {
        match self {
            Damped::Region(region) => {
                region.see(local);
                region.step(at, local, bounds)
            }
            Damped::Diagonal(part) => {
                let part = *part;
                Step::of(at, local, bounds, &[], |normal, _, descent| {
                    let mut damped = normal;
                    for k in 0..damped.order() {
                        damped.set(k, k, damped.get(k, k) * (1.0 + part));
                    }
                    Some(damped.solve(descent, LOST_PIVOT))
                })
            }
        }
    }

    /// Whether the step, after which the sum of squares has fallen by `fall`, is taken; if not, whether a shorter one is
    /// worth trying.
    pub(super) fn learn(&mut self, step: &Step, fall: f64, resolution: f64) -> (bool, bool) {
        match self {
            Damped::Region(region) => {
                region.learn(step, fall);
                let is_stuck = region.radius == 0.0 || step.moved < f64::MIN_POSITIVE;
                (fall >= -resolution, !is_stuck)
            }
            Damped::Diagonal(part) => {
                let is_taken = fall > 0.0;
                *part = if is_taken {
                    (*part * 0.1_f64).max(LEAST_PART)
                } else {
                    part.max(LEAST_PART_AFTER_RISE) * 10.0
                };
                (is_taken, *part <= MOST_PART)
            }
        }
    }
}

/// A step within the box.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) to: Vec<f64>,
    /// Largest move of a coordinate.
    pub(super) moved: f64,
    /// Length of the step in scaled coordinates.
    length: f64,
    /// Fall of the sum of squares that the local model promises.
    pub(super) expected: f64,
}

impl Step {
    /// The damped step within the box; none where every coordinate is held by its bound. `solve` gives it without a box,
    /// from the part of J'J and of the descent of some coordinates, and which these are.
    ///
    /// A coordinate that would leave the box goes to its bound, and the others are solved anew with it there.
    fn of(
        at: &[f64],
        local: &Local,
        bounds: &Bounds,
        scales: &[f64],
        solve: impl Fn(Symmetric, &[usize], &[f64]) -> Option<Vec<f64>>,
    ) -> Option<Step> {
        let n = at.len();
        let held = |k: usize| {
            (at[k] <= bounds.low[k] && local.descent[k] <= 0.0)
                || (at[k] >= bounds.high[k] && local.descent[k] >= 0.0)
        };
        let mut free: Vec<usize> = (0..n)
            .filter(|&k| !held(k) && local.normal.get(k, k) > 0.0)
            .collect();
        if free.is_empty() {
            return None;
        }
        let mut taken = vec![0.0; n];
        while !free.is_empty() {
            let at_bounds = local.normal.times(&taken);
            let descent: Vec<f64> = free.iter().map(|&k| local.descent[k] - at_bounds[k]).collect();
            let wanted = solve(local.normal.part(&free), &free, &descent)?;
            let leaves = |&j: &usize| !bounds.contain(free[j], at[free[j]] + wanted[j]);
            let Some(j) = (0..free.len()).find(leaves) else {
                for (value, &k) in wanted.iter().zip(&free) {
                    taken[k] = *value;
                }
                break;
            };
            let k = free.remove(j);
            taken[k] = bounds.nearest(k, at[k] + wanted[j]) - at[k];
        }
        let linear: f64 = local.descent.iter().zip(&taken).map(|(d, t)| d * t).sum();
        let scaled = taken.iter().zip(scales).map(|(t, scale)| scale * t * t);
        Some(Step {
            to: (0..n).map(|k| bounds.nearest(k, at[k] + taken[k])).collect(),
            moved: peak(&taken),
            length: scaled.fold(0.0, |sum, square| sum + square).sqrt(),
            expected: (2.0 * linear - local.normal.form(&taken, &taken)).max(0.0),
        })
    }
}

/// Where the local model is trusted: steps no longer than `radius` in coordinates scaled by the largest slope
/// that each has had so far (More 1978), so that a coordinate whose slope dies away cannot run off.
pub(super) struct Region {
    radius: f64,
    /// Largest diagonal of J'J so far.
    scales: Vec<f64>,
}

/// Damping of a step that nothing holds back, relative to the scales.
const LEAST_DAMPING: f64 = 1e-12;

impl Region {
    fn new(at: &[f64], local: &Local, first_radius: f64) -> Region {
        let mut region = Region {
            radius: f64::INFINITY,
            scales: vec![0.0; at.len()],
        };
        region.see(local);
        if first_radius.is_finite() {
            let square: f64 = at
                .iter()
                .zip(&region.scales)
                .map(|(x, scale)| scale * x * x)
                .sum();
            region.radius = first_radius * if square > 0.0 { square.sqrt() } else { 1.0 };
        }
        region
    }

    fn see(&mut self, local: &Local) {
        for (k, scale) in self.scales.iter_mut().enumerate() {
            let own = local.normal.get(k, k);
            if own > *scale {
                *scale = own;
            }
        }
    }

    /// Widens the region after a good step and narrows it after a bad one.
    fn learn(&mut self, step: &Step, fall: f64) {
        let share = fall / step.expected;
        if share.is_nan() || share < 0.25 {
            self.radius = 0.25 * step.length;
        } else if share > 0.75 {
            self.radius = self.radius.max(2.0 * step.length);
        }
    }

    /// The longest damped step that stays in the region; none where every coordinate is held by its bound.
    fn step(&self, at: &[f64], local: &Local, bounds: &Bounds) -> Option<Step> {
        let damped = |damping: f64| {
            Step::of(at, local, bounds, &self.scales, |normal, free, descent| {
                self.solve(&normal, free, descent, damping)
            })
        };
        let free = damped(LEAST_DAMPING)?;
        if free.length <= self.radius {
            return Some(free);
        }
        // The length falls as the damping rises: bisection of its logarithm to a tenth of the radius.
        let (mut short, mut long) = (40.0, LEAST_DAMPING.log10());
        let mut found = free;
        for _ in 0..60 {
            let middle = 0.5 * (short + long);
            found = damped(10.0_f64.powf(middle))?;
            if found.length > self.radius {
                long = middle;
            } else if found.length < 0.9 * self.radius && short - long > 1e-3 {
                short = middle;
            } else {
                break;
            }
        }
        Some(found)
    }

    /// Solution with `damping` times the scales on the diagonal; more of it where rounding makes that necessary.
    fn solve(&self, normal: &Symmetric, free: &[usize], descent: &[f64], damping: f64) -> Option<Vec<f64>> {
        let mut damping = damping;
        for _ in 0..8 {
            let mut damped = normal.clone();
            for (j, &k) in free.iter().enumerate() {
                damped.set(j, j, damped.get(j, j) + damping * self.scales[k]);
            }
            if let Some(factor) = damped.cholesky(0.0) {
                return Some(factor.solve(descent));
            }
            damping *= 100.0;
        }
        None
    }
}
