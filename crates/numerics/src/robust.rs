//! Robust statistics: the middle of values, and a spread that a few strays leave alone.

/// Standard deviation of Gaussian values over the median of their distances from the middle: 1 / 0.6745.
pub const SD_PER_MEDIAN_DISTANCE: f64 = 1.4826;

/// The middle value; of an even count the upper of the two in the middle. None of none.
///
/// It is always one of the values, so that a step of time is one that was kept. The values change their order.
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The middle value; of an even count the mean of the two in the middle. None of none.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    let upper = upper_median(&mut values)?;
    // What stands before the upper middle is not above it.
    let below = values[..values.len() / 2].iter().copied().max_by(f64::total_cmp);
    match below {
        Some(lower) if values.len().is_multiple_of(2) => Some(0.5 * (lower + upper)),
        _ => Some(upper),
    }
}

/// The middle one of the steps from each value to the next, in the values' unit. None of fewer than two values.
pub fn median_step(values: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    upper_median(&mut steps)
}

/// Standard deviation of Gaussian values about zero, from their median size; zero of none.
pub fn sd_about_zero(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    upper_median(&mut sizes).map_or(0.0, |size| SD_PER_MEDIAN_DISTANCE * size)
}

/// [`sd_about_zero`] around every value, among those of its stretch of so many and of the stretches beside it; that of all values
/// where that is wider.
pub fn sd_around(values: &[f64], stretch: usize) -> Vec<f64> {
    let whole = sd_about_zero(values);
    let around = |k: usize| {
        let first = (k * stretch).saturating_sub(stretch);
        let end = ((k + 2) * stretch).min(values.len());
        sd_about_zero(&values[first..end]).max(whole)
    };
    let of_stretch = |k: usize| std::iter::repeat_n(around(k), stretch.min(values.len() - k * stretch));
    (0..values.len().div_ceil(stretch)).flat_map(of_stretch).collect()
}

/// Standard deviation of Gaussian values from their median distance to their median (MAD); zero of none.
pub fn sd_about_median(values: &[f64]) -> f64 {
    let mut distances = values.to_vec();
    let middle = upper_median(&mut distances).unwrap_or(0.0);
    distances
        .iter_mut()
        .for_each(|value| *value = (*value - middle).abs());
    SD_PER_MEDIAN_DISTANCE * upper_median(&mut distances).unwrap_or(0.0)
}

/// Standard deviation of independent noise on a steady rise, from second differences; zero of fewer than three values.
///
/// A second difference has six times the variance of a value.
pub fn sd_on_a_slope(values: &[f64]) -> f64 {
    let mut bends: Vec<f64> = values
        .windows(3)
        .map(|three| (three[2] - 2.0 * three[1] + three[0]).abs())
        .collect();
    SD_PER_MEDIAN_DISTANCE / 6f64.sqrt() * upper_median(&mut bends).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn middles_of_few_values() {
        assert_eq!(
            (upper_median(&mut []), median(&[]), median_step(&[1.0])),
            (None, None, None)
        );
        assert_eq!((upper_median(&mut [3.0]), median(&[3.0])), (Some(3.0), Some(3.0)));
        assert_eq!(
            (upper_median(&mut [4.0, 1.0]), median(&[4.0, 1.0])),
            (Some(4.0), Some(2.5))
        );
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median_step(&[0.0, 1.0, 3.0, 90.0]), Some(2.0));
    }

    #[test]
    fn spreads_of_gaussian_noise_come_back_past_strays() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let mut noise: Vec<f64> = (0..20_000)
            .map(|_| 0.3 * Distribution::<f64>::sample(&StandardNormal, &mut random))
            .collect();
        (0..100).for_each(|k| noise[200 * k] = 1e6);
        let shifted: Vec<f64> = noise.iter().map(|value| value + 5.0).collect();
        let rising: Vec<f64> = (noise.iter().enumerate())
            .map(|(k, value)| value + 0.1 * k as f64)
            .collect();
        for found in [
            sd_about_zero(&noise),
            sd_about_median(&shifted),
            sd_on_a_slope(&rising),
        ] {
            assert!((found / 0.3 - 1.0).abs() < 0.03, "{found}");
        }
        assert_eq!(
            (
                sd_about_zero(&[]),
                sd_about_median(&[]),
                sd_on_a_slope(&[1.0, 2.0])
            ),
            (0.0, 0.0, 0.0)
        );
    }

    #[test]
    fn a_spread_is_that_of_its_surroundings_where_these_are_wide() {
        let values: Vec<f64> = (0..100).map(|k| if k < 20 { 5.0 } else { 1.0 }).collect();
        let found = sd_around(&values, 10);
        let of = |size: f64| SD_PER_MEDIAN_DISTANCE * size;
        assert_eq!((found.len(), found[0], found[15]), (100, of(5.0), of(5.0)));
        assert_eq!((found[35], found[99]), (of(1.0), of(1.0)));
        assert_eq!(
            (sd_around(&[], 10), sd_around(&[2.0], 10)),
            (vec![], vec![of(2.0)])
        );
    }

    proptest! {
        #[test]
        fn medians_are_those_of_sorted_values(values in prop::collection::vec(-1e3..1e3f64, 1..40)) {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let (n, middle) = (sorted.len(), sorted.len() / 2);
            let mean = if n % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
            prop_assert_eq!(median(&values), Some(mean));
            prop_assert_eq!(upper_median(&mut values.clone()), Some(sorted[middle]));
        }
    }
}
