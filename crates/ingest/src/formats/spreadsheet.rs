//! Spreadsheets (.xlsx, .xls): every sheet with a header row that names a time column, the plain run table's
//! columns and those of the NOVA export alike; where there is none, the table of a climate logger.

use super::assemble::{Raw, assemble};
use super::autolab_nova;
use super::cells::CellTable;
use super::recognition::{FileHead, Match};
use super::sheet_cells::{self, Sheet, SheetCell, SheetRow};
use super::{Format, ReadContext, ReadError, climate, plain_table, unpacking};
use crate::formats::policy::HEADER_WITHIN_ROWS;
use crate::text::unit_row::unit_row;
use crate::text::{Cell, Decimal, layout, number};
use crate::{Reading, RunTable};
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of spreadsheets.
pub struct Spreadsheet;

impl Format for Spreadsheet {
    fn id(&self) -> &'static str {
        "spreadsheet"
    }

    fn title(&self) -> &'static str {
        "Excel spreadsheet with a run table, as exported by Metrohm Autolab NOVA, or of a climate logger (.xlsx, .xls)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["xlsx", "xls", "xlsm"]
    }

    fn version(&self) -> u32 {
        7
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
            [b'P', b'K', 3, 4, ..] if self.extensions().contains(&head.extension().as_str()) => {
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
        if bytes.starts_with(b"PK") {
            unpacking::check_size(bytes, context.max_unpacked_bytes)?;
        }
        let mut issues = Vec::new();
        let mut tables = Vec::new();
        let mut refusal = None;
        let mut is_step_response = true;
        let sheets = sheet_cells::read(bytes)?;
        for sheet in &sheets {
            let Some(header_at) = header_row(sheet) else {
                continue;
            };
            let mut found = Vec::new();
            match table(sheet, header_at, &mut found) {
                Ok((table, is_step)) => {
                    tables.push(table);
                    issues.extend(found);
                    is_step_response &= is_step;
                }
                Err(error) => {
                    let message = format!("sheet {} is left out: {error}", super::error::quoted(&sheet.name));
                    issues.push(Issue::warning("table-refused", message).at(error.place()));
                    refusal = refusal.or(Some(error));
                }
            }
        }
        if tables.is_empty()
            && let Some(log) = climate::sheet::log((self.id(), self.version()), context.date_order, &sheets)
        {
            return log;
        }
        if tables.is_empty() {
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
            format: self.id(),
            reader_version: self.version(),
            technique: None,
            is_step_response,
            encoding: None,
            status: RunStatus::Complete,
            status_evidence: "the workbook is whole; the format declares no number of rows".to_owned(),
            started_at: None,
            header_tags: Vec::new(),
            tables,
            original_metadata: Vec::new(),
            issues,
        })
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

/// Index of the first row with a time column that can be used, else of the first that speaks of time.
fn header_row(sheet: &Sheet) -> Option<usize> {
    let time = |row: &SheetRow| {
        let texts = row.cells.iter().filter_map(|(_, cell)| match cell {
            SheetCell::Text(text) => Some(text.as_str()),
            _ => None,
        });
        layout::time_among(texts)
    };
    let rows = &sheet.rows[..sheet.rows.len().min(HEADER_WITHIN_ROWS)];
    let usable = rows.iter().position(|row| time(row) == Some(true));
    usable.or_else(|| rows.iter().position(|row| time(row).is_some()))
}

/// The run table of a sheet, and whether it can be a step response.
fn table(sheet: &Sheet, header_at: usize, issues: &mut Vec<Issue>) -> Result<(RunTable, bool), ReadError> {
    let header_row = &sheet.rows[header_at];
    let named = header_row.cells.iter().filter_map(|(column, cell)| match cell {
        SheetCell::Text(text) if !text.trim().is_empty() => Some((*column, text)),
        _ => None,
    });
    let (places, names): (Vec<u32>, Vec<&str>) = named.map(|(column, text)| (column, text.as_str())).unzip();
    let units = units_below(sheet, header_at, &places);
    let headers = layout::headers(&names, units.as_deref());
    let is_nova = autolab_nova::is_nova(&headers);
    let keep_text: Vec<bool> = headers
        .iter()
        .map(|header| plain_table::is_flag(header) || (is_nova && autolab_nova::is_flag(header)))
        .collect();
    let cells = cells(
        sheet,
        header_at,
        usize::from(units.is_some()),
        &places,
        &keep_text,
    );
    let name = sheet.name.clone();
    if is_nova {
        let is_step_response = !autolab_nova::is_cyclic(&headers);
        return Ok((
            autolab_nova::table(name, headers, cells, issues)?,
            is_step_response,
        ));
    }
    let raw = Raw {
        name,
        headers,
        cells,
        flags: Vec::new(),
        printed_time: None,
        time_zero_is_step: true,
        must_be_run: true,
        must_respond: true,
    };
    Ok((assemble(raw, issues)?, true))
}

/// Units in the row below the names.
fn units_below(sheet: &Sheet, header_at: usize, places: &[u32]) -> Option<Vec<String>> {
    let row = sheet.rows.get(header_at + 1)?;
    let text = |place: &u32| {
        let found = row.cells.binary_search_by_key(place, |(column, _)| *column);
        match found.map(|at| &row.cells[at].1) {
            Ok(SheetCell::Text(text)) => Some(text.clone()),
            Ok(_) => None,
            Err(_) => Some(String::new()),
        }
    };
    let texts: Vec<String> = places.iter().map(text).collect::<Option<_>>()?;
    unit_row(places.len(), texts.iter().map(String::as_str))
}

fn cells(
    sheet: &Sheet,
    header_at: usize,
    rows_of_units: usize,
    places: &[u32],
    keep_text: &[bool],
) -> CellTable {
    let data = &sheet.rows[header_at + 1 + rows_of_units..];
    let decimal = decimal_of_texts(data.iter().flat_map(|row| row.cells.iter().map(|(_, cell)| cell)));
    let mut table = CellTable::new(sheet.rows[header_at].number as usize, keep_text, data.len());
    for row in data {
        let mut any = false;
        for (index, place) in places.iter().enumerate() {
            let (cell, text) = row.cell(*place, decimal);
            any |= cell != Cell::Empty;
            let column = &mut table.columns[index];
            // A row without any cell is none, so columns run ahead of the rows until it is ended.
            column.push(row.number as usize, cell, || text.to_owned());
        }
        if any {
            table.end_row(row.number as usize, places.len());
        } else {
            let rows = table.rows();
            table
                .columns
                .iter_mut()
                .for_each(|column| column.numbers.truncate(rows));
        }
    }
    table
}

/// Decimal sign of numbers that a sheet stores as text: a comma where only that makes them numbers.
pub fn decimal_of_texts<'a>(cells: impl Iterator<Item = &'a SheetCell>) -> Decimal {
    let (mut point, mut comma) = (false, false);
    for cell in cells {
        if let SheetCell::Text(text) = cell {
            let reads = |decimal| matches!(number::parse(text, decimal), Cell::Number(_));
            let (as_point, as_comma) = (reads(Decimal::Point), reads(Decimal::Comma));
            point |= as_point && !as_comma;
            comma |= as_comma && !as_point;
        }
    }
    if comma && !point {
        Decimal::Comma
    } else {
        Decimal::Point
    }
}
