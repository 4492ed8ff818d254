//! BioLogic EC-Lab and BT-Lab text export (.mpt): settings, then columns between tabs.
//!
//! Current is in mA, charge in mA.h or C; time in s, from anywhere (linked techniques) or as dates. The decimal sign
//! is that of the computer, and may differ between header and rows. The start is always written month first, in
//! local time. The format declares no number of rows, and files may end without a line end. The technique `Wait` has no
//! rows and is a sidecar of the run it stands between.

use super::mpt_header::{self, Settings};
use crate::formats::assemble::{Raw, assemble_untimed};
use crate::formats::cells::CellTable;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::{self, DateOrder};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::text::grid::Dialect;
use crate::text::header::Meaning;
use crate::text::{Delimiter, Line, Lines};
use crate::{Reading, Timestamp};
use ieap_domain::Issue;
use ieap_domain::tag::keys;

/// Reader of EC-Lab text.
pub struct BiologicMpt;

impl Format for BiologicMpt {
    fn about(&self) -> About {
        About {
            id: "biologic-mpt",
            title: "BioLogic EC-Lab or BT-Lab text export (.mpt)",
            extensions: &["mpt", "txt"],
            version: 5,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = Lines::new(text).next().map_or("", |line| line.text);
        if matches!(first.trim(), "EC-Lab ASCII FILE" | "BT-Lab ASCII FILE") {
            return Match::Certain("the file begins with EC-Lab ASCII FILE");
        }
        Match::certain_if(
            mpt_header::names_columns(first) && first.starts_with("mode\t"),
            "the first line names mode and other columns of EC-Lab",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let names_at = mpt_header::names_at(&lines);
        let settings = Settings::of(&lines[..names_at.unwrap_or(lines.len())]);
        let rows = &lines[names_at.map_or(lines.len(), |at| at + 1)..];
        if settings.technique == Some("Wait") && rows.iter().all(|row| row.text.trim().is_empty()) {
            return Err(ReadError::Sidecar {
                kind: "EC-Lab pause",
                sign: "the technique Wait without rows",
            });
        }
        let names_at = names_at.ok_or_else(|| ReadError::header_only(lines.len(), "no names of columns"))?;
        let raw = raw(&lines[names_at], rows, &mut issues)?;
        let is_step_response = is_step_response(settings.technique, &raw);
        let table = assemble_untimed(raw, &mut issues)?;
        let started_at = settings.value("Acquisition started on").map(|text| {
            let basis = "month first, as EC-Lab always writes";
            let (stamp, issue) = stamp::in_order(text, DateOrder::MonthFirst, Timestamp::Start, basis);
            issues.extend(issue);
            stamp
        });
        Ok(Reading {
            technique: settings.technique.map(str::to_owned),
            is_step_response,
            encoding: Some(decoded.encoding),
            status,
            status_evidence: delimited::undeclared(status, evidence),
            started_at,
            header_tags: header_tags(&settings, is_step_response, &mut issues),
            tables: vec![table],
            original_metadata: metadata(&settings),
            issues,
            ..self.reading()
        })
    }
}

fn raw(names: &Line<'_>, rows: &[Line<'_>], issues: &mut Vec<Issue>) -> Result<Raw, ReadError> {
    let mut headers = mpt_header::headers(names.text);
    if headers.iter().any(|header| header.raw_name == "freq/Hz") {
        // Rows of a spectrum stand for frequencies; their times may repeat.
        for header in headers.iter_mut().filter(|header| header.raw_name == "time/s") {
            header.meaning = Meaning::Other;
        }
    }
    let delimiter = Delimiter::Tab;
    let decimal = delimited::decimal_of(rows, delimiter)?;
    let mut cells = delimited::cells_of(
        names.number,
        headers.len(),
        rows,
        Dialect::new(delimiter, decimal),
    );
    if let Some(index) = headers.iter().position(|header| header.raw_name == "time/s") {
        read_dates(&mut cells, index, rows, issues);
    }
    super::mode_and_error::judge_control(&mut headers, &cells);
    Ok(Raw {
        flags: super::mode_and_error::marks(&headers, &cells),
        ..Raw::of_instrument(String::new(), headers, cells)
    })
}

/// Turns a time column that holds dates into seconds since its first one.
fn read_dates(cells: &mut CellTable, index: usize, rows: &[Line<'_>], issues: &mut Vec<Issue>) {
    if cells.columns[index].text.count == 0 || cells.columns[index].text.count != cells.rows() {
        return;
    }
    let filled = rows.iter().filter(|row| !row.text.trim().is_empty());
    let dates = filled.map(|row| stamp::civil(row.text.split('\t').nth(index)?, DateOrder::MonthFirst));
    let Some(dates) = dates.collect::<Option<Vec<_>>>() else {
        return;
    };
    let Some(first) = dates.first().copied() else {
        return;
    };
    let column = &mut cells.columns[index];
    column.text = Default::default();
    for (number, date) in column.numbers.iter_mut().zip(&dates) {
        *number = date.duration_since(first).as_secs_f64();
    }
    let message = format!("the column time/s holds dates; it is counted in seconds from the first, {first}");
    issues.push(Issue::note("time-from-dates", message));
}

/// Whether the technique holds the voltage; without a name, a potential that is held in every row.
fn is_step_response(technique: Option<&str>, raw: &Raw) -> bool {
    if let Some(technique) = technique {
        return super::mode_and_error::holds_the_voltage(technique);
    }
    let mode = raw.headers.iter().position(|header| header.raw_name == "mode");
    mode.is_some_and(|index| {
        let modes = &raw.cells.columns[index].numbers;
        modes
            .iter()
            .all(|mode| *mode == super::mode_and_error::POTENTIOSTATIC)
    })
}

/// The instrument, and for potential steps the level farthest from zero.
fn header_tags(
    settings: &Settings<'_>,
    is_step: bool,
    issues: &mut Vec<Issue>,
) -> Vec<(String, String, String)> {
    let mut tags = Vec::new();
    let tag = |key: &str, value: String, name: &str| (key.to_owned(), value, name.to_owned());
    if let Some(device) = settings.value("Device").filter(|device| !device.is_empty()) {
        tags.push(tag(keys::INSTRUMENT, device.to_owned(), "Device"));
    }
    let potentials = settings.potentials();
    if !is_step || potentials.is_empty() {
        return tags;
    }
    if let Some((_, reference)) = potentials.iter().find(|(_, reference)| *reference != "Ref") {
        let message = format!(
            "Ei is relative to {reference}, which the header does not give; no step voltage is taken from the header"
        );
        issues.push(Issue::note("potential-relative", message).at("Ei (V)"));
        return tags;
    }
    let farthest = potentials
        .into_iter()
        .reduce(|best, next| if next.0.abs() > best.0.abs() { next } else { best });
    if let Some((volts, _)) = farthest {
        tags.push(tag(keys::VOLTAGE_V, (volts + 0.0).to_string(), "Ei (V)"));
    }
    tags
}

fn metadata(settings: &Settings<'_>) -> Vec<(String, String)> {
    let pair = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    settings.pairs.iter().map(pair).collect()
}
