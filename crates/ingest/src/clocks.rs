//! The clocks of a run whose readings come from several instruments, and the offsets between them.
//!
//! Offsets are found and shown. Only one that a person states (the tag `clock_offset_s`) changes times: the start
//! moments of two files are printed by two computers whose clocks may differ by more than their digits, and the onset
//! of bending lags the voltage by what the strip itself needs, which is what a fit is to find out.

mod onset;
mod policy;

use crate::clocks::policy::{OFF_BY_HEADER_S, OFF_SIGMAS};
use crate::drive;
use ieap_domain::number::{digits, fixed, measured};
use ieap_domain::{
    Channel, ClockOffset, Edge, Issue, OffsetSource, Quantity, RunOrigin, Segment, StartedAt, Timestamp,
};

/// What one file of a run gives.
#[derive(Debug, Clone, Copy)]
pub struct FileClock<'a> {
    /// Channels that the file times.
    pub channels: &'a [Channel],
    /// The moment that the file states.
    pub stamp: Option<&'a StartedAt>,
    /// Whether its time zero is the voltage step by the format's own contract.
    pub time_zero_is_step: bool,
}

/// The clock that the others are held against: that of the voltage, else of the current, else the first.
pub fn reference(files: &[FileClock<'_>]) -> usize {
    let holds = |quantity| {
        files
            .iter()
            .position(|file| file.channels.iter().any(|channel| channel.is_whole(quantity)))
    };
    holds(Quantity::Voltage)
        .or_else(|| holds(Quantity::Current))
        .unwrap_or(0)
}

/// Offsets of every clock but the reference, from the start moments and from the data; those that cannot be had say
/// why.
pub fn offsets(files: &[FileClock<'_>]) -> Vec<ClockOffset> {
    let reference = reference(files);
    let others = (0..files.len()).filter(|&clock| clock != reference);
    others
        .flat_map(|clock| {
            let (held_against, file) = (&files[reference], &files[clock]);
            [
                found(clock, OffsetSource::Header, from_starts(held_against, file)),
                found(clock, OffsetSource::Estimated, from_onset(held_against, file)),
            ]
        })
        .collect()
}

/// What a reader must know of the offsets: those that differ clearly from what is in use, and a tag without effect.
pub fn remarks(origin: &RunOrigin, stated_s: Option<f64>) -> Vec<Issue> {
    let mut issues = Vec::new();
    if stated_s.is_some() && origin.clocks.len() < 2 {
        let message = "the run has one clock only, so the stated offset changes nothing";
        issues.push(Issue::warning("clock-offset-unused", message).at("clock_offset_s"));
    }
    let in_use = stated_s.unwrap_or(0.0);
    for offset in &origin.offsets {
        let (Some(offset_s), Some(clock)) = (offset.offset_s, origin.clocks.get(offset.clock)) else {
            continue;
        };
        let apart = (offset_s - in_use).abs();
        let clear = match (offset.source, offset.standard_error_s) {
            (OffsetSource::Estimated, Some(error)) => apart > OFF_SIGMAS * error,
            (OffsetSource::Header, _) => apart > OFF_BY_HEADER_S,
            _ => false,
        };
        if clear {
            let message = format!(
                "the clock of {} is off by {} by the {} ({}); in use is {in_use} s",
                clock.file,
                with_error(offset_s, offset.standard_error_s),
                offset.source.label(),
                offset.detail
            );
            let mend = format!(
                "where the two instruments had no common trigger, set the tag clock_offset_s = {}; a strip that \
                 bends late shows the same, so nothing is changed by itself",
                digits(offset_s, 4)
            );
            issues.push(Issue::warning("clock-offset", message).mend(mend));
        }
    }
    issues
}

/// `12.3 ± 0.4 s`
fn with_error(value_s: f64, error_s: Option<f64>) -> String {
    match error_s {
        Some(error_s) => format!("{} s", measured(value_s, error_s)),
        None => format!("{} s (uncertainty not known)", fixed(value_s, 3)),
    }
}

fn found(clock: usize, source: OffsetSource, result: Result<Found, String>) -> ClockOffset {
    let (offset_s, standard_error_s, detail) = match result {
        Ok(found) => (Some(found.offset_s), found.standard_error_s, found.detail),
        Err(reason) => (None, None, reason),
    };
    ClockOffset {
        clock,
        source,
        offset_s,
        standard_error_s,
        applied: false,
        detail,
    }
}

struct Found {
    offset_s: f64,
    standard_error_s: Option<f64>,
    detail: String,
}

/// The later start minus the earlier one, where both times count from the start that their file states.
fn from_starts(reference: &FileClock<'_>, file: &FileClock<'_>) -> Result<Found, String> {
    if reference.time_zero_is_step || file.time_zero_is_step {
        return Err("a table whose time zero is the voltage step has no clock of its own".to_owned());
    }
    let (at, other) = match (moment(reference.stamp), moment(file.stamp)) {
        (Some(at), Some(other)) => (at, other),
        _ => return Err("not both files state their start for certain".to_owned()),
    };
    if at.offset.is_some() != other.offset.is_some() {
        return Err("one file states a zone and the other does not".to_owned());
    }
    Ok(Found {
        offset_s: other.utc_s - at.utc_s,
        standard_error_s: None,
        detail: format!(
            "started {} and {}; how far the two computers' clocks differ is not known",
            at.text, other.text
        ),
    })
}

struct StatedStart<'a> {
    utc_s: f64,
    offset: Option<&'a str>,
    text: String,
}

/// A certain start; without a zone it counts as if it were UTC, which cancels between two of the same zone.
fn moment(stamp: Option<&StartedAt>) -> Option<StatedStart<'_>> {
    let stamp = stamp.filter(|stamp| stamp.kind == Timestamp::Start)?;
    let local = stamp.moment()?;
    let text = format!("{local}{}", stamp.offset.as_deref().unwrap_or("Z"));
    let moment: jiff::Timestamp = text.parse().ok()?;
    Some(StatedStart {
        utc_s: moment.as_duration().as_secs_f64(),
        offset: stamp.offset.as_deref(),
        text: format!("{local}{}", stamp.offset.as_deref().unwrap_or("")),
    })
}

