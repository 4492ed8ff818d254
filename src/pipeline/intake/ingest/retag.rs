//! Tags runs again whose tag files, hand tags, climate logs or campaign.toml changed. The readings are not touched.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::batch::{MOST_FILES, together};
use super::start;
use super::summary::IngestSummary;
use super::tagging::{TaggingInput, digest, tag_files, tagging, unreadable};
use super::window::window;
use crate::domain::tag::keys;
use crate::domain::{Issue, RunRecord, RunState, Tag, TagSource};
use crate::ingest::formats::date::DATE_UNCERTAIN;
use crate::ingest::tags::{TagFiles, is_unreadable};
use crate::ingest::{StartedAt, Timestamp};
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::now;
use crate::pipeline::campaign::planned::known_sheets;
use crate::pipeline::intake::climate::Shelf;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::TagSources;

/// Tags again every current run whose tag sources changed, and lists their names. A run keeps its tags while
/// something that states some of them cannot be read.
///
/// # Errors
/// The database refuses.
pub fn retag_runs(
    context: &mut Context,
    summary: &mut IngestSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    summary.retagged = retag_among(context, None, observer)?;
    Ok(())
}

/// The same of these runs alone, after something was said of them, and of those that hold the readings of one of them: no
/// other hangs on what is said of them.
///
/// # Errors
/// The database refuses.
pub(crate) fn retag_named(
    context: &mut Context,
    names: &BTreeSet<String>,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    retag_among(context, Some(names), observer).map(drop)
}

fn retag_among(
    context: &mut Context,
    names: Option<&BTreeSet<String>>,
    observer: &dyn Observer,
) -> Result<Vec<String>, PipelineError> {
    let shelf = Shelf::open(&context.store)?;
    // What is written from here on is of the next time: digest and tags are of one reading.
    context.stated = TagFiles::of(&context.folder);
    context.sheets = known_sheets(context)?;
    let other_names = context.store.other_names()?;
    let others_of = |run_id: i64| other_names.get(&run_id).map_or(&[][..], Vec::as_slice);
    let all_sources = match names {
        None => context.store.tag_sources()?,
        Some(names) => {
            let ids = with_others(context, names, &other_names)?;
            context.store.tag_sources_of(&ids)?
        }
    };
    let mut due: BTreeMap<i64, Due> = BTreeMap::new();
    for sources in all_sources {
        let run_id = sources.run_id;
        let files: Vec<&str> = sources.files.iter().map(String::as_str).collect();
        let files = tag_files(&sources.path, &files);
        let digest = digest(
            context,
            &shelf,
            (&sources.path, &files),
            &sources.said_of,
            others_of(run_id),
            window(sources.started_at.as_deref(), sources.times),
            sources.is_gone,
        )?;
        let changed = digest != sources.digest;
        if changed || (has_open_date(&sources) && is_decided_beside(context, run_id, &files)?) {
            due.insert(run_id, Due { changed, sources });
        }
    }
    let runs = context.store.runs_of(due.keys().copied())?;
    let mut retagged = Vec::new();
    for batch in runs.chunks(MOST_FILES) {
        interrupt::check();
        let before = retagged.len();
        together(context, |context| {
            for run in batch {
                let (Due { changed, sources }, others) = (&due[&run.id], others_of(run.id));
                let held = held_by(context, run, others);
                // Where only its date could be told now that waits for what cannot be read, too.
                if (held.is_none() || *changed)
                    && retag(
                        context,
                        &shelf,
                        (run, &sources.said_of),
                        others,
                        sources.is_gone,
                        held,
                    )?
                {
                    retagged.push(run.path.clone());
                }
            }
            Ok(())
        })?;
        retagged[before..]
            .iter()
            .for_each(|path| observer.say(&format!("tagged {path} again")));
    }
    Ok(retagged)
}

/// Row ids of the current runs of these names, and of those of which one of them is another name.
fn with_others(
    context: &Context,
    names: &BTreeSet<String>,
    other_names: &BTreeMap<i64, Vec<String>>,
) -> Result<BTreeSet<i64>, PipelineError> {
    let is_of_one = |(_, others): &(&i64, &Vec<String>)| others.iter().any(|other| names.contains(other));
    let mut ids: BTreeSet<i64> = other_names.iter().filter(is_of_one).map(|(id, _)| *id).collect();
    for name in names {
        ids.extend(context.store.id_of_run(name)?);
    }
    Ok(ids)
}

/// Whether it was said of a run that its file leaves open which of two dates it states.
fn has_open_date(sources: &TagSources) -> bool {
    let is_of_date = |issue: &Issue| issue.code == DATE_UNCERTAIN && issue.place == keys::STARTED_AT;
    sources.issues.iter().any(is_of_date)
}

