//! The one door to methods that search a box for the least sum of squares: one file and one row of `METHODS` each.

mod descent;
mod differential_evolution;

use std::fmt::Debug;
use std::panic::RefUnwindSafe;

use super::least_squares::{Minimum, Problem};

pub use descent::Descent;
pub use differential_evolution::DifferentialEvolution;

/// A problem whose whole box is looked over: the sum of squares of its local model may come from products, which round
/// by the size.
pub trait Landscape: Problem {
    /// Sum of squares at a place within the limits, taken from the residuals.
    fn square(&self, at: &[f64]) -> f64;

    /// Places that a coarse look finds promising, the best first.
    fn starts(&self) -> Vec<Vec<f64>>;

    /// Sum of squares of the measured values: what rounding is measured by.
    fn size(&self) -> f64;
}

/// How far a search goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Part of the sum of squares by which a further step must lower it to be worth while.
    pub settle: f64,
    /// Seed of everything random in the search.
    pub seed: u64,
}

/// A way to find the least sum of squares. The same landscape, effort and seed give the same place.
pub trait Method: Debug + Sync + RefUnwindSafe {
    /// Stored id, `differential-evolution`.
    fn id(&self) -> &'static str;

    /// The method's name in running text.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn description(&self) -> &'static str;

    /// Whether the seed matters.
    fn is_random(&self) -> bool;

    /// Searches the box.
    fn minimise(&self, landscape: &dyn Landscape, effort: Effort) -> Minimum;
}

static METHODS: [&dyn Method; 2] = [&Descent, &DifferentialEvolution::STANDARD];

/// Every method, the one that is taken by default first.
pub fn methods() -> &'static [&'static dyn Method] {
    &METHODS
}

/// The method of that id.
pub fn method(id: &str) -> Option<&'static dyn Method> {
    METHODS.iter().copied().find(|method| method.id() == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::{Bounds, Local};

    /// Two valleys: y = (x^2 - 1)^2 + (x - 1)^2 / 4 + y^2 as residuals; the deeper one lies at x = 1.
    struct TwoValleys {
        starts: Vec<Vec<f64>>,
    }

    impl Problem for TwoValleys {
        fn bounds(&self) -> Bounds {
            Bounds::even(2, -3.0, 3.0)
        }

        fn local(&self, at: &[f64], _: f64) -> Local {
            let residuals = [at[0] * at[0] - 1.0, (at[0] - 1.0) / 2.0, at[1], 0.3];
            Local::of(
                &residuals,
                &[[-2.0 * at[0], -0.5, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]],
            )
        }
    }

    impl Landscape for TwoValleys {
        fn square(&self, at: &[f64]) -> f64 {
            self.local(at, f64::INFINITY).square
        }

        fn starts(&self) -> Vec<Vec<f64>> {
            self.starts.clone()
        }

        fn size(&self) -> f64 {
            1.0
        }
    }

    #[test]
    fn every_method_finds_the_deeper_valley_and_repeats_itself() {
        let landscape = TwoValleys {
            starts: vec![vec![-2.0, 1.0], vec![2.0, -1.0]],
        };
        for method in methods() {
            for seed in 0..5 {
                let effort = Effort { settle: 1e-10, seed };
                let found = method.minimise(&landscape, effort);
                assert!(found.stop.converged(), "{}: {found:?}", method.id());
                assert!(
                    (found.local.square - 0.09).abs() < 1e-10,
                    "{}: {found:?}",
                    method.id()
                );
                assert!(
                    (found.at[0] - 1.0).abs() < 1e-5 && found.at[1].abs() < 1e-5,
                    "{found:?}"
                );
                let again = method.minimise(&landscape, effort);
                assert_eq!(found, again);
            }
        }
    }

    #[test]
    fn ids_are_unique_and_found() {
        for (k, found) in methods().iter().enumerate() {
            assert!(methods()[..k].iter().all(|other| other.id() != found.id()));
            assert_eq!(method(found.id()).map(|m| m.name()), Some(found.name()));
        }
        assert!(method("guessing").is_none());
    }
}
