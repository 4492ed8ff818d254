//! A table on a page.

use serde::Serialize;

use super::RunText;
use crate::pages::wording::group_title;
use crate::site::Site;
use crate::tables::{ShownCell, grid, note_letter, note_letters, remarks, repeated};
use ieap_analysis::study::UNTOLD;
use ieap_domain::number::interval as interval_text;
use ieap_show::quantities::RUNS;
use ieap_show::{Cell, Content, Source, SourceOrigin, Table};

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
    /// The runs that are counted, in place of their number.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    runs: Vec<RunText>,
    is_number: bool,
    is_head: bool,
    /// Whether it says that nothing can be told: it stands back behind what is.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_untold: bool,
}

impl TableText {
    /// The text of a table; the name of a run leads to its page.
    pub fn of(site: &Site, table: &Table) -> TableText {
        let table = &table.as_read();
        let (cells, repeated) = (grid(table), repeated(table));
        let is_number = |column: usize| {
            let is_of_runs = table.columns[column].key == RUNS.key;
            let leads = is_of_runs
                && table
                    .rows
                    .iter()
                    .any(|row| !runs(site, &row.cells[column]).is_empty());
            let is_told = column >= table.stub && !is_of_runs;
            let mut cells = cells.iter().map(|row| &row[column]);
            !leads && cells.all(|cell| cell.is_number() || is_told && is_read_as_number(&cell.text()))
        };
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
                symbol: match column.key.as_str() {
                    // In the place of their number stand the runs.
                    key if key == RUNS.key => RUNS.symbol.to_owned(),
                    _ => column.symbol.clone(),
                },
                unit: column.unit.clone(),
                quantity: column.quantity.clone(),
                is_number: numbers[at],
            }
        });
        let cell = |row: usize, column: usize| {
            let (cell, shown) = (&table.rows[row].cells[column], &cells[row][column]);
            let runs = match table.columns[column].key.as_str() {
                key if key == RUNS.key => runs(site, cell),
                _ => Vec::new(),
            };
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
                runs,
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

/// Whether words are a number: `≤ 0.001`, `8.1 %`, `150 ± 12`; no interval and no date is one.
fn is_read_as_number(text: &str) -> bool {
    let is_sign = |c: char| c.is_ascii_digit() || " ⁰¹²³⁴⁵⁶⁷⁸⁹⁻.·−–±%<>≤≥()".contains(c);
    let has_digit = text.contains(|c: char| c.is_ascii_digit());
    (has_digit || text.is_empty()) && text.chars().all(is_sign)
}

/// The 95 % interval, and of a mean how it came about.
fn interval_of(cell: &Cell) -> String {
    let Content::Measured(own) = &cell.content else {
        return String::new();
    };
    let interval = own.low_95.zip(own.high_95);
    let interval = interval.map(|(low, high)| format!("95\u{a0}%: {}", interval_text(low, high)));
    let mean = own.pooled.as_ref().filter(|mean| mean.runs > 1);
    let mean = mean.map(|mean| format!("mean of {} runs, {} samples", mean.runs, mean.samples));
    interval.into_iter().chain(mean).collect::<Vec<_>>().join("; ")
}

/// The runs that a cell is made from.
fn runs(site: &Site, cell: &Cell) -> Vec<RunText> {
    let is_run = |source: &&Source| matches!(source.origin, SourceOrigin::Run(_));
    let runs = cell.sources.iter().filter(is_run);
    let runs = runs.map(|source| RunText::of(site, &source.name));
    runs.filter(|run| run.href.is_some()).collect()
}

/// The page of the run or of the group that a cell names.
fn href(site: &Site, cell: &Cell, shown: &ShownCell) -> Option<String> {
    let ShownCell::Words(words) = shown else {
        return None;
    };
    cell.sources.iter().find_map(|source| {
        let name = source.name.as_str();
        if source.origin == SourceOrigin::Diagnosis {
            let place = site
                .input
                .findings
                .groups
                .iter()
                .position(|found| found.group == name)?;
            return (group_title(name) == *words).then(|| site.finding_href(place));
        }
        let is_named = [name, site.input.campaign.run_name(name)].contains(&words.as_str());
        let run = site.run_of(name).filter(|_| is_named)?;
        Some(match source.origin {
            SourceOrigin::Strip => site.strip_href(run),
            _ => site.run_href(run),
        })
    })
}
