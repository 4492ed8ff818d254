//! What is tied to what in a set of confounded covariates, and by how much.

use super::policy::MOST_INFLATION;
use crate::laws::covariate::Covariate;
use crate::laws::design::columns_by_level;
use crate::laws::facts::RunFacts;
use crate::laws::policy::INFLATION_LIMIT;

/// A covariate, and one or two others that may leave it unclear: what tied sets are found by.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Tie {
    /// The one whose variance is inflated.
    pub one: Covariate,
    /// Those that inflate it.
    pub others: Vec<Covariate>,
}

/// The name that stands for all that say the same: cycle, age, order, charge and exposure grow with every run.
pub fn class(covariate: Covariate) -> Covariate {
    if Covariate::OF_AGE.contains(&covariate) {
        Covariate::Cycle
    } else {
        covariate
    }
}

/// Every tie that the covariates of a set may have, but those among the names of use.
pub fn ties(set: &[Covariate]) -> Vec<Tie> {
    let mut ties = Vec::new();
    for &one in set {
        let others: Vec<Covariate> = set
            .iter()
            .copied()
            .filter(|&other| class(other) != class(one))
            .collect();
        for (k, &first) in others.iter().enumerate() {
            ties.push(Tie {
                one,
                others: vec![first],
            });
            for &second in &others[k + 1..] {
                ties.push(Tie {
                    one,
                    others: vec![first, second],
                });
            }
        }
    }
    ties
}

/// Inflation of each tie in the design of the runs at `places`; 1 where its covariates do not all differ at one level.
pub fn inflations(facts: &[RunFacts], places: &[usize], ties: &[Tie]) -> Vec<f64> {
    let named = ties
        .iter()
        .flat_map(|tie| std::iter::once(&tie.one).chain(&tie.others));
    let levels = columns_by_level(facts, places, &named.copied().collect());
    let of_tie = |tie: &Tie| {
        let names = || std::iter::once(&tie.one).chain(&tie.others);
        levels
            .iter()
            .find(|rows| names().all(|name| rows.columns.contains_key(name)))
            .map_or(1.0, |rows| rows.inflation(tie.one, &tie.others))
    };
    ties.iter().map(of_tie).collect()
}

/// How tied a design is: the largest inflation, and what all of them exceed the limit by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tightness {
    /// Logarithm of the largest inflation, at most that of [`MOST_INFLATION`].
    pub largest: f64,
    /// Sum over the ties of the logarithm of inflation over limit, where that is positive.
    pub excess: f64,
}

impl Tightness {
    /// Of these inflations.
    pub fn of(inflations: &[f64]) -> Tightness {
        let mut tightness = Tightness {
            largest: 0.0,
            excess: 0.0,
        };
        for inflation in inflations {
            let size = inflation.min(MOST_INFLATION).ln();
            tightness.largest = tightness.largest.max(size);
            tightness.excess += (size - INFLATION_LIMIT.ln()).max(0.0);
        }
        tightness
    }

    /// Whether every inflation is below the limit.
    pub fn is_loose(self) -> bool {
        self.excess == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_use_are_not_told_from_each_other() {
        let found = ties(&[Covariate::Cycle, Covariate::Age, Covariate::Voltage]);
        // Cycle by voltage, age by voltage, voltage by cycle, by age, and by both.
        assert_eq!(found.len(), 5, "{found:?}");
        assert!(ties(&[Covariate::Cycle, Covariate::RunOrder]).is_empty());
    }

    #[test]
    fn tightness_is_of_the_largest_and_of_all() {
        let loose = Tightness::of(&[1.0, 4.9]);
        assert!(loose.is_loose());
        let tight = Tightness::of(&[1.0, f64::INFINITY, 50.0]);
        assert!((tight.largest - MOST_INFLATION.ln()).abs() < 1e-12 && !tight.is_loose());
    }
}
