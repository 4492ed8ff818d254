//! From a logger's clock to UTC: by the offset that is stated, or by the campaign's time zone.
//!
//! Where only the zone is known, the readings themselves show whether the clock followed its changes: it ran through
//! the hour that comes twice without going back, or through the hour that never comes, or it did not. A clock that did
//! not follow keeps the offset of its first reading. Readings in an hour that comes twice, with nothing to show which
//! one is meant, are left out.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use ieap_domain::{Issue, LogSeries};

/// What is known of the time zone of a logger's clock, strongest first.
#[derive(Debug, Clone, PartialEq)]
pub enum Clock {
    /// An offset from UTC, s, with where it is stated.
    Fixed {
        /// Offset, s.
        offset_s: f64,
        /// `the file`, `campaign.toml`.
        stated_in: &'static str,
    },
    /// The campaign's time zone.
    Zone(TimeZone),
    /// Nothing: the readings cannot be placed in time.
    Unknown,
}

/// Readings on UTC.
#[derive(Debug, Clone, PartialEq)]
pub struct OnUtc {
    /// Time of each reading, s since 1970 UTC; NaN for those left out.
    pub times_s: Vec<f64>,
    /// What the clock was taken for, in words.
    pub words: String,
    /// What to know of it.
    pub issues: Vec<Issue>,
}

/// A change of the zone's offset.
struct Change {
    at_s: f64,
    before_s: f64,
    after_s: f64,
}

/// What the readings show of a clock at one change.
#[derive(PartialEq)]
enum Shown {
    Followed,
    RanThrough,
    Nothing,
}

/// The times of `elapsed_s` (s since the log's first row) on UTC; none where the clock's zone is not known.
pub fn on_utc(series: &LogSeries, elapsed_s: &[f64], clock: &Clock) -> Option<OnUtc> {
    match clock {
        Clock::Unknown => None,
        Clock::Fixed { offset_s, stated_in } => Some(OnUtc {
            times_s: elapsed_s
                .iter()
                .map(|e| series.clock_start_s + e - offset_s)
                .collect(),
            words: format!("{} (stated in {stated_in})", offset_in_words(*offset_s)),
            issues: Vec::new(),
        }),
        Clock::Zone(zone) => Some(in_zone(series, elapsed_s, zone)),
    }
}

fn in_zone(series: &LogSeries, elapsed_s: &[f64], zone: &TimeZone) -> OnUtc {
    let name = zone.iana_name().unwrap_or("the campaign's time zone").to_owned();
    let shown_s = |elapsed: f64| series.clock_start_s + elapsed - set_back_before(series, elapsed);
    let first_s = first_offset_s(series.clock_start_s, zone);
    let last = elapsed_s.last().copied().unwrap_or(0.0);
    let changes = changes_between(zone, series.clock_start_s - first_s, shown_s(last));
    let shown: Vec<Shown> = changes
        .iter()
        .map(|change| shown_at(change, series, elapsed_s, &shown_s))
        .collect();
    if let Some(at) = shown.iter().position(|shown| *shown == Shown::RanThrough) {
        let message = format!(
            "the clock did not follow the change of the clocks on {}: its readings run through it. The offset of its \
             first reading, {}, is taken for all",
            date(changes[at].at_s),
            offset_in_words(first_s)
        );
        return OnUtc {
            times_s: elapsed_s
                .iter()
                .map(|e| series.clock_start_s + e - first_s)
                .collect(),
            words: format!(
                "{} ({name} at the first reading; did not follow summer time)",
                offset_in_words(first_s)
            ),
            issues: vec![
                Issue::note("clock-without-summer-time", message)
                    .at(&series.path)
                    .mend("state the sensor's utc_offset in campaign.toml if another one holds"),
            ],
        };
    }
    let mut left_out = 0usize;
    let mut next = 0usize;
    let mut times_s = Vec::with_capacity(elapsed_s.len());
    for &elapsed in elapsed_s {
        let local = shown_s(elapsed);
        while changes
            .get(next)
            .is_some_and(|c| local >= c.at_s + c.before_s.max(c.after_s))
        {
            next += 1;
        }
        let offset_s = match changes.get(next) {
            Some(change) if change.after_s < change.before_s && local >= change.at_s + change.after_s => {
                match (&shown[next], set_back_near(change, series)) {
                    (Shown::Followed, Some(at)) if elapsed >= at => change.after_s,
                    (Shown::Followed, Some(_)) => change.before_s,
                    _ => {
                        left_out += 1;
                        f64::NAN
                    }
                }
            }
            Some(change) => change.before_s,
            None => changes.last().map_or(first_s, |change| change.after_s),
        };
        times_s.push(local - offset_s);
    }
    let mut issues = Vec::new();
    if left_out > 0 {
        let message = format!(
            "{left_out} readings lie in the hour that came twice in {name}, and nothing shows which one: left out"
        );
        issues.push(
            Issue::warning("clock-ambiguous", message)
                .at(&series.path)
                .mend("state the sensor's utc_offset in campaign.toml"),
        );
    }
    OnUtc {
        times_s,
        words: format!("{name} (campaign.toml)"),
        issues,
    }
}

