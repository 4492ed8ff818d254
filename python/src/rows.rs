//! Runs out of tables with one run a row: list columns are readings, other columns are what is stated of the run.

use std::collections::BTreeMap;

use arrow_array::{Array, RecordBatch};
use ieap::domain::{Issue, Severity};
use ieap::pipeline::standalone::in_memory::{self, CampaignRow, Column, RunAtHand, Stated};

use crate::campaign_rows;
use crate::columns::{is_duration, is_list, is_text, list_at, numbers, text_at};
use crate::stated::drive_of;

/// Column with the name of the run.
const RUN: &str = "run";
/// Columns with lists that are a drive and no readings.
const DRIVE_START_S: &str = "drive_start_s";
const DRIVE_VOLTAGE_V: &str = "drive_voltage_v";

/// A run of a row, or why it is none.
pub type RowRun = (String, Result<Found, Issue>);

/// What a row holds.
pub enum Found {
    /// A run that no campaign holds.
    AtHand(Box<RunAtHand>),
    /// A run of a campaign, with how that fits it.
    OfCampaign(Box<CampaignRow>),
}

impl Found {
    /// The run, however it is fitted in a campaign.
    pub fn run(self) -> RunAtHand {
        match self {
            Found::AtHand(run) => *run,
            Found::OfCampaign(row) => row.at_hand(),
        }
    }
}

/// The runs of a batch. `first` is the number of rows before it, for runs without a name.
pub fn runs(batch: &RecordBatch, first: usize) -> Vec<RowRun> {
    let of_campaign = campaign_rows::are_in(batch);
    let run = |row: usize| {
        let name = cell(batch, RUN, row).unwrap_or_else(|| format!("row {}", first + row));
        let made = match of_campaign {
            true => campaign_rows::row_at(batch, row, &name).map(|row| Found::OfCampaign(Box::new(row))),
            false => run_at(batch, row, &name).map(|run| Found::AtHand(Box::new(run))),
        };
        (name, made)
    };
    (0..batch.num_rows()).map(run).collect()
}

fn run_at(batch: &RecordBatch, row: usize, name: &str) -> Result<RunAtHand, Issue> {
    let (mut columns, mut tags) = (Vec::new(), BTreeMap::new());
    for (field, column) in batch.schema_ref().fields().iter().zip(batch.columns()) {
        let key = field.name();
        if [RUN, DRIVE_START_S, DRIVE_VOLTAGE_V].contains(&key.as_str()) || SIZES.contains(&key.as_str()) {
            continue;
        }
        match is_list(column.data_type()) {
            true => columns.extend(readings(column, row, key)?),
            false => tags.extend(cell(batch, key, row).map(|value| (key.clone(), value))),
        }
    }
    let mut read = in_memory::arrays(columns)?;
    let (stated, slips) = stated(batch, row, tags)?;
    read.issues.extend(slips);
    RunAtHand::new(name, &read, &stated)
}

/// Columns of one number a run that are no tags.
const SIZES: [&str; 5] = [
    "area_cm2",
    "length_mm",
    "width_mm",
    "electrode_resistance_ohm_per_sq",
    "baseline_v",
];

fn stated(
    batch: &RecordBatch,
    row: usize,
    tags: BTreeMap<String, String>,
) -> Result<(Stated, Vec<Issue>), Issue> {
    let [
        area_cm2,
        length_mm,
        width_mm,
        electrode_resistance_ohm_per_sq,
        baseline_v,
    ] = SIZES.map(|key| number(batch, key, row));
    let list = |key: &str| -> Result<Vec<f64>, Issue> {
        let column = batch.column_by_name(key);
        let found = column.map(|column| readings(column, row, key)).transpose()?;
        Ok(found.flatten().map(|own| own.numbers).unwrap_or_default())
    };
    let (starts, voltages) = (list(DRIVE_START_S)?, list(DRIVE_VOLTAGE_V)?);
    if starts.len() != voltages.len() {
        let message = format!("{} starts and {} voltages", starts.len(), voltages.len());
        let issue = Issue::error("bad-drive", message).at(format!("column {DRIVE_VOLTAGE_V}"));
        return Err(issue.mend("give a voltage for each start; an empty one is an open circuit"));
    }
    let segments: Vec<(f64, Option<f64>)> = starts
        .into_iter()
        .zip(
            voltages
                .into_iter()
                .map(|volts| (!volts.is_nan()).then_some(volts)),
        )
        .collect();
    let stated = Stated {
        strip: in_memory::Strip {
            area_cm2,
            length_mm,
            width_mm,
            electrode_resistance_ohm_per_sq,
        },
        drive: drive_of(baseline_v.unwrap_or(0.0), &segments),
        tags,
    };
    // Any column may stand beside the readings: one that is near a tag's name is told and kept.
    let slips: Vec<Issue> = stated.misspelt().map(as_warning).collect();
    match stated.contradiction() {
        Some(issue) => Err(issue),
        None => Ok((stated, slips)),
    }
}

fn as_warning(issue: Issue) -> Issue {
    Issue {
        severity: Severity::Warning,
        ..issue
    }
}

/// The readings of a row; none where it has none.
fn readings(column: &dyn Array, row: usize, name: &str) -> Result<Option<Column>, Issue> {
    let Some(list) = list_at(column, row) else {
        return Ok(None);
    };
    match numbers(&list) {
        Some(numbers) => Ok(Some(Column {
            are_durations: is_duration(list.data_type()),
            ..Column::new(name.to_owned(), numbers)
        })),
        None => {
            let message = format!("a list of {} holds no readings", list.data_type());
            let issue = Issue::error("column-unusable", message).at(format!("column {name}"));
            Err(issue.mend("give lists of numbers, or leave the column out"))
        }
    }
}

/// The number in a cell; none where it is empty.
pub fn number(batch: &RecordBatch, key: &str, row: usize) -> Option<f64> {
    let column = batch.column_by_name(key)?.slice(row, 1);
    numbers(&column)?
        .first()
        .copied()
        .filter(|number| !number.is_nan())
}

/// A cell as a tag states it: a word, or a number in its shortest form.
fn cell(batch: &RecordBatch, key: &str, row: usize) -> Option<String> {
    let column = batch.column_by_name(key)?;
    match is_text(column.data_type()) {
        true => text_at(column, row).map(str::to_owned),
        false => number(batch, key, row).map(|number| number.to_string()),
    }
}
