//! Least squares in a box by damped Gauss-Newton steps within a region of trust (Levenberg, Marquardt, More).

use super::interrupt;
use super::symmetric::{CAPACITY, Symmetric};

/// Sum of squares and its local model at one place.
#[derive(Debug, Clone, Copy)]
pub struct Local {
    /// Sum of squared residuals.
    pub square: f64,
    /// J'r: the direction of descent, half of the negative gradient.
    pub descent: [f64; CAPACITY],
    /// J'J.
    pub normal: Symmetric,
}

/// Why a search stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A further step would lower the sum of squares by less than the part asked for, or move by less than 10^-9.
    Converged,
    /// No damped step lowers the sum of squares any more: rounding has been reached.
    NoDescent,
    /// The limit of evaluations was reached first.
    EvaluationLimit,
    /// The sum of squares was no finite number.
    NotFinite,
}

impl Stop {
    /// Whether the place found is a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Stop::Converged | Stop::NoDescent)
    }

    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Stop::Converged => "a further step would not lower the sum of squares noticeably",
            Stop::NoDescent => "no step lowers the sum of squares any more",
            Stop::EvaluationLimit => "the limit of evaluations was reached",
            Stop::NotFinite => "the sum of squares is no finite number",
        }
    }
}

/// Where a search ended.
#[derive(Debug, Clone, Copy)]
pub struct Minimum {
    /// The place.
    pub at: [f64; CAPACITY],
    /// The local model there.
    pub local: Local,
    /// Evaluations that it took.
    pub evaluations: u64,
    /// Why it stopped.
    pub stop: Stop,
}

/// When a search stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stopping {
    /// Evaluations allowed.
    pub limit: u64,
    /// It settles where a further step would lower the sum of squares by less than this part of it.
    pub settle: f64,
    /// Rounding error of the sum of squares: a rise below it counts as none.
    pub resolution: f64,
    /// It settles where no coordinate would move by more.
    pub smallest_move: f64,
    /// Longest first step, in parts of the start's distance from zero; infinite where the first step is trusted.
    pub first_radius: f64,
}

/// Lowers the sum of squares from `start` inside the box `low..=high`, within `limit` evaluations.
///
/// It settles where a further step would lower the sum by less than the part `settle` of it, or move by less
/// than 10^-9. `resolution` is the rounding error of the sum of squares. Coordinates should be scaled so that a
/// step of 1 is large (logarithms of positive parameters are).
pub fn minimise(
    start: &[f64],
    low: &[f64],
    high: &[f64],
    limit: u64,
    settle: f64,
    resolution: f64,
    evaluate: impl FnMut(&[f64]) -> Local,
) -> Minimum {
    let stopping = Stopping {
        limit,
        settle,
        resolution,
        smallest_move: 1e-9,
        first_radius: f64::INFINITY,
    };
    search(start, low, high, stopping, evaluate)
}

