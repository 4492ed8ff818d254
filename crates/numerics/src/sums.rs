//! Sums over long columns in eight running parts: fast, of small rounding, and the same on every machine; and sums of columns.

/// Running parts of a sum.
pub(super) const LANES: usize = 8;

/// `SUM f(a_k, b_k)` over the shorter of two columns.
#[inline(always)]
fn over_pairs(a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mut sums = [0.0; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (left_rest, right_rest) = (left.remainder(), right.remainder());
    for (left, right) in left.zip(right) {
        for lane in 0..LANES {
            sums[lane] += f(left[lane], right[lane]);
        }
    }
    let rest: f64 = left_rest.iter().zip(right_rest).map(|(&a, &b)| f(a, b)).sum();
    total(&sums, rest)
}

/// The sum of the running parts and of what is left over.
#[inline(always)]
pub(super) fn total(sums: &[f64; LANES], rest: f64) -> f64 {
    let halves = (sums[0] + sums[4]) + (sums[1] + sums[5]);
    halves + ((sums[2] + sums[6]) + (sums[3] + sums[7])) + rest
}

/// `SUM a_k b_k`.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    over_pairs(a, b, |a, b| a * b)
}

/// `SUM a_k`.
pub fn sum(a: &[f64]) -> f64 {
    over_pairs(a, a, |a, _| a)
}

/// Mean, summed in order; 0 of none.
pub fn mean(a: &[f64]) -> f64 {
    a.iter().sum::<f64>() / a.len().max(1) as f64
}

/// Standard deviation of values about their mean, with one less than their number.
pub fn standard_deviation(a: &[f64]) -> f64 {
    let mean = mean(a);
    let square: f64 = a.iter().map(|value| (value - mean).powi(2)).sum();
    (square / (a.len() as f64 - 1.0)).sqrt()
}

/// What each value is above the mean of all.
pub fn about_mean(a: &[f64]) -> Vec<f64> {
    let mean = mean(a);
    a.iter().map(|value| value - mean).collect()
}

/// `SUM a_k^2`.
pub fn square(a: &[f64]) -> f64 {
    over_pairs(a, a, |a, _| a * a)
}

/// `SUM (a_k - centre)^2`.
pub fn square_about(a: &[f64], centre: f64) -> f64 {
    over_pairs(a, a, |a, _| (a - centre) * (a - centre))
}

/// `SUM a_k a_(k+1)`.
pub fn lagged(a: &[f64]) -> f64 {
    if a.is_empty() { 0.0 } else { dot(a, &a[1..]) }
}

/// Adds `factor` times a column, over the shorter of the two.
#[inline]
pub fn add(to: &mut [f64], factor: f64, column: &[f64]) {
    for (to, value) in to.iter_mut().zip(column) {
        *to += factor * value;
    }
}

/// The sum of columns of one length, each times its factor; of none when there is none.
pub fn combined(columns: &[Vec<f64>], factors: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, factor) in columns.iter().zip(factors) {
        add(&mut sum, *factor, column);
    }
    sum
}

/// Least `a_k - b_k` over the shorter of two columns; infinite where there is none.
pub fn least_difference(a: &[f64], b: &[f64]) -> f64 {
    let mut least = [f64::INFINITY; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let whole = left.len().min(right.len()) * LANES;
    for (left, right) in left.zip(right) {
        for lane in 0..LANES {
            let apart = left[lane] - right[lane];
            least[lane] = if apart < least[lane] { apart } else { least[lane] };
        }
    }
    let rest = a[whole..].iter().zip(&b[whole..]).map(|(a, b)| a - b);
    least.into_iter().chain(rest).fold(f64::INFINITY, f64::min)
}

/// Largest magnitude; 0 where there is none.
pub fn peak(a: &[f64]) -> f64 {
    let mut most = [0.0_f64; LANES];
    let parts = a.chunks_exact(LANES);
    let rest = parts
        .remainder()
        .iter()
        .fold(0.0_f64, |most, v| most.max(v.abs()));
    for part in parts {
        for lane in 0..LANES {
            most[lane] = most[lane].max(part[lane].abs());
        }
    }
    most.into_iter().fold(rest, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_every_length_are_the_plain_ones() {
        for n in 0..40 {
            let a: Vec<f64> = (0..n).map(|k| k as f64 - 7.0).collect();
            let b: Vec<f64> = (0..n).map(|k| (k * k) as f64).collect();
            assert_eq!(dot(&a, &b), a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>());
            assert_eq!(sum(&a), a.iter().sum::<f64>());
            assert_eq!(square(&a), a.iter().map(|v| v * v).sum::<f64>());
            assert_eq!(
                square_about(&a, 2.0),
                a.iter().map(|v| (v - 2.0) * (v - 2.0)).sum::<f64>()
            );
            assert_eq!(lagged(&a), a.windows(2).map(|p| p[0] * p[1]).sum::<f64>());
            let apart = a.iter().zip(&b).map(|(a, b)| a - b).fold(f64::INFINITY, f64::min);
            assert_eq!(least_difference(&a, &b), apart);
            assert_eq!(peak(&a), a.iter().fold(0.0_f64, |most, v| most.max(v.abs())));
        }
    }
}
