//! NI TDMS (.tdms): segments of objects, properties and raw values. The index (.tdms_index) is a sidecar.
//!
//! Read: whole and fractional numbers, truth values and moments, in either byte order, contiguous and interleaved, in
//! any number of chunks and segments, with objects listed anew, changed or as before. Texts are counted and left out.
//! Each group is a table; time is a channel of that name, else `wf_start_offset` + row · `wf_increment` of each
//! channel, behind its `wf_start_time`: channels that started at different moments, or at different rates, stand on the
//! one clock of the file, which starts with the earliest of them. Units are `unit_string`, or stand in the name. Moments
//! are UTC. A last segment that was not closed, or lacks bytes, shows a cut. Raw DAQmx data are read with one scaler for
//! each channel in one buffer. Complex and extended numbers, digital DAQmx lines, several DAQmx buffers, and scales
//! other than one linear scale were never seen and are refused.

use self::clock::civil;
use self::segments::{Object, Property, Structure};
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext};
use crate::{Reading, RunTable};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunStatus};

mod clock;
pub mod cursor;
pub mod daqmx;
mod groups;
#[cfg(test)]
mod layout_tests;
pub mod segments;
mod tables;
pub mod values;
#[cfg(test)]
mod waveform_tests;
#[cfg(test)]
pub mod waveform_writer;

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
    fn about(&self) -> About {
        About {
            id: "labview-tdms",
            title: "NI TDMS file of LabVIEW (.tdms)",
            extensions: &["tdms"],
            version: 5,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(head.bytes.starts_with(b"TDSm"), "the file begins with TDSm")
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let mut structure = Structure::read(bytes, |objects, raw| values::add(bytes, objects, raw))?;
        let mut issues = Vec::new();
        let refusal = scale(&mut structure.objects, &mut issues);
        let (groups, starts) = groups::found(&structure.objects, &mut issues);
        let columns = groups::starts_of_columns(&groups);
        let started_at = clock::started_at(&structure.objects, starts, columns, &mut issues);
        let tables = tables::of(groups, &mut structure.objects, starts, &mut issues)?;
        let (status, status_evidence) = match structure.broken_off {
            Some(evidence) => (RunStatus::Cut, evidence),
            None => (
                RunStatus::Complete,
                "the last segment ends at the end of the file".to_owned(),
            ),
        };
        if let Some(error) = refusal.filter(|_| tables.is_empty()) {
            return Err(error);
        }
        if tables.is_empty() {
            return Err(ReadError::header_only(
                0,
                format!("{} segments without numbers", structure.segments),
            ));
        }
        let has_response = |table: &RunTable| {
            table.time_column.is_some()
                && table
                    .channels
                    .iter()
                    .any(|channel| channel.quantity.is_response())
        };
        Ok(Reading {
            is_step_response: tables.iter().any(has_response),
            status,
            status_evidence,
            started_at,
            header_tags: header_tags(&structure.objects),
            tables,
            original_metadata: metadata(&structure.objects),
            issues,
            ..self.reading()
        })
    }
}

/// Applies the scales of raw values; a channel whose scale cannot be applied is left out. Gives the first refusal.
fn scale(objects: &mut [Object], issues: &mut Vec<Issue>) -> Option<ReadError> {
    let mut refusal = None;
    for object in objects {
        if let Err(error) = values::scale(object) {
            let message = format!("channel {} is left out: {error}", quoted(&object.path));
            issues.push(Issue::warning("column-refused", message));
            object.values.clear();
            refusal = refusal.or(Some(error));
        }
    }
    refusal
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
