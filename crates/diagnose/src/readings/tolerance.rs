//! What a campaign tolerates, as an error of the model: slow, of a size that the campaign states, another in every run.
//!
//! No model is exact to the last digit of a quiet instrument. Readings are therefore no surer of a law than the campaign asks the
//! simulation to be; otherwise the runs with the least noise would decide alone, by errors that nobody minds.

use crate::readings::group::GroupRun;
use crate::readings::policy::TOLERATED_STEP;

/// Courses of one channel over its readings, smooth over the logarithm of the time since the last edge of the drive: with random
/// coefficients of standard deviation one their sum has a standard deviation of `size` everywhere.
pub(super) fn courses(run: &GroupRun, kind: usize, size: f64) -> Vec<Vec<f64>> {
    let times_s = run.times(kind);
    let (Some(first_s), true) = (times_s.first(), size > 0.0) else {
        return Vec::new();
    };
    let edges_s = run.drive().edges_s();
    let since_s = |t: f64| {
        let before = edges_s.partition_point(|edge_s| *edge_s <= t);
        t - before.checked_sub(1).map_or(*first_s, |last| edges_s[last])
    };
    let steps = times_s.windows(2).map(|pair| pair[1] - pair[0]);
    let shortest_s = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    let place = |t: &f64| (1.0 + since_s(*t).max(0.0) / shortest_s).ln() / TOLERATED_STEP;
    let places: Vec<f64> = times_s.iter().map(place).collect();
    let last = places.iter().copied().fold(0.0, f64::max).ceil() as usize;
    let bell = |knot: usize, place: f64| (-0.5 * (place - knot as f64).powi(2)).exp();
    let whole: Vec<f64> = (places.iter())
        .map(|&place| {
            (0..=last)
                .map(|knot| bell(knot, place).powi(2))
                .sum::<f64>()
                .sqrt()
        })
        .collect();
    let of_knot = |knot: usize| {
        let each = places.iter().zip(&whole);
        each.map(|(&place, whole)| size * bell(knot, place) / whole)
            .collect()
    };
    (0..=last).map(of_knot).collect()
}
