//! Decides what files that were read come to, and stores it: one transaction a run.

use std::collections::{BTreeMap, BTreeSet};

use super::continues::continues;
use super::prepare::{Outcome, Prepared, PreparedFile, RunPart, joined, run_parts};
use super::readers::{Readers, format_of, reader_of};
use super::rows::{content_of, file_row, set_aside};
use super::start::{of_run, without_open_dates};
use super::summary::IngestSummary;
use super::tagging::{TaggingInput, tagging};
use crate::domain::data_hash::data_hash;
use crate::domain::{FileState, Issue, ProfileUse, RunClock, RunKind, RunOrigin, RunStatus};
use crate::ingest::Reading;
use crate::ingest::scan::{Changes, Scan};
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::climate::Shelf;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::journal::NamedRun;
use crate::store::{Continues, FileRow, Moves, NewRun, RunContent, Store, measurement};

/// Stores a group: its runs, an alias, a new name, or why it was refused.
pub fn settle(
    context: &mut Context,
    (readers, shelf): (&Readers, &Shelf),
    prepared: Prepared,
    changes: &Changes,
    summary: &mut IngestSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let unread: Vec<(String, Issue)> = prepared.files.iter().filter_map(PreparedFile::unread).collect();
    if !unread.is_empty() {
        // Without one of its files a run would be half a run: all of it waits.
        summary.unread.extend(unread);
        return Ok(());
    }
    let (mut readable, kind) = (Vec::new(), prepared.kind);
    for file in prepared.files {
        match file.outcome.aside() {
            None => readable.push(file),
            Some((state, issue)) => set_aside(context, readers, &file, state, issue, observer)?,
        }
    }
    let is_known = match readable.as_slice() {
        [] => true,
        [single] => is_known(context, readers, single, changes, summary)?,
        several => are_known(context, readers, several)?,
    };
    if is_known {
        Ok(())
    } else {
        store_runs(
            context,
            (readers, shelf),
            &prepared.run_name,
            kind,
            &readable,
            summary,
            observer,
        )
    }
}

/// Stores a group whatever is known of its bytes: they make another run now.
pub fn settle_anew(
    context: &mut Context,
    with: (&Readers, &Shelf),
    prepared: Prepared,
    summary: &mut IngestSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    // What cannot be read now is paired when it can.
    if prepared
        .files
        .iter()
        .any(|file| !matches!(file.outcome, Outcome::Read(_)))
    {
        return Ok(());
    }
    let (name, kind) = (&prepared.run_name, prepared.kind);
    store_runs(context, with, name, kind, &prepared.files, summary, observer)
}

/// Whether the current run of several files holds these very bytes, read by these readers: a file that was only
/// touched makes no new revision.
fn are_known(
    context: &mut Context,
    readers: &Readers,
    files: &[PreparedFile],
) -> Result<bool, PipelineError> {
    let found: Vec<(String, String)> = files
        .iter()
        .filter_map(|file| Some((file.file.display.clone(), file.hash.clone()?)))
        .collect();
    let Some(run_name) = run_of_files(context, &found)? else {
        return Ok(false);
    };
    let reader = files.first().and_then(|file| match &file.outcome {
        Outcome::Read(reading) => Some(reader_of(reading, file.profile.as_ref())),
        _ => None,
    });
    let same_reader = |file: &PreparedFile| match &file.outcome {
        Outcome::Read(reading) => {
            let reader = reader_of(reading, file.profile.as_ref());
            readers.last_of(&file.file.display) == Some(reader.as_str())
        }
        _ => false,
    };
    if context.store.reader_of(&run_name)? != reader || !files.iter().all(same_reader) {
        return Ok(false);
    }
    let rows: Vec<FileRow> = files.iter().filter_map(|file| run_row(readers, file)).collect();
    context.store.record_files(&now(), &rows)?;
    Ok(true)
}

/// The current run that was read from just these files, by path and hash.
fn run_of_files(context: &Context, files: &[(String, String)]) -> Result<Option<String>, PipelineError> {
    let Some((_, hash)) = files.first() else {
        return Ok(None);
    };
    for (run, _) in context.store.runs_with_content(hash)? {
        if context.store.contents_of(&run)? == files {
            return Ok(Some(run));
        }
    }
    Ok(None)
}

