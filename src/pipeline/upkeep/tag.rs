//! Sets tags by hand.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::{FileState, Issue, RunState};
use crate::ingest::tags::objection;
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::climate;
use crate::pipeline::intake::ingest::{IngestSummary, retag_runs, unreadable_tags};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::HandTag;

/// The verb `tag`.
#[derive(Debug, Clone)]
pub struct SetTags {
    /// The run's name.
    pub run: String,
    /// Keys and values; an empty value takes an earlier hand tag back.
    pub pairs: Vec<(String, String)>,
    /// Who sets them.
    pub set_by: String,
}

/// What `tag` did.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TagSummary {
    /// The run.
    pub run: String,
    /// Its state now.
    pub state: &'static str,
    /// Its chosen tags now: key, value, source.
    pub tags: Vec<(String, String, String)>,
    /// What a reader must know of its tags.
    pub issues: Vec<Issue>,
}

impl SetTags {
    /// Stores the tags and tags the run again.
    ///
    /// # Errors
    /// No run has that name, a key is neither known nor declared, or the database refuses.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<TagSummary, PipelineError> {
        self.check_keys(&context.campaign.extra_tags)?;
        let run_path = known_run(context, &self.run)?;
        let now = now();
        let tag = |(key, value): &(String, String)| HandTag {
            run_path: run_path.clone(),
            key: key.clone(),
            value: (!value.is_empty()).then(|| value.clone()),
            set_by: self.set_by.clone(),
            set_at: now.clone(),
        };
        context
            .store
            .add_hand_tags(&now, &self.pairs.iter().map(tag).collect::<Vec<_>>())?;
        let mut retagged = IngestSummary::default();
        retag_runs(context, &mut retagged, observer)?;
        for tags in unreadable_tags(context)? {
            observer.warn(&format!(
                "{}: {}; runs that it tags are tagged again later",
                tags.issue.place, tags.issue.message
            ));
        }
        let shelf = climate::Shelf::open(&context.store)?;
        climate::assess(context, &shelf)?;
        let others = context
            .store
            .dma_logs()?
            .into_iter()
            .chain(context.store.spectra()?);
        let mut runs = context.store.runs()?.into_iter().chain(others);
        let found = runs.find(|run| run.path == run_path);
        let Some(run) = found else {
            return Err(unknown(&run_path, ""));
        };
        let mut seen = std::collections::BTreeSet::new();
        let chosen = run.tags.iter().take_while(|tag| seen.insert(tag.key.clone()));
        Ok(TagSummary {
            state: if run.state == RunState::Ready {
                "ready"
            } else {
                run.state.key()
            },
            tags: chosen
                .map(|t| (t.key.clone(), t.value.clone(), t.source.label().to_owned()))
                .collect(),
            issues: run.issues,
            run: run.path,
        })
    }

    /// Refuses keys that are neither known nor declared; one that was set before may be taken back.
    fn check_keys(&self, extra: &[String]) -> Result<(), PipelineError> {
        let set = self.pairs.iter().filter(|(_, value)| !value.is_empty());
        match set.filter_map(|(key, _)| objection(key, extra)).next() {
            Some(issue) => Err(PipelineError::UnknownTagKey {
                found: issue.message,
                mend: issue.mend,
            }),
            None => Ok(()),
        }
    }
}

/// The run meant: by its whole name, by the end of it where only one run ends so, or by another name of its file's bytes.
///
/// # Errors
/// There is no such run, or more than one.
pub(crate) fn known_run(context: &Context, given: &str) -> Result<String, PipelineError> {
    let names: Vec<String> = context
        .store
        .tag_digests()?
        .into_iter()
        .map(|(_, path, _)| path)
        .collect();
    let wanted = given.trim_start_matches("./").replace('\\', "/");
    if names.contains(&wanted) {
        return Ok(wanted);
    }
    let ends: Vec<&String> = names
        .iter()
        .filter(|name| name.ends_with(&format!("/{wanted}")))
        .collect();
    match ends.as_slice() {
        [one] => Ok((*one).clone()),
        [] => {
            if let Some(run) = run_of_alias(context, &wanted)? {
                return Ok(run);
            }
            let file = wanted.rsplit('/').next().unwrap_or(&wanted);
            let near = names
                .iter()
                .find(|name| name.ends_with(file) || name.contains(&wanted));
            Err(unknown(
                given,
                &near.map(|name| format!(" Is {name} meant?")).unwrap_or_default(),
            ))
        }
        _ => Err(unknown(
            given,
            &format!(" {} runs end so; give the whole name.", ends.len()),
        )),
    }
}

/// The run whose file holds the bytes that lie under this name too.
fn run_of_alias(context: &Context, path: &str) -> Result<Option<String>, PipelineError> {
    let files = context.store.files()?;
    let alias = files
        .iter()
        .find(|file| file.path == path && file.state == FileState::Alias);
    let Some(hash) = alias.and_then(|file| file.hash.as_deref()) else {
        return Ok(None);
    };
    Ok(context
        .store
        .runs_with_content(hash)?
        .into_iter()
        .map(|(run, _)| run)
        .next())
}

fn unknown(found: &str, nearest: &str) -> PipelineError {
    PipelineError::UnknownRun {
        found: found.to_owned(),
        nearest: nearest.to_owned(),
    }
}
