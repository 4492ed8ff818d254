//! What changes runs: new revisions, tags, names.

use rusqlite::params;

use super::columns::to_json;
use super::files::upsert_file;
use super::insert_run::insert_run;
use super::journal::{Entry, NamedBytes, NamedRun};
use super::measurement::documents;
use super::new_run::{Continues, NewRun, TagDocument, TagOfSource, Tagging};
use super::read_files::supersede_parts;
use super::results::retire_of_run;
use super::rows::RUN;
use super::{FileRow, RunContent, StepError, Store, StoreError, Transaction};
use ieap_domain::{RunState, Tag, TagSource};

impl Store {
    /// Stores what was read from files, whole or not at all: the files, their contents, and each run as the
    /// new current revision of its name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_runs(&mut self, now: &str, files: &[FileRow], runs: &[NewRun]) -> Result<(), StoreError> {
        self.write("storing a run", now, |transaction| {
            let mut named = Vec::with_capacity(runs.len());
            for run in runs {
                let revision = insert_run(transaction, now, run)?;
                named.push(NamedRun {
                    name: run.path.clone(),
                    revision,
                    continues: run.continues == Continues::Same,
                });
            }
            if let Some(first) = runs.first() {
                let named_bytes = |content: &RunContent| NamedBytes {
                    path: content.path.clone(),
                    hash: content.hash.clone(),
                };
                let read = Entry::Read {
                    kind: first.kind,
                    reader: first.format.clone(),
                    files: first.contents.iter().map(named_bytes).collect(),
                    runs: named,
                };
                transaction.says(now, read)?;
            }
            supersede_parts(transaction, now, runs)?;
            files.iter().try_for_each(|file| upsert_file(transaction, file))
        })
    }

    /// Puts new tags, and what follows from them, in place of those of a run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn retag(&mut self, now: &str, run_id: i64, tagging: &Tagging) -> Result<(), StoreError> {
        self.write("storing tags", now, |transaction| {
            let (document, curves) = tagging.documents()?;
            transaction.change(RUN, ("id = ?1", &run_id), || {
                let sql = "UPDATE run SET state = ?2, tag_digest = ?3, tagging = ?4, climate_curves = ?5 WHERE id = ?1";
                let values = params![run_id, tagging.state.key(), tagging.digest, document, curves];
                transaction.prepare_cached(sql)?.execute(values)?;
                Ok(())
            })?;
            if tagging.state != RunState::Ready {
                retire_of_run(transaction, now, run_id)?;
            }
            Ok(())
        })
    }

    /// Gives the current runs in a file what was stated beside it, in place of what they have of it, and has them tagged again:
    /// of a file that is gone this holds ([`Entry::Gone`]).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn keep_tags(&mut self, now: &str, path: &str, tags: &[Tag]) -> Result<(), StoreError> {
        self.write("keeping tags", now, |transaction| {
            for run_id in current_runs_in(transaction, path)? {
                change_tags(transaction, run_id, "", |tagging| {
                    tagging.tags.retain(|tag| !is_stated_beside(&tag.tag));
                    let kept = tags.iter().cloned();
                    tagging
                        .tags
                        .extend(kept.map(|tag| TagOfSource { tag, chosen: false }));
                })?;
            }
            Ok(())
        })
    }

    /// Says of a file that is gone what is stated beside it now: the files that state it may go as well.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn say_stated_beside(&mut self, now: &str, path: &str) -> Result<(), StoreError> {
        self.write("noting tags", now, |transaction| {
            let (path, tags) = (path.to_owned(), stated_beside(transaction, path)?);
            transaction.says(now, Entry::Gone { path, tags })
        })
    }
}

/// Changes the tags of a run, and writes down what they came from.
fn change_tags(
    transaction: &Transaction<'_>,
    run_id: i64,
    digest: &str,
    change: impl Fn(&mut TagDocument),
) -> Result<(), StepError> {
    for (id, mut tagging) in documents::<TagDocument>(transaction, "tagging", "id = ?1", run_id)? {
        change(&mut tagging);
        let tagging = to_json("the tags of a run", &tagging)?;
        transaction.change(RUN, ("id = ?1", &id), || {
            let sql = "UPDATE run SET tag_digest = ?2, tagging = ?3 WHERE id = ?1";
            transaction
                .prepare_cached(sql)?
                .execute(params![id, digest, tagging])?;
            Ok(())
        })?;
    }
    Ok(())
}

/// Current runs in a file: under its name, with the bytes that it had.
fn current_runs_in(transaction: &Transaction<'_>, path: &str) -> Result<Vec<i64>, StepError> {
    let sql = "SELECT DISTINCT run.id FROM run JOIN run_file ON run_file.run_id = run.id
               WHERE superseded_at IS NULL AND run_file.path = ?1
                 AND run_file.hash = (SELECT hash FROM source_file WHERE path = ?1) ORDER BY run.id";
    let mut statement = transaction.prepare_cached(sql)?;
    let ids = statement.query_map([path], |row| row.get(0))?;
    Ok(ids.collect::<rusqlite::Result<_>>()?)
}

/// Whether a tag stands in files that may be gone with the readings.
fn is_stated_beside(tag: &Tag) -> bool {
    matches!(
        tag.source,
        TagSource::Sidecar | TagSource::Folder | TagSource::RunSheet | TagSource::Derived
    )
}

/// What files beside a file and run sheets stated of the current runs in it, each once.
pub(super) fn stated_beside(transaction: &Transaction<'_>, path: &str) -> Result<Vec<Tag>, StepError> {
    let mut stated: Vec<Tag> = Vec::new();
    for run_id in current_runs_in(transaction, path)? {
        for (_, tagging) in documents::<TagDocument>(transaction, "tagging", "id = ?1", run_id)? {
            let beside = tagging.tags.into_iter().map(|of| of.tag).filter(is_stated_beside);
            for tag in beside {
                if !stated.contains(&tag) {
                    stated.push(tag);
                }
            }
        }
    }
    Ok(stated)
}
