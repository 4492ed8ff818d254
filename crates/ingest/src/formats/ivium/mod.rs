//! Ivium: files of IviumSoft (.idf, .ids) and its text export. A method (.imf) is a sidecar.
//!
//! Read: `Method=Transients` (time s, I A, E V) and `Method=Impedance` (real and imaginary part Ohm, frequency
//! Hz). Scans (cyclic and linear sweep) were never seen as files, and `ocpdata`, `pretreatmentdata`, `RsCs_data`
//! and `osc_data` mean other things in other versions: they are not read.
//!
//! Start and end stand in the `QR` line as days since 1899-12-30 where they are filled, else in the report in the
//! order of the computer's locale. The report's `endcondition` tells how the run ended; a placeholder
//! `:endcondition` is that of a file written before it did.

use encoding_rs::WINDOWS_1252;

use self::sections::DataSet;
use super::assemble::{Raw, assemble};
use super::cells::CellTable;
use super::delimited::header_number;
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::sample_clock::{self, SampleClock};
use super::{About, Format, ReadContext, date, stamp};
use crate::text::grid::{Dialect, push_line};
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, Line};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunStatus};

pub mod sections;
pub mod text_export;

pub use text_export::IviumText;

/// Reader of IviumSoft's own files.
pub struct IviumIdf;

/// Separator of lines inside one value.
const INNER_LINE: &str = "\u{1c}\u{1e}";