/// What the readings show at one change of the zone's offset.
fn shown_at(change: &Change, series: &LogSeries, elapsed_s: &[f64], shown_s: &impl Fn(f64) -> f64) -> Shown {
    let (low, high) = (
        change.at_s + change.before_s.min(change.after_s),
        change.at_s + change.before_s.max(change.after_s),
    );
    let goes_back = change.after_s < change.before_s;
    if goes_back && set_back_near(change, series).is_some() {
        return Shown::Followed;
    }
    let from = elapsed_s.partition_point(|&e| shown_s(e) < low);
    let to = elapsed_s.partition_point(|&e| shown_s(e) < high);
    let dense = series.interval_s <= high - low;
    let (before, after) = (
        from.checked_sub(1).map(|k| elapsed_s[k]),
        elapsed_s.get(to).copied(),
    );
    let steps = |first: f64, last: f64| last - first <= (high - low) + 2.5 * series.interval_s;
    match (before, after) {
        // Readings in that hour, and right before and after it.
        (Some(before), Some(after)) if to > from && dense && steps(before, after) => Shown::RanThrough,
        (Some(before), Some(after)) if to == from && !goes_back && dense && steps(before, after) => {
            Shown::Followed
        }
        _ if to > from && !goes_back => Shown::RanThrough,
        _ => Shown::Nothing,
    }
}

/// When the clock was set back about that change, s since the log's first row.
fn set_back_near(change: &Change, series: &LogSeries) -> Option<f64> {
    let near = |elapsed: f64| {
        let local = series.clock_start_s + elapsed - set_back_before(series, elapsed);
        (local - (change.at_s + change.after_s)).abs() <= 2.0 * 3600.0
    };
    series
        .clock_set_back
        .iter()
        .map(|(at, _)| *at)
        .find(|at| near(*at))
}

/// By how much the clock had been set back in all at that time, s.
fn set_back_before(series: &LogSeries, elapsed: f64) -> f64 {
    let before = series.clock_set_back.iter().filter(|(at, _)| *at <= elapsed);
    before.map(|(_, by)| by).sum()
}

fn changes_between(zone: &TimeZone, from_s: f64, to_s: f64) -> Vec<Change> {
    let day = 86_400.0;
    let Ok(start) = Timestamp::from_second((from_s - day) as i64) else {
        return Vec::new();
    };
    let mut before_s = f64::from(zone.to_offset(start).seconds());
    let mut changes = Vec::new();
    for transition in zone.following(start) {
        let at_s = transition.timestamp().as_second() as f64;
        if at_s > to_s + day {
            break;
        }
        let after_s = f64::from(transition.offset().seconds());
        if after_s != before_s {
            changes.push(Change {
                at_s,
                before_s,
                after_s,
            });
        }
        before_s = after_s;
    }
    // What ended before the first reading says nothing of this clock.
    changes.retain(|change| change.at_s >= from_s);
    changes
}

/// Offset of the zone at a local time, s.
fn first_offset_s(local_s: f64, zone: &TimeZone) -> f64 {
    let local = Timestamp::from_second(local_s as i64).map(|t| TimeZone::UTC.to_datetime(t));
    let offset = local.ok().and_then(|local: DateTime| zone.to_zoned(local).ok());
    offset.map_or(0.0, |zoned| f64::from(zoned.offset().seconds()))
}

