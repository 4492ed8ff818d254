//! The runs to make next, as a list and as a run sheet.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::study;
pub use crate::analysis::plan::PlannedRun;
use crate::analysis::plan::list::{Grounds, RowOfSheet};
use crate::analysis::plan::next_runs;
use crate::analysis::study::Study;
use crate::domain::safe_text::csv_text;
use crate::domain::tag::keys;
use crate::domain::{GroupDiagnosis, RunRecord};
use crate::ingest::name_pattern::{KnownIds, NameMatch, NamePattern};
use crate::ingest::run_sheet::{self, COLUMNS, SheetRow};
use crate::pipeline::campaign::planned::planned;
use crate::pipeline::campaign::standing::{self, Runs};
use crate::pipeline::findings::current::findings_among;
use crate::pipeline::findings::kept;
use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::{Context, PipelineError, failed};
use crate::system::fs;

/// Runs to make, the first first, from what the campaign says now.
///
/// # Errors
/// The database cannot be read.
pub fn plan(context: &Context) -> Result<Vec<PlannedRun>, PipelineError> {
    let all = standing::all(context)?;
    let findings = findings_among(context, &all)?;
    let ids = PlannedIds::of(context, &all)?;
    let runs = Runs::of(all).speaking;
    let of_parameters = study::of_runs(context, &runs, &findings, &[], &kept::values(context));
    Ok(plan_from(
        context,
        (&runs, &ids),
        &of_parameters,
        &findings.groups,
    ))
}

/// What the sheets and the runs say of planned ids, runs that were set aside too.
#[derive(Debug, Clone, Default)]
pub(crate) struct PlannedIds {
    /// Rows of sheets whose runs have not been made.
    open: Vec<RowOfSheet>,
    /// Number of the last id that was used.
    last_number: u32,
}

impl PlannedIds {
    /// Of all runs, by path.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(crate) fn of(context: &Context, all: &[RunRecord]) -> Result<PlannedIds, PipelineError> {
        let sheets = planned(context, all)?;
        let rows = sheets.done.iter().chain(&sheets.open);
        let ids = rows.map(|row| row.row.planned.as_str());
        let tagged = all.iter().filter_map(|run| run.tag(keys::PLANNED));
        let number = |id: &str| id.strip_prefix('P')?.parse::<u32>().ok();
        Ok(PlannedIds {
            last_number: ids.chain(tagged).filter_map(number).max().unwrap_or(0),
            open: sheets.open.into_iter().map(|row| row.row).collect(),
        })
    }
}

/// The same from a study and findings that are known already.
pub(crate) fn plan_from(
    context: &Context,
    (runs, ids): (&[RunRecord], &PlannedIds),
    study: &Study,
    groups: &[GroupDiagnosis],
) -> Vec<PlannedRun> {
    let mut planned_runs = next_runs(&Grounds {
        runs,
        campaign: &context.campaign,
        study,
        groups,
        open: &ids.open,
        last_number: ids.last_number,
    });
    shorten_misread(context, &mut planned_runs);
    planned_runs
}

/// Names that `name_pattern` would read tags from become the bare id, so that a name says nothing beside the sheet.
fn shorten_misread(context: &Context, runs: &mut [PlannedRun]) {
    let campaign = &context.campaign;
    let pattern = campaign.name_pattern.as_deref();
    let Some(pattern) = pattern.and_then(|text| NamePattern::compile(text).ok()) else {
        return;
    };
    let samples: Vec<&str> = campaign.samples.iter().map(|sample| sample.id.as_str()).collect();
    let environments = campaign.environments.iter().map(|known| known.id.as_str());
    let environments: Vec<&str> = environments.collect();
    let known = KnownIds {
        samples: &samples,
        environments: &environments,
    };
    for run in runs.iter_mut().filter(|run| run.on_sheet.is_none()) {
        if pattern.match_stem(&run.file, known) != NameMatch::None {
            run.file.clone_from(&run.planned);
        }
    }
}

/// What writing a run sheet did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SheetSummary {
    /// The sheet.
    pub sheet: PathBuf,
    /// Rows that plan a run which has not been made.
    pub open: usize,
    /// Rows of runs that have been made, kept for their tags.
    pub kept: usize,
    /// Ids of rows that were open on it and are needed no more.
    pub dropped: Vec<String>,
    /// Ids of runs left out, for they stand on another sheet.
    pub elsewhere: Vec<String>,
    /// Whether it lies where `ieap run` looks for runs.
    pub among_runs: bool,
}

