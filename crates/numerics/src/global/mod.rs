//! The one door to methods that search a box for the least sum of squares: one file and one row of `METHODS` each.

mod descent;
mod differential_evolution;
mod method;

pub use descent::Descent;
pub use differential_evolution::DifferentialEvolution;
pub use method::{Effort, Landscape, Method};

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
    use crate::least_squares::{Bounds, Local, Problem};

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
