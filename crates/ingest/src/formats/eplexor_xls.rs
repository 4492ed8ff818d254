//! NETZSCH GABO Eplexor export (.xls): a sheet `Exported Data` with a row of names, a row of units, then rows.
//!
//! One public file was seen, a sweep of frequency and temperature. Names and units are the dictionary's, as in any table; a
//! column that is not known is kept under its own name until a tag says what it is. The sheet `Data header` is kept as
//! metadata. The export has no date and declares no number of rows.

use super::assemble::{Raw, assemble_untimed};
use super::cells::CellTable;
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::sheet_cells::{self, Sheet, SheetCell};
use super::{About, Format, ReadContext};
use crate::Reading;
use crate::text::Cell;
use crate::text::header::{Header, is_of_analyser};

/// Reader of the Eplexor's spreadsheets.
pub struct EplexorXls;

/// Name of the sheet with the readings, and of that with the settings.
const READINGS: &str = "Exported Data";
const SETTINGS: &str = "Data header";

impl Format for EplexorXls {
    fn about(&self) -> About {
        About {
            id: "eplexor-xls",
            title: "NETZSCH GABO Eplexor export of a dynamic mechanical analysis (.xls)",
            extensions: &["xls"],
            version: 2,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let holds = |mark: &str| {
            head.bytes
                .windows(mark.len())
                .any(|window| window == mark.as_bytes())
        };
        let is_compound = head.bytes.starts_with(&[0xD0, 0xCF, 0x11, 0xE0]);
        Match::certain_if(
            is_compound && holds(READINGS) && holds(SETTINGS),
            "a compound file with the sheets of an Eplexor export",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        reading(&sheet_cells::read(bytes, context.max_unpacked_bytes)?)
    }
}

/// The reading of a workbook's sheets.
fn reading(sheets: &[Sheet]) -> Result<Reading, ReadError> {
    let never_seen = |what, found: String| Err(ReadError::NeverSeen { what, found });
    let Some(sheet) = sheets.iter().find(|sheet| sheet.name == READINGS) else {
        let names: Vec<&str> = sheets.iter().map(|sheet| sheet.name.as_str()).collect();
        return never_seen(
            "an Eplexor export without a sheet \"Exported Data\"",
            quoted(&names.join(", ")),
        );
    };
    let [names, units, ..] = sheet.rows.as_slice() else {
        return Err(ReadError::header_only(
            sheet.rows.len(),
            "no rows of names and units",
        ));
    };
    if text_at(&names.cells, 0) != Some("Nr") {
        let found = quoted(text_at(&names.cells, 0).unwrap_or(""));
        return never_seen("an Eplexor table whose first column is not \"Nr\"", found);
    }
    let mut issues = Vec::new();
    let columns: Vec<(u32, Header)> = names
        .cells
        .iter()
        .filter_map(|(place, _)| {
            let name = text_at(&names.cells, *place)?;
            let unit = text_at(&units.cells, *place).unwrap_or("");
            Some((*place, Header::with_unit(name, unit).keeping(is_of_analyser)))
        })
        .collect();
    let cells = cells(sheet, &columns);
    let headers = columns.into_iter().map(|(_, header)| header).collect();
    let table = assemble_untimed(Raw::of_instrument(String::new(), headers, cells), &mut issues)?;
    let settings = settings(sheets);
    let technique = settings.iter().find(|(key, _)| key == "Measurement type");
    Ok(Reading {
        technique: technique.map(|(_, value)| value.clone()),
        status_evidence: "the workbook is whole; the format declares no number of rows".to_owned(),
        tables: vec![table],
        original_metadata: settings,
        issues,
        ..EplexorXls.reading()
    })
}

fn text_at(cells: &[(u32, SheetCell)], place: u32) -> Option<&str> {
    cells.iter().find_map(|(column, cell)| match cell {
        SheetCell::Text(text) if *column == place => Some(text.trim()),
        _ => None,
    })
}

fn cells(sheet: &Sheet, columns: &[(u32, Header)]) -> CellTable {
    let rows = &sheet.rows[2..];
    let mut table = CellTable::new(
        sheet.rows[0].number as usize,
        &vec![false; columns.len()],
        rows.len(),
    );
    for row in rows {
        for ((place, _), column) in columns.iter().zip(&mut table.columns) {
            let found = row.cells.iter().find(|(at, _)| at == place).map(|(_, cell)| cell);
            let (cell, text) = match found {
                Some(SheetCell::Number(number)) => (Cell::Number(*number), ""),
                Some(SheetCell::Error(text)) => (Cell::NotFinite, text.as_str()),
                Some(SheetCell::Text(text) | SheetCell::Date(text)) => (Cell::Text, text.as_str()),
                None => (Cell::Empty, ""),
            };
            column.push(row.number as usize, cell, || text.to_owned());
        }
        table.end_row(row.number as usize, columns.len());
    }
    table
}

/// Rows of the sheet of settings as name and value.
fn settings(sheets: &[Sheet]) -> Vec<(String, String)> {
    let shown = |cell: &SheetCell| match cell {
        SheetCell::Number(number) => number.to_string(),
        SheetCell::Text(text) | SheetCell::Date(text) | SheetCell::Error(text) => text.trim().to_owned(),
    };
    let rows = sheets
        .iter()
        .filter(|sheet| sheet.name == SETTINGS)
        .flat_map(|sheet| &sheet.rows);
    rows.filter_map(|row| {
        let (_, first) = row.cells.first()?;
        let values: Vec<String> = row.cells[1..].iter().map(|(_, cell)| shown(cell)).collect();
        Some((shown(first).trim_end_matches(':').to_owned(), values.join("; ")))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::super::sheet_cells::SheetRow;
    use super::*;
    use ieap_domain::Quantity;

    fn sheet(name: &str, rows: &[&[&str]]) -> Sheet {
        let cell = |text: &str| match text.parse() {
            Ok(number) => SheetCell::Number(number),
            Err(_) => SheetCell::Text(text.to_owned()),
        };
        let cells = |row: &[&str]| {
            let filled = row.iter().enumerate().filter(|(_, text)| !text.is_empty());
            filled.map(|(at, text)| (at as u32, cell(text))).collect()
        };
        let rows = rows.iter().enumerate().map(|(at, row)| SheetRow {
            number: at as u32 + 1,
            cells: cells(row),
        });
        Sheet {
            name: name.to_owned(),
            rows: rows.collect(),
            formulas_without_value: None,
        }
    }

    fn exported(extra: &str, unit: &str) -> Vec<Sheet> {
        vec![
            sheet(
                SETTINGS,
                &[&["Measurement type:", "Time Sweep"], &["Limits:", "100", "50"]],
            ),
            sheet(
                READINGS,
                &[
                    &["Nr", "Time", "f", "E'", "E''", "|E*|", "tan delta", extra],
                    &["", "s", "Hz", "MPa", "MPa", "MPa", "", unit],
                    &["1", "0.5", "1", "60", "11", "61", "0.1833", "0.1"],
                    &["2", "30.5", "1", "50", "9", "50.8", "0.18", "39.8"],
                ],
            ),
        ]
    }

    #[test]
    fn columns_that_were_seen_are_read() {
        let reading = reading(&exported("T", "°C")).unwrap();
        let quantities: Vec<Quantity> = reading.tables[0].channels.iter().map(|c| c.quantity).collect();
        assert_eq!(
            quantities,
            [
                Quantity::Other,
                Quantity::Frequency,
                Quantity::StorageModulus,
                Quantity::LossModulus,
                Quantity::ComplexModulus,
                Quantity::LossFactor,
                Quantity::Temperature
            ]
        );
        assert_eq!(&reading.tables[0].channels[2].values[..], &[60.0, 50.0]);
        assert_eq!(&reading.tables[0].channels[2].time_s[..], &[0.5, 30.5]);
        assert_eq!(reading.technique.as_deref(), Some("Time Sweep"));
        assert_eq!(reading.original_metadata[1].1, "100; 50");
        assert!(reading.issues.is_empty(), "{:?}", reading.issues);
    }

    #[test]
    fn further_columns_are_known_by_the_dictionary() {
        for (name, unit, quantity) in [
            ("RH", "%", Quantity::RelativeHumidity),
            ("T", "K", Quantity::Temperature),
            ("Strain stat", "%", Quantity::Other),
            ("F dyn.", "N", Quantity::Other),
            ("T2", "°C", Quantity::Other),
        ] {
            let reading = reading(&exported(name, unit)).unwrap();
            let last = reading.tables[0].channels.iter().find(|c| c.raw_name == name);
            assert_eq!(last.unwrap().quantity, quantity, "{name}");
        }
    }

    #[test]
    fn other_layouts_are_refused() {
        let mut renamed = exported("T", "°C");
        renamed[1].name = "Sheet1".to_owned();
        assert!(matches!(reading(&renamed), Err(ReadError::NeverSeen { .. })));
        let shifted = [sheet(READINGS, &[&["Time", "E'"], &["s", "MPa"], &["1", "2"]])];
        assert!(matches!(reading(&shifted), Err(ReadError::NeverSeen { .. })));
        let short = [sheet(READINGS, &[&["Nr", "Time"], &["", "s"]])];
        assert!(reading(&short).unwrap_err().is_pending());
    }
}
