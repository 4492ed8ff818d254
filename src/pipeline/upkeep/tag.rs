//! Sets tags by hand.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::tag::keys;
use crate::domain::{Campaign, FileState, Issue, RunRecord, RunState, Tag, TagSource};
use crate::ingest::archive;
use crate::ingest::scan::{is_another, parse_display_path};
use crate::ingest::tags::{is_unreadable, objection, value_objection};
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::climate;
use crate::pipeline::intake::ingest::{LARGEST_FILE_BYTES, known, retag_named, together};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FileRow, HandTag};

/// The verb `tag`.
#[derive(Debug, Clone)]
pub struct SetTags {
    /// Names of runs, or patterns of names with `*` and `?`.
    pub runs: Vec<String>,
    /// Keys and values; an empty value takes an earlier hand tag back.
    pub pairs: Vec<(String, String)>,
    /// Who sets them.
    pub set_by: String,
    /// Whether a voltage is set that the readings contradict.
    pub even_so: bool,
}

/// A stated voltage so many times larger or smaller than what was read is one in another unit.
const OTHER_UNIT: f64 = 10.0;

/// What `tag` did.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TagSummary {
    /// The run.
    pub run: String,
    /// Its state now.
    pub state: &'static str,
    /// Its chosen tags now: key, value, source.
    pub tags: Vec<(String, String, String)>,
    /// Whether a tag file cannot be read now: what was set is stored, and its tags are worked out when it can.
    pub waits: bool,
    /// What a reader must know of its tags.
    pub issues: Vec<Issue>,
    /// Those among them that were not there before.
    #[serde(skip)]
    pub new_issues: Vec<Issue>,
}

