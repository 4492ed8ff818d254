//! LabVIEW measurement file (.lvm): a header, then segments, each with a header of its own, names and rows.
//!
//! `Separator` and `Decimal_Separator` are declared; where the second is missing (old writers) the rows decide. With
//! `X_Columns No` the X cells are empty and x = X0 + row · Delta_X; with `One` the first column is x; with `Multi` each
//! channel has its own. Units stand in `Y_Unit_Label`. With `Multi_Headings No` more rows may follow than `Samples`
//! says; fewer rows show a cut. Dates are written year first, in local time. The `Comment` column holds texts and is
//! left out. Channels of one segment with different X0 or Delta_X under `X_Columns No` were never seen.

use self::segments::{Keys, Segment, declared, keys, segments, value};
use super::assemble::{Raw, assemble_untimed};
use super::cells::{CellColumn, CellTable};
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, number};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys as tag_keys;
use ieap_domain::{Issue, RunStatus};

pub mod segments;

/// Reader of LabVIEW measurement files.
pub struct LabviewLvm;

impl Format for LabviewLvm {
    fn about(&self) -> About {
        About {
            id: "labview-lvm",
            title: "LabVIEW measurement file (.lvm)",
            extensions: &["lvm"],
            version: 5,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(
            head.text().unwrap_or_default().starts_with("LabVIEW Measurement"),
            "the file begins with LabVIEW Measurement",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (text_status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let has_commas = lines.iter().any(|line| line.text.starts_with("Separator,"));
        let delimiter = if has_commas {
            Delimiter::Comma
        } else {
            Delimiter::Tab
        };
        let (header, after) = keys(&lines, delimiter);
        let segments = segments(&lines[after..], delimiter);
        let several = segments.len() > 1;
        let mut tables = Vec::new();
        for (index, segment) in segments.iter().enumerate() {
            let name = if several {
                format!("segment {}", index + 1)
            } else {
                String::new()
            };
            tables.extend(tables_of(segment, &header, delimiter, name, &mut issues)?);
        }
        let Some(first) = segments.first().filter(|_| !tables.is_empty()) else {
            return Err(ReadError::header_only(lines.len(), "no segment with rows"));
        };
        let (status, status_evidence) = status(&segments, text_status, evidence);
        let has_response = |table: &RunTable| {
            table.time_column.is_some()
                && table
                    .channels
                    .iter()
                    .any(|channel| channel.quantity.is_response())
        };
        let operator = value(&header, "Operator", 1).filter(|name| !name.is_empty());
        Ok(Reading {
            is_step_response: tables.iter().any(has_response),
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
            started_at: start_of_all(&segments, &mut issues),
            header_tags: operator
                .map(|name| {
                    (
                        tag_keys::OPERATOR.to_owned(),
                        name.to_owned(),
                        "Operator".to_owned(),
                    )
                })
                .into_iter()
                .collect(),
            tables,
            original_metadata: header
                .iter()
                .chain(&first.keys)
                .map(|(key, cells)| ((*key).to_owned(), cells.join(" ").trim().to_owned()))
                .collect(),
            issues,
            ..self.reading()
        })
    }
}

/// The table of a segment; with an X column for each channel that differ, one table each.
fn tables_of(
    segment: &Segment<'_>,
    header: &Keys<'_>,
    delimiter: Delimiter,
    name: String,
    issues: &mut Vec<Issue>,
) -> Result<Vec<RunTable>, ReadError> {
    if segment.rows.is_empty() {
        return Ok(Vec::new());
    }
    let decimal = match value(header, "Decimal_Separator", 1) {
        Some(",") => Decimal::Comma,
        Some(".") => Decimal::Point,
        _ => delimited::decimal_of(&segment.rows, delimiter)?,
    };
    let mut cells = cells(segment, delimiter, decimal);
    let headers: Vec<Header> = (0..segment.names.len())
        .map(|index| column(segment, index))
        .collect();
    match value(header, "X_Columns", 1) {
        Some("No") => count_time(&mut cells.columns[0], segment)?,
        Some("Multi") => return multi(segment, &cells, &headers, &name, issues),
        _ => {}
    }
    let keep = usize::from(segment.names.last() == Some(&"Comment"));
    let kept = headers.len() - keep;
    cells.columns.truncate(kept);
    let raw = Raw::of_instrument(name, headers[..kept].to_vec(), cells);
    Ok(vec![assemble_untimed(raw, issues)?])
}

/// One table where all channels share their X, else one for each.
fn multi(
    segment: &Segment<'_>,
    cells: &CellTable,
    headers: &[Header],
    name: &str,
    issues: &mut Vec<Issue>,
) -> Result<Vec<RunTable>, ReadError> {
    let is_x = |index: &usize| segment.names[*index] == "X_Value";
    let places: Vec<usize> = (0..headers.len()).filter(is_x).collect();
    // Declared starts and steps decide first, so that a part of the file reads as the whole does.
    let [x0, delta] = ["X0", "Delta_X"].map(|key| declared(segment, key));
    let is_declared_same = [&x0, &delta]
        .iter()
        .all(|cells| cells.windows(2).all(|pair| pair[0] == pair[1]));
    let same = is_declared_same
        && places
            .iter()
            .all(|&at| cells.columns[at].numbers == cells.columns[places[0]].numbers);
    let of = |at: usize| {
        [at, at + 1]
            .into_iter()
            .filter(|&k| k < headers.len() && segment.names[k] != "Comment")
    };
    let groups: Vec<Vec<usize>> = if same {
        let channels = places.iter().flat_map(|&at| of(at).skip(1));
        vec![places.iter().take(1).copied().chain(channels).collect()]
    } else {
        places.iter().map(|&at| of(at).collect()).collect()
    };
    let several = groups.len() > 1;
    let mut tables = Vec::new();
    for group in groups {
        let part = CellTable {
            columns: group.iter().map(|&at| cells.columns[at].clone()).collect(),
            ..cells.clone()
        };
        let channel = group.last().map_or("", |&at| segment.names[at]);
        let name = if several {
            format!("{name} {channel}").trim().to_owned()
        } else {
            name.to_owned()
        };
        let headers = group.iter().map(|&at| headers[at].clone()).collect();
        tables.push(assemble_untimed(Raw::of_instrument(name, headers, part), issues)?);
    }
    Ok(tables)
}

/// A column's meaning: its unit stands in its name or in `Y_Unit_Label`.
fn column(segment: &Segment<'_>, index: usize) -> Header {
    let name = segment.names[index];
    if name == "X_Value" {
        let is_time = value(&segment.keys, "X_Dimension", 1).is_none_or(|dimension| dimension == "Time");
        let header = if is_time {
            Header::with_unit("time", "s")
        } else {
            Header::other(name)
        };
        return Header {
            raw_name: name.to_owned(),
            ..header
        };
    }
    let header = Header::parse(name);
    match (
        header.raw_unit.as_str(),
        value(&segment.keys, "Y_Unit_Label", index),
    ) {
        ("", Some(unit)) if !unit.is_empty() => Header::with_unit(name, unit),
        _ => header,
    }
}

/// Cells of all columns; the comment may be missing, and what stands behind it does not count.
fn cells(segment: &Segment<'_>, delimiter: Delimiter, decimal: Decimal) -> CellTable {
    let columns = segment.names.len();
    let needed = columns - usize::from(segment.names.last() == Some(&"Comment"));
    let mut keep_text = vec![false; columns];
    keep_text[needed..].fill(true);
    let mut table = CellTable::new(segment.names_line, &keep_text, segment.rows.len());
    for row in &segment.rows {
        let found = delimiter.split(row.text, |index, text| {
            if let Some(column) = table.columns.get_mut(index) {
                column.push(row.number, number::parse(text, decimal), || {
                    text.trim().to_owned()
                });
            }
        });
        let is_whole = (needed..=columns).contains(&found);
        table.end_row(row.number, if is_whole { columns } else { found });
    }
    table
}

/// Fills the empty X cells: x = X0 + row · Delta_X.
fn count_time(column: &mut CellColumn, segment: &Segment<'_>) -> Result<(), ReadError> {
    let (x0, delta) = (declared(segment, "X0"), declared(segment, "Delta_X"));
    if [&x0, &delta]
        .iter()
        .any(|cells| cells.windows(2).any(|pair| pair[0] != pair[1]))
    {
        return Err(ReadError::NeverSeen {
            what: "a segment of LabVIEW whose channels start or step differently",
            found: quoted(&format!("X0 {} Delta_X {}", x0.join(" "), delta.join(" "))),
        });
    }
    let number = |cells: &[&str]| delimited::header_number(cells.first()?);
    let (Some(x0), Some(delta)) = (number(&x0), number(&delta)) else {
        return Err(ReadError::Column {
            line: segment.names_line,
            index: 1,
            column: quoted("X_Value"),
            reason: "its cells are empty and X0 or Delta_X is missing".to_owned(),
        });
    };
    if column.filled == 0 {
        column.filled = column.numbers.len();
        for (row, number) in column.numbers.iter_mut().enumerate() {
            *number = x0 + row as f64 * delta;
        }
    }
    Ok(())
}

fn status(segments: &[Segment<'_>], text: RunStatus, evidence: String) -> (RunStatus, String) {
    if text == RunStatus::Cut {
        return (text, evidence);
    }
    for segment in segments {
        let declared = value(&segment.keys, "Samples", 1).and_then(|text| text.parse::<usize>().ok());
        if let Some(declared) = declared.filter(|declared| segment.rows.len() < *declared) {
            let found = segment.rows.len();
            return (
                RunStatus::Cut,
                format!("Samples declares {declared} rows, {found} found"),
            );
        }
    }
    (
        RunStatus::Complete,
        evidence + "; no segment has fewer rows than Samples declares",
    )
}

fn start_of_all(segments: &[Segment<'_>], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let mut found = Vec::new();
    let with_rows = segments.iter().filter(|segment| !segment.rows.is_empty());
    let starts: Vec<StartedAt> = with_rows
        .filter_map(|segment| started_at(&segment.keys, &mut found))
        .collect();
    issues.extend(found);
    stamp::shared(starts, issues)
}

fn started_at(keys: &Keys<'_>, issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let (date, time) = (value(keys, "Date", 1)?, value(keys, "Time", 1)?);
    // Fractions have up to nineteen digits; nine are nanoseconds.
    let (clock, fraction) = time.split_once(['.', ',']).unwrap_or((time, "0"));
    let fraction: String = fraction.chars().take(9).collect();
    let raw = format!("{date} {clock}.{fraction}");
    let (stamp, issue) = stamp::in_order(&raw, DateOrder::YearFirst, Timestamp::Start, "year first");
    issues.extend(issue);
    Some(StartedAt {
        raw: format!("{date} {time}"),
        ..stamp
    })
}
