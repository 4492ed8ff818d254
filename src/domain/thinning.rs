//! Choosing which readings of a long channel are drawn.

/// Stretches of time that a drawn curve of a run is thinned over: about 480 points at most.
pub const DRAWN_BUCKETS: usize = 120;

/// Indices (increasing) of the readings that a drawing keeps: the first, the last, and in each of
/// `buckets` stretches of time the smallest and largest value of every series in `series`.
///
/// Half of the stretches have equal length in time, half equal length in the logarithm of the time since
/// `origin_s`, so that both the fast start and the slow rest of a step response keep their shape, and no
/// peak is lost. Every series must be as long as `time_s`.
pub fn drawn_indices(time_s: &[f64], series: &[&[f64]], origin_s: f64, buckets: usize) -> Vec<usize> {
    let n = time_s.len();
    if n <= 4 * buckets {
        return (0..n).collect();
    }
    let mut kept = vec![0, n - 1];
    let (first, last) = (time_s[0], time_s[n - 1]);
    let half = (buckets / 2).max(1);
    let linear = (1..=half).map(|k| first + (last - first) * k as f64 / half as f64);
    keep_extremes(time_s, series, linear, &mut kept);
    let start = time_s.partition_point(|&t| t <= origin_s);
    if start + 1 < n {
        let (low, high) = ((time_s[start] - origin_s).ln(), (last - origin_s).ln());
        let logarithmic = (0..=half).map(|k| origin_s + (low + (high - low) * k as f64 / half as f64).exp());
        keep_extremes(time_s, series, logarithmic, &mut kept);
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Adds, for each stretch that ends at one of `ends`, the indices of the extremes of each series.
fn keep_extremes(time_s: &[f64], series: &[&[f64]], ends: impl Iterator<Item = f64>, kept: &mut Vec<usize>) {
    let mut start = 0;
    for end in ends {
        let stop = time_s.partition_point(|&t| t <= end).max(start);
        for values in series {
            let stretch = start..stop;
            kept.extend(stretch.clone().min_by(|&a, &b| values[a].total_cmp(&values[b])));
            kept.extend(stretch.max_by(|&a, &b| values[a].total_cmp(&values[b])));
        }
        start = stop;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_survives_and_ends_are_kept() {
        let time_s: Vec<f64> = (0..50_000).map(|k| k as f64 * 0.1 - 10.0).collect();
        let mut values = vec![0.0; time_s.len()];
        values[31_234] = 1.0;
        values[7] = -1.0;
        let kept = drawn_indices(&time_s, &[&values], 0.0, 100);
        assert!(kept.len() <= 400 + 4, "{}", kept.len());
        assert!(kept.contains(&31_234) && kept.contains(&7));
        assert_eq!((kept[0], *kept.last().unwrap()), (0, time_s.len() - 1));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn short_channels_are_kept_whole() {
        assert_eq!(drawn_indices(&[0.0, 1.0], &[&[1.0, 2.0]], 0.0, 100), vec![0, 1]);
    }
}