impl SetTags {
    /// Stores the tags and tags the runs again; one entry a run.
    ///
    /// # Errors
    /// No run has that name, a key is neither known nor declared, a value is none that a run can have, or the database
    /// refuses. Nothing is set then.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<Vec<TagSummary>, PipelineError> {
        self.check(&context.campaign)?;
        let (mut said_of, mut before) = (Vec::new(), BTreeMap::new());
        // What a name means and what is said of it is one step: nobody renames in between.
        together(context, |context| {
            let runs = self.known_runs(context)?;
            if !self.even_so {
                self.check_voltage(&stored_runs(context, &runs)?)?;
            }
            let now = now();
            let tags: Vec<HandTag> = runs.iter().flat_map(|run| self.hand_tags(run, &now)).collect();
            for run in &runs {
                said_of.push(context.store.measurement_of(run)?);
            }
            for (of, (_, issues)) in said_of.iter().zip(issues_of(context, &runs)?) {
                before.insert(of.clone(), issues);
            }
            Ok(context.store.add_hand_tags(&now, &tags)?)
        })?;
        let mut names = BTreeSet::new();
        for of in &said_of {
            names.extend(context.store.name_of(of)?);
        }
        retag_named(context, &names, observer)?;
        let shelf = climate::Shelf::open(&context.store)?;
        climate::assess(context, &shelf)?;
        let mut stored = Vec::with_capacity(said_of.len());
        for of in &said_of {
            // One that another program took out since is not there to be shown; what was said of it is kept.
            let Some(name) = context.store.name_of(of)? else {
                continue;
            };
            let known = before.remove(of).unwrap_or_default();
            let found = stored_runs(context, std::slice::from_ref(&name))?;
            stored.extend(found.into_iter().map(|run| (run, known.clone())));
        }
        let unreadable = unreadable(stored.iter().map(|(run, _)| run));
        for issue in &unreadable {
            observer.warn(&format!(
                "{}: {}; runs that it tags are tagged again later",
                issue.place, issue.message
            ));
        }
        let waits = !unreadable.is_empty();
        let summary = |(run, known): &(RunRecord, Vec<Issue>)| TagSummary::of(run, known, waits);
        Ok(stored.iter().map(summary).collect())
    }

    /// Refuses keys that are neither known nor declared, and values that no run can have; what was set before may be taken
    /// back.
    fn check(&self, campaign: &Campaign) -> Result<(), PipelineError> {
        let set = self.pairs.iter().filter(|(_, value)| !value.is_empty());
        let objected = |(key, value): &(String, String)| {
            let tag = Tag {
                key: key.clone(),
                value: value.clone(),
                source: TagSource::Hand,
                detail: String::new(),
            };
            objection(key, &campaign.extra_tags).or_else(|| value_objection(&tag, campaign))
        };
        match set.filter_map(objected).next() {
            Some(issue) => Err(PipelineError::TagRefused {
                found: issue.message,
                mend: issue.mend,
            }),
            None => Ok(()),
        }
    }

    /// Refuses a voltage that is that of the readings in another unit.
    fn check_voltage(&self, runs: &[RunRecord]) -> Result<(), PipelineError> {
        let mut pairs = self.pairs.iter().rev().filter(|(key, _)| key == keys::VOLTAGE_V);
        let Some(stated_v) = pairs.next().and_then(|(_, value)| value.parse::<f64>().ok()) else {
            return Ok(());
        };
        let read = |run: &RunRecord| {
            let read = [TagSource::Channel, TagSource::Header];
            let mut tags = run
                .tags
                .iter()
                .filter(|tag| tag.key == keys::VOLTAGE_V && read.contains(&tag.source));
            tags.next().and_then(|tag| tag.value.parse::<f64>().ok())
        };
        let is_other = |read_v: f64| {
            let times = (stated_v / read_v).abs();
            read_v != 0.0 && stated_v != 0.0 && !(OTHER_UNIT.recip()..=OTHER_UNIT).contains(&times)
        };
        let found = runs
            .iter()
            .find_map(|run| Some((run, read(run).filter(|read_v| is_other(*read_v))?)));
        match found {
            None => Ok(()),
            Some((run, read_v)) => Err(PipelineError::TagRefused {
                found: format!(
                    "voltage_v = {stated_v} V, and the readings of {} say {read_v} V",
                    run.path
                ),
                mend: "write it in volts, or say --even-so if the readings are wrong".to_owned(),
            }),
        }
    }

    fn hand_tags(&self, run: &str, now: &str) -> Vec<HandTag> {
        let tag = |(key, value): &(String, String)| HandTag {
            run_path: run.to_owned(),
            key: key.clone(),
            value: (!value.is_empty()).then(|| value.clone()),
            set_by: self.set_by.clone(),
            set_at: now.to_owned(),
        };
        self.pairs.iter().map(tag).collect()
    }

    /// The names of the runs meant, each once.
    fn known_runs(&self, context: &Context) -> Result<Vec<String>, PipelineError> {
        let mut known: Vec<String> = Vec::new();
        for given in &self.runs {
            let found = if given.contains(['*', '?']) {
                let found = runs_like(context, given)?;
                found.iter().try_for_each(|run| refuse_unseen(context, run))?;
                found
            } else {
                vec![known_run(context, given)?]
            };
            for run in found {
                if !known.contains(&run) {
                    known.push(run);
                }
            }
        }
        Ok(known)
    }
}

impl TagSummary {
    fn of(run: &RunRecord, before: &[Issue], waits: bool) -> TagSummary {
        let mut seen = std::collections::BTreeSet::new();
        let chosen = run.tags.iter().take_while(|tag| seen.insert(tag.key.clone()));
        let new_issues = run.issues.iter().filter(|issue| !before.contains(issue));
        TagSummary {
            state: if run.state == RunState::Ready {
                "ready"
            } else {
                run.state.key()
            },
            tags: chosen
                .map(|t| (t.key.clone(), t.value.clone(), t.source.label().to_owned()))
                .collect(),
            new_issues: new_issues.cloned().collect(),
            issues: run.issues.clone(),
            run: run.path.clone(),
            waits,
        }
    }
}

/// What cannot be read of the tag files of runs, each once, by place.
fn unreadable<'a>(runs: impl Iterator<Item = &'a RunRecord>) -> Vec<&'a Issue> {
    let issues = runs.flat_map(|run| &run.issues);
    let found: BTreeMap<_, _> = issues
        .filter(|issue| is_unreadable(issue))
        .map(|issue| ((&issue.place, &issue.code), issue))
        .collect();
    found.into_values().collect()
}

