//! One series from several files of the same sensor: what stands in two of them counts once.

/// Readings of one file, on UTC.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece<'a> {
    /// Time of each reading, s since 1970 UTC, increasing.
    pub times_s: &'a [f64],
    /// Readings.
    pub values: &'a [f64],
    /// Time between most of them, s.
    pub interval_s: f64,
    /// Hash of the file's readings: decides between files that begin and end together.
    pub hash: &'a str,
}

/// The readings of all pieces in the order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Merged {
    /// Time of each reading, s since 1970 UTC, increasing.
    pub times_s: Vec<f64>,
    /// Readings.
    pub values: Vec<f64>,
    /// Readings of the same second that differ between files.
    pub conflicts: usize,
}

/// Merges pieces. The file that begins first counts (then the longer one); of another one only the readings are added
/// that have none beside them within half an interval, so that gaps are filled and nothing counts twice. The order of
/// `pieces` does not matter.
pub fn merged(mut pieces: Vec<Piece<'_>>) -> Merged {
    pieces.retain(|piece| !piece.times_s.is_empty());
    pieces.sort_by(|a, b| {
        let ends = |piece: &Piece<'_>| (piece.times_s[0], -piece.times_s[piece.times_s.len() - 1]);
        let ((a0, a1), (b0, b1)) = (ends(a), ends(b));
        a0.total_cmp(&b0)
            .then(a1.total_cmp(&b1))
            .then_with(|| a.hash.cmp(b.hash))
    });
    let mut all = Merged::default();
    let mut interval_s = f64::INFINITY;
    for piece in &pieces {
        interval_s = interval_s.min(piece.interval_s);
        let from = all
            .times_s
            .partition_point(|&t| t < piece.times_s[0] - interval_s);
        let (times, values) = (all.times_s.split_off(from), all.values.split_off(from));
        add(&mut all, (&times, &values), piece, 0.5 * interval_s);
    }
    all
}

/// Appends `kept` and, of `piece`, what lies farther than `apart_s` from any of `kept`.
fn add(all: &mut Merged, kept: (&[f64], &[f64]), piece: &Piece<'_>, apart_s: f64) {
    let (times, values) = kept;
    let mut at = 0;
    for (&time, &value) in piece.times_s.iter().zip(piece.values) {
        while at < times.len() && times[at] <= time {
            all.times_s.push(times[at]);
            all.values.push(values[at]);
            at += 1;
        }
        let before = at.checked_sub(1).map(|k| (time - times[k], values[k]));
        let after = times.get(at).map(|t| (t - time, values[at]));
        let near = [before, after]
            .into_iter()
            .flatten()
            .filter(|(distance, _)| *distance < apart_s.max(1e-3));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            None => {
                all.times_s.push(time);
                all.values.push(value);
            }
            Some((distance, other)) if distance <= 1.0 && (other - value).abs() > 1e-6 => all.conflicts += 1,
            Some(_) => {}
        }
    }
    all.times_s.extend_from_slice(&times[at..]);
    all.values.extend_from_slice(&values[at..]);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn piece<'a>(times_s: &'a [f64], values: &'a [f64], hash: &'a str) -> Piece<'a> {
        Piece {
            times_s,
            values,
            interval_s: 60.0,
            hash,
        }
    }

    #[test]
    fn a_logger_read_out_twice_counts_once() {
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) * 60.0).collect();
        let values: Vec<f64> = (0..100).map(f64::from).collect();
        let first = piece(&times[..60], &values[..60], "a");
        let second = piece(&times, &values, "b");
        let all = merged(vec![first, second]);
        assert_eq!((all.times_s.as_slice(), all.conflicts), (times.as_slice(), 0));
    }

    #[test]
    fn gaps_are_filled_and_contradictions_counted() {
        let (times_a, values_a) = ([0.0, 60.0, 600.0], [1.0, 2.0, 3.0]);
        let (times_b, values_b) = ([60.0, 120.0, 610.0], [9.0, 5.0, 7.0]);
        let all = merged(vec![
            piece(&times_a, &values_a, "a"),
            piece(&times_b, &values_b, "b"),
        ]);
        assert_eq!(all.times_s, [0.0, 60.0, 120.0, 600.0]);
        assert_eq!(all.values, [1.0, 2.0, 5.0, 3.0]);
        assert_eq!(all.conflicts, 1);
    }

    proptest! {
        #[test]
        fn the_order_of_files_does_not_count(starts in prop::collection::vec((0u32..2000, 1usize..60), 1..7), turn in 0usize..7) {
            let series: Vec<(Vec<f64>, Vec<f64>, String)> = starts
                .iter()
                .enumerate()
                .map(|(k, (start, count))| {
                    let times: Vec<f64> = (0..*count).map(|i| f64::from(*start) + 60.0 * i as f64).collect();
                    let values = times.iter().map(|t| t.sin() + k as f64).collect();
                    (times, values, k.to_string())
                })
                .collect();
            let mut pieces: Vec<Piece<'_>> = series.iter().map(|(t, v, h)| piece(t, v, h)).collect();
            let all = merged(pieces.clone());
            pieces.rotate_left(turn % series.len());
            pieces.reverse();
            prop_assert_eq!(&all, &merged(pieces));
            prop_assert!(all.times_s.windows(2).all(|pair| pair[1] > pair[0]));
            prop_assert_eq!(all.times_s.len(), all.values.len());
        }
    }
}
