//! The search: damped Gauss-Newton steps in a box (Levenberg, Marquardt, More).

use super::step::{Damping, Step};
use super::{Bounds, Minimum, Problem, Stop};
use crate::interrupt;

/// A step that would lower the sum of squares by less is not made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Settle {
    /// A part of the sum of squares.
    Part(f64),
    /// A fall of it, where it is weighted by the noise.
    Fall(f64),
}

/// A search with its damping, and when it stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levenberg {
    /// How steps are kept short where the local model does not hold.
    pub damping: Damping,
    /// Evaluations allowed.
    pub limit: u64,
    /// When a further step is not worth while.
    pub settle: Settle,
    /// Rounding error of the sum of squares: a rise below it counts as none.
    pub resolution: f64,
    /// The search settles where no coordinate would move by more.
    pub smallest_move: f64,
}

impl Levenberg {
    /// By steps within a region of trust, the first one as long as the local model has it, until a further step would
    /// lower the sum of squares, which rounding leaves uncertain by `resolution`, by less than the part `part`.
    pub fn by_region(limit: u64, part: f64, resolution: f64) -> Levenberg {
        Levenberg {
            damping: Damping::Region {
                first_radius: f64::INFINITY,
            },
            limit,
            settle: Settle::Part(part),
            resolution,
            smallest_move: 1e-9,
        }
    }

    /// By steps with a part of the diagonal added, until a further step would lower the sum of squares, in units of its
    /// noise, by less than `fall`.
    pub fn by_diagonal(limit: u64, fall: f64) -> Levenberg {
        Levenberg {
            damping: Damping::Diagonal,
            limit,
            settle: Settle::Fall(fall),
            resolution: 0.0,
            smallest_move: 0.0,
        }
    }

    /// Lowers the sum of squares of `problem` from `start`.
    pub fn search(&self, problem: &(impl Problem + ?Sized), start: &[f64]) -> Minimum {
        self.search_within(problem, &problem.bounds(), start)
    }

    /// The same within another box.
    pub fn search_within(
        &self,
        problem: &(impl Problem + ?Sized),
        bounds: &Bounds,
        start: &[f64],
    ) -> Minimum {
        let start = start.iter().enumerate();
        let mut at: Vec<f64> = start.map(|(k, &value)| bounds.nearest(k, value)).collect();
        let mut local = problem.local(&at, f64::INFINITY);
        let mut evaluations = 1;
        let mut damped = self.damping.begin(&at, &local);
        let mut promised = f64::INFINITY;
        let stop = loop {
            interrupt::check();
            if !local.square.is_finite() {
                break Stop::NotFinite;
            }
            let Some(step) = damped.step(&at, &local, bounds) else {
                break Stop::Converged;
            };
            if self.is_settled(&step, local.square) {
                break Stop::Converged;
            }
            if evaluations >= self.limit {
                break Stop::EvaluationLimit;
            }
            // A little more than what is taken below: rounding must not refuse what is taken then.
            let there = problem.local(&step.to, local.square + 2.0 * self.resolution);
            evaluations += 1;
            let fall = local.square - there.square;
            if step.expected < self.resolution && fall.abs() <= self.resolution {
                // The sum is too coarse to judge the step, but the slopes still tell: go on while they die away.
                let is_last = step.expected > 0.9 * promised;
                promised = step.expected;
                (at, local) = (step.to, there);
                if is_last {
                    break Stop::NoDescent;
                }
                continue;
            }
            let (is_taken, goes_on) = damped.learn(&step, fall, self.resolution);
            if is_taken {
                (at, local) = (step.to, there);
            } else if !goes_on {
                break Stop::NoDescent;
            }
        };
        Minimum {
            at,
            local,
            evaluations,
            stop,
        }
    }

    fn is_settled(&self, step: &Step, square: f64) -> bool {
        let least = match self.settle {
            Settle::Part(part) => part * square,
            Settle::Fall(fall) => fall,
        };
        step.moved < self.smallest_move || step.expected <= least
    }
}

#[cfg(test)]
mod tests {
    use super::super::Local;
    use super::*;

    /// Rosenbrock's valley as residuals 10 (y - x^2) and 1 - x.
    struct Valley {
        bounds: Bounds,
    }

    impl Valley {
        fn within(high: [f64; 2]) -> Valley {
            Valley {
                bounds: Bounds {
                    low: vec![-5.0; 2],
                    high: high.to_vec(),
                },
            }
        }
    }

    impl Problem for Valley {
        fn bounds(&self) -> Bounds {
            self.bounds.clone()
        }

        fn local(&self, at: &[f64], most: f64) -> Local {
            let residuals = [10.0 * (at[1] - at[0] * at[0]), 1.0 - at[0]];
            let local = Local::of(&residuals, &[[20.0 * at[0], 1.0], [-10.0, 0.0]]);
            if local.square <= most {
                local
            } else {
                Local::refused(local.square, 2)
            }
        }
    }

    const START: [f64; 2] = [-1.2, 1.0];

    fn both(limit: u64) -> [Levenberg; 2] {
        [
            Levenberg::by_region(limit, 1e-10, 0.0),
            Levenberg::by_diagonal(limit, 1e-14),
        ]
    }

    #[test]
    fn finds_the_bottom_of_a_valley() {
        for method in both(200) {
            let found = method.search(&Valley::within([5.0; 2]), &START);
            assert!(found.stop.converged(), "{found:?}");
            assert!(
                (found.at[0] - 1.0).abs() < 1e-5 && (found.at[1] - 1.0).abs() < 1e-5,
                "{found:?}"
            );
        }
    }

    #[test]
    fn stays_in_the_box_and_within_the_limit() {
        for method in both(200) {
            let found = method.search(&Valley::within([0.5, 5.0]), &START);
            assert!(
                (found.at[0] - 0.5).abs() < 1e-9 && (found.at[1] - 0.25).abs() < 1e-5,
                "{found:?}"
            );
        }
        for method in both(3) {
            let cut = method.search(&Valley::within([5.0; 2]), &START);
            assert_eq!((cut.stop, cut.evaluations), (Stop::EvaluationLimit, 3));
        }
    }

    #[test]
    fn no_number_ends_the_search() {
        struct Nothing;
        impl Problem for Nothing {
            fn bounds(&self) -> Bounds {
                Bounds::even(1, -1.0, 1.0)
            }
            fn local(&self, _: &[f64], _: f64) -> Local {
                Local::refused(f64::NAN, 1)
            }
        }
        for method in both(50) {
            assert_eq!(method.search(&Nothing, &[0.0]).stop, Stop::NotFinite);
        }
    }
}