/// Whether the bytes of a file are those of a current run: then the file is that run's, an alias of it, or
/// the run takes the file's name because its own file was moved.
fn is_known(
    context: &mut Context,
    readers: &Readers,
    prepared: &PreparedFile,
    changes: &Changes,
    summary: &mut IngestSummary,
) -> Result<bool, PipelineError> {
    let (Some(hash), Outcome::Read(reading)) = (&prepared.hash, &prepared.outcome) else {
        return Ok(false);
    };
    let path = prepared.file.display.clone();
    let mut holders = context.store.runs_with_content(hash)?;
    // Bytes that moved between the folders are measured anew: what they are is told by the folder.
    let kind = context.campaign.kind_of(&path);
    holders.retain(|(run, _)| context.campaign.kind_of(run) == kind);
    let reader = reader_of(reading, prepared.profile.as_ref());
    let stamp = readers.of_file(reading, prepared.profile.as_ref());
    let row = |state| file_row(&prepared.file, Some(hash.clone()), state, stamp.clone(), None);
    let Some((run_path, file_path)) = holders.iter().find(|(_, file)| *file == path).or(holders.first())
    else {
        return Ok(false);
    };
    let now = now();
    if *file_path == path {
        // Touched, or read before by this or another version of the reader.
        let same_reader = context.store.reader_of(run_path)? == Some(reader.clone());
        if same_reader {
            context.store.record_files(&now, &[row(FileState::Run)])?;
        }
        return Ok(same_reader);
    }
    // A folder of frames: of all else the names were settled before ([`super::moves`]).
    let moved = holders.len() == 1
        && run_path == file_path
        && changes.gone.binary_search(file_path).is_ok()
        && !context.store.has_run(&path)?;
    if moved {
        let (old, new) = (run_path.clone(), path.clone());
        let moves = Moves {
            files: [(old.clone(), row(FileState::Run))].into(),
            runs: vec![(old, new)],
        };
        context.store.move_files(&now, &moves)?;
        summary.renamed.extend(moves.runs);
    } else {
        context.store.record_files(&now, &[row(FileState::Alias)])?;
        summary.aliases.push(path);
    }
    Ok(true)
}

/// What was read from the files that could be read.
fn readings_of(files: &[PreparedFile]) -> Vec<&Reading> {
    files
        .iter()
        .filter_map(|file| match &file.outcome {
            Outcome::Read(reading) => Some(&**reading),
            _ => None,
        })
        .collect()
}

/// Tags the runs and stores everything at once.
fn store_runs(
    context: &mut Context,
    (readers, shelf): (&Readers, &Shelf),
    run_name: &str,
    kind: RunKind,
    files: &[PreparedFile],
    summary: &mut IngestSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let (rows, runs) = runs_of(context, (readers, shelf), (run_name, kind), files, &[])?;
    for run in &runs {
        let known = context.store.id_of_run(&run.path)?.is_some();
        let (did, list) = match run.continues {
            Continues::Same if known => ("new revision of", &mut summary.revised),
            Continues::Another if known => {
                summary.replaced.push(run.path.clone());
                ("another measurement than before is", &mut summary.new)
            }
            _ => ("read", &mut summary.new),
        };
        observer.say(&format!("{did} {} ({})", run.path, run.format));
        list.push(run.path.clone());
    }
    if runs.is_empty() {
        Ok(())
    } else {
        Ok(context.store.save_runs(&now(), &rows, &runs)?)
    }
}

/// The runs that files hold, tagged, with what is known of the files. The first runs are named as `given`, and continue what
/// had the name then as it says.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn runs_of(
    context: &Context,
    (readers, shelf): (&Readers, &Shelf),
    (run_name, kind): (&str, RunKind),
    files: &[PreparedFile],
    given: &[NamedRun],
) -> Result<(Vec<FileRow>, Vec<NewRun>), PipelineError> {
    let readings = readings_of(files);
    let Some(first) = readings.first().copied() else {
        return Ok((Vec::new(), Vec::new()));
    };
    let (parts, join_issues) = if readings.len() == 1 {
        (run_parts(first, kind), Vec::new())
    } else {
        let (part, issues) = joined(&readings);
        (vec![part], issues)
    };
    let contents = contents_of(files);
    let rows: Vec<FileRow> = files.iter().filter_map(|file| run_row(readers, file)).collect();
    // A single file keeps its own name; a joined run takes that of the stem.
    let base = if files.len() == 1 {
        files[0].file.display.as_str()
    } else {
        run_name
    };
    let mut names = run_names(context, base, &parts, &contents)?;
    for (name, given) in names.iter_mut().zip(given) {
        name.clone_from(&given.name);
    }
    let mut tables: BTreeMap<String, usize> = BTreeMap::new();
    let runs: Vec<NewRun> = parts
        .into_iter()
        .zip(names)
        .enumerate()
        .map(|(at, (part, name))| {
            let before = tables.entry(part.suffix.clone()).or_insert(0);
            *before += 1;
            let table = if *before > 1 {
                format!("{} ({before})", part.suffix)
            } else {
                part.suffix.clone()
            };
            let continues = match given.get(at) {
                Some(given) if given.continues => Continues::Same,
                Some(_) => Continues::Another,
                None => continues(context, &name, &contents, &part.channels)?,
            };
            let known_by = (measurement(kind, &contents, &table), continues);
            let kind = part.kind(kind);
            new_run(
                (context, shelf),
                (name, known_by),
                kind,
                part,
                files,
                &contents,
                &join_issues,
            )
        })
        .collect::<Result<_, _>>()?;
    Ok((rows, runs))
}