/// The same with every condition of stopping stated.
pub fn search(
    start: &[f64],
    low: &[f64],
    high: &[f64],
    stopping: Stopping,
    mut evaluate: impl FnMut(&[f64]) -> Local,
) -> Minimum {
    let n = start.len();
    let resolution = stopping.resolution;
    let mut at = [0.0; CAPACITY];
    for k in 0..n {
        at[k] = start[k].clamp(low[k], high[k]);
    }
    let mut local = evaluate(&at[..n]);
    let mut evaluations = 1;
    let mut region = Region::new(&at[..n], &local, stopping.first_radius);
    let mut promised = f64::INFINITY;
    let ended = |at, local, evaluations, stop| Minimum {
        at,
        local,
        evaluations,
        stop,
    };
    loop {
        interrupt::check();
        if !local.square.is_finite() {
            return ended(at, local, evaluations, Stop::NotFinite);
        }
        region.see(&local);
        let Some(step) = region.step(&at, &local, low, high) else {
            return ended(at, local, evaluations, Stop::Converged);
        };
        if step.moved < stopping.smallest_move || step.expected <= stopping.settle * local.square {
            return ended(at, local, evaluations, Stop::Converged);
        }
        if evaluations >= stopping.limit {
            return ended(at, local, evaluations, Stop::EvaluationLimit);
        }
        let there = evaluate(&step.to[..n]);
        evaluations += 1;
        let fall = local.square - there.square;
        if step.expected < resolution && fall.abs() <= resolution {
            // The sum is too coarse to judge the step, but the slopes still tell: go on while they die away.
            let settled = step.expected > 0.9 * promised;
            promised = step.expected;
            (at, local) = (step.to, there);
            if settled {
                return ended(at, local, evaluations, Stop::NoDescent);
            }
            continue;
        }
        region.learn(&step, fall);
        if fall >= -resolution {
            (at, local) = (step.to, there);
        } else if region.radius == 0.0 || step.moved < f64::MIN_POSITIVE {
            return ended(at, local, evaluations, Stop::NoDescent);
        }
    }
}

/// A step within the box and the region of trust.
#[derive(Debug, Clone, Copy)]
struct Step {
    to: [f64; CAPACITY],
    /// Largest move of a coordinate.
    moved: f64,
    /// Length of the step in scaled coordinates.
    length: f64,
    /// Fall of the sum of squares that the local model promises.
    expected: f64,
}

/// Where the local model is trusted: steps no longer than `radius` in coordinates scaled by the largest slope
/// that each has had so far (More 1978), so that a coordinate whose slope dies away cannot run off.
struct Region {
    radius: f64,
    /// Largest diagonal of J'J so far.
    scales: [f64; CAPACITY],
    order: usize,
}

/// Damping of a step that nothing holds back, relative to the scales.
const LEAST_DAMPING: f64 = 1e-12;

