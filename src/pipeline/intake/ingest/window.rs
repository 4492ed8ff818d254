//! From when to when a run was measured.

use jiff::Timestamp as Moment;

use crate::analysis::climate::Window;
use crate::domain::RunRecord;
use crate::domain::tag::keys;

/// A run on UTC: from its start, for as long as its readings last; none without a start.
pub fn run_window(run: &RunRecord) -> Option<Window> {
    let firsts = run.channels.iter().filter_map(|channel| channel.first_time_s);
    let lasts = run.channels.iter().filter_map(|channel| channel.last_time_s);
    let times = (
        firsts.fold(f64::INFINITY, f64::min),
        lasts.fold(f64::NEG_INFINITY, f64::max),
    );
    window(run.tag(keys::STARTED_AT), Some(times))
}

/// The window of a run that started then and whose readings have these first and last times, s.
pub(super) fn window(started_at: Option<&str>, times: Option<(f64, f64)>) -> Option<Window> {
    let start = started_at?.parse::<Moment>().ok()?.as_millisecond() as f64 / 1000.0;
    let (first_s, last_s) = times?;
    let length_s = last_s - first_s;
    (length_s.is_finite() && length_s >= 0.0).then_some(Window {
        from_s: start,
        to_s: start + length_s,
    })
}
