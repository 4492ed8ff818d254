//! Which channels of a file stand in one table: those of a group that share a clock.

use super::clock::{self, Sampling, Starts};
use super::cursor::TimeStamp;
use super::segments::{Object, Property};
use crate::formats::error::quoted;
use crate::text::header::{Header, Meaning};
use ieap_domain::unit::{self, Conversion};
use ieap_domain::{Issue, Quantity};

/// A channel of numbers.
pub struct Numbers {
    /// Its name, unit and meaning.
    pub header: Header,
    /// Its place among the objects of the file.
    pub place: usize,
    /// The moment at which its clock started, where one is stated.
    pub start: Option<TimeStamp>,
    /// How it was sampled, where it is a waveform.
    pub sampling: Option<Sampling>,
}

/// What times the rows of a table.
#[derive(Clone, Copy, PartialEq)]
pub enum Timing {
    /// Their own sampling: that of each waveform, on the clock of the file or, without a start, on one of their own.
    Waveforms {
        /// Whether the clock is the file's.
        of_file: bool,
    },
    /// A column of times among them, or nothing; with the sampling that they state all the same.
    Rows(Option<(f64, f64)>),
}

/// Channels of a table.
pub struct Group {
    /// Name of the group in the file.
    pub name: String,
    /// What times them.
    pub timing: Timing,
    /// The channels, in the file's order.
    pub channels: Vec<Numbers>,
}

/// Every group with its channels of numbers, and when the waveforms among them started.
pub fn found(objects: &[Object], issues: &mut Vec<Issue>) -> (Vec<Group>, Starts) {
    let named: Vec<(String, Numbers)> = objects
        .iter()
        .enumerate()
        .filter(|(_, object)| !object.values.is_empty())
        .filter_map(|(place, object)| numbers(place, object, issues))
        .collect();
    let is_time = |numbers: &Numbers| numbers.header.meaning.quantity() == Some(Quantity::Time);
    let columns: Vec<(&str, (f64, f64))> = named
        .iter()
        .filter(|(_, numbers)| is_time(numbers))
        .filter_map(|(group, numbers)| Some((group.as_str(), numbers.sampling?.rows())))
        .collect();
    let waveform = |group: &str, numbers: &Numbers| {
        numbers
            .sampling
            .filter(|sampling| !columns.contains(&(group, sampling.rows())))
    };
    let waveforms: Vec<Option<Sampling>> = named
        .iter()
        .map(|(group, numbers)| waveform(group, numbers))
        .collect();
    let mut starts = Starts::default();
    waveforms
        .iter()
        .flatten()
        .for_each(|sampling| starts.add(*sampling));
    let mut groups: Vec<Group> = Vec::new();
    for ((name, numbers), waveform) in named.into_iter().zip(waveforms) {
        let timing = match waveform {
            Some(sampling) => Timing::Waveforms {
                of_file: starts.place(sampling),
            },
            None => Timing::Rows(numbers.sampling.map(Sampling::rows)),
        };
        let is_same = |group: &&mut Group| group.name == name && group.timing == timing;
        match groups.iter_mut().find(is_same) {
            Some(group) => group.channels.push(numbers),
            None => groups.push(Group {
                name,
                timing,
                channels: vec![numbers],
            }),
        }
    }
    issues.extend(without_a_start(&groups));
    (groups, starts)
}

/// Moments at which channels started that a column of times times: their zero.
pub fn starts_of_columns(groups: &[Group]) -> impl Iterator<Item = TimeStamp> + '_ {
    let timed = groups
        .iter()
        .filter(|group| matches!(group.timing, Timing::Rows(_)));
    timed
        .flat_map(|group| &group.channels)
        .filter_map(|channel| channel.start)
}

fn without_a_start(groups: &[Group]) -> Option<Issue> {
    let apart = groups
        .iter()
        .find(|group| group.timing == Timing::Waveforms { of_file: false })?;
    let message = format!(
        "channel {} states no wf_start_time, and the others started at different moments; channels without a start \
         are a table of their own",
        quoted(&apart.channels[0].header.raw_name)
    );
    let mend = "write wf_start_time into every channel, or add a channel with the times";
    Some(Issue::warning("starts-differ", message).mend(mend))
}

/// The name of the group and the channel; none for texts, of which a note is made.
fn numbers(place: usize, object: &Object, issues: &mut Vec<Issue>) -> Option<(String, Numbers)> {
    let (group, channel) = object.names()?;
    if object.is_text {
        let message = format!("channel {} holds texts; it is left out", quoted(&channel));
        issues.push(Issue::note("text-column", message));
        return None;
    }
    let numbers = Numbers {
        header: header(&channel, object, issues),
        place,
        start: clock::start(object),
        sampling: Sampling::of(object),
    };
    Some((group, numbers))
}

fn header(name: &str, object: &Object, issues: &mut Vec<Issue>) -> Header {
    let unit = match object.property("unit_string") {
        Some(Property::Text(unit)) => unit.as_str(),
        _ => "",
    };
    match (object.is_time, unit) {
        (true, _) => Header::with_unit(name, "s"),
        (false, "") => Header::parse(name),
        (false, unit) => with_unit(name, unit, issues),
    }
}

/// A name with the unit beside it. A name may hold the unit, too: `Voltage (V)`.
fn with_unit(name: &str, unit: &str, issues: &mut Vec<Issue>) -> Header {
    let beside = Header::with_unit(name, unit);
    let inside = Header::parse(name);
    let (Meaning::Other, Meaning::Known { quantity, conversion }) = (&beside.meaning, &inside.meaning) else {
        return beside;
    };
    let is_same = |stated: Conversion| stated == *conversion || stated.negated() == *conversion;
    if unit::conversion(*quantity, unit).is_ok_and(is_same) {
        return Header {
            raw_unit: beside.raw_unit,
            ..inside
        };
    }
    let message = format!(
        "channel {} holds a unit in its name and the other unit {} in unit_string; it is kept under its own name",
        quoted(name),
        quoted(unit)
    );
    let mend = "state one unit in the name and in unit_string";
    issues.push(Issue::warning("column-refused", message).mend(mend));
    beside
}