impl FileClock<'_> {
    fn channel(&self, quantity: Quantity) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.is_whole(quantity))
    }
}

/// The edge of the voltage (or the first jump of the current) minus the onset of bending.
fn from_onset(reference: &FileClock<'_>, file: &FileClock<'_>) -> Result<Found, String> {
    let edge: Moment = match (
        reference.channel(Quantity::Voltage),
        reference.channel(Quantity::Current),
    ) {
        (Some(voltage), _) => voltage_edge(voltage)?,
        (None, Some(current)) => drive::jumps::from_rest(current)?.into(),
        (None, None) => return Err("neither voltage nor current is on the reference clock".to_owned()),
    };
    let bending = [
        Quantity::Curvature,
        Quantity::TipDisplacement,
        Quantity::BlockingForce,
    ]
    .into_iter()
    .find_map(|quantity| file.channel(quantity))
    .ok_or("no bending is on this clock")?;
    let onset = onset::of_bending(bending)?;
    Ok(Found {
        offset_s: edge.time_s - onset.time_s,
        standard_error_s: Some(edge.standard_error_s.hypot(onset.standard_error_s)),
        detail: format!(
            "the electrical edge at {} s, bending from {} s on its own clock; any lag of the bending \
             is in it",
            measured(edge.time_s, edge.standard_error_s),
            measured(onset.time_s, onset.standard_error_s)
        ),
    })
}

/// A moment on a clock.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moment {
    time_s: f64,
    standard_error_s: f64,
}

impl From<Edge> for Moment {
    fn from(edge: Edge) -> Moment {
        Moment {
            time_s: edge.middle_s(),
            standard_error_s: edge.standard_deviation_s(),
        }
    }
}

/// The first step of the voltage, between the last reading before it and the first after.
fn voltage_edge(voltage: &Channel) -> Result<Moment, String> {
    let drive = drive::find(std::slice::from_ref(voltage), false, None, &[]).drive;
    let segments = drive.map(|drive| drive.segments).unwrap_or_default();
    let (time_s, _) = voltage.included();
    let readings_before = |segment: &Segment| time_s.partition_point(|&time| time < segment.start_s());
    // An edge before the first reading was not seen.
    let seen = segments.iter().map(readings_before).find(|&before| before > 0);
    match seen.unwrap_or(0) {
        _ if segments.is_empty() => Err("the voltage shows no step".to_owned()),
        0 => Err("the record starts with the voltage applied, so its edge is not seen".to_owned()),
        after if after == time_s.len() => Err("the voltage shows no step".to_owned()),
        after => Ok(Edge::between(time_s[after - 1], time_s[after]).into()),
    }
}

#[cfg(test)]
mod tests;
