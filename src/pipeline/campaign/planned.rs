//! Planned runs: the run sheets of a campaign, and which of their rows have been made.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::plan::list::RowOfSheet;
use crate::domain::tag::keys;
use crate::domain::{FileState, RunRecord};
use crate::ingest::run_sheet::{self, IS_DAMAGED, IS_SHEET, RunSheet, RunSheets, SheetRow};
use crate::ingest::scan::{Changes, Scan, parse_display_path};
use crate::pipeline::{Context, PipelineError};
use crate::store::FileRow;

/// Rows of run sheets by whether they have been made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Planned {
    /// Run sheets that are used, by path.
    pub sheets: Vec<String>,
    /// Run sheets that cannot be used; they are listed among the refused files with the reason.
    pub damaged_sheets: Vec<String>,
    /// Planned runs that have been made.
    pub done: Vec<PlannedRow>,
    /// Planned runs that have not.
    pub open: Vec<PlannedRow>,
}

/// A row of a run sheet, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PlannedRow {
    /// The row.
    #[serde(flatten)]
    pub row: RowOfSheet,
    /// The run that was made; none while it is open.
    pub run: Option<String>,
    /// Whether a later row of the sheet has been made before it.
    pub passed_over: bool,
}

/// Sorts the rows of all sheets. A row has been made where a current run carries its id from it.
///
/// # Errors
/// The database cannot be read.
pub fn planned(context: &Context, runs: &[RunRecord]) -> Result<Planned, PipelineError> {
    Ok(sorted(&known_sheets(context)?, runs))
}

fn sorted(sheets: &RunSheets, runs: &[RunRecord]) -> Planned {
    let made: BTreeMap<&str, &str> = runs
        .iter()
        .filter_map(|run| Some((run.tag(keys::PLANNED)?, run.path.as_str())))
        .collect();
    let mut planned = Planned {
        sheets: sheets.sheets.iter().map(|sheet| sheet.path.clone()).collect(),
        damaged_sheets: sheets.damaged.keys().cloned().collect(),
        ..Planned::default()
    };
    for sheet in &sheets.sheets {
        let run_of = |row: &SheetRow| made.get(row.planned.as_str()).copied();
        let rows = run_sheet::runs_of(&sheet.rows);
        let last_made = rows.iter().rposition(|row| run_of(row).is_some());
        for (at, row) in rows.into_iter().enumerate() {
            let run = run_of(row);
            let passed_over = run.is_none() && last_made.is_some_and(|last| at < last);
            let list = match run {
                Some(_) => &mut planned.done,
                None => &mut planned.open,
            };
            list.push(shown(sheet, row, run, passed_over));
        }
    }
    planned
}

fn shown(sheet: &RunSheet, row: &SheetRow, run: Option<&str>, passed_over: bool) -> PlannedRow {
    let number = |key: &str| row.tag(key).and_then(|text| text.parse::<f64>().ok());
    let text = |key: &str| row.tag(key).map(str::to_owned);
    let row = RowOfSheet {
        planned: row.planned.clone(),
        file: row.file.clone(),
        sheet: sheet.path.clone(),
        sample: text(keys::SAMPLE),
        environment: text(keys::ENVIRONMENT),
        relative_humidity_percent: number(keys::RELATIVE_HUMIDITY_PERCENT),
        voltage_v: number(keys::VOLTAGE_V),
        cycle: number(keys::CYCLE)
            .filter(|cycle| (0.0..1e9).contains(cycle))
            .map(|cycle| cycle as u32),
        drive: row.said("drive").to_owned(),
    };
    PlannedRow {
        row,
        run: run.map(str::to_owned),
        passed_over,
    }
}

/// The sheets that earlier scans found and that are still there, with those that could not be read yet.
pub(crate) fn known_sheets(context: &Context) -> Result<RunSheets, PipelineError> {
    let files = context.store.files()?;
    let there = files
        .iter()
        .filter(|file| is_known_sheet(file) && file.missing_since.is_none());
    let unread = context.store.unread_files()?;
    let is_there = |path: &str| {
        let found = context.folder.join(parse_display_path(path)).try_exists();
        !matches!(found, Ok(false))
    };
    let unread = unread
        .iter()
        .map(|(path, _)| path.as_str())
        .filter(|path| run_sheet::is_named_as_one(path) && is_there(path));
    let paths = there.map(|file| file.path.as_str()).chain(unread);
    Ok(RunSheets::load(&context.folder, paths))
}

/// The sheets that a scan saw, before anything of it is stored.
pub(crate) fn sheets_now(context: &Context, stored: &[FileRow], seen: &Scan, changes: &Changes) -> RunSheets {
    let known: BTreeSet<&str> = stored
        .iter()
        .filter(|file| is_known_sheet(file))
        .map(|file| file.path.as_str())
        .collect();
    let found = changes.new.iter().chain(&changes.changed);
    let fresh: BTreeSet<&str> = found.map(|file| file.display.as_str()).collect();
    let paths = run_sheet::among(&context.folder, &seen.files, &known, &fresh);
    RunSheets::load(&context.folder, paths)
}

fn is_known_sheet(file: &FileRow) -> bool {
    let codes = [IS_SHEET, IS_DAMAGED];
    let is_one = file
        .issue
        .as_ref()
        .is_some_and(|issue| codes.contains(&issue.code.as_str()));
    is_one && matches!(file.state, FileState::Sidecar | FileState::Refused)
}