/// Writes the list as a run sheet. Rows of a sheet that is there already stay where their runs have been made, for
/// these have their tags from them.
///
/// # Errors
/// The file is there and no run sheet, or it cannot be written.
pub fn write_sheet(
    context: &Context,
    plan: &[PlannedRun],
    file: &Path,
) -> Result<SheetSummary, PipelineError> {
    let before = earlier_rows(file)?;
    // A run that was set aside was made all the same, and has its tags from its row.
    let runs = standing::all(context)?;
    let made: BTreeSet<&str> = runs.iter().filter_map(|run| run.tag(keys::PLANNED)).collect();
    let (kept, open): (Vec<&SheetRow>, Vec<&SheetRow>) =
        before.iter().partition(|row| made.contains(row.planned.as_str()));
    let absolute = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    };
    let here = absolute(file);
    let is_here = |sheet: &str| {
        let path = context
            .folder
            .join(crate::ingest::scan::parse_display_path(sheet));
        here.is_some() && absolute(&path) == here
    };
    let (own, elsewhere): (Vec<&PlannedRun>, Vec<&PlannedRun>) = plan
        .iter()
        .partition(|run| run.on_sheet.as_deref().is_none_or(is_here));
    let dropped = open
        .iter()
        .filter(|row| !own.iter().any(|run| run.planned == row.planned))
        .map(|row| row.planned.clone())
        .collect();
    let mut rows: Vec<Vec<(String, String)>> = kept.iter().map(|row| cells_of_row(row)).collect();
    rows.extend(own.iter().map(|run| cells(run)));
    write(file, &rows)?;
    let runs_folder = context.folder.join(&context.campaign.runs_folder);
    let among_runs = here.is_some_and(|here| {
        runs_folder
            .canonicalize()
            .is_ok_and(|folder| here.starts_with(folder))
    });
    Ok(SheetSummary {
        sheet: file.to_owned(),
        open: own.len(),
        kept: kept.len(),
        dropped,
        elsewhere: elsewhere.iter().map(|run| run.planned.clone()).collect(),
        among_runs,
    })
}

/// Rows of the sheet that is there already.
fn earlier_rows(file: &Path) -> Result<Vec<SheetRow>, PipelineError> {
    let bytes = match fs::read_named(file) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(failed(file, "reading the run sheet that is there")(source)),
    };
    run_sheet::read(&bytes).map_err(|issue| PipelineError::BadArgument {
        what: "--sheet",
        found: format!("{}, {}: {}", file.display(), issue.place, issue.message),
        needed: "a name that is free, or that of a run sheet without a fault".to_owned(),
    })
}

fn cells_of_row(row: &SheetRow) -> Vec<(String, String)> {
    let mut cells = row.tags.clone();
    cells.push(("file".to_owned(), row.file.clone()));
    cells.extend(row.said.iter().cloned());
    cells
}

fn cells(planned: &PlannedRun) -> Vec<(String, String)> {
    let run = &planned.run;
    let number = |value: Option<f64>| value.map(|value| value.to_string());
    let given = [
        (keys::PLANNED, Some(planned.planned.clone())),
        ("file", Some(planned.file.clone())),
        (keys::SAMPLE, Some(run.sample.clone())),
        (keys::ENVIRONMENT, run.environment.clone()),
        (
            keys::RELATIVE_HUMIDITY_PERCENT,
            number(run.relative_humidity_percent),
        ),
        (keys::TEMPERATURE_C, number(run.temperature_c)),
        (keys::VOLTAGE_V, number(run.voltage_v)),
        ("drive", Some(run.drive.clone())),
        (keys::REST_BEFORE_S, number(run.rest_before_s)),
        (keys::CYCLE, planned.cycle.map(|cycle| cycle.to_string())),
        // Spreadsheets guess the encoding of a CSV: an arrow would not survive everywhere.
        ("why", Some(run.why.join("; ").replace('→', "to"))),
    ];
    given
        .into_iter()
        .filter_map(|(column, value)| Some((column.to_owned(), value?)))
        .collect()
}

/// Writes rows under the columns of a sheet and whatever else they state; the file is exchanged whole.
fn write(file: &Path, rows: &[Vec<(String, String)>]) -> Result<(), PipelineError> {
    let failed = failed(file, "writing the run sheet");
    let mut columns: Vec<&str> = COLUMNS.to_vec();
    for (column, _) in rows.iter().flatten() {
        if !columns.contains(&column.as_str()) {
            columns.push(column);
        }
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let of_row = |row: &Vec<(String, String)>| -> Vec<String> {
        let cell = |column: &&str| {
            let known = row.iter().find(|(key, _)| key == column);
            // The reader of sheets takes off what keeps a spreadsheet from calculating.
            known.map_or_else(String::new, |(_, value)| csv_text(value).into_owned())
        };
        columns.iter().map(cell).collect()
    };
    let as_io = |error: csv::Error| failed(std::io::Error::other(error));
    let names = columns.iter().map(|column| csv_text(column).into_owned());
    writer.write_record(names).map_err(as_io)?;
    for row in rows {
        writer.write_record(of_row(row)).map_err(as_io)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| failed(std::io::Error::other(error.to_string())))?;
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder).map_err(&failed)?;
    }
    put_bytes(file, true, &bytes)
}
