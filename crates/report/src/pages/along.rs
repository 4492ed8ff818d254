//! The page of all runs that are read along the strip: what each shows, and table 3.
//!
//! Maps, shapes and voltages of a run have a page of their own ([`super::strip`]), which this page and the page of the run
//! lead to: on the page of the run they would bury the parameters, and most runs have none of them.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::along_words::{decision, places};
use super::run_condition::condition;
use super::strip::residual_ratio;
use super::wording::{RunLink, why_unfitted};
use crate::error::ReportError;
use crate::input::Input;
use crate::site::Site;
use crate::tables::{grid, note_letter, remarks};
use ieap_analysis::tables::named;
use ieap_domain::{Quantity, RunRecord};

#[derive(Debug, Serialize)]
struct Page {
    summary: String,
    runs: Vec<RunRow>,
    table: Option<Table3>,
}

#[derive(Debug, Serialize)]
struct RunRow {
    strip: RunLink,
    condition: String,
    places: String,
    model: String,
    curvature: String,
    voltage: String,
    verdict: String,
}

#[derive(Debug, Serialize)]
struct Table3 {
    title: String,
    /// Symbol, unit, quantity.
    columns: Vec<[String; 3]>,
    rows: Vec<Vec<CellText>>,
    notes: Vec<(String, String)>,
    remarks: Vec<String>,
}

#[derive(Debug, Serialize)]
struct CellText {
    text: String,
    is_number: bool,
    is_head: bool,
    notes: Vec<String>,
}

/// Whether some run is read at several places.
pub fn is_shown(input: &Input) -> bool {
    input.runs.iter().any(RunRecord::is_along)
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let runs = &site.input.runs;
    let along: Vec<usize> = (0..runs.len()).filter(|&run| runs[run].is_along()).collect();
    let fitted = along.iter().filter(|&&run| {
        runs[run]
            .fit
            .as_ref()
            .is_some_and(|fit| fit.parameter(MARK).is_some())
    });
    let page = Page {
        summary: format!(
            "{} at several places along the strip; {} fitted with the distributed model.",
            match along.len() {
                1 => "1 run is read".to_owned(),
                many => format!("{many} runs are read"),
            },
            match fitted.count() {
                0 => "none is".to_owned(),
                1 => "1 is".to_owned(),
                many => format!("{many} are"),
            }
        ),
        runs: along.iter().map(|&run| row(site, run)).collect(),
        table: table3(site),
    };
    Content::new("along.html", &page, BTreeMap::new())
}

/// A parameter that only the distributed model has: its fits are told by it.
const MARK: &str = "re_ohm_per_sq";

fn row(site: &Site, run: usize) -> RunRow {
    let record = &site.input.runs[run];
    let fit = record.fit.as_ref();
    let residual = |quantity: Quantity| match record.places(quantity) {
        0 => String::new(),
        _ => fit
            .and_then(|fit| residual_ratio(fit, quantity))
            .unwrap_or_else(|| "–".to_owned()),
    };
    RunRow {
        strip: RunLink {
            href: site.strip_href(run),
            name: site.run_name(run).to_owned(),
        },
        condition: condition(site, run),
        places: places(record),
        model: fit.map_or_else(|| why_unfitted(record).to_owned(), |fit| fit.model.clone()),
        curvature: residual(Quantity::Curvature),
        voltage: residual(Quantity::Voltage),
        verdict: decision(record),
    }
}

fn table3(site: &Site) -> Option<Table3> {
    let input = site.input;
    let table = named("table3")?.table(&input.of_tables());
    if table.rows.is_empty() {
        return None;
    }
    let shown = grid(&table);
    let rows = table.rows.iter().zip(&shown).map(|(row, shown)| {
        let cells = row.cells.iter().zip(shown).enumerate();
        let cell =
            |(at, (cell, shown)): (usize, (&ieap_analysis::tables::Cell, &crate::tables::ShownCell))| {
                CellText {
                    text: shown.text(),
                    is_number: shown.is_number(),
                    is_head: at == 0,
                    notes: cell.notes.iter().map(|&note| note_letter(note)).collect(),
                }
            };
        cells.map(cell).collect()
    });
    Some(Table3 {
        title: table.title.clone(),
        columns: table
            .columns
            .iter()
            .map(|column| [&column.symbol, &column.unit, &column.quantity].map(String::clone))
            .collect(),
        rows: rows.collect(),
        notes: table
            .notes
            .iter()
            .enumerate()
            .map(|(at, text)| (note_letter(at), text.clone()))
            .collect(),
        remarks: remarks(&table),
    })
}
