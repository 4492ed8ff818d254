//! Tags runs again whose tag files, hand tags or campaign.toml changed. The readings are not touched.

use super::now;
use super::tagging::{TaggingInput, digest, tag_files, tagging};
use crate::domain::tag::keys;
use crate::domain::{RunRecord, TagSource};
use crate::ingest::{StartedAt, Timestamp};
use crate::pipeline::{Context, Observer, PipelineError};

/// Tags again every current run whose tag sources changed; gives their names.
///
/// # Errors
/// The database refuses.
pub fn retag_runs(context: &mut Context, observer: &dyn Observer) -> Result<Vec<String>, PipelineError> {
    let mut due = Vec::new();
    for (run_id, path, stored) in context.store.tag_digests()? {
        let files = context.store.file_paths(run_id)?;
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        if digest(context, &path, &tag_files(&path, &files))? != stored {
            due.push(run_id);
        }
    }
    if due.is_empty() {
        return Ok(Vec::new());
    }
    let mut retagged = Vec::new();
    for run in context
        .store
        .runs()?
        .into_iter()
        .chain(context.store.dma_logs()?)
        .filter(|run| due.contains(&run.id))
    {
        retag(context, &run)?;
        observer.say(&format!("tagged {} again", run.path));
        retagged.push(run.path);
    }
    Ok(retagged)
}

fn retag(context: &mut Context, run: &RunRecord) -> Result<(), PipelineError> {
    let (time_zero_is_step, is_step_response) = context.store.reading_facts(run.id)?;
    let channels = context.store.channels_as_read(run.id)?;
    let header = run.tags.iter().filter(|tag| tag.source == TagSource::Header);
    let (starts, others): (Vec<_>, Vec<_>) = header.partition(|tag| tag.key == keys::STARTED_AT);
    // The stored start carries its offset already.
    let started_at = starts.first().map(|tag| StartedAt {
        raw: tag.detail.clone(),
        kind: Timestamp::Start,
        local: Some(tag.value.clone()),
        offset: None,
        basis: String::new(),
    });
    let input = TaggingInput {
        run_path: &run.path,
        kind: run.kind,
        file_paths: run.files.iter().map(|file| file.path.as_str()).collect(),
        origin: &run.origin,
        channels: &channels,
        time_zero_is_step,
        is_step_response,
        header_tags: others
            .iter()
            .map(|tag| (tag.key.clone(), tag.value.clone(), tag.detail.clone()))
            .collect(),
        started_at,
    };
    let tagging = tagging(context, &input)?;
    Ok(context.store.retag(&now(), run.id, &tagging)?)
}
