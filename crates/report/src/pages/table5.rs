//! The table of parameters: table 5 of [`ieap_analysis::tables`], one section a material, each row with its runs.

use serde::Serialize;

use super::wording::RunLink;
use crate::site::Site;
use crate::tables::{ShownCell, grid, note_letter};
use ieap_analysis::tables::{self, Cell, SourceOrigin, named};
use ieap_domain::number::interval;

/// Place of the material among the columns, and of the first column that is no part of the condition.
const MATERIAL: usize = 0;
const FIRST_VALUE: usize = 4;
/// The last two columns are numbers of samples and runs: the page shows the runs themselves.
const COUNTS: usize = 2;

/// The table as the page shows it.
#[derive(Debug, Serialize)]
pub struct Shown {
    columns: Vec<Column>,
    materials: Vec<Material>,
    footnotes: Vec<Footnote>,
    remarks: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Column {
    symbol: String,
    unit: String,
    quantity: String,
}

#[derive(Debug, Serialize)]
struct Material {
    name: String,
    rows: Vec<Row>,
}

/// One condition.
#[derive(Debug, Serialize)]
struct Row {
    environment: String,
    humidity: String,
    voltage: String,
    /// Letters of footnotes about the whole row.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    voltage_footnotes: Vec<String>,
    links: Vec<RunLink>,
    cells: Vec<ShownParameter>,
    starts_environment: bool,
}

#[derive(Debug, Serialize)]
struct ShownParameter {
    text: String,
    /// Standard error, to stand below the value; empty where there is none.
    error: String,
    /// 95 % interval, numbers of runs and samples, reasons: shown on hover.
    hover: String,
    kind: &'static str,
    /// Letters of the footnotes that give the reasons.
    footnotes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Footnote {
    letter: String,
    text: String,
}

/// Makes it.
pub fn shown(site: &Site) -> Shown {
    let input = site.input;
    let table = named("table5").map(|named| named.table(&input.of_tables()));
    let table = table.unwrap_or_default();
    let shown = grid(&table);
    let mut materials: Vec<Material> = Vec::new();
    let mut before: Option<[String; 2]> = None;
    for (row, cells) in table.rows.iter().zip(&shown) {
        let name = cells[MATERIAL].text();
        if materials.last().is_none_or(|material| material.name != name) {
            materials.push(Material { name, rows: vec![] });
            before = None;
        }
        let surroundings = [cells[1].text(), humidity(&cells[2])];
        let starts_environment = before.as_ref() != Some(&surroundings);
        before = Some(surroundings.clone());
        let [environment, humidity] = surroundings;
        let row = Row {
            environment,
            humidity,
            voltage: cells[3].text(),
            voltage_footnotes: row.cells[3].notes.iter().map(|&note| note_letter(note)).collect(),
            links: links(site, &row.cells[MATERIAL]),
            cells: parameters(&table, row, cells),
            starts_environment,
        };
        if let Some(material) = materials.last_mut() {
            material.rows.push(row);
        }
    }
    let values = FIRST_VALUE..table.columns.len().saturating_sub(COUNTS);
    let columns = table
        .columns
        .get(values)
        .unwrap_or_default()
        .iter()
        .map(|column| Column {
            symbol: column.symbol.clone(),
            unit: column.unit.clone(),
            quantity: column.quantity.clone(),
        });
    let footnotes = table.notes.iter().enumerate().map(|(at, text)| Footnote {
        letter: note_letter(at),
        text: text.clone(),
    });
    Shown {
        columns: columns.collect(),
        materials,
        footnotes: footnotes.collect(),
        remarks: crate::tables::remarks(&table),
    }
}

/// `28–38 % RH`; empty where no humidity is known.
fn humidity(cell: &ShownCell) -> String {
    match cell {
        ShownCell::Words(range) => format!("{range} % RH"),
        _ => String::new(),
    }
}

/// Links to the runs that a cell was made from.
fn links(site: &Site, cell: &Cell) -> Vec<RunLink> {
    let run = |source: &tables::Source| match source.origin {
        SourceOrigin::Run(_) => site.run_of(&source.name),
        _ => None,
    };
    cell.sources
        .iter()
        .filter_map(run)
        .map(|run| RunLink::to(site, run))
        .collect()
}

fn parameters(table: &tables::Table, row: &tables::Row, shown: &[ShownCell]) -> Vec<ShownParameter> {
    let last = row.cells.len() - COUNTS;
    (FIRST_VALUE..last)
        .map(|at| {
            let cell = &row.cells[at];
            let (text, error) = stacked(&shown[at]);
            let notes = cell
                .notes
                .iter()
                .filter_map(|&note| table.notes.get(note).cloned());
            let hover = spread(cell, row.cells[MATERIAL].sources.len())
                .into_iter()
                .chain(notes);
            ShownParameter {
                text,
                error,
                hover: hover.collect::<Vec<_>>().join("; "),
                kind: kind(&shown[at]),
                footnotes: cell.notes.iter().map(|&note| note_letter(note)).collect(),
            }
        })
        .collect()
}

/// A value, and its standard error to stand below it.
fn stacked(shown: &ShownCell) -> (String, String) {
    match shown {
        ShownCell::Number(number) => number.stacked(),
        other => (other.text(), String::new()),
    }
}

/// Interval, and the number of runs where it is not that of the row's `runs`.
fn spread(cell: &Cell, runs: usize) -> Vec<String> {
    let tables::Content::Measured(measured) = &cell.content else {
        return vec![];
    };
    let interval = match (measured.low_95, measured.high_95) {
        (Some(low), Some(high)) => Some(format!("95 %: {}", interval(low, high))),
        _ => None,
    };
    let pooled = measured.pooled.as_ref().filter(|mean| mean.runs != runs);
    let pooled = pooled.map(|mean| format!("mean of {} runs, {} samples", mean.runs, mean.samples));
    interval.into_iter().chain(pooled).collect()
}

fn kind(shown: &ShownCell) -> &'static str {
    match shown {
        ShownCell::Number(_) | ShownCell::Words(_) => "value",
        ShownCell::Below(_) | ShownCell::Above(_) | ShownCell::Between(..) => "bound",
        ShownCell::NotDetermined | ShownCell::Missing => "missing",
    }
}
