//! NI TDMS (.tdms): segments of objects, properties and raw values. The index (.tdms_index) is a sidecar.
//!
//! Read: whole and fractional numbers, truth values and moments, in either byte order, contiguous and interleaved, in
//! any number of chunks and segments, with objects listed anew, changed or as before. Texts are counted and left out.
//! Each group is a table (one for each sampling where its channels differ); time is a channel of that name, else
//! `wf_start_offset` + row · `wf_increment`. Units are `unit_string`. Moments are UTC. A last segment that was not
//! closed, or lacks bytes, shows a cut. Raw DAQmx data are read with one scaler for each channel in one
//! buffer. Complex and extended numbers, digital DAQmx lines, several DAQmx buffers, and scales other than one linear
//! scale were never seen and are refused.

use jiff::ToSpan;
use jiff::civil::{Date, DateTime};

use self::cursor::TimeStamp;
use self::segments::{Object, Property, Structure};
use super::assemble::{Raw, assemble_untimed};
use super::cells::CellTable;
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::{Format, ReadContext, stamp};
use crate::text::header::Header;
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity, RunStatus};

pub mod cursor;
pub mod daqmx;
#[cfg(test)]
mod layout_tests;
pub mod segments;
pub mod values;

/// Reader of TDMS files.
pub struct LabviewTdms;

/// Properties of the file that are tags under the same name.
const TAG_PROPERTIES: [&str; 6] = [
    keys::SAMPLE,
    keys::ENVIRONMENT,
    keys::VOLTAGE_V,
    keys::RELATIVE_HUMIDITY_PERCENT,
    keys::TEMPERATURE_C,
    keys::OPERATOR,
];

impl Format for LabviewTdms {
    fn id(&self) -> &'static str {
        "labview-tdms"
    }

    fn title(&self) -> &'static str {
        "NI TDMS file of LabVIEW (.tdms)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["tdms"]
    }

    fn version(&self) -> u32 {
        3
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        if head.bytes.starts_with(b"TDSm") {
            Match::Certain("the file begins with TDSm")
        } else {
            Match::No
        }
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let mut structure = Structure::read(bytes, |objects, raw| values::add(bytes, objects, raw))?;
        let mut issues = Vec::new();
        let tables = tables(&mut structure.objects, &mut issues)?;
        let (status, status_evidence) = match structure.broken_off {
            Some(evidence) => (RunStatus::Cut, evidence),
            None => (
                RunStatus::Complete,
                "the last segment ends at the end of the file".to_owned(),
            ),
        };
        if tables.is_empty() {
            return Err(ReadError::HeaderOnly {
                line: 0,
                found: format!("{} segments without numbers", structure.segments),
            });
        }
        let has_response = |table: &RunTable| {
            table.time_column.is_some()
                && table
                    .channels
                    .iter()
                    .any(|channel| channel.quantity.is_response())
        };
        Ok(Reading {
            format: self.id(),
            reader_version: self.version(),
            technique: None,
            is_step_response: tables.iter().any(has_response),
            encoding: None,
            status,
            status_evidence,
            started_at: starts(&structure.objects, &mut issues),
            header_tags: header_tags(&structure.objects),
            tables,
            original_metadata: metadata(&structure.objects),
            issues,
        })
    }
}

/// Group and channel of a path `/'group'/'channel'`; a quote inside a name is doubled.
fn names(path: &str) -> Option<(String, String)> {
    let inner = path.strip_prefix("/'")?.strip_suffix('\'')?;
    let (group, channel) = inner.split_once("'/'")?;
    Some((group.replace("''", "'"), channel.replace("''", "'")))
}

/// Channels of one group with the same sampling: their names and places among the objects.
struct Group {
    name: String,
    sampling: Option<(f64, f64)>,
    channels: Vec<(String, usize)>,
}

