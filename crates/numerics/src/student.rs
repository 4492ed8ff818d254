//! Student's t.

use ieap_domain::quantiles::NORMAL_95;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Half-width of a two-sided 95 % interval in standard errors, for `degrees_of_freedom`: below one as the law has it, infinite
/// where there are none.
pub fn quantile_95(degrees_of_freedom: f64) -> f64 {
    let freedom = degrees_of_freedom;
    if freedom >= 100.0 {
        // Expansion in 1/nu (Abramowitz and Stegun 26.7.5), below 1e-7 off from 100 degrees of freedom on.
        let z = NORMAL_95;
        let first = (z.powi(3) + z) / 4.0;
        let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
        let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
        return z + first / freedom + second / freedom.powi(2) + third / freedom.powi(3);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

/// What Student's t stays below with chance `p`, for `degrees_of_freedom` (none: nothing; infinite ones are the normal law).
pub fn quantile(p: f64, degrees_of_freedom: f64) -> f64 {
    // Beyond a million degrees of freedom the normal law is the same to seven digits.
    let freedom = degrees_of_freedom.min(1e6);
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(p))
}

/// Chance that Student's t lies as far from 0 as `t`, on either side; 1 without degrees of freedom or without a number.
pub fn two_sided_chance(t: f64, degrees_of_freedom: f64) -> f64 {
    if t.is_nan() {
        return 1.0;
    }
    StudentsT::new(0.0, 1.0, degrees_of_freedom)
        .map_or(1.0, |chance| (2.0 * chance.sf(t.abs())).clamp(0.0, 1.0))
}

/// Chance that Student's t lies above `t`; 1 without degrees of freedom or without a number.
pub fn one_sided_chance(t: f64, degrees_of_freedom: f64) -> f64 {
    if t.is_nan() {
        return 1.0;
    }
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(1.0, |chance| chance.sf(t).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_printed_tables() {
        for (freedom, expected) in [
            (1.0, 12.7062),
            (5.0, 2.5706),
            (30.0, 2.0423),
            (100.0, 1.9840),
            (1e9, 1.9600),
        ] {
            assert!((quantile_95(freedom) - expected).abs() < 6e-5, "{freedom}");
        }
        assert!((one_sided_chance(2.5706, 5.0) - 0.025).abs() < 1e-5 && one_sided_chance(0.0, 3.0) == 0.5);
        assert!((two_sided_chance(-2.5706, 5.0) - 0.05).abs() < 1e-5 && two_sided_chance(0.0, 3.0) == 1.0);
        assert!((quantile_95(99.999) - quantile_95(100.0)).abs() < 1e-6);
    }
}
