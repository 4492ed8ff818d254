//! Choosing which readings of a long channel are drawn.

/// Readings up to which a drawing keeps all: as many as a panel shows apart, and as most runs have.
pub const ALL_DRAWN: usize = 1000;
/// Stretches of time that the drawn curve of a longer run is thinned over: about 480 points at most.
pub const DRAWN_BUCKETS: usize = 120;

/// Indices (increasing) of the readings that a drawing keeps: all up to [`ALL_DRAWN`]; of more the first, the last, and in
/// each of `buckets` stretches of time the smallest and largest value of every series in `series`.
///
/// Half of the stretches have equal length in time, half equal length in the logarithm of the time since
/// `origin_s`, so that both the fast start and the slow rest of a step response keep their shape, and no
/// peak is lost. Every series must be as long as `time_s`.
pub fn drawn_indices(time_s: &[f64], series: &[&[f64]], origin_s: f64, buckets: usize) -> Vec<usize> {
    let n = time_s.len();
    if n <= ALL_DRAWN.max(4 * buckets) {
        return (0..n).collect();
    }
    let mut kept = Kept::new(n);
    kept.mark(0);
    kept.mark(n - 1);
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
    kept.indices()
}

/// Indices to keep, one bit each.
struct Kept {
    words: Vec<u64>,
}

impl Kept {
    fn new(n: usize) -> Kept {
        Kept {
            words: vec![0; n.div_ceil(64)],
        }
    }

    fn mark(&mut self, index: usize) {
        self.words[index / 64] |= 1 << (index % 64);
    }

    /// The marked indices, increasing.
    fn indices(&self) -> Vec<usize> {
        let mut found = Vec::new();
        for (number, &word) in self.words.iter().enumerate() {
            let mut left = word;
            while left != 0 {
                found.push(number * 64 + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        found
    }
}

/// Adds, for each stretch that ends at one of `ends`, the indices of the extremes of each series.
fn keep_extremes(time_s: &[f64], series: &[&[f64]], ends: impl Iterator<Item = f64>, kept: &mut Kept) {
    let mut start = 0;
    for end in ends {
        let stop = time_s.partition_point(|&t| t <= end).max(start);
        for values in series {
            if let Some((least, most)) = extremes(&values[start..stop]) {
                kept.mark(start + least);
                kept.mark(start + most);
            }
        }
        start = stop;
    }
}

/// Places of the first smallest and the last largest value.
fn extremes(values: &[f64]) -> Option<(usize, usize)> {
    const PART: usize = 64;
    let (mut low, mut high) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
    for (number, part) in values.chunks(PART).enumerate() {
        let (least, most) = range(part);
        if least < low.0 {
            low = (least, number);
        }
        if most >= high.0 {
            high = (most, number);
        }
    }
    let part = |number: usize| &values[number * PART..values.len().min((number + 1) * PART)];
    let first = part(low.1).iter().position(|&v| v == low.0)?;
    let last = part(high.1).iter().rposition(|&v| v == high.0)?;
    Some((low.1 * PART + first, high.1 * PART + last))
}

/// Smallest and largest of the values, in lanes that the compiler turns into vector instructions.
fn range(values: &[f64]) -> (f64, f64) {
    const LANES: usize = 8;
    let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let parts = values.chunks_exact(LANES);
    let rest = parts.remainder();
    for part in parts {
        for lane in 0..LANES {
            least[lane] = if part[lane] < least[lane] {
                part[lane]
            } else {
                least[lane]
            };
            most[lane] = if part[lane] > most[lane] {
                part[lane]
            } else {
                most[lane]
            };
        }
    }
    let low = least.iter().chain(rest).copied().fold(f64::INFINITY, f64::min);
    let high = most.iter().chain(rest).copied().fold(f64::NEG_INFINITY, f64::max);
    (low, high)
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
    fn channels_of_a_thousand_readings_are_kept_whole() {
        for (n, kept) in [(2, 2), (1000, 1000), (1001, 21)] {
            let time_s: Vec<f64> = (0..n).map(f64::from).collect();
            let found = drawn_indices(&time_s, &[&time_s], 0.0, 10);
            assert!(
                found.len() <= kept && (n > 1000 || found.len() == kept),
                "{n}: {}",
                found.len()
            );
        }
    }

    #[test]
    fn extremes_are_the_first_smallest_and_the_last_largest() {
        for n in [1_usize, 5, 64, 65, 200] {
            let values: Vec<f64> = (0..n).map(|k| ((k * 7919) % 13) as f64).collect();
            let least = (0..n).min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap();
            let most = (0..n).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap();
            assert_eq!(extremes(&values), Some((least, most)), "{n}");
        }
        assert_eq!(extremes(&[]), None);
    }
}
