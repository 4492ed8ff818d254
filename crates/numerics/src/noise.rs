//! Noise of a channel without any model of its signal.

use super::correlation::Autoregression;
use super::sums;

/// Noise found in a series.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalScatter {
    /// Standard deviation, unit of the series.
    pub standard_deviation: f64,
    /// Lag-1 autocorrelation.
    pub correlation: f64,
    /// Readings per window.
    pub window: usize,
}

impl LocalScatter {
    /// The same as a first-order autoregression.
    pub fn noise(&self) -> Autoregression {
        Autoregression {
            variance: self.standard_deviation.powi(2),
            correlation: self.correlation,
        }
    }
}

/// Scatter about local parabolas: the series is cut into windows, a parabola over the index is taken out of
/// each, and the middle 60 % of the windows by scatter are averaged, so that neither a transient nor a
/// stretch in which a coarse converter shows one step only decides. `series` are stretches without a jump.
///
/// None where no stretch holds a window of eight readings.
pub fn local_scatter(series: &[&[f64]]) -> Option<LocalScatter> {
    let window = window_of(series)?;
    let parabola = Parabola::new(window);
    let mut sums: Vec<(f64, f64)> = (series.iter())
        .flat_map(|stretch| stretch.chunks_exact(window))
        .map(|values| parabola.scatter(values))
        .filter(|sums| sums.0.is_finite())
        .collect();
    sums.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let cut = sums.len() / 5;
    let kept = &sums[cut..sums.len() - cut];
    if kept.is_empty() {
        return None;
    }
    let count = kept.len() as f64;
    let square = kept.iter().map(|sums| sums.0).sum::<f64>() / count;
    let product = kept.iter().map(|sums| sums.1).sum::<f64>() / count;
    let noise = Autoregression::from_sums(square, product, window as f64, 3.0);
    Some(LocalScatter {
        standard_deviation: noise.variance.max(0.0).sqrt(),
        correlation: noise.correlation,
        window,
    })
}

/// Readings of a window; none where no stretch holds eight.
fn window_of(series: &[&[f64]]) -> Option<usize> {
    let longest = series.iter().map(|stretch| stretch.len()).max()?;
    let total: usize = series.iter().map(|stretch| stretch.len()).sum();
    let window = (total / 20).clamp(8, 64).min(longest);
    (window >= 8).then_some(window)
}

/// [`local_scatter`] of a series that may jump at the times `edges_s`, which increase.
///
/// A parabola does not follow what comes right after a jump. Where there are more jumps than windows that are left out for
/// their scatter, the first window after each jump is left out, as far as two others remain of its stretch.
pub fn scatter_between(time_s: &[f64], values: &[f64], edges_s: &[f64]) -> Option<LocalScatter> {
    let mut stretches = Vec::with_capacity(edges_s.len() + 1);
    let mut first = 0;
    for edge_s in edges_s {
        let end = time_s.partition_point(|t| t < edge_s).max(first);
        stretches.push(&values[first..end]);
        first = end;
    }
    stretches.push(&values[first..]);
    let window = window_of(&stretches)?;
    let windows: usize = stretches.iter().map(|stretch| stretch.len() / window).sum();
    if edges_s.len() > windows / 5 {
        for stretch in stretches.iter_mut().skip(1) {
            if stretch.len() >= 3 * window {
                *stretch = &stretch[window..];
            }
        }
    }
    local_scatter(&stretches)
}

/// Orthonormal polynomials up to the second degree on a window.
struct Parabola {
    terms: [Vec<f64>; 3],
}

impl Parabola {
    fn new(window: usize) -> Parabola {
        let half = (window as f64 - 1.0) / 2.0;
        let at = |k: usize| (k as f64 - half) / half;
        let mean_square = (0..window).map(|k| at(k) * at(k)).sum::<f64>() / window as f64;
        let normed = |raw: Vec<f64>| -> Vec<f64> {
            let norm = raw.iter().map(|v| v * v).sum::<f64>().sqrt();
            raw.into_iter().map(|v| v / norm).collect()
        };
        Parabola {
            terms: [
                normed(vec![1.0; window]),
                normed((0..window).map(at).collect()),
                normed((0..window).map(|k| at(k) * at(k) - mean_square).collect()),
            ],
        }
    }

    /// SUM e_t^2 and SUM e_t e_(t+1) of what the parabola leaves.
    fn scatter(&self, values: &[f64]) -> (f64, f64) {
        let mut rest = [0.0; 64];
        let rest = &mut rest[..values.len()];
        // The first value is taken off so that a large offset costs no digits.
        for (out, value) in rest.iter_mut().zip(values) {
            *out = value - values[0];
        }
        // The terms are orthonormal, so that each part can be told from the whole.
        let [constant, line, bend] = &self.terms;
        let parts = self.terms.each_ref().map(|term| sums::dot(term, rest));
        for (((out, a), b), c) in rest.iter_mut().zip(constant).zip(line).zip(bend) {
            *out -= parts[0] * a + parts[1] * b + parts[2] * c;
        }
        (sums::square(rest), sums::lagged(rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn noisy_decay(n: usize, rho: f64, quantum: f64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut last: f64 = 0.0;
        let value = |k: usize| {
            let fresh: f64 = StandardNormal.sample(&mut rng);
            last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
            let exact = 1000.0 * (-(k as f64) / (0.15 * n as f64)).exp() + last;
            if quantum > 0.0 {
                (exact / quantum).round() * quantum
            } else {
                exact
            }
        };
        (0..n).map(value).collect()
    }

    #[test]
    fn white_correlated_and_short_records() {
        for (n, rho, within) in [(4000, 0.0, 0.03), (4000, 0.6, 0.08), (400, 0.0, 0.12)] {
            let values = noisy_decay(n, rho, 0.0);
            let found = local_scatter(&[&values]).unwrap();
            assert!(
                (found.standard_deviation - 1.0).abs() < within,
                "{n} {rho}: {found:?}"
            );
            assert!((found.correlation - rho).abs() < 0.12, "{n} {rho}: {found:?}");
        }
    }

    #[test]
    fn many_jumps_with_fast_answers_do_not_count_as_noise() {
        let noise = noisy_decay(400, 0.0, 0.0);
        let time_s: Vec<f64> = (0..400).map(f64::from).collect();
        let edges_s: Vec<f64> = (0..6).map(|k| f64::from(66 * k)).collect();
        let values: Vec<f64> = (noise.iter().zip(&time_s))
            .enumerate()
            .map(|(k, (value, t))| {
                let decay = 1000.0 * (-(k as f64) / 60.0).exp();
                value - decay + 400.0 * (-(t % 66.0) / 3.0).exp() * if (k / 66) % 2 == 0 { 1.0 } else { -1.0 }
            })
            .collect();
        let found = scatter_between(&time_s, &values, &edges_s).unwrap();
        assert!((found.standard_deviation - 1.0).abs() < 0.15, "{found:?}");
    }

    #[test]
    fn a_coarse_converter_adds_its_rounding_and_hides_nothing() {
        let values = noisy_decay(4000, 0.0, 3.0);
        let found = local_scatter(&[&values]).unwrap().standard_deviation;
        let expected = (1.0_f64 + 9.0 / 12.0).sqrt();
        assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    }

    #[test]
    fn too_short_is_none_and_constant_is_zero() {
        assert_eq!(local_scatter(&[&[1.0, 2.0, 3.0]]), None);
        assert_eq!(local_scatter(&[]), None);
        assert_eq!(local_scatter(&[&[4.0; 40]]).unwrap().standard_deviation, 0.0);
    }
}