/// A name for each part: that of the file, with `#TABLE` where it has several. A name that another part has, or a run of
/// other files (the table `Run` of `a.xlsx` beside a file `a.xlsx#Run`), gets a number: no run takes another's place.
fn run_names(
    context: &Context,
    base: &str,
    parts: &[RunPart],
    contents: &[RunContent],
) -> Result<Vec<String>, PipelineError> {
    let mut names: Vec<String> = Vec::with_capacity(parts.len());
    for part in parts {
        let wanted = format!("{base}{}", part.suffix);
        let (mut name, mut number) = (wanted.clone(), 1);
        while names.contains(&name) || is_of_other_files(context, &name, contents)? {
            number += 1;
            name = format!("{wanted} ({number})");
        }
        names.push(name);
    }
    Ok(names)
}

/// Whether the current run of that name was read from none of these files.
fn is_of_other_files(context: &Context, name: &str, contents: &[RunContent]) -> Result<bool, PipelineError> {
    let held = context.store.contents_of(name)?;
    let is_ours = |path: &String| contents.iter().any(|content| content.path == *path);
    Ok(!held.is_empty() && !held.iter().any(|(path, _)| is_ours(path)))
}

/// What the archive holds of the files.
fn contents_of(files: &[PreparedFile]) -> Vec<RunContent> {
    files.iter().filter_map(content_of).collect()
}

fn run_row(readers: &Readers, file: &PreparedFile) -> Option<FileRow> {
    let (Some(hash), Outcome::Read(reading)) = (&file.hash, &file.outcome) else {
        return None;
    };
    let reader = readers.of_file(reading, file.profile.as_ref());
    Some(file_row(
        &file.file,
        Some(hash.clone()),
        FileState::Run,
        reader,
        None,
    ))
}

fn new_run(
    (context, shelf): (&Context, &Shelf),
    (path, (measurement, continues)): (String, (String, Continues)),
    kind: RunKind,
    part: RunPart,
    files: &[PreparedFile],
    contents: &[RunContent],
    join_issues: &[Issue],
) -> Result<NewRun, PipelineError> {
    let readings = readings_of(files);
    let first = readings[0];
    let origin = origin(part.origin, files);
    let is_step_response =
        kind != RunKind::Impedance && readings.iter().all(|reading| reading.is_step_response);
    let worst = readings
        .iter()
        .find(|reading| reading.status != RunStatus::Complete)
        .unwrap_or(&first);
    // What holds of earlier bytes that come back is known when all are in; then it is tagged again.
    let mut said_of = vec![measurement.clone()];
    match continues {
        Continues::Same => said_of.extend(context.store.said_of(&path)?),
        Continues::Another => said_of.extend(contents.iter().map(|content| content.hash.clone())),
    }
    let input = TaggingInput {
        said_of,
        run_path: &path,
        kind,
        file_paths: contents.iter().map(|content| content.path.as_str()).collect(),
        // Which others hold these readings is known when all are in; then it is tagged again.
        other_names: &[],
        origin: &origin,
        channels: &part.channels,
        time_zero_is_step: part.time_zero_is_step,
        is_step_response,
        header_tags: readings
            .iter()
            .flat_map(|reading| reading.header_tags.clone())
            .collect(),
        started_at: of_run(&origin, &part.channels),
        kept: None,
        held: None,
    };
    Ok(NewRun {
        tagging: tagging(context, shelf, &input)?,
        data_hash: data_hash(&part.channels),
        measurement,
        continues,
        format: format_of(first, files[0].profile.as_ref()),
        origin,
        reader_version: first.reader_version,
        technique: first.technique.clone(),
        is_step_response,
        encoding: first.encoding.map(str::to_owned),
        status: worst.status,
        status_evidence: worst.status_evidence.clone(),
        time_zero_is_step: part.time_zero_is_step,
        original_metadata: readings
            .iter()
            .flat_map(|reading| reading.original_metadata.clone())
            .collect(),
        issues: readings
            .iter()
            .flat_map(|reading| without_open_dates(reading))
            .chain(join_issues.to_vec())
            .collect(),
        channels: part.channels,
        contents: contents.to_vec(),
        kind,
        path,
    })
}