impl Region {
    fn new(at: &[f64], local: &Local, first_radius: f64) -> Region {
        let mut region = Region {
            radius: f64::INFINITY,
            scales: [0.0; CAPACITY],
            order: at.len(),
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
        for k in 0..self.order {
            let own = local.normal.get(k, k);
            if own > self.scales[k] {
                self.scales[k] = own;
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
    fn step(&self, at: &[f64; CAPACITY], local: &Local, low: &[f64], high: &[f64]) -> Option<Step> {
        let free = damped(at, local, low, high, LEAST_DAMPING, &self.scales)?;
        if free.length <= self.radius {
            return Some(free);
        }
        // The length falls as the damping rises: bisection of its logarithm to a tenth of the radius.
        let (mut short, mut long) = (40.0, LEAST_DAMPING.log10());
        let mut found = free;
        for _ in 0..60 {
            let middle = 0.5 * (short + long);
            found = damped(at, local, low, high, 10.0_f64.powf(middle), &self.scales)?;
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
}

/// The damped step within the box; none where every coordinate is held by its bound.
///
/// A coordinate that would leave the box goes to its bound, and the others are solved anew with it there.
fn damped(
    at: &[f64; CAPACITY],
    local: &Local,
    low: &[f64],
    high: &[f64],
    damping: f64,
    scales: &[f64; CAPACITY],
) -> Option<Step> {
    let n = low.len();
    let held = |k: usize| {
        (at[k] <= low[k] && local.descent[k] <= 0.0) || (at[k] >= high[k] && local.descent[k] >= 0.0)
    };
    let mut free: Vec<usize> = (0..n)
        .filter(|&k| !held(k) && local.normal.get(k, k) > 0.0)
        .collect();
    let mut taken = [0.0; CAPACITY];
    let mut movable = false;
    while !free.is_empty() {
        movable = true;
        let bound_part = local.normal.times(&taken);
        let descent: Vec<f64> = free.iter().map(|&k| local.descent[k] - bound_part[k]).collect();
        let wanted = solve_damped(local, &free, damping, scales, &descent)?;
        let outside = |&(j, k): &(usize, usize)| !(low[k]..=high[k]).contains(&(at[k] + wanted[j]));
        let leaving = free.iter().copied().enumerate().find(outside);
        match leaving {
            Some((j, k)) => {
                taken[k] = (at[k] + wanted[j]).clamp(low[k], high[k]) - at[k];
                free.remove(j);
            }
            None => {
                for (j, &k) in free.iter().enumerate() {
                    taken[k] = wanted[j];
                }
                break;
            }
        }
    }
    if !movable {
        return None;
    }
    let mut step = Step {
        to: *at,
        moved: 0.0,
        length: 0.0,
        expected: 0.0,
    };
    for k in 0..n {
        step.to[k] = (at[k] + taken[k]).clamp(low[k], high[k]);
        step.moved = step.moved.max(taken[k].abs());
        step.length += scales[k] * taken[k] * taken[k];
    }
    step.length = step.length.sqrt();
    let linear: f64 = (0..n).map(|k| local.descent[k] * taken[k]).sum();
    step.expected = (2.0 * linear - local.normal.form(&taken, &taken)).max(0.0);
    Some(step)
}

/// Solution with `damping` times the scales on the diagonal; more of it where rounding makes that necessary.
fn solve_damped(
    local: &Local,
    free: &[usize],
    damping: f64,
    scales: &[f64; CAPACITY],
    descent: &[f64],
) -> Option<[f64; CAPACITY]> {
    let part = local.normal.part(free);
    let mut damping = damping;
    for _ in 0..8 {
        let mut damped = part;
        for (j, &k) in free.iter().enumerate() {
            damped.set(j, j, damped.get(j, j) + damping * scales[k]);
        }
        if let Some(factor) = damped.cholesky(0.0) {
            return Some(factor.solve(descent));
        }
        damping *= 100.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals 10 (y - x^2) and 1 - x.
    fn valley(at: &[f64]) -> Local {
        let residuals = [10.0 * (at[1] - at[0] * at[0]), 1.0 - at[0]];
        let jacobian = [[-20.0 * at[0], 10.0], [-1.0, 0.0]];
        let mut descent = [0.0; CAPACITY];
        for k in 0..2 {
            descent[k] = -(0..2).map(|r| jacobian[r][k] * residuals[r]).sum::<f64>();
        }
        Local {
            square: residuals.iter().map(|r| r * r).sum(),
            descent,
            normal: Symmetric::from_fn(2, |a, b| (0..2).map(|r| jacobian[r][a] * jacobian[r][b]).sum()),
        }
    }

    #[test]
    fn finds_the_bottom_of_a_valley() {
        let found = minimise(&[-1.2, 1.0], &[-5.0; 2], &[5.0; 2], 200, 1e-10, 0.0, valley);
        assert!(found.stop.converged(), "{found:?}");
        assert!((found.at[0] - 1.0).abs() < 1e-6 && (found.at[1] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn stays_in_the_box_and_within_the_limit() {
        let found = minimise(&[-1.2, 1.0], &[-5.0; 2], &[0.5, 5.0], 200, 1e-10, 0.0, valley);
        assert!((found.at[0] - 0.5).abs() < 1e-9 && (found.at[1] - 0.25).abs() < 1e-6);
        let cut = minimise(&[-1.2, 1.0], &[-5.0; 2], &[5.0; 2], 3, 1e-10, 0.0, valley);
        assert_eq!((cut.stop, cut.evaluations), (Stop::EvaluationLimit, 3));
    }

    #[test]
    fn no_number_ends_the_search() {
        let nan = |_: &[f64]| Local {
            square: f64::NAN,
            descent: [0.0; CAPACITY],
            normal: Symmetric::zero(1),
        };
        assert_eq!(
            minimise(&[0.0], &[-1.0], &[1.0], 50, 1e-10, 0.0, nan).stop,
            Stop::NotFinite
        );
    }
}
