//! Spreadsheets (.xlsx, .xls): every sheet with a header row that names a time column, the plain run table's
//! columns and those of the NOVA export alike; where there is none, the table of a climate logger.

use super::autolab_nova;
use super::delimited::metadata;
use super::recognition::{FileHead, Match};
use super::sheet_cells::{self, Sheet};
use super::{About, Format, ReadContext, ReadError, climate, plain_table};
use crate::table::{self, layout, sheet as text_of};
use crate::text::{Delimiter, Line};
use crate::{Reading, RunTable, StartedAt};
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of spreadsheets.
pub struct Spreadsheet;

impl Format for Spreadsheet {
    fn about(&self) -> About {
        About {
            id: "spreadsheet",
            title: "Excel spreadsheet with a run table, as exported by Metrohm Autolab NOVA, or of a climate logger (.xlsx, .xls)",
            extensions: &["xlsx", "xls", "xlsm"],
            version: 12,
        }
    }

    fn is_generic(&self) -> bool {
        true
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let holds = |mark: &[u8]| head.bytes.windows(mark.len()).any(|window| window == mark);
        /// Bytes before the name of the first member of a zip archive.
        const NAME_AT: usize = 30;
        let begins_with = |name: &[u8]| {
            head.bytes
                .get(NAME_AT..)
                .is_some_and(|rest| rest.starts_with(name))
        };
        match head.bytes {
            // A binary file of NETZSCH Proteus (.ngb-*), which may hold "xl/" by chance.
            [b'P', b'K', 3, 4, ..] if begins_with(b"Streams/") => Match::No,
            [b'P', b'K', 3, 4, ..] if holds(b"[Content_Types].xml") || holds(b"xl/") => {
                Match::Certain("a zip archive with the parts of an Excel workbook")
            }
            [b'P', b'K', 3, 4, ..] if self.about().extensions.contains(&head.extension().as_str()) => {
                Match::Possible {
                    score: 0.5,
                    reason: "a zip archive with the extension of a spreadsheet",
                }
            }
            [0xD0, 0xCF, 0x11, 0xE0, ..] => Match::Possible {
                score: 0.7,
                reason: "a compound file, as .xls is",
            },
            _ => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let mut issues = Vec::new();
        let mut tables = Vec::new();
        let mut refusal = None;
        let mut is_step_response = true;
        let mut started_at = None;
        let sheets = sheet_cells::read(bytes, context.max_unpacked_bytes)?;
        if let Some(stated) = context.answers.table() {
            let (sheet, texts) = stated.sheet(&sheets)?;
            issues.extend(uncomputed(sheet));
            let lines = text_of::lines(sheet, &texts);
            let (tables, started_at, names_at) = plain_table::runs(&lines, context, false, &mut issues)?;
            return Ok(Reading {
                status_evidence: "the workbook is whole".to_owned(),
                started_at,
                tables,
                original_metadata: metadata(&lines, names_at.unwrap_or(0)),
                issues,
                ..self.reading()
            });
        }
        // A workbook tells numbers from texts itself.
        let mut own = context.clone();
        let typed = [("decimal", "point"), ("thousands", "none")];
        typed
            .into_iter()
            .for_each(|(key, word)| own.answers.add(key, word).unwrap_or_default());
        let mut logs = Vec::new();
        for sheet in &sheets {
            issues.extend(uncomputed(sheet));
            let wide = text_of::texts(sheet, usize::MAX);
            let columns = width(&text_of::lines(sheet, &wide));
            let Some(columns) = columns else {
                if let Err(waits @ ReadError::HeaderOnly { .. }) =
                    layout::best_shape(&text_of::lines(sheet, &wide))
                {
                    refusal = refusal.or(Some(waits));
                }
                continue;
            };
            // A large sheet is held once as text.
            drop(wide);
            let texts = text_of::texts(sheet, columns);
            let lines = text_of::lines(sheet, &texts);
            if climate::table::is_log(&lines, || layout::best_shape(&lines).ok()) {
                logs.push((sheet, texts));
                continue;
            }
            let mut found = Vec::new();
            match run(sheet, &text_of::lines(sheet, &texts), &own, &mut found) {
                Ok((runs, start, is_step)) => {
                    tables.extend(runs);
                    issues.extend(found);
                    is_step_response &= is_step;
                    started_at = started_at.or(start);
                }
                Err(error) => {
                    let message = format!("sheet {} is left out: {error}", super::error::quoted(&sheet.name));
                    issues.push(Issue::warning("table-refused", message).at(error.place()));
                    refusal = refusal.or(Some(error));
                }
            }
        }
        if tables.is_empty()
            && let [(sheet, texts), others @ ..] = logs.as_slice()
        {
            issues.extend(others.iter().map(|(other, _)| left_out(other, sheet)));
            let evidence = "the workbook is whole; the format declares no number of rows".to_owned();
            let status = (RunStatus::Complete, evidence);
            let lines = text_of::lines(sheet, texts);
            return climate::table::read_lines(self.reading(), None, &own, &lines, status, issues);
        }
        if tables.is_empty() {
            if let Some(sheet) = sheets.iter().find(|sheet| sheet.formulas_without_value.is_some()) {
                return Err(without_values(sheet));
            }
            return Err(refusal.unwrap_or(ReadError::NoHeader {
                line: 0,
                found: "no sheet has a row that names a time column".to_owned(),
            }));
        }
        join_halves(&mut tables, &mut issues);
        if let [only] = tables.as_mut_slice() {
            only.name.clear();
        }
        Ok(Reading {
            is_step_response,
            status_evidence: "the workbook is whole; the format declares no number of rows".to_owned(),
            started_at,
            tables,
            issues,
            ..self.reading()
        })
    }
}

/// Columns of the table in a sheet: what stands to the right of its last name belongs to something else.
fn width(lines: &[Line<'_>]) -> Option<usize> {
    let shape = layout::shapes(lines)
        .into_iter()
        .find(|shape| shape.delimiter == Delimiter::Tab)?;
    (shape.names_at.is_some() && shape.known > 0).then_some(shape.names.len())
}

/// The runs of a sheet, the start that it states, and whether they can be step responses.
fn run(
    sheet: &Sheet,
    lines: &[Line<'_>],
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<(Vec<RunTable>, Option<StartedAt>, bool), ReadError> {
    let layout = layout::decide(lines, context)?;
    let headers = layout.headers();
    if autolab_nova::is_nova(&headers) {
        let part = layout.shape.data_at..lines.len();
        let read = table::read(lines, &layout, part, |header| {
            plain_table::is_flag(header) || autolab_nova::is_flag(header)
        });
        let is_step = !autolab_nova::is_cyclic(&headers);
        let table = autolab_nova::table(sheet.name.clone(), read.headers, read.cells, issues)?;
        return Ok((vec![table], None, is_step));
    }
    let needs_response = ReadContext {
        needs_response: true,
        ..context.clone()
    };
    let (mut runs, start, _) = plain_table::runs(lines, &needs_response, true, issues)?;
    for run in &mut runs {
        let own = run.name.clone();
        run.name = if own.is_empty() {
            sheet.name.clone()
        } else {
            format!("{}, {own}", sheet.name)
        };
    }
    Ok((runs, start, true))
}

fn left_out(other: &Sheet, sheet: &Sheet) -> Issue {
    let message = format!(
        "sheet {} is left out: sheet {} is read, and a file is one log",
        super::error::quoted(&other.name),
        super::error::quoted(&sheet.name)
    );
    Issue::warning("table-refused", message).mend("save each sheet as a file of its own")
}

fn uncomputed(sheet: &Sheet) -> Option<Issue> {
    let (count, row, column) = sheet.formulas_without_value?;
    let message = format!(
        "sheet {} holds {count} formulas without a value, the first in row {row}, column {column}: no program has computed them",
        super::error::quoted(&sheet.name)
    );
    let mend = "open the workbook in a spreadsheet program and save it, or export the sheet as CSV";
    Some(Issue::warning("formulas-without-values", message).mend(mend))
}

fn without_values(sheet: &Sheet) -> ReadError {
    let (count, row, column) = sheet.formulas_without_value.unwrap_or_default();
    ReadError::Formulas {
        line: row as usize,
        column: column as usize,
        count,
    }
}

/// Two sheets, of which one holds what the instrument measured and the other only how the strip moved, are one run. Their
/// times are taken to be counted from the same moment, which a warning says.
fn join_halves(tables: &mut Vec<RunTable>, issues: &mut Vec<Issue>) {
    let has = |table: &RunTable, wanted: &dyn Fn(Quantity) -> bool| {
        table.channels.iter().any(|own| wanted(own.quantity))
    };
    let is_electrical = |quantity| matches!(quantity, Quantity::Current | Quantity::Voltage);
    let is_motion = |quantity: Quantity| quantity.is_response() && !is_electrical(quantity);
    let halves = |a: &RunTable, b: &RunTable| {
        has(a, &is_electrical) && !has(a, &is_motion) && !has(b, &is_electrical) && has(b, &is_motion)
    };
    let [first, second] = tables.as_slice() else {
        return;
    };
    let (electrical, motion) = match (halves(first, second), halves(second, first)) {
        (true, _) => (0, 1),
        (_, true) => (1, 0),
        _ => return,
    };
    let message = format!(
        "sheets {} and {} are joined to one run, as if both counted time from the same moment",
        super::error::quoted(&tables[electrical].name),
        super::error::quoted(&tables[motion].name)
    );
    let mend = "where they do not, bring them to one clock, or export each sheet as a run of its own";
    issues.push(Issue::warning("sheets-joined", message).mend(mend));
    let moved = tables.remove(motion);
    let joined = &mut tables[0];
    joined.rows = joined.rows.max(moved.rows);
    joined.channels.extend(moved.channels);
    joined.flags.extend(moved.flags);
    if let (Some(own), Some(other)) = (joined.time_first_last_s, moved.time_first_last_s) {
        joined.time_first_last_s = Some((own.0.min(other.0), own.1.max(other.1)));
    }
}
