//! Thinning for drawing: fewer points, the same picture. No peak is lost.

use ieap_domain::thinning::ALL_DRAWN;

/// Dots that a column of a thinned panel keeps: the smallest, the largest, and the one in the middle of its time.
const OF_A_COLUMN: usize = 3;
/// How far a thinned line may lie from the full one, px.
const TOLERANCE: f64 = 0.4;

/// Pixels per unit of a panel's positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixels {
    /// To the right.
    pub across: f64,
    /// Upward.
    pub up: f64,
}

/// The points that are drawn as dots: all of them up to a thousand; of more as many by their shape, in every column of a
/// pixel or two the first of the smallest, the first of the largest and the one in the middle of its time, for extremes
/// alone look as if readings shunned what is between. `points` go from left to right.
pub fn dots(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    if points.len() <= ALL_DRAWN {
        return points.to_vec();
    }
    let width = (last.0 - first.0) / (ALL_DRAWN / OF_A_COLUMN) as f64;
    let column = |point: &(f64, f64)| ((point.0 - first.0) / width).floor();
    let mut kept = Vec::new();
    for stretch in points.chunk_by(|a, b| column(a) == column(b)) {
        let mut ends = [stretch[0]; 2];
        for &point in stretch {
            if point.1 < ends[0].1 {
                ends[0] = point;
            }
            if point.1 > ends[1].1 {
                ends[1] = point;
            }
        }
        let mut drawn = [ends[0], stretch[stretch.len() / 2], ends[1]];
        drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend_from_slice(&drawn);
        kept.dedup();
    }
    kept
}

/// The corners that a line needs to lie within four tenths of a pixel of the full one (Douglas and Peucker 1973).
pub fn line(points: &[(f64, f64)], pixels: Pixels) -> Vec<(f64, f64)> {
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let at = |k: usize| (points[k].0 * pixels.across, points[k].1 * pixels.up);
    let mut keep = vec![false; points.len()];
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|k| (distance(at(k), at(from), at(to)), k))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, k)) = farthest.filter(|(far, _)| *far > TOLERANCE) {
            keep[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of `p` from the stretch between `a` and `b`.
fn distance(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 {
        (((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p.0 - a.0 - along * dx).hypot(p.1 - a.1 - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PIXELS: Pixels = Pixels {
        across: 100.0,
        up: 50.0,
    };

    fn rising(values: &[f64]) -> Vec<(f64, f64)> {
        let at = |(k, value): (usize, &f64)| (k as f64 * 0.004, *value);
        values.iter().enumerate().map(at).collect()
    }

    proptest! {
        #[test]
        fn a_thousand_readings_are_all_drawn(values in prop::collection::vec(-5.0..5.0f64, 0..1000)) {
            let all = rising(&values);
            prop_assert_eq!(dots(&all), all);
        }

        #[test]
        fn of_more_the_extremes_and_the_order_stay(values in prop::collection::vec(-5.0..5.0f64, 1001..4000)) {
            let all = rising(&values);
            let kept = dots(&all);
            prop_assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
            prop_assert!(kept.len() <= ALL_DRAWN + OF_A_COLUMN);
            for end in [f64::min, f64::max] {
                let of = |points: &[(f64, f64)]| points.iter().map(|point| point.1).reduce(end);
                prop_assert_eq!(of(&kept), of(&all));
            }
        }

        #[test]
        fn a_thinned_line_stays_near_every_point(values in prop::collection::vec(-5.0..5.0f64, 2..200)) {
            let all = rising(&values);
            let kept = line(&all, PIXELS);
            let pixels = |p: (f64, f64)| (p.0 * PIXELS.across, p.1 * PIXELS.up);
            for point in &all {
                let near = kept.windows(2).map(|pair| distance(pixels(*point), pixels(pair[0]), pixels(pair[1])));
                prop_assert!(near.fold(f64::INFINITY, f64::min) <= TOLERANCE + 1e-9);
            }
        }
    }

    #[test]
    fn a_smooth_curve_needs_few_corners() {
        let decay: Vec<f64> = (0..450).map(|k| 3.0 * (-f64::from(k) / 40.0).exp()).collect();
        let kept = line(&rising(&decay), PIXELS);
        assert!((3..30).contains(&kept.len()), "{}", kept.len());
    }
}
