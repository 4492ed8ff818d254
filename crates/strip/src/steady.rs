//! The steady course of what is read along the strip: running medians.

use super::ground::median;

/// Median over `window` places to either side, found at every few places and straight between them; NaNs are left out.
///
/// At the ends, where places to one side are missing, a median stands for the middle of those that there are, and the
/// course goes on as it came: light falls and strips taper there as elsewhere.
pub fn running_median(values: &[f64], window: usize) -> Vec<f64> {
    let n = values.len();
    let nodes = nodes(values, window);
    let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else {
        return vec![0.0; n];
    };
    let far = 0.75 * window as f64;
    let slope =
        |from: (f64, f64), to: Option<&(f64, f64)>| to.map_or(0.0, |to| (to.1 - from.1) / (to.0 - from.0));
    let before = slope(first, nodes.iter().find(|node| node.0 >= first.0 + far));
    let after = slope(last, nodes.iter().rfind(|node| node.0 <= last.0 - far));
    let mut next = 0;
    (0..n)
        .map(|k| {
            let k = k as f64;
            while next < nodes.len() && nodes[next].0 < k {
                next += 1;
            }
            let reach = window as f64;
            match (next.checked_sub(1).map(|before| nodes[before]), nodes.get(next)) {
                (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (k - a.0) / (b.0 - a.0),
                (None, _) => first.1 + before * (k - first.0).max(-reach),
                (_, None) => last.1 + after * (k - last.0).min(reach),
            }
        })
        .collect()
}

/// Medians and the places for which they stand, in order.
fn nodes(values: &[f64], window: usize) -> Vec<(f64, f64)> {
    let n = values.len();
    let step = (window / 4).max(1);
    let mut nodes: Vec<(f64, f64)> = Vec::new();
    let mut room = Vec::with_capacity(2 * window + 1);
    for at in (0..n).step_by(step).chain([n.saturating_sub(1)]) {
        let range = at.saturating_sub(window)..(at + window + 1).min(n);
        room.clear();
        let mut places = 0.0;
        for k in range.filter(|&k| values[k].is_finite()) {
            room.push(values[k]);
            places += k as f64;
        }
        let place = places / room.len().max(1) as f64;
        if !room.is_empty() && nodes.last().is_none_or(|last| place > last.0 + 0.5) {
            nodes.push((place, median(&mut room)));
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_kept_up_to_the_ends_and_a_gap_is_bridged() {
        let mut values: Vec<f64> = (0..200).map(|k| 3.0 + 0.01 * f64::from(k)).collect();
        values[80..120].fill(f64::NAN);
        // A few that are far off do not matter.
        values[20..23].fill(90.0);
        for (k, value) in running_median(&values, 16).iter().enumerate() {
            let truth = 3.0 + 0.01 * k as f64;
            assert!((value - truth).abs() < 0.06, "{k}: {value} for {truth}");
        }
    }

    #[test]
    fn of_nothing_it_is_nought() {
        assert_eq!(running_median(&[f64::NAN; 5], 3), [0.0; 5]);
    }
}
