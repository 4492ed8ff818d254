//! Clocks of waveforms and moments: when each channel started, and the one clock on which a file's waveforms stand.

use jiff::ToSpan;
use jiff::civil::{Date, DateTime};

use super::cursor::TimeStamp;
use super::segments::{Object, Property};
use crate::formats::policy::SAME_TIME_SHARE;
use crate::formats::stamp;
use crate::{StartedAt, Timestamp};
use ieap_domain::Issue;

/// Property with the moment at which a waveform's clock started.
const START: &str = "wf_start_time";

/// How a waveform was sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// The moment at which its clock started; none where nobody set one.
    pub start: Option<TimeStamp>,
    /// Time of the first value on that clock, s.
    offset_s: f64,
    /// Time between two values, s.
    increment_s: f64,
}

impl Sampling {
    /// The sampling that an object states; none where it is no waveform.
    pub fn of(object: &Object) -> Option<Sampling> {
        let number = |name| match object.property(name) {
            Some(Property::Number(number)) => Some(*number),
            _ => None,
        };
        Some(Sampling {
            start: start(object),
            offset_s: number("wf_start_offset").unwrap_or(0.0),
            increment_s: number("wf_increment").filter(|increment| *increment > 0.0)?,
        })
    }

    /// Time of the first value on its own clock, and between two values, s: the same for channels of the same rows.
    pub fn rows(self) -> (f64, f64) {
        (self.offset_s, self.increment_s)
    }

    /// Whether values of both were taken at the same times.
    pub fn is_that_of(self, other: Sampling) -> bool {
        let is_together = match (self.start, other.start) {
            (Some(a), Some(b)) => self.is_now(a, b),
            (a, b) => a == b,
        };
        self.rows() == other.rows() && is_together
    }

    /// Whether two moments are one at this sampling: LabVIEW rounds the starts of one clock apart.
    fn is_now(self, a: TimeStamp, b: TimeStamp) -> bool {
        a.seconds_after(b).abs() <= SAME_TIME_SHARE * self.increment_s
    }

    /// Times of the first `rows` values, s, on a clock that starts at `zero`; without a start, on its own clock.
    pub fn times_s(self, zero: Option<TimeStamp>, rows: usize) -> Vec<f64> {
        let apart = self
            .start
            .zip(zero)
            .filter(|(start, zero)| !self.is_now(*start, *zero));
        let later_s = apart.map_or(0.0, |(start, zero)| start.seconds_after(zero));
        let first_s = later_s + self.offset_s;
        (0..rows)
            .map(|row| first_s + row as f64 * self.increment_s)
            .collect()
    }
}

/// The moments at which the waveforms of a file started.
#[derive(Debug, Clone, Copy, Default)]
pub struct Starts {
    /// The earliest of them: zero of the clock of all.
    pub zero: Option<TimeStamp>,
    /// Whether there is another one.
    differ: bool,
}

impl Starts {
    /// Adds the start of a waveform.
    pub fn add(&mut self, sampling: Sampling) {
        let Some(start) = sampling.start else { return };
        self.differ |= self.zero.is_some_and(|zero| !sampling.is_now(start, zero));
        self.zero = Some(self.zero.map_or(start, |zero| zero.min(start)));
    }

    /// Whether a waveform can be placed on the clock of the file: its start is known, or is that of all others.
    pub fn place(self, sampling: Sampling) -> bool {
        sampling.start.is_some() || !self.differ
    }
}

/// The start of the file: that of its waveforms' clock and those of `others` where they are one moment; where there is
/// none, moments of the file or a group that speak of a start by their name.
pub fn started_at(
    objects: &[Object],
    starts: Starts,
    others: impl Iterator<Item = TimeStamp>,
    issues: &mut Vec<Issue>,
) -> Option<StartedAt> {
    let of_waveforms = starts.zero.into_iter().chain(others);
    let of_waveforms: Vec<StartedAt> = of_waveforms.filter_map(|start| stamp_of(start, START)).collect();
    if !of_waveforms.is_empty() {
        return stamp::shared(of_waveforms, issues);
    }
    let is_whole = |object: &&Object| object.names().is_none();
    let moments = objects.iter().filter(is_whole).flat_map(|object| {
        let named = object.properties.iter().filter(|(name, _)| names_start(name));
        named.filter_map(|(name, _)| stamp_of(moment(object, name)?, name))
    });
    stamp::shared(moments.collect::<Vec<_>>(), issues)
}

/// The moment at which the clock of a channel started; none where nobody set one.
pub fn start(object: &Object) -> Option<TimeStamp> {
    moment(object, START)
}

/// `DateTime`, `Start Time`, `Timestamp`, but no moment of an end or a change.
fn names_start(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let is_other = ["end", "stop", "modif", "saved", "calib", "trigger"]
        .iter()
        .any(|word| name.contains(word));
    !is_other && ["start", "date", "time"].iter().any(|word| name.contains(word))
}

/// The moment of a property; the zero of LabVIEW's clock, which stands where nobody set one, is none.
fn moment(object: &Object, property: &str) -> Option<TimeStamp> {
    match object.property(property) {
        Some(Property::Time(time)) if time.seconds != 0 && civil(*time).is_some() => Some(*time),
        _ => None,
    }
}

fn stamp_of(time: TimeStamp, property: &str) -> Option<StartedAt> {
    Some(StartedAt {
        raw: format!("{} s since 1904-01-01 UTC", time.seconds as f64 + time.fraction()),
        kind: Timestamp::Start,
        local: Some(civil(time)?.to_string()),
        offset: Some("+00:00".to_owned()),
        basis: format!("{property} counts UTC seconds"),
    })
}

/// UTC to the millisecond; none for moments that no clock shows.
pub fn civil(time: TimeStamp) -> Option<DateTime> {
    let epoch = Date::new(1904, 1, 1)
        .ok()?
        .to_datetime(jiff::civil::Time::midnight());
    if !(0..=100_000_000_000).contains(&time.seconds) {
        return None;
    }
    let milliseconds = (time.fraction() * 1000.0).round() as i64;
    let seconds = epoch.checked_add(time.seconds.seconds()).ok()?;
    seconds.checked_add(milliseconds.milliseconds()).ok()
}