fn date(at_s: f64) -> String {
    Timestamp::from_second(at_s as i64).map_or_else(|_| String::new(), |t| t.strftime("%Y-%m-%d").to_string())
}

fn offset_in_words(offset_s: f64) -> String {
    let minutes = (offset_s.abs() / 60.0).round() as i64;
    let sign = if offset_s < 0.0 { '-' } else { '+' };
    format!("UTC{sign}{:02}:{:02}", minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::ClimateQuantity;

    fn seconds(text: &str) -> f64 {
        text.parse::<Timestamp>().unwrap().as_second() as f64
    }

    fn log(clock_start: &str, interval_s: f64, set_back: Vec<(f64, f64)>) -> LogSeries {
        LogSeries {
            log_id: 1,
            ordinal: 0,
            path: "ambient/a.csv".into(),
            data_hash: String::new(),
            sensor: "a".into(),
            quantity: ClimateQuantity::Temperature,
            not_used: None,
            readings: 0,
            interval_s,
            clock_start_s: seconds(&format!("{clock_start}Z")),
            first_s: 0.0,
            length_s: 0.0,
            clock_offset: None,
            clock_set_back: set_back,
        }
    }

    fn tallinn() -> Clock {
        Clock::Zone(TimeZone::get("Europe/Tallinn").unwrap())
    }

    fn every(interval_s: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| k as f64 * interval_s).collect()
    }

    #[test]
    fn a_clock_that_goes_back_gives_even_steps() {
        // 02:00 to 04:50 summer time, then 04:00 was 03:00: readings every 10 minutes.
        let series = log("2026-10-25T02:00:00", 600.0, vec![(7200.0, 3600.0)]);
        let found = on_utc(&series, &every(600.0, 30), &tallinn()).unwrap();
        assert_eq!(found.times_s[0], seconds("2026-10-24T23:00:00Z"));
        assert!(
            found.times_s.windows(2).all(|pair| pair[1] - pair[0] == 600.0),
            "{found:?}"
        );
        assert!(found.issues.is_empty());
    }

    #[test]
    fn a_clock_that_ran_through_keeps_its_first_offset() {
        for start in ["2026-10-25T00:00:00", "2026-03-29T00:00:00"] {
            let series = log(start, 600.0, vec![]);
            let found = on_utc(&series, &every(600.0, 60), &tallinn()).unwrap();
            assert!(
                found.times_s.windows(2).all(|pair| pair[1] - pair[0] == 600.0),
                "{start}"
            );
            assert_eq!(found.issues[0].code, "clock-without-summer-time", "{start}");
        }
    }

    #[test]
    fn a_clock_that_jumps_in_spring_followed() {
        // 02:50, then 04:00.
        let series = log("2026-03-29T02:00:00", 600.0, vec![]);
        let elapsed: Vec<f64> = every(600.0, 12)
            .into_iter()
            .map(|e| if e < 3600.0 { e } else { e + 3600.0 })
            .collect();
        let found = on_utc(&series, &elapsed, &tallinn()).unwrap();
        assert!(
            found.times_s.windows(2).all(|pair| pair[1] - pair[0] == 600.0),
            "{found:?}"
        );
    }

    #[test]
    fn what_may_be_either_hour_is_left_out() {
        // Every two hours: one reading falls into the hour that comes twice.
        let series = log("2026-10-25T01:30:00", 7200.0, vec![]);
        let found = on_utc(&series, &every(7200.0, 4), &tallinn()).unwrap();
        assert_eq!(
            found.times_s.iter().filter(|t| t.is_nan()).count(),
            1,
            "{found:?}"
        );
        assert_eq!(found.issues[0].code, "clock-ambiguous");
    }

    #[test]
    fn stated_offsets_hold_and_nothing_is_guessed() {
        let series = log("2026-10-25T02:00:00", 600.0, vec![]);
        let fixed = Clock::Fixed {
            offset_s: 7200.0,
            stated_in: "the file",
        };
        assert_eq!(
            on_utc(&series, &[0.0], &fixed).unwrap().times_s,
            [seconds("2026-10-25T00:00:00Z")]
        );
        assert_eq!(on_utc(&series, &[0.0], &Clock::Unknown), None);
    }
}