/// The runs, modulus logs and spectra of these names; the others are not read.
fn stored_runs(context: &Context, names: &[String]) -> Result<Vec<RunRecord>, PipelineError> {
    let mut runs = Vec::with_capacity(names.len());
    for name in names {
        runs.extend(context.store.run_named(name)?);
    }
    if runs.len() < names.len() {
        let others = context
            .store
            .dma_logs()?
            .into_iter()
            .chain(context.store.spectra()?);
        runs.extend(others.filter(|run| names.contains(&run.path)));
    }
    Ok(runs)
}

/// The issues of runs, in the order of these names.
fn issues_of(context: &Context, names: &[String]) -> Result<Vec<(String, Vec<Issue>)>, PipelineError> {
    let runs = stored_runs(context, names)?.into_iter();
    let mut issues: BTreeMap<String, Vec<Issue>> = runs.map(|run| (run.path, run.issues)).collect();
    let of = |name: &String| (name.clone(), issues.remove(name).unwrap_or_default());
    Ok(names.iter().map(of).collect())
}

/// The runs whose name, or its end after a `/`, fits the pattern.
fn runs_like(context: &Context, pattern: &str) -> Result<Vec<String>, PipelineError> {
    // A bracket in a name of a file stands for itself.
    let plain = pattern.trim_start_matches("./").replace('[', "[[]");
    let parsed = |text: &str| glob::Pattern::new(text).map_err(|_| unknown(pattern, ""));
    let (whole, end) = (parsed(&plain)?, parsed(&format!("*/{plain}"))?);
    let found: Vec<String> = (context.store.run_names()?.into_iter())
        .filter(|name| whole.matches(name) || end.matches(name))
        .collect();
    if found.is_empty() {
        Err(unknown(pattern, ""))
    } else {
        Ok(found)
    }
}

/// The run meant: by its whole name, by the end of it where only one run ends so, or by another name of its file's bytes.
///
/// # Errors
/// There is no such run, or more than one.
pub(crate) fn known_run(context: &Context, given: &str) -> Result<String, PipelineError> {
    let run = meant_run(context, given)?;
    refuse_unseen(context, &run)?;
    Ok(run)
}

/// Refuses a run under whose name another file lies than at the last look: nobody knows which of them is meant.
fn refuse_unseen(context: &Context, run: &str) -> Result<(), PipelineError> {
    let paths: Vec<String> = (context.store.contents_of(run)?.into_iter())
        .map(|(path, _)| path)
        .collect();
    let of_run = context.store.files_of(&paths)?;
    let looks_other = |row: &&FileRow| {
        let mut files = known(std::slice::from_ref(*row)).into_iter();
        files.any(|file| is_another(&context.folder, &file))
    };
    let mut looking = of_run.iter().filter(looks_other);
    match looking.find(|row| holds_other(context, row)) {
        Some(row) => Err(PipelineError::Unseen {
            file: row.path.clone(),
        }),
        None => Ok(()),
    }
}

/// Whether a file that looks another by its times holds other bytes: a copied campaign has files of its own with the same ones.
fn holds_other(context: &Context, row: &FileRow) -> bool {
    let location = context.folder.join(parse_display_path(&row.path));
    match (context.read_file)(&location, LARGEST_FILE_BYTES) {
        Ok(bytes) => Some(archive::hash(&bytes)) != row.hash,
        Err(_) => true,
    }
}

fn meant_run(context: &Context, given: &str) -> Result<String, PipelineError> {
    let wanted = given.trim_start_matches("./").replace('\\', "/");
    if context.store.id_of_run(&wanted)?.is_some() {
        return Ok(wanted);
    }
    let names = context.store.run_names()?;
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
            if context.folder.join(parse_display_path(&wanted)).is_file() {
                return Err(PipelineError::Unseen { file: wanted });
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