/// Why a run is looked at again.
struct Due {
    /// Whether the digest of its tag sources is another one than before.
    changed: bool,
    /// What its tags came from.
    sources: TagSources,
}

/// Why a run keeps the tags that it has until something is mended: what they came from cannot be read now, and the next
/// source would give other tags. One that waits for tags is not held.
fn held_by(context: &Context, run: &RunRecord, other_names: &[String]) -> Option<Vec<Issue>> {
    let files: Vec<&str> = run.files.iter().map(|file| file.path.as_str()).collect();
    let mut issues = unreadable(context, &run.path, &tag_files(&run.path, &files), other_names);
    let is_lost = run.tags.iter().any(|tag| context.sheets.is_from_damaged(tag));
    if run.state == RunState::Untagged || issues.is_empty() && !is_lost {
        return None;
    }
    for issue in &mut issues {
        issue.message += "; the run keeps the tags that it had";
    }
    Some(issues)
}

/// Whether the files beside a run, whose date leaves day and month open, show their order now.
fn is_decided_beside(context: &Context, run_id: i64, files: &[PathBuf]) -> Result<bool, PipelineError> {
    let origin = context.store.origin(run_id)?;
    let stamps = origin.clocks.iter().filter_map(|clock| clock.stamp.as_ref());
    let Some(file) = files.first() else {
        return Ok(false);
    };
    let beside = context.folder.join(file);
    Ok(stamps
        .filter(|stamp| start::is_open(stamp))
        .any(|stamp| start::settled(stamp, None, &beside).1.is_none()))
}

/// Tags that stand in files which may be gone with the readings.
fn stated_beside(tags: &[Tag]) -> impl Iterator<Item = &Tag> {
    let sources = [
        TagSource::Sidecar,
        TagSource::Folder,
        TagSource::RunSheet,
        TagSource::Derived,
    ];
    tags.iter().filter(move |tag| sources.contains(&tag.source))
}

/// Tags a run anew; says whether that is news: a file that was mended to what it said before is none, and one that cannot be
/// read now is none. What people said holds at once also where the rest is held. Where the file of the readings is gone, what was stated beside it holds: a disk that is not mounted, or a folder that was moved away, takes no
/// tags from runs that stay.
fn retag(
    context: &mut Context,
    shelf: &Shelf,
    (run, said_of): (&RunRecord, &[String]),
    other_names: &[String],
    is_gone: bool,
    held: Option<Vec<Issue>>,
) -> Result<bool, PipelineError> {
    let (time_zero_is_step, is_step_response) = context.store.reading_facts(run.id)?;
    let channels = context.store.channels_as_read(run.id)?;
    let header = run.tags.iter().filter(|tag| tag.source == TagSource::Header);
    let (starts, others): (Vec<_>, Vec<_>) = header.partition(|tag| tag.key == keys::STARTED_AT);
    // The stored start carries its offset already.
    let start = starts.first().map(|tag| StartedAt {
        raw: tag.detail.clone(),
        kind: Timestamp::Start,
        local: Some(tag.value.clone()),
        offset: None,
        basis: String::new(),
    });
    // A date that the file leaves open is read anew, for what decides it may have changed.
    let mut stamps = run.origin.clocks.iter().filter_map(|clock| clock.stamp.as_ref());
    let open = stamps.find(|stamp| start::is_open(stamp)).cloned();
    let started_at = open.or(start).or_else(|| start::of_run(&run.origin, &channels));
    let input = TaggingInput {
        run_path: &run.path,
        kind: run.kind,
        file_paths: run.files.iter().map(|file| file.path.as_str()).collect(),
        said_of: said_of.to_vec(),
        other_names,
        origin: &run.origin,
        channels: &channels,
        time_zero_is_step,
        is_step_response,
        header_tags: others
            .iter()
            .map(|tag| (tag.key.clone(), tag.value.clone(), tag.detail.clone()))
            .collect(),
        started_at,
        kept: is_gone.then(|| stated_beside(&run.tags).cloned().collect()),
        held: held.map(|why| (run.tags.as_slice(), why)),
    };
    let tagging = tagging(context, shelf, &input)?;
    let was_held = run.state != RunState::Untagged && run.issues.iter().any(is_unreadable);
    let is_news = !(was_held || is_gone || input.held.is_some()) || tagging.tags != run.tags;
    context.store.retag(&now(), run.id, &tagging)?;
    if is_gone && !stated_beside(&tagging.tags).eq(stated_beside(&run.tags)) {
        for file in &run.files {
            context.store.say_stated_beside(&now(), &file.path)?;
        }
    }
    Ok(is_news)
}
