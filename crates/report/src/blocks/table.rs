//! A table on a page.

use serde::Serialize;

use crate::site::Site;
use crate::tables::{ShownCell, grid, note_letter, note_letters, remarks, repeated};
use ieap_analysis::study::UNTOLD;
use ieap_domain::number::interval;
use ieap_show::{Cell, Content, SourceOrigin, Table};

/// A table as its template prints it.
#[derive(Debug, Serialize)]
pub struct TableText {
    title: String,
    head: Vec<HeadText>,
    rows: Vec<Vec<CellText>>,
    /// Letters and texts.
    notes: Vec<(String, String)>,
    remarks: Vec<String>,
}

#[derive(Debug, Serialize)]
struct HeadText {
    symbol: String,
    unit: String,
    quantity: String,
    is_number: bool,
}

#[derive(Debug, Serialize)]
struct CellText {
    text: String,
    /// Letters of its footnotes.
    #[serde(skip_serializing_if = "String::is_empty")]
    letters: String,
    /// The 95 % interval.
    #[serde(skip_serializing_if = "String::is_empty")]
    interval: String,
    /// Where it leads to.
    #[serde(skip_serializing_if = "Option::is_none")]
    href: Option<String>,
    is_number: bool,
    is_head: bool,
    /// Whether it says that nothing can be told: it stands back behind what is.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_untold: bool,
}

impl TableText {
    /// The text of a table; the name of a run leads to its page.
    pub fn of(site: &Site, table: &Table) -> TableText {
        let (cells, repeated) = (grid(table), repeated(table));
        let is_number = |column: usize| cells.iter().all(|row| row[column].is_number());
        let numbers: Vec<bool> = (0..table.columns.len()).map(is_number).collect();
        // A column in which no row says anything is not shown.
        let says = |column: usize| {
            column < table.stub
                || table.rows.iter().zip(&cells).any(|(row, shown)| {
                    !row.cells[column].notes.is_empty() || !matches!(shown[column].text().as_str(), "" | "–")
                })
        };
        let seen: Vec<usize> = (0..table.columns.len()).filter(|column| says(*column)).collect();
        let head = seen.iter().map(|&at| {
            let column = &table.columns[at];
            HeadText {
                symbol: column.symbol.clone(),
                unit: column.unit.clone(),
                quantity: column.quantity.clone(),
                is_number: numbers[at],
            }
        });
        let cell = |row: usize, column: usize| {
            let (cell, shown) = (&table.rows[row].cells[column], &cells[row][column]);
            CellText {
                text: if repeated[row][column] {
                    String::new()
                } else {
                    shown.text()
                },
                letters: note_letters(&cell.notes),
                interval: interval_of(cell),
                href: href(site, cell, shown),
                is_number: numbers[column],
                is_untold: shown.text().starts_with(UNTOLD),
                // What stands above already heads nothing.
                is_head: column < table.stub && !repeated[row][column],
            }
        };
        let row = |row: usize| seen.iter().map(|&column| cell(row, column)).collect();
        let notes = table.notes.iter().enumerate();
        TableText {
            title: table.title.clone(),
            head: head.collect(),
            rows: (0..table.rows.len()).map(row).collect(),
            notes: notes.map(|(at, note)| (note_letter(at), note.clone())).collect(),
            remarks: remarks(table),
        }
    }
}

fn interval_of(cell: &Cell) -> String {
    match &cell.content {
        Content::Measured(own) => match own.low_95.zip(own.high_95) {
            Some((low, high)) => format!("95\u{a0}%: {}", interval(low, high)),
            None => String::new(),
        },
        _ => String::new(),
    }
}

/// The page of a run that a cell names.
fn href(site: &Site, cell: &Cell, shown: &ShownCell) -> Option<String> {
    let ShownCell::Words(words) = shown else {
        return None;
    };
    let named = cell.sources.iter().find(|source| source.name == *words)?;
    let run = site.run_of(words)?;
    Some(match named.origin {
        SourceOrigin::Strip => site.strip_href(run),
        _ => site.run_href(run),
    })
}