fn tables(objects: &mut [Object], issues: &mut Vec<Issue>) -> Result<Vec<RunTable>, ReadError> {
    let mut refusal = None;
    for object in objects.iter_mut() {
        if let Err(error) = values::scale(object) {
            let message = format!("channel {} is left out: {error}", quoted(&object.path));
            issues.push(Issue::warning("column-refused", message));
            object.values.clear();
            refusal = refusal.or(Some(error));
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    let filled = objects
        .iter()
        .enumerate()
        .filter(|(_, object)| !object.values.is_empty());
    for (place, object) in filled {
        let Some((name, channel)) = names(&object.path) else {
            continue;
        };
        if object.is_text {
            let message = format!("channel {} holds texts; it is left out", quoted(&channel));
            issues.push(Issue::note("text-column", message));
            continue;
        }
        let sampling = sampling(object);
        match groups
            .iter_mut()
            .find(|group| group.name == name && group.sampling == sampling)
        {
            Some(group) => group.channels.push((channel, place)),
            None => groups.push(Group {
                name,
                sampling,
                channels: vec![(channel, place)],
            }),
        }
    }
    let several = groups.len() > 1;
    let mut tables: Vec<RunTable> = Vec::new();
    for group in &groups {
        let is_taken = tables.iter().any(|table| table.name == group.name);
        let name = match (several, is_taken) {
            (false, _) => String::new(),
            (_, false) => group.name.clone(),
            _ => format!("{} ({})", group.name, tables.len() + 1),
        };
        tables.push(assemble_untimed(raw(name, group, objects), issues)?);
    }
    match refusal {
        Some(error) if tables.is_empty() => Err(error),
        _ => Ok(tables),
    }
}

/// Offset and increment of a waveform, s.
fn sampling(object: &Object) -> Option<(f64, f64)> {
    let number = |name| match object.property(name) {
        Some(Property::Number(number)) => Some(*number),
        _ => None,
    };
    let increment = number("wf_increment").filter(|increment| *increment > 0.0)?;
    Some((number("wf_start_offset").unwrap_or(0.0), increment))
}

/// The table of a group; the values are taken out of the objects, for a long record would not fit twice.
fn raw(name: String, group: &Group, objects: &mut [Object]) -> Raw {
    let header = |(name, place): &(String, usize)| header(name, &objects[*place]);
    let mut headers: Vec<Header> = group.channels.iter().map(header).collect();
    let lengths = group
        .channels
        .iter()
        .map(|(_, place)| objects[*place].values.len());
    let rows = lengths.max().unwrap_or(0);
    let has_time = headers
        .iter()
        .any(|header| header.meaning.quantity() == Some(Quantity::Time));
    let waveform = group.sampling.filter(|_| !has_time);
    let places = group.channels.iter().map(|(_, place)| *place);
    let mut columns: Vec<Vec<f64>> = places.map(|place| column(&mut objects[place])).collect();
    if let Some((offset, increment)) = waveform {
        headers.insert(
            0,
            Header {
                raw_name: "row number x wf_increment".to_owned(),
                ..Header::with_unit("time", "s")
            },
        );
        columns.insert(0, (0..rows).map(|row| offset + row as f64 * increment).collect());
    }
    Raw::of_instrument(name, headers, CellTable::of_numbers(columns))
}

fn header(name: &str, object: &Object) -> Header {
    let unit = match object.property("unit_string") {
        Some(Property::Text(unit)) => unit.as_str(),
        _ => "",
    };
    match (object.is_time, unit) {
        (true, _) => Header::with_unit(name, "s"),
        (false, "") => Header::parse(name),
        (false, unit) => Header::with_unit(name, unit),
    }
}

/// Numbers of a channel, taken out of it; moments count from the first one.
fn column(object: &mut Object) -> Vec<f64> {
    let mut values = std::mem::take(&mut object.values);
    if let (true, Some(&first)) = (object.is_time, values.first()) {
        values.iter_mut().for_each(|value| *value -= first);
    }
    values
}

/// The start that waveforms state; where none does, moments of the file or a group that speak of a start by their name.
fn starts(objects: &[Object], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let of_waveforms: Vec<StartedAt> = objects
        .iter()
        .filter_map(|object| started_at(object, "wf_start_time"))
        .collect();
    if !of_waveforms.is_empty() {
        return stamp::shared(of_waveforms, issues);
    }
    let is_whole = |object: &&Object| names(&object.path).is_none();
    let moments = objects.iter().filter(is_whole).flat_map(|object| {
        let named = object.properties.iter().filter(|(name, _)| names_start(name));
        named.filter_map(|(name, _)| started_at(object, name))
    });
    stamp::shared(moments.collect::<Vec<_>>(), issues)
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
fn started_at(object: &Object, property: &str) -> Option<StartedAt> {
    let Some(Property::Time(time)) = object.property(property) else {
        return None;
    };
    if time.seconds == 0 {
        return None;
    }
    let local = civil(*time)?;
    Some(StartedAt {
        raw: format!("{} s since 1904-01-01 UTC", time.seconds as f64 + time.fraction()),
        kind: Timestamp::Start,
        local: Some(local.to_string()),
        offset: Some("+00:00".to_owned()),
        basis: format!("{property} counts UTC seconds"),
    })
}

/// UTC to the millisecond.
fn civil(time: TimeStamp) -> Option<DateTime> {
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

fn header_tags(objects: &[Object]) -> Vec<(String, String, String)> {
    let root = objects.iter().find(|object| object.path == "/");
    let properties = root.map_or(&[][..], |root| root.properties.as_slice());
    let is_tag = |(key, _): &&(String, Property)| TAG_PROPERTIES.contains(&key.as_str());
    let tags = properties.iter().filter(is_tag);
    tags.map(|(key, value)| (key.clone(), shown(value), key.clone()))
        .collect()
}

fn metadata(objects: &[Object]) -> Vec<(String, String)> {
    let pair =
        |object: &Object, key: &str, value: &Property| (format!("{} {key}", object.path), shown(value));
    let of = |object: &Object| -> Vec<(String, String)> {
        object
            .properties
            .iter()
            .map(|(key, value)| pair(object, key, value))
            .collect()
    };
    objects.iter().flat_map(of).collect()
}

fn shown(value: &Property) -> String {
    match value {
        Property::Number(number) => number.to_string(),
        Property::Text(text) => text.clone(),
        Property::Time(time) => civil(*time).map_or(String::new(), |time| format!("{time}Z")),
    }
}
