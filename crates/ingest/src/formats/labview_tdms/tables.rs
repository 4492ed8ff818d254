//! Tables of a file: the channels of a group, each with the times of its own sampling.

use super::clock::{Sampling, Starts};
use super::groups::{Group, Numbers, Timing};
use super::segments::Object;
use crate::RunTable;
use crate::formats::ReadError;
use crate::formats::assemble::{Raw, assemble_untimed};
use crate::formats::cells::CellTable;
use crate::formats::error::quoted;
use crate::text::header::{Header, Meaning};
use ieap_domain::{Channel, Issue};

/// The tables of the groups; the values are taken out of the objects, for a long record would not fit twice.
///
/// # Errors
/// No row, or too many ragged rows.
pub fn of(
    groups: Vec<Group>,
    objects: &mut [Object],
    starts: Starts,
    issues: &mut Vec<Issue>,
) -> Result<Vec<RunTable>, ReadError> {
    let mut tables: Vec<RunTable> = Vec::new();
    for group in groups {
        let found = match group.timing {
            Timing::Rows(_) => vec![assemble_untimed(raw(group.channels, objects), issues)?],
            Timing::Waveforms { .. } => waveforms(group.channels, objects, starts, issues)?,
        };
        for table in found {
            let is_taken = tables.iter().any(|table| table.name == group.name);
            let name = if is_taken {
                format!("{} ({})", group.name, tables.len() + 1)
            } else {
                group.name.clone()
            };
            tables.push(RunTable { name, ..table });
        }
    }
    if let [only] = tables.as_mut_slice() {
        only.name.clear();
    }
    Ok(tables)
}

/// A table without a name.
fn raw(channels: Vec<Numbers>, objects: &mut [Object]) -> Raw {
    let columns = channels
        .iter()
        .map(|channel| column(&mut objects[channel.place]))
        .collect();
    let headers = channels.into_iter().map(|channel| channel.header).collect();
    Raw::of_instrument(String::new(), headers, CellTable::of_numbers(columns))
}

/// Numbers of a channel, taken out of it; moments count from the first one.
fn column(object: &mut Object) -> Vec<f64> {
    let mut values = std::mem::take(&mut object.values);
    if let (true, Some(&first)) = (object.is_time, values.first()) {
        values.iter_mut().for_each(|value| *value -= first);
    }
    values
}

/// One table of waveforms: those of the same sampling share their times, and all of them one clock. Waveforms whose
/// times no number can hold apart are numbered by row, in a table of their own.
fn waveforms(
    channels: Vec<Numbers>,
    objects: &mut [Object],
    starts: Starts,
    issues: &mut Vec<Issue>,
) -> Result<Vec<RunTable>, ReadError> {
    let name = |channel: &Numbers| channel.header.raw_name.clone();
    let order: Vec<String> = channels.iter().map(name).collect();
    let mut parts: Vec<(Sampling, Vec<Numbers>)> = Vec::new();
    for channel in channels {
        let Some(sampling) = channel.sampling else {
            continue;
        };
        match parts.iter_mut().find(|(other, _)| sampling.is_that_of(*other)) {
            Some((_, part)) => part.push(channel),
            None => parts.push((sampling, vec![channel])),
        }
    }
    let mut tables: Vec<RunTable> = Vec::new();
    for (sampling, mut part) in parts {
        let known = || tables.iter().flat_map(|table| &table.channels);
        let renamed = part
            .iter_mut()
            .filter_map(|channel| only_once(&mut channel.header, known()));
        issues.extend(renamed);
        let mut raw = raw(part, objects);
        let times_s = sampling.times_s(starts.zero, raw.cells.rows());
        add_time(&mut raw, times_s);
        let table = assemble_untimed(raw, issues)?;
        let is_timed = |table: &RunTable| table.time_column.is_some();
        match tables
            .iter_mut()
            .find(|first| is_timed(first) && is_timed(&table))
        {
            Some(first) => join(first, table),
            None => tables.push(table),
        }
    }
    let place = |channel: &Channel| order.iter().position(|name| *name == channel.raw_name);
    tables
        .iter_mut()
        .for_each(|table| table.channels.sort_by_key(place));
    Ok(tables)
}

/// Puts times, s, before the columns.
fn add_time(raw: &mut Raw, times_s: Vec<f64>) {
    let time = Header {
        raw_name: "row number x wf_increment".to_owned(),
        ..Header::with_unit("time", "s")
    };
    raw.headers.insert(0, time);
    let times = CellTable::of_numbers(vec![times_s]).columns;
    raw.cells.columns.splice(0..0, times);
}

/// Keeps a channel under its own name where one of another sampling measures the same.
fn only_once<'a>(header: &mut Header, mut known: impl Iterator<Item = &'a Channel>) -> Option<Issue> {
    let quantity = header.meaning.quantity()?;
    let is_same =
        |channel: &&Channel| channel.quantity == quantity && channel.position_mm == header.position_mm;
    let first = known.find(is_same)?;
    header.meaning = Meaning::Other;
    let message = format!(
        "column {} measures what {} does; it is kept under its own name",
        quoted(&header.raw_name),
        quoted(&first.raw_name)
    );
    Some(Issue::note("duplicate-quantity", message))
}

/// Adds the channels of a table of the same clock; each keeps its own times.
fn join(first: &mut RunTable, second: RunTable) {
    first.rows = first.rows.max(second.rows);
    first.channels.extend(second.channels);
    let spans = first.time_first_last_s.zip(second.time_first_last_s);
    first.time_first_last_s = spans.map(|(a, b)| (a.0.min(b.0), a.1.max(b.1)));
}