/// What the readings rest on, with the names of the files and the profiles that they were read with.
fn origin(origin: RunOrigin, files: &[PreparedFile]) -> RunOrigin {
    let clocks = origin
        .clocks
        .into_iter()
        .zip(files)
        .map(|(clock, file)| RunClock {
            file: file.file.display.clone(),
            ..clock
        });
    let profiles = files.iter().enumerate().filter_map(|(index, file)| {
        let profile = file.profile.as_ref()?;
        Some(ProfileUse {
            file: index,
            id: profile.id.clone(),
            version: profile.version,
            digest: profile.digest.clone(),
            text: profile.text.clone(),
        })
    });
    RunOrigin {
        clocks: clocks.collect(),
        profiles: profiles.collect(),
        ..origin
    }
}

/// Files that are no longer there: those of runs are marked, the others forgotten. Links that lead out of the
/// campaign are listed as refused.
pub fn gone(
    context: &mut Context,
    readers: &Readers,
    stored: &[FileRow],
    changes: &Changes,
    seen: &Scan,
    summary: &mut IngestSummary,
) -> Result<(), PipelineError> {
    let now = now();
    let outside: Vec<FileRow> = seen
        .issues
        .iter()
        .filter(|issue| !issue.place.is_empty())
        .map(|issue| refused_entry(readers, issue))
        .collect();
    let all_renamed = summary.renamed.iter().chain(&summary.logs.renamed);
    let renamed_from = all_renamed.map(|(old, _)| old);
    // A whole folder may go at once: what is known of each file is looked up, not searched for.
    let stays: BTreeSet<&String> = outside.iter().map(|row| &row.path).chain(renamed_from).collect();
    let known: BTreeMap<&String, &FileRow> = stored.iter().map(|row| (&row.path, row)).collect();
    let is_run = |path: &String| {
        let state = known.get(path).map(|row| row.state);
        matches!(state, Some(FileState::Run | FileState::Log))
    };
    let gone = changes.gone.iter().filter(|path| !stays.contains(path));
    let (mut runs, others): (Vec<String>, Vec<String>) = gone.cloned().partition(is_run);
    let held = files_of_runs(&context.store, &others)?;
    context.store.record_files(&now, &held)?;
    runs.extend(held.into_iter().map(|row| row.path));
    let others: Vec<String> = others.into_iter().filter(|path| !runs.contains(path)).collect();
    context.store.mark_missing(&now, &runs)?;
    context.store.forget_files(&now, &others)?;
    summary.gone.extend(runs);
    let is_stored = |row: &FileRow| known.get(&row.path).is_some_and(|known| *known == row);
    let fresh: Vec<FileRow> = outside.iter().filter(|row| !is_stored(row)).cloned().collect();
    Ok(context.store.record_files(&now, &fresh)?)
}

/// Files of the current runs that stand under these names: what was refused in the place of a run leaves it where it was.
pub(crate) fn files_of_runs(store: &Store, paths: &[String]) -> Result<Vec<FileRow>, PipelineError> {
    let mut rows = Vec::new();
    for path in paths {
        let held = store.contents_of(path)?;
        if let Some((_, hash)) = held.into_iter().find(|(own, _)| own == path) {
            let reader = store.reader_of(path)?.unwrap_or_default();
            rows.push(FileRow {
                hash: Some(hash),
                ..FileRow::unseen(path.clone(), FileState::Run, reader)
            });
        }
    }
    Ok(rows)
}

fn refused_entry(readers: &Readers, issue: &Issue) -> FileRow {
    // The place is the path already.
    let path = issue.place.clone();
    let message = issue.message.replace(&format!("{}: ", issue.place), "");
    let issue = Issue {
        place: String::new(),
        message,
        ..issue.clone()
    };
    FileRow {
        issue: Some(issue),
        ..FileRow::unseen(path, FileState::Refused, readers.all())
    }
}
