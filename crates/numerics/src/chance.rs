//! Chances of sums of squares, and of counts.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, FisherSnedecor};

/// Chance that a chi-square of `degrees_of_freedom` is `square` or more; 1 where there is no freedom.
pub fn chi_square_chance(square: f64, degrees_of_freedom: usize) -> f64 {
    if degrees_of_freedom == 0 || square.is_nan() {
        return 1.0;
    }
    ChiSquared::new(degrees_of_freedom as f64).map_or(1.0, |chance| chance.sf(square.max(0.0)))
}

/// Chance that a ratio of mean squares (Fisher's F) with those degrees of freedom is `ratio` or more; 1 where there
/// is no freedom.
pub fn f_chance(ratio: f64, above: usize, below: usize) -> f64 {
    if above == 0 || below == 0 || ratio.is_nan() {
        return 1.0;
    }
    if ratio.is_infinite() {
        return 0.0;
    }
    FisherSnedecor::new(above as f64, below as f64)
        .map_or(1.0, |chance| chance.sf(ratio.max(0.0)).clamp(0.0, 1.0))
}

/// Chance that of `trials`, each of which comes out with `probability`, `hits` or fewer do; 1 where there is none.
pub fn as_few_chance(hits: usize, trials: usize, probability: f64) -> f64 {
    Binomial::new(probability, trials as u64).map_or(1.0, |count| count.cdf(hits as u64))
}

/// Reduced chi-square of so many degrees of freedom that noise exceeds as rarely as a normal value exceeds `deviations`
/// (Wilson and Hilferty 1931).
pub fn reduced_chi_square_limit(degrees_of_freedom: f64, deviations: f64) -> f64 {
    let part = 2.0 / (9.0 * degrees_of_freedom);
    (1.0 - part + deviations * part.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use ieap_domain::quantiles::*;
    use statrs::distribution::Normal;

    use super::*;

    #[test]
    fn chances_of_the_printed_tables() {
        for (square, freedom, expected) in [(3.841, 1, 0.05), (18.307, 10, 0.05), (124.342, 100, 0.05)] {
            let found = chi_square_chance(square, freedom);
            assert!(
                (found / expected - 1.0).abs() < 1e-3,
                "{square} {freedom}: {found}"
            );
        }
        assert_eq!((chi_square_chance(5.0, 0), chi_square_chance(0.0, 3)), (1.0, 1.0));
        assert!(chi_square_chance(1e6, 7) < 1e-300);
    }

    #[test]
    fn chances_of_few_hits_in_the_printed_table() {
        // The binomial table for 20 at 0.05: five misses or more, four or more.
        assert!((as_few_chance(15, 20, 0.95) - 0.0026).abs() < 5e-5);
        assert!((as_few_chance(16, 20, 0.95) - 0.0159).abs() < 5e-5);
        assert_eq!(
            (as_few_chance(20, 20, 0.95), as_few_chance(0, 0, 0.95)),
            (1.0, 1.0)
        );
    }

    #[test]
    fn quantiles_are_those_of_the_distributions() {
        let normal = |p| Normal::standard().inverse_cdf(p);
        for (found, expected, within) in [
            (NORMAL_95, normal(0.975), 1e-9),
            (NORMAL_95_ROUNDED, normal(0.975), 5e-5),
            (NORMAL_ONE_SIDED_95, normal(0.95), 5e-4),
            (NORMAL_ONE_SIDED_99, normal(0.99), 5e-4),
        ] {
            assert!((found - expected).abs() < within, "{found} {expected}");
        }
        let chi_square = |freedom, p| ChiSquared::new(freedom).unwrap().inverse_cdf(p);
        for (k, found) in CHI_SQUARE_95.into_iter().enumerate() {
            assert!((found - chi_square(k as f64 + 1.0, 0.95)).abs() < 6e-3);
        }
        assert!((CHI_SQUARE_95_OF_ONE - chi_square(1.0, 0.95)).abs() < 6e-4);
        assert!((CHI_SQUARE_99_OF_ONE - chi_square(1.0, 0.99)).abs() < 6e-3);
        assert!(
            (reduced_chi_square_limit(30.0, NORMAL_ONE_SIDED_95) - chi_square(30.0, 0.95) / 30.0).abs()
                < 1e-3
        );
    }

    #[test]
    fn chances_of_ratios_in_the_printed_tables() {
        for (ratio, above, below, expected) in
            [(161.45, 1, 1, 0.05), (4.3512, 1, 20, 0.05), (5.8018, 6, 9, 0.01)]
        {
            let found = f_chance(ratio, above, below);
            assert!((found / expected - 1.0).abs() < 1e-3, "{ratio}: {found}");
        }
        assert_eq!((f_chance(3.0, 0, 4), f_chance(0.0, 1, 4)), (1.0, 1.0));
        assert!(f_chance(1e9, 1, 30) < 1e-60);
    }
}
