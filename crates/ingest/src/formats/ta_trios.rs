//! TA Instruments TRIOS text export: sections in square brackets, then steps with names, units and rows.
//!
//! Two flavours: `[step]`, a name, names, units, rows; and `[Step]` with `Number of points`, `Variables`, `Units`,
//! `Data point` lines. Decimal sign and order of dates follow the computer. Names may repeat with different units, so a
//! column is known by both. Each step is a table; time and temperature are taken as such, everything else keeps its
//! name and unit. Fewer points than declared, or a missing line end, show a cut. The JSON export is not read.

use super::assemble::{Raw, assemble_untimed};
use super::error::ReadError;
use super::recognition::{FileHead, Match};
use super::{About, Format, ReadContext, date, delimited};
use crate::text::grid::Dialect;
use crate::text::header::{Header, is_of_analyser, is_of_any_analyser};
use crate::text::{Delimiter, Line};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunStatus};

/// Reader of TRIOS text.
pub struct TaTrios;

/// One step as text.
struct Step<'a> {
    name: &'a str,
    declared_rows: Option<usize>,
    names_line: usize,
    names: Vec<&'a str>,
    units: Vec<&'a str>,
    rows: Vec<Line<'a>>,
}

impl Format for TaTrios {
    fn about(&self) -> About {
        About {
            id: "ta-trios",
            title: "TA Instruments TRIOS text export (.txt)",
            extensions: &["txt"],
            version: 5,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let is_export = text.starts_with("[Version]") && text.contains("TA Instruments");
        Match::certain_if(
            is_export || (text.starts_with("Filename\t") && text.contains("[File Parameters]")),
            "sections of a TRIOS export",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (text_status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let first_step = lines
            .iter()
            .position(|line| is_step(line.text))
            .unwrap_or(lines.len());
        let (preamble, rest) = lines.split_at(first_step);
        let steps = steps(rest);
        let of_analyser = preamble.iter().any(|line| names_analyser(line.text));
        let mut tables: Vec<RunTable> = Vec::new();
        for step in &steps {
            let is_taken = tables.iter().any(|table| table.name == step.name);
            let name = if is_taken {
                format!("{} ({})", step.name, tables.len() + 1)
            } else {
                step.name.to_owned()
            };
            tables.push(table(name, step, of_analyser, &mut issues)?);
        }
        let Some(first) = steps.first() else {
            return Err(ReadError::header_only(lines.len(), "no step with rows"));
        };
        let (status, status_evidence) = status(&steps, text_status, evidence);
        let pairs = pairs(preamble);
        let instrument = pairs
            .iter()
            .find(|(key, value)| key == "Instrument name" && !value.is_empty());
        Ok(Reading {
            technique: Some(first.name.to_owned()),
            is_step_response: false,
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
            started_at: started_at(&pairs, &mut issues),
            header_tags: instrument
                .map(|(key, value)| (keys::INSTRUMENT.to_owned(), value.clone(), key.clone()))
                .into_iter()
                .collect(),
            tables,
            original_metadata: pairs,
            issues,
            ..self.reading()
        })
    }
}

fn is_step(text: &str) -> bool {
    matches!(text.trim(), "[step]" | "[Step]")
}

fn steps<'a>(lines: &[Line<'a>]) -> Vec<Step<'a>> {
    let parts = lines.split(|line| is_step(line.text));
    parts
        .filter_map(step)
        .filter(|step| !step.rows.is_empty() && !step.names.is_empty())
        .collect()
}

