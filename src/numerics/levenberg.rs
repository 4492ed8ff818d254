//! Least squares in a box by damped Gauss-Newton steps (Levenberg and Marquardt).

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

/// Lowers the sum of squares from `start` inside the box `low..=high`, within `limit` evaluations.
///
/// It settles where a further step would lower the sum by less than the part `settle` of it. `resolution` is the rounding error of the sum of squares: a rise below it counts as none. Coordinates
/// should be scaled so that a step of 1 is large (logarithms of positive parameters are).
pub fn minimise(
    start: &[f64],
    low: &[f64],
    high: &[f64],
    limit: u64,
    settle: f64,
    resolution: f64,
    mut evaluate: impl FnMut(&[f64]) -> Local,
) -> Minimum {
    let n = start.len();
    let mut at = [0.0; CAPACITY];
    for k in 0..n {
        at[k] = start[k].clamp(low[k], high[k]);
    }
    let mut local = evaluate(&at[..n]);
    let mut evaluations = 1;
    let mut damping = 1e-4;
    let ended = |at, local, evaluations, stop| Minimum {
        at,
        local,
        evaluations,
        stop,
    };
    loop {
        if !local.square.is_finite() {
            return ended(at, local, evaluations, Stop::NotFinite);
        }
        let Some((trial, moved, expected)) = step(&at, &local, low, high, damping) else {
            return ended(at, local, evaluations, Stop::Converged);
        };
        if moved < 1e-9 || expected <= settle * local.square {
            return ended(at, local, evaluations, Stop::Converged);
        }
        if evaluations >= limit {
            return ended(at, local, evaluations, Stop::EvaluationLimit);
        }
        let there = evaluate(&trial[..n]);
        evaluations += 1;
        if there.square <= local.square + resolution {
            // A step within rounding is taken once; after it nothing more can be told.
            let settled = there.square >= local.square - resolution && expected < resolution;
            (at, local) = (trial, there);
            damping = (damping * 0.1).max(1e-12);
            if settled {
                return ended(at, local, evaluations, Stop::NoDescent);
            }
        } else {
            damping = damping.max(1e-6) * 10.0;
            if damping > 1e12 {
                return ended(at, local, evaluations, Stop::NoDescent);
            }
        }
    }
}

/// The damped step within the box: place, largest move, expected fall of the sum of squares; none where
/// every coordinate is held by its bound.
///
/// A coordinate that would leave the box goes to its bound, and the others are solved anew with it there.
fn step(
    at: &[f64; CAPACITY],
    local: &Local,
    low: &[f64],
    high: &[f64],
    damping: f64,
) -> Option<([f64; CAPACITY], f64, f64)> {
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
        let mut damped = local.normal.part(&free);
        for k in 0..free.len() {
            damped.set(k, k, damped.get(k, k) * (1.0 + damping));
        }
        let bound_part = local.normal.times(&taken);
        let descent: Vec<f64> = free.iter().map(|&k| local.descent[k] - bound_part[k]).collect();
        let wanted = damped.cholesky(0.0)?.solve(&descent);
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
    let mut trial = *at;
    let mut moved: f64 = 0.0;
    for k in 0..n {
        trial[k] = (at[k] + taken[k]).clamp(low[k], high[k]);
        moved = moved.max(taken[k].abs());
    }
    let linear: f64 = (0..n).map(|k| local.descent[k] * taken[k]).sum();
    let expected = 2.0 * linear - local.normal.form(&taken, &taken);
    Some((trial, moved, expected.max(0.0)))
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
