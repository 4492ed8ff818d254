//! Stiffness and coupling over those of a reference, from the modulus, from the blocking force, or from both.
//!
//! alpha = mu / (E I): with alpha, one of the two gives the other. Where both were measured each ratio is known twice, and
//! the two are weighed; where they differ by more than their errors they are not.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_99_ROUNDED;

use super::estimates::{of_logarithm, product};

/// Ratios to a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratios {
    /// E I.
    pub stiffness: Estimate,
    /// mu.
    pub coupling: Estimate,
    /// What they are from.
    pub from: &'static str,
    /// Whether modulus and force say the same, where both were measured.
    pub agree: bool,
}

/// The ratios of stiffness and coupling, from the ratio of alpha, that of E I by the modulus and that of mu by the force.
pub fn both_ways(alpha: &Estimate, by_modulus: &Estimate, by_force: &Estimate) -> Ratios {
    let coupling_by_modulus = product(&[(alpha, 1.0), (by_modulus, 1.0)]);
    let stiffness_by_force = product(&[(by_force, 1.0), (alpha, -1.0)]);
    let ratios = |stiffness: &Estimate, coupling: &Estimate, from| Ratios {
        stiffness: stiffness.clone(),
        coupling: coupling.clone(),
        from,
        agree: true,
    };
    match (by_modulus.value.is_some(), by_force.value.is_some()) {
        (false, true) => ratios(&stiffness_by_force, by_force, "blocking force"),
        (false, false) => ratios(by_modulus, &coupling_by_modulus, ""),
        (true, false) => ratios(by_modulus, &coupling_by_modulus, "modulus"),
        (true, true) => match (
            weighed(by_modulus, &stiffness_by_force),
            weighed(by_force, &coupling_by_modulus),
        ) {
            // Without alpha each way stands for itself.
            (None, _) | (_, None) => ratios(by_modulus, by_force, "modulus and blocking force"),
            (Some((stiffness, apart)), Some((coupling, _))) => Ratios {
                agree: apart <= NORMAL_99_ROUNDED,
                ..ratios(&stiffness, &coupling, "modulus and blocking force")
            },
        },
    }
}

/// The weighted mean of two independent positive numbers, and how far they are apart in standard errors. Errors are not
/// widened where they are: such a mean is not used.
fn weighed(a: &Estimate, b: &Estimate) -> Option<(Estimate, f64)> {
    let logarithm = |own: &Estimate| {
        let value = own.value.filter(|value| *value > 0.0)?;
        Some((
            value.ln(),
            own.standard_error.filter(|error| *error > 0.0)? / value,
        ))
    };
    let ((a, a_error), (b, b_error)) = (logarithm(a)?, logarithm(b)?);
    let (a_weight, b_weight) = (a_error.powi(-2), b_error.powi(-2));
    let mean = (a * a_weight + b * b_weight) / (a_weight + b_weight);
    let error = (a_weight + b_weight).sqrt().recip();
    Some((of_logarithm(mean, error), (a - b).abs() / a_error.hypot(b_error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::{Cause, cause};
    use ieap_domain::testing::known;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn open() -> Estimate {
        Estimate::not_determined("not measured")
    }

    #[test]
    fn each_way_alone_tells_a_halved_alpha_apart() {
        let half = known(0.5, 0.05);
        let by_force = both_ways(&half, &open(), &known(1.0, 0.05));
        assert_eq!(
            cause(&half, &by_force.stiffness, &by_force.coupling),
            Cause::Stiffness
        );
        assert_eq!(by_force.from, "blocking force");
        let by_force = both_ways(&half, &open(), &known(0.5, 0.05));
        assert_eq!(
            cause(&half, &by_force.stiffness, &by_force.coupling),
            Cause::Coupling
        );
        let by_modulus = both_ways(&half, &known(2.0, 0.05), &open());
        assert_eq!(
            cause(&half, &by_modulus.stiffness, &by_modulus.coupling),
            Cause::Stiffness
        );
        assert!(both_ways(&half, &open(), &open()).coupling.value.is_none());
    }

    #[test]
    fn two_ways_that_contradict_each_other_are_said_to() {
        let half = known(0.5, 0.05);
        assert!(both_ways(&half, &known(2.0, 0.05), &known(1.0, 0.05)).agree);
        assert!(!both_ways(&half, &known(2.0, 0.05), &known(0.5, 0.05)).agree);
    }

    /// Intervals of 95 % hold the truth in 95 % of 2000 campaigns, within four standard errors of such a count.
    #[test]
    fn intervals_of_both_ways_together_are_calibrated() {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let errors = [0.05, 0.08, 0.06];
        let (mut stiffness, mut coupling) = (0, 0);
        for _ in 0..2000 {
            // E I doubles, mu is 0.7 of what it was.
            let mut measured = |truth: f64, error: f64| {
                let normal: f64 = StandardNormal.sample(&mut random);
                of_logarithm(truth.ln() + error * normal, error)
            };
            let alpha = measured(0.35, errors[0]);
            let ratios = both_ways(&alpha, &measured(2.0, errors[1]), &measured(0.7, errors[2]));
            let holds =
                |own: &Estimate, truth: f64| own.low_95.unwrap() <= truth && own.high_95.unwrap() >= truth;
            stiffness += usize::from(holds(&ratios.stiffness, 2.0));
            coupling += usize::from(holds(&ratios.coupling, 0.7));
        }
        for held in [stiffness, coupling] {
            assert!((1861..=1939).contains(&held), "{stiffness} {coupling}");
        }
    }
}
