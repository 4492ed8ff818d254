//! Chances of sums of squares.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

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
    FisherSnedecor::new(above as f64, below as f64)
        .map_or(1.0, |chance| chance.sf(ratio.max(0.0)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
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
