//! The start that was read, held against that of the file.

use ieap_ingest::{Reading, Timestamp};
use jiff::civil::DateTime;

use crate::expected::Expected;
use crate::judge::Fault;

/// The start that was read, held against that of the file.
pub fn start(expected: &Expected, reading: &Reading, is_log: bool) -> Option<Fault> {
    let stamp = reading
        .started_at
        .as_ref()
        .filter(|stamp| stamp.kind == Timestamp::Start)?;
    let local = stamp.local.as_deref()?.parse::<DateTime>().ok()?;
    let local_us = local
        .to_zoned(jiff::tz::TimeZone::UTC)
        .ok()?
        .timestamp()
        .as_microsecond();
    let said = format!("{local} from {:?}, {}", stamp.raw, stamp.basis);
    let Some(true_us) = expected.start_us else {
        return Some(("a start is read that the file does not state".to_owned(), said));
    };
    let offset = stamp.offset.as_deref().map(minutes);
    let shift = match (expected.offset_min, offset) {
        (Some(_), None) if expected.is_stamped => 0,
        (Some(_), None) => return Some(("the offset from UTC is lost".to_owned(), said)),
        (Some(stated), Some(read)) => read - stated,
        (None, Some(read)) => read,
        (None, None) => 0,
    };
    let late_s = (local_us - true_us) as f64 / 1e6 - f64::from(shift) * 60.0;
    let kind = if is_log { "log" } else { "run" };
    (late_s.abs() > 1.0).then(|| {
        (
            format!("the start of a {kind} is wrong"),
            format!("by {late_s} s: {said}"),
        )
    })
}

/// `+02:00` or `Z` in minutes.
fn minutes(text: &str) -> i32 {
    let digits: Vec<i32> = text
        .chars()
        .filter_map(|c| c.to_digit(10))
        .map(|d| d as i32)
        .collect();
    let size = match digits[..] {
        [h1, h2, m1, m2, ..] => (h1 * 10 + h2) * 60 + m1 * 10 + m2,
        [h1, h2] => (h1 * 10 + h2) * 60,
        _ => 0,
    };
    if text.starts_with('-') { -size } else { size }
}
