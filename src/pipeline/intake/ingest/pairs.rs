//! Runs in two files: which files are one run now, and what is read again for it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use jiff::tz::TimeZone;

use super::batch::in_batches;
use super::groups::run_name;
use super::prepare::Group;
use super::settle::settle_anew;
use super::{IngestSummary, Readers};
use crate::domain::RunKind;
use crate::domain::pairs::Pair;
use crate::ingest::StartedAt;
use crate::ingest::pairs::{Half, Paired, half_of, pair, window_s};
use crate::ingest::scan::{Scan, SeenFile};
use crate::pipeline::campaign::planned::known_sheets;
use crate::pipeline::intake::climate::Shelf;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::ReadFile;

/// Which files are one run, by what was read of them.
///
/// # Errors
/// The database cannot be read.
pub fn paired(context: &Context) -> Result<Paired, PipelineError> {
    let files = context.store.read_files()?;
    let halves = halves(context, &files)?;
    Ok(pair(
        &halves,
        &context.campaign.pairs,
        &context.campaign.runs_folder,
        &known_sheets(context)?.pairs(),
    ))
}

/// Runs of two files that were paired by what they hold, by file: the other files of a run are parts of one name.
///
/// # Errors
/// The database cannot be read.
pub fn stored_pairs(context: &Context) -> Result<Vec<(String, [String; 2])>, PipelineError> {
    Ok(pairs_among(&context.store.read_files()?))
}

fn pairs_among(files: &[ReadFile]) -> Vec<(String, [String; 2])> {
    let of_pair = |both: &[ReadFile]| match both {
        [one, two] if one.run == two.run && is_of_pair(one) && is_of_pair(two) => {
            Some((one.run.clone(), [one.path.clone(), two.path.clone()]))
        }
        _ => None,
    };
    files.windows(2).filter_map(of_pair).collect()
}

/// Whether a file of a run of two files is there because it was paired, and not by the parts of its name.
fn is_of_pair(file: &ReadFile) -> bool {
    file.files == 2 && (file.path == file.run || run_name(&file.path) != file.run)
}

/// Halves among the files: of a pair, or of a run of one file that no person took out.
fn halves(context: &Context, files: &[ReadFile]) -> Result<Vec<Half>, PipelineError> {
    let words = context.store.run_words()?;
    let is_dropped = |run: &str| words.get(run).is_some_and(|word| word.drops);
    let mut runs_of: BTreeMap<&str, usize> = BTreeMap::new();
    for file in files {
        *runs_of.entry(&file.path).or_insert(0) += 1;
    }
    let pairs: BTreeSet<String> = pairs_among(files).into_iter().map(|(run, _)| run).collect();
    let may_be = |file: &&ReadFile| {
        let is_alone = file.files == 1 && file.path == file.run;
        runs_of.get(file.path.as_str()) == Some(&1)
            && (is_alone || pairs.contains(&file.run))
            && (pairs.contains(&file.run) || !is_dropped(&file.run))
    };
    let half = |file: &ReadFile| {
        let window = file.stamp.as_ref().zip(file.times_s);
        Some(Half {
            kind: half_of(file.quantities.iter().copied())?,
            window_s: window.and_then(|(stamp, times)| window_of(context, stamp, times)),
            path: file.path.clone(),
        })
    };
    Ok(files.iter().filter(may_be).filter_map(half).collect())
}

fn window_of(context: &Context, stamp: &StartedAt, times: (f64, f64)) -> Option<(f64, f64)> {
    let zone = context.campaign.timezone.as_deref();
    let zone = zone
        .and_then(|name| TimeZone::get(name).ok())
        .unwrap_or(TimeZone::UTC);
    let local: jiff::civil::DateTime = stamp.moment()?.parse().ok()?;
    let offset = zone.to_ambiguous_timestamp(local).compatible().ok()?;
    window_s(stamp, times, f64::from(zone.to_offset(offset).seconds()))
}

/// Makes runs of the pairs that there are now, and runs of their own of files that were paired and are not any more.
///
/// # Errors
/// The archive or the database refuses.
pub fn settle_pairs(
    context: &mut Context,
    (readers, shelf): (&Readers, &Shelf),
    seen: &Scan,
    summary: &mut IngestSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let files = context.store.read_files()?;
    let halves = halves(context, &files)?;
    let campaign = &context.campaign;
    let wanted = pair(
        &halves,
        &campaign.pairs,
        &campaign.runs_folder,
        &context.sheets.pairs(),
    );
    let stored = pairs_among(&files);
    let is_wanted = |files: &[String; 2]| {
        let is = |pair: &Pair| *files == [pair.electrical.clone(), pair.bending.clone()];
        wanted.pairs.iter().any(is)
    };
    let is_stored = |pair: &&Pair| {
        stored
            .iter()
            .any(|(_, files)| *files == [pair.electrical.clone(), pair.bending.clone()])
    };
    let by_path: BTreeMap<&str, &Arc<SeenFile>> =
        seen.files.iter().map(|f| (f.display.as_str(), f)).collect();
    let group = |run_name: &String, paths: &[&String]| {
        let found = paths
            .iter()
            .map(|path| by_path.get(path.as_str()).map(|file| Arc::clone(file)));
        Some(Group {
            run_name: run_name.clone(),
            kind: RunKind::Actuation,
            // What is not in the folder now stays as it is.
            files: found.collect::<Option<Vec<_>>>()?,
        })
    };
    let undone = stored.iter().filter(|(_, files)| !is_wanted(files));
    let mut groups: Vec<Group> = undone
        .flat_map(|(_, files)| files.iter().filter_map(|file| group(file, &[file])))
        .collect();
    for pair in wanted.pairs.iter().filter(|pair| !is_stored(pair)) {
        if let Some(group) = group(&pair.electrical, &[&pair.electrical, &pair.bending]) {
            groups.push(group);
            summary.paired.push(pair.clone());
        }
    }
    if groups.is_empty() {
        return Ok(());
    }
    let mended = in_batches(context, &groups, observer, &mut |context, prepared, observer| {
        settle_anew(context, (readers, shelf), prepared, summary, observer)
    })?;
    summary.mended.extend(mended);
    // A half that came now is the run that it became, or part of it.
    let names: BTreeSet<String> = context
        .store
        .read_files()?
        .into_iter()
        .map(|file| file.run)
        .collect();
    let is_half =
        |path: &String| summary.paired.iter().any(|pair| pair.bending == *path) && !names.contains(path);
    summary.new.retain(|path| !is_half(path));
    let new: BTreeSet<&String> = summary.new.iter().collect();
    summary.revised.retain(|path| !new.contains(path));
    Ok(())
}