impl Format for IviumIdf {
    fn about(&self) -> About {
        About {
            id: "ivium-idf",
            title: "Ivium potentiostat file of IviumSoft (.idf, .ids)",
            extensions: &["idf", "ids"],
            version: 3,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let start = &head.bytes[..head.bytes.len().min(512)];
        let begins = start.starts_with(&[0; 16]) || start.starts_with(&[b' '; 16]);
        let holds = |mark: &[u8]| start.windows(mark.len()).any(|window| window == mark);
        Match::certain_if(
            begins && (holds(b"QR=") || holds(b"Peaks=")),
            "a section of IviumSoft with QR or Peaks",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let text = WINDOWS_1252.decode_without_bom_handling(bytes).0;
        let lines = sections::lines(&text);
        let (sets, settings) = sections::data_sets(&lines);
        if sets.iter().all(|set| set.rows.is_empty()) {
            return Err(ReadError::HeaderOnly {
                line: lines.len(),
                found: format!(
                    "{} settings, no row of primary_data",
                    settings.len().max(sets.len())
                ),
            });
        }
        let mut issues = Vec::new();
        let mut tables = Vec::new();
        for set in sets.iter().filter(|set| !set.rows.is_empty()) {
            let title = set.setting("Title").unwrap_or("");
            let name = table_name(title, sets.len(), &tables);
            tables.push(table(name, set, &mut issues)?);
        }
        let (status, status_evidence) = status(&sets);
        let first = &sets[0];
        let technique = first.setting("Technique").or(first.setting("Method"));
        let is_step_response = sets.iter().all(is_potential_step);
        Ok(Reading {
            technique: technique.map(str::to_owned),
            is_step_response,
            encoding: Some("windows-1252"),
            status,
            status_evidence,
            started_at: start_of_all(&sets, &mut issues),
            header_tags: header_tags(first, is_step_response),
            tables,
            original_metadata: metadata(first),
            issues,
            ..self.reading()
        })
    }
}

fn table_name(title: &str, sets: usize, known: &[RunTable]) -> String {
    let title = if title.is_empty() { "set" } else { title };
    let is_taken = |name: &str| known.iter().any(|table| table.name == name);
    match (sets, is_taken(title)) {
        (1, _) => String::new(),
        (_, false) => title.to_owned(),
        _ => format!("{title} ({})", known.len() + 1),
    }
}

fn is_potential_step(set: &DataSet<'_>) -> bool {
    set.setting("Method") == Some("Transients") && set.setting("Technique") == Some("ChronoAmperometry")
}

fn table(name: String, set: &DataSet<'_>, issues: &mut Vec<Issue>) -> Result<RunTable, ReadError> {
    let headers = headers(set)?;
    let keep_text = vec![false; headers.len()];
    let mut cells = CellTable::new(set.line, &keep_text, set.rows.len());
    let dialect = Dialect::new(Delimiter::Blanks, Decimal::Point);
    for row in &set.rows {
        let line = Line {
            number: row.number,
            text: row.text,
            ended: true,
        };
        push_line(&mut cells, line, dialect);
    }
    let mut raw = Raw::of_instrument(name, headers, cells);
    let interval = set.setting("Interval time").and_then(header_number);
    if let Some(interval_s) = interval.filter(|_| set.setting("Method") == Some("Transients")) {
        let clock = SampleClock {
            interval_s,
            name: "Interval time",
            digits: 6,
            drift: 0.0,
        };
        sample_clock::rebuild(&mut raw, 0, clock, issues);
    }
    assemble(raw, issues)
}

/// The columns have no names in the file; they follow from the method.
fn headers(set: &DataSet<'_>) -> Result<Vec<Header>, ReadError> {
    let method = set.setting("Method").unwrap_or("");
    let headers: Vec<Header> = match method {
        "Transients" => ["time/s", "I/A", "E/V"].map(Header::parse).into(),
        "Impedance" => ["Z real/Ohm", "Z imaginary/Ohm", "frequency/Hz"]
            .map(Header::parse)
            .into(),
        other => {
            return Err(ReadError::NeverSeen {
                what: "this method of Ivium",
                found: quoted(other),
            });
        }
    };
    match set.columns {
        Some(columns) if columns == headers.len() => Ok(headers),
        found => Err(ReadError::NeverSeen {
            what: "primary_data of Ivium with another number of columns than three",
            found: format!("{} columns", found.unwrap_or(0)),
        }),
    }
}

fn status(sets: &[DataSet<'_>]) -> (RunStatus, String) {
    for set in sets {
        let (declared, found) = (set.declared_rows.unwrap_or(0), set.rows.len());
        if set.declared_rows.is_none() || found < declared {
            let evidence = format!("primary_data declares {declared} rows, {found} found");
            return (RunStatus::Cut, evidence);
        }
    }
    let all: Vec<(RunStatus, String)> = sets.iter().map(end_condition).collect();
    let worst = all.iter().find(|(status, _)| *status != RunStatus::Complete);
    worst
        .or(all.first())
        .cloned()
        .unwrap_or((RunStatus::Unknown, "no data set".to_owned()))
}

fn end_condition(set: &DataSet<'_>) -> (RunStatus, String) {
    let Some(condition) = report(set, "endcondition") else {
        return (RunStatus::Unknown, "the report has no endcondition".to_owned());
    };
    let status = match condition {
        ":endcondition" => RunStatus::StillRunning,
        "Scan completed" | "normal" => RunStatus::Complete,
        "Scan Aborted" => RunStatus::Aborted,
        _ => RunStatus::Unknown,
    };
    (status, format!("endcondition is {}", quoted(condition)))
}

/// A value of the report, which is one setting of several lines.
fn report<'a>(set: &DataSet<'a>, key: &str) -> Option<&'a str> {
    let report = set.setting("Report.Process data")?;
    let pairs = report.split(INNER_LINE).filter_map(|line| line.split_once(':'));
    let mut found = pairs.filter(|(name, _)| name.trim() == key);
    found.next().map(|(_, value)| value.trim())
}

fn start_of_all(sets: &[DataSet<'_>], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let mut found = Vec::new();
    let starts: Vec<StartedAt> = sets
        .iter()
        .filter_map(|set| started_at(set, &mut found))
        .collect();
    // The same doubt in every set is said once.
    found.dedup();
    issues.extend(found);
    stamp::shared(starts, issues)
}

fn started_at(set: &DataSet<'_>, issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let qr = set.setting("QR").unwrap_or("");
    let days = qr
        .split(',')
        .nth(5)
        .and_then(header_number)
        .filter(|days| *days > 0.0);
    if let Some((days, local)) = days.and_then(|days| Some((days, stamp::from_day_number(days, false)?))) {
        return Some(StartedAt {
            raw: days.to_string(),
            kind: Timestamp::Start,
            local: Some(local.to_string()),
            offset: None,
            basis: "days since 1899-12-30 in the QR line".to_owned(),
        });
    }
    let text = [set.setting("starttime"), report(set, "start time")];
    let text = text.into_iter().flatten().find(|text| !text.is_empty())?;
    let end = [set.setting("endtime"), report(set, "end time")];
    let end = end
        .into_iter()
        .flatten()
        .find(|text| !text.is_empty())
        .unwrap_or("");
    let (date, time) = text.split_once(' ').unwrap_or((text, ""));
    let end_date = end.split(' ').next().unwrap_or("");
    let (stamp, issue) = date::started_at(date, time.trim(), Timestamp::Start, &[("endtime", end_date)]);
    issues.extend(issue.map(|issue| issue.at("start time")));
    Some(stamp)
}

/// The instrument, and for potential steps the level farthest from zero.
fn header_tags(set: &DataSet<'_>, is_step: bool) -> Vec<(String, String, String)> {
    let mut tags = Vec::new();
    let tag = |key: &str, value: String, name: &str| (key.to_owned(), value, name.to_owned());
    if let Some(serial) = set.setting("serialnumber").filter(|serial| !serial.is_empty()) {
        tags.push(tag(keys::INSTRUMENT, format!("Ivium {serial}"), "serialnumber"));
    }
    let levels = set
        .settings
        .iter()
        .filter(|(key, _)| key.starts_with("Levels.E["));
    let levels = levels.filter_map(|(key, value)| Some((*key, header_number(value)?)));
    let farthest = levels.reduce(|best, next| if next.1.abs() > best.1.abs() { next } else { best });
    if let Some((key, volts)) = farthest.filter(|_| is_step) {
        tags.push(tag(keys::VOLTAGE_V, (volts + 0.0).to_string(), key));
    }
    tags
}

fn metadata(set: &DataSet<'_>) -> Vec<(String, String)> {
    let pair = |(key, value): &(&str, &str)| ((*key).to_owned(), value.replace(INNER_LINE, "; "));
    set.settings.iter().map(pair).collect()
}
