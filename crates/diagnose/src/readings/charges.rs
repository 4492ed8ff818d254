//! Charge that a current carries.

use crate::readings::group::GroupRun;

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
