//! What a campaign holds, as plain columns and tables of readings: for programs that hold no data frames of ours.

use std::collections::BTreeMap;

use super::{columns, tables};
use crate::domain::RunRecord;
use crate::domain::tag::keys;
use crate::pipeline::campaign::standing;
use crate::pipeline::standalone::in_memory::{ReadTable, Stated, Strip};
use crate::pipeline::{Context, PipelineError};
use crate::show::Frame;

/// Name of every table that programs can have, and what it shows.
pub fn listed() -> impl Iterator<Item = (&'static str, &'static str)> {
    tables::listed().chain([columns::LISTED])
}

/// All columns of the table of that name, numbers in full and in their stored units.
///
/// # Errors
/// There is none of that name, or the database cannot be read.
pub fn plain_table(context: &Context, name: &str) -> Result<Frame, PipelineError> {
    if name == columns::LISTED.0 {
        return Ok(columns::of_written(
            &standing::speaking(context)?,
            &context.campaign,
        ));
    }
    tables::frame(context, name)
}

/// The readings of a stored run as a fit takes them, with what the campaign states of it.
///
/// # Errors
/// There is no such run, or the database cannot be read.
pub fn stored_readings(context: &Context, path: &str) -> Result<(ReadTable, Stated), PipelineError> {
    let Some(run) = context.store.run_named(path)? else {
        let runs = standing::all(context)?;
        let near = runs.iter().find(|run| run.path.ends_with(path));
        return Err(PipelineError::UnknownRun {
            found: path.to_owned(),
            nearest: near.map_or_else(String::new, |run| format!(" There is {:?}.", run.path)),
        });
    };
    let run = &run;
    let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
    let stated = Stated {
        strip: Strip {
            area_cm2: run.area_cm2,
            length_mm: sample.and_then(|sample| sample.length_mm),
            width_mm: sample.and_then(|sample| sample.width_mm),
            electrode_resistance_ohm_per_sq: sample.and_then(|sample| sample.electrode_resistance_ohm_per_sq),
        },
        drive: run.drive.clone(),
        tags: chosen_tags(run),
    };
    let read = ReadTable {
        name: run.path.clone(),
        rows: run
            .channels
            .iter()
            .map(|channel| channel.readings)
            .max()
            .unwrap_or(0),
        channels: context.store.channels(run.id)?,
        format: run.format.clone(),
        reader_version: run.reader_version,
        technique: run.technique.clone(),
        // The drive is stated: what the technique is was decided when the run was taken in.
        is_step_response: true,
        time_zero_is_step: true,
        status: run.status.key().to_owned(),
        started_at: None,
        header_tags: Vec::new(),
        flags: run.origin.flags.clone(),
        original_metadata: Vec::new(),
        issues: Vec::new(),
    };
    Ok((read, stated))
}

/// The first tag of each key, which is the chosen one.
fn chosen_tags(run: &RunRecord) -> BTreeMap<String, String> {
    let mut chosen = BTreeMap::new();
    for tag in &run.tags {
        chosen.entry(tag.key.clone()).or_insert_with(|| tag.value.clone());
    }
    chosen
}
