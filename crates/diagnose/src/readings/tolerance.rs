//! What a campaign tolerates, as an error of the model: slow, of a size that the campaign states, another in every run.
//!
//! No model is exact to the last digit of a quiet instrument. Readings are therefore no surer of a law than the campaign asks the
//! simulation to be; otherwise the runs with the least noise would decide alone, by errors that nobody minds. What is tolerated is
//! small in every measure: of the range of a channel, and of the charge that passes, of which a leak far below the first peak of a
//! current can be a third.

use crate::readings::group::GroupRun;
use crate::readings::policy::TOLERATED_STEP;

/// Courses of one channel over its readings, smooth over the logarithm of the time since the last edge of the drive: with random
/// coefficients of standard deviation one their sum has a standard deviation of `part` of the channel's range everywhere, and less
/// where one course would carry that part of a charge, `most`; 0 where none is asked.
pub(super) fn courses(run: &GroupRun, kind: usize, part: f64, range: f64, most: f64) -> Vec<Vec<f64>> {
    let (size, most) = (part * range, part * most);
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
        let course: Vec<f64> = each
            .map(|(&place, whole)| size * bell(knot, place) / whole)
            .collect();
        let carried = passed(times_s, &course).last().unwrap_or(0.0);
        // Of two independent bounds of one coefficient the variances add inversely.
        let kept = if most > 0.0 {
            most / most.hypot(carried)
        } else {
            1.0
        };
        course.iter().map(|v| kept * v).collect()
    };
    (0..=last).map(of_knot).collect()
}

/// Integral of values over their times up to each reading from the second: charge, C, of a current, A.
pub(crate) fn passed(times_s: &[f64], values: &[f64]) -> impl Iterator<Item = f64> {
    let spans = times_s.windows(2).zip(values.windows(2));
    spans.scan(0.0, |sum, (t, v)| {
        *sum += 0.5 * (t[1] - t[0]) * (v[0] + v[1]);
        Some(*sum)
    })
}

/// Largest charge on the way through a run, C; 0 without a current.
pub(crate) fn most_charge(run: &GroupRun) -> f64 {
    let Some(channel) = &run.channels[0] else {
        return 0.0;
    };
    let charges = passed(run.times(0), channel.values());
    charges.fold(0.0, |most: f64, charge| most.max(charge.abs()))
}