fn step<'a>(lines: &[Line<'a>]) -> Option<Step<'a>> {
    let cells = |line: &Line<'a>| -> Vec<&'a str> { line.text.split('\t').map(str::trim).collect() };
    let behind = |line: &Line<'a>| -> Vec<&'a str> { line.text.split('\t').skip(1).map(str::trim).collect() };
    let of = |key: &str| {
        lines
            .iter()
            .find(|line| line.text.split('\t').next() == Some(key))
    };
    if let (Some(variables), Some(units)) = (of("Variables"), of("Units")) {
        let points = lines.iter().filter_map(|line| {
            let text = line.text.strip_prefix("Data point\t")?;
            Some(Line { text, ..*line })
        });
        let first = lines.first()?;
        return Some(Step {
            name: first.text.split('\t').next_back().unwrap_or("").trim(),
            declared_rows: of("Number of points").and_then(|line| behind(line).first()?.parse().ok()),
            names_line: variables.number,
            names: behind(variables),
            units: behind(units),
            rows: points.collect(),
        });
    }
    let [name, names, rest @ ..] = lines else {
        return None;
    };
    // Thermal analysers may write units into the names and leave their row out.
    let (units, rows) = match rest {
        [units, rows @ ..]
            if !cells(units)
                .iter()
                .any(|cell| delimited::header_number(cell).is_some()) =>
        {
            (cells(units), rows)
        }
        rows => (Vec::new(), rows),
    };
    let is_row = |line: &&Line<'a>| !line.text.trim().is_empty() && !line.text.starts_with('[');
    Some(Step {
        name: name.text.trim(),
        declared_rows: None,
        names_line: names.number,
        names: cells(names),
        units,
        rows: rows.iter().take_while(is_row).copied().collect(),
    })
}

/// Whether a line above the steps names a dynamic mechanical analyser: instrument type DMA850.
fn names_analyser(text: &str) -> bool {
    text.split_once('\t').is_some_and(|(key, value)| {
        key.starts_with("Instrument") && ["DMA", "RSA", "Q800"].iter().any(|name| value.contains(name))
    })
}

fn table(
    name: String,
    step: &Step<'_>,
    of_analyser: bool,
    issues: &mut Vec<Issue>,
) -> Result<RunTable, ReadError> {
    let unit = |index: usize| {
        if step.units.is_empty() {
            None
        } else {
            Some(step.units.get(index).copied().unwrap_or(""))
        }
    };
    let headers: Vec<Header> = step
        .names
        .iter()
        .enumerate()
        .map(|(index, name)| header(name, unit(index), of_analyser))
        .collect();
    let dialect = Dialect::new(Delimiter::Tab, delimited::decimal_of(&step.rows, Delimiter::Tab)?);
    let cells = delimited::cells_of(step.names_line, headers.len(), &step.rows, dialect);
    assemble_untimed(Raw::of_instrument(name, headers, cells), issues)
}

/// Only an analyser's moduli are of bending or stretching. Without a row of units they stand in the names.
fn header(name: &str, unit: Option<&str>, of_analyser: bool) -> Header {
    let header = match unit {
        None => Header::parse(name),
        Some(unit) => Header::with_unit(name, unit),
    };
    header.keeping(|quantity| {
        if of_analyser {
            is_of_analyser(quantity)
        } else {
            is_of_any_analyser(quantity)
        }
    })
}

fn status(steps: &[Step<'_>], text: RunStatus, evidence: String) -> (RunStatus, String) {
    if text == RunStatus::Cut {
        return (text, evidence);
    }
    for step in steps {
        if let Some(declared) = step.declared_rows.filter(|declared| step.rows.len() < *declared) {
            let found = step.rows.len();
            let evidence = format!("step {} declares {declared} points, {found} found", step.name);
            return (RunStatus::Cut, evidence);
        }
    }
    let all_declared = steps.iter().all(|step| step.declared_rows.is_some());
    let more = if all_declared {
        "; every step has its points"
    } else {
        "; no number of rows is declared"
    };
    (RunStatus::Complete, evidence + more)
}

fn pairs(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let pair = |line: &Line<'_>| {
        let (key, value) = line.text.split_once('\t')?;
        (!key.is_empty()).then(|| (key.trim().to_owned(), value.trim().to_owned()))
    };
    lines.iter().filter_map(pair).collect()
}

fn started_at(pairs: &[(String, String)], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let is_date = |key: &str| matches!(key, "Run date" | "rundate");
    let dates = pairs
        .iter()
        .filter(|(key, value)| is_date(key) && value.contains(|c: char| c.is_ascii_digit()));
    let (_, text) = dates.max_by_key(|(_, value)| value.len())?;
    let (day, time) = text.split_once(' ').unwrap_or((text, ""));
    let (stamp, issue) = date::started_at(day, time, Timestamp::Start, &[]);
    issues.extend(issue);
    Some(stamp)
}
