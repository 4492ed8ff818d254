//! Gamry EXPLAIN .DTA: objects `KEY TYPE value label`, then tables with a row of names and a row of units.
//!
//! Numbers follow the locale of the computer, decimal comma included, and so does the date; both are judged by
//! the file alone. The number of rows that a table declares is the plan, not what was measured.

use super::assemble::{Raw, assemble};
use super::cells::CellTable;
use super::error::{ReadError, quoted};
use super::gamry_objects::{self, Explain, Table};
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext, date, delimited, overload};
use crate::formats::policy::NO_PROBE_ABOVE_C;
use crate::text::grid::{Dialect, push_line};
use crate::text::header::{Header, Meaning};
use crate::text::{Decimal, Delimiter, Lines};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of Gamry Framework files.
pub struct GamryDta;

/// Columns with a meaning for a run or a spectrum; `P` and the like stand for other things here than in a plain table.
const KNOWN_COLUMNS: [&str; 13] = [
    "T", "Time", "Vf", "Vm", "Im", "Temp", "Voltage", "Current", "Freq", "Zreal", "Zimag", "Zmod", "Zphz",
];

impl Format for GamryDta {
    fn about(&self) -> About {
        About {
            id: "gamry-dta",
            title: "Gamry Framework EXPLAIN file (.DTA)",
            extensions: &["dta"],
            version: 6,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let mut lines = Lines::new(text).map(|line| line.text);
        let (first, second) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        Match::certain_if(
            first.trim_end() == "EXPLAIN" || second.starts_with("TAG\t"),
            "the file begins with EXPLAIN and TAG",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (text_status, text_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        delimited::note_replacements(&decoded, &lines, &mut issues);
        let explain = gamry_objects::parse(&lines);
        let tables = tables(&explain, &mut issues)?;
        let (status, status_evidence) = status(&explain, text_status, text_evidence);
        let technique = explain.value("TAG").map(str::to_owned);
        let is_step_response = technique.as_deref().is_some_and(is_step_response);
        Ok(Reading {
            is_step_response,
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
            started_at: started_at(&explain, &mut issues),
            header_tags: header_tags(&explain, is_step_response, &mut issues),
            tables,
            original_metadata: explain.metadata(),
            technique,
            issues,
            ..self.reading()
        })
    }
}

/// Chronoamperometry, and a held potential.
fn is_step_response(technique: &str) -> bool {
    technique == "CHRONOA" || technique.ends_with("_POTENTIOSTATIC")
}

fn tables(explain: &Explain<'_>, issues: &mut Vec<Issue>) -> Result<Vec<RunTable>, ReadError> {
    let rows = explain.tables.iter().flat_map(|table| &table.rows);
    let decimal = delimited::decimal_of(rows, Delimiter::Tab)?;
    let is_step = explain.value("TAG").is_some_and(is_step_response);
    let mut tables = Vec::new();
    for table in &explain.tables {
        let mut found = Vec::new();
        match run_table(table, decimal, is_step, &mut found) {
            Ok(read) => {
                issues.extend(found);
                tables.push(read);
            }
            Err(error) if explain.tables.len() == 1 => return Err(error),
            Err(error) => {
                let message = format!("table {} is left out: {error}", quoted(table.name));
                issues.push(Issue::warning("table-refused", message).at(error.place()));
            }
        }
    }
    if tables.is_empty() {
        return Err(ReadError::header_only(
            explain.tables.last().map_or(explain.lines, |table| table.line),
            "no table with rows",
        ));
    }
    Ok(tables)
}

fn run_table(
    table: &Table<'_>,
    decimal: Decimal,
    is_step: bool,
    issues: &mut Vec<Issue>,
) -> Result<RunTable, ReadError> {
    let header = |(index, name): (usize, &&str)| {
        let unit = table.units.get(index).copied().unwrap_or("");
        let header = Header::with_unit(name, unit);
        match KNOWN_COLUMNS.contains(name) {
            // The signal of the potentiostat is the voltage that was asked for; of a galvanostat it is a current.
            _ if is_step && (*name, unit) == ("Sig", "V") => Header {
                raw_name: header.raw_name,
                ..Header::with_unit("control voltage", unit)
            },
            true => header,
            false => Header {
                meaning: Meaning::Other,
                ..header
            },
        }
    };
    let headers: Vec<Header> = table.names.iter().enumerate().map(header).collect();
    let keep_text: Vec<bool> = headers.iter().map(|header| header.raw_name == "Over").collect();
    let mut cells = CellTable::new(table.line, &keep_text, table.rows.len());
    let delimiter = Delimiter::Tab;
    for row in &table.rows {
        push_line(&mut cells, *row, Dialect::new(delimiter, decimal));
    }
    let mut raw = Raw {
        name: table.name.to_owned(),
        headers,
        cells,
        flags: Vec::new(),
        printed_time: None,
        time_zero_is_step: false,
        must_be_run: false,
        must_respond: false,
    };
    if let Some(index) = keep_text.iter().position(|keep| *keep) {
        overload::exclude(&mut raw, index, is_marked, touches_current, issues);
    }
    drop_missing_probe(&mut raw, issues);
    assemble(raw, issues)
}

/// Whether any of the flags is set.
fn is_marked(flags: &str) -> bool {
    flags.contains(|flag| flag != '.')
}

/// Whether overload flags concern the cell. The position of a flag says what it means (Gamry, Framework help,
/// "Overloads"): timing, potential, control amplifier, current, settling; the eleventh is the auxiliary input.
fn touches_current(flags: &str) -> bool {
    const AUXILIARY_INPUT: usize = 10;
    flags
        .chars()
        .enumerate()
        .any(|(position, flag)| flag != '.' && position != AUXILIARY_INPUT)
}

/// Empties the readings of a thermometer that is not there, and takes the column out where none is left.
fn drop_missing_probe(raw: &mut Raw, issues: &mut Vec<Issue>) {
    let is_temperature = |header: &Header| header.meaning.quantity() == Some(Quantity::Temperature);
    let Some(index) = raw.headers.iter().position(is_temperature) else {
        return;
    };
    let column = &mut raw.cells.columns[index];
    let readings = column.numbers.iter().filter(|number| !number.is_nan()).count();
    let mut missing = 0;
    let mut shown = 0.0;
    for number in column
        .numbers
        .iter_mut()
        .filter(|number| **number > NO_PROBE_ABOVE_C)
    {
        shown = if missing == 0 { *number } else { shown };
        missing += 1;
        *number = f64::NAN;
    }
    if missing == 0 {
        return;
    }
    if missing == readings {
        // Kept as an uninterpreted column without numbers, it becomes no channel.
        raw.headers[index].meaning = Meaning::Other;
    }
    let message = format!(
        "{missing} of {readings} readings of Temp are {shown} °C and the like, as an input without a probe shows; \
         they are no temperature and are left out"
    );
    issues.push(Issue::note("no-temperature-probe", message).at(format!("column {}", index + 1)));
}

fn status(explain: &Explain<'_>, text_status: RunStatus, text_evidence: String) -> (RunStatus, String) {
    if matches!(explain.value("EXPERIMENTABORTED"), Some("T" | "TRUE")) {
        return (RunStatus::Aborted, "EXPERIMENTABORTED is T".to_owned());
    }
    if text_status == RunStatus::Cut {
        return (RunStatus::Cut, text_evidence);
    }
    let declared: Vec<(&str, usize, usize)> = explain
        .tables
        .iter()
        .filter_map(|table| Some((table.name, table.declared_rows?, table.rows.len())))
        .collect();
    let describe = |(name, planned, found): &(&str, usize, usize)| {
        format!("{name} declares {planned} rows, {found} found")
    };
    match declared.iter().find(|(_, planned, found)| found < planned) {
        Some(short) => (RunStatus::StoppedEarly, describe(short)),
        None if declared.is_empty() => (
            RunStatus::Complete,
            text_evidence + "; no table declares a number of rows",
        ),
        None => (
            RunStatus::Complete,
            declared.iter().map(describe).collect::<Vec<_>>().join("; "),
        ),
    }
}

fn started_at(explain: &Explain<'_>, issues: &mut Vec<Issue>) -> Option<StartedAt> {
    // Calibration dates are left out: real files write them month first beside a run date with the day first.
    let others = explain.objects.iter().filter(|object| {
        object.key.ends_with("DATE") && object.key != "DATE" && !object.key.ends_with("CALDATE")
    });
    let others: Vec<(&str, &str)> = others.map(|object| (object.key, object.value)).collect();
    let date = explain.value("DATE")?;
    let (stamp, issue) = date::started_at(
        date,
        explain.value("TIME").unwrap_or(""),
        Timestamp::Start,
        &others,
    );
    issues.extend(issue.map(|issue| issue.at("DATE")));
    Some(stamp)
}

/// The instrument, and for a step response the programmed level farthest from zero.
fn header_tags(
    explain: &Explain<'_>,
    is_step: bool,
    issues: &mut Vec<Issue>,
) -> Vec<(String, String, String)> {
    let mut tags = Vec::new();
    if let Some(instrument) = explain.value("PSTAT").filter(|name| !name.is_empty()) {
        tags.push((
            keys::INSTRUMENT.to_owned(),
            instrument.to_owned(),
            "PSTAT".to_owned(),
        ));
    }
    if !is_step {
        return tags;
    }
    let levels = explain.objects.iter().filter(|object| is_level(object.key));
    if let Some(relative) = levels.clone().find(|object| object.rest.first() == Some(&"T")) {
        let message = format!(
            "{} is relative to the open circuit potential, which the header does not give; no step voltage is taken \
             from the header",
            relative.key
        );
        issues.push(Issue::note("potential-relative", message).at(relative.key));
        return tags;
    }
    let mut farthest: Option<(f64, &str)> = None;
    for object in levels {
        if let Some(volts) = delimited::header_number(object.value)
            && farthest.is_none_or(|(far, _)| volts.abs() > far.abs())
        {
            farthest = Some((volts, object.key));
        }
    }
    if let Some((volts, key)) = farthest {
        // Adding zero turns -0 into 0.
        tags.push((
            keys::VOLTAGE_V.to_owned(),
            (volts + 0.0).to_string(),
            key.to_owned(),
        ));
    }
    tags
}

fn is_level(key: &str) -> bool {
    let numbered = key
        .strip_prefix("VSTEP")
        .is_some_and(|k| !k.is_empty() && k.bytes().all(|b| b.is_ascii_digit()));
    key == "VPRESTEP" || key == "VOLTAGE" || numbered
}
