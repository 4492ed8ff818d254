//! What became of every file of the campaign, and why: the intake told from its end.

use std::collections::{BTreeMap, BTreeSet};

use super::ingest::pairs::paired;
use super::ingest::statements::is_statement;
use crate::analysis;
use crate::domain::file_story::{FileStory, HALF_WITHOUT_PARTNER, TagOfFile, WordOfName};
use crate::domain::pairs::{LoneHalf, Pair};
use crate::domain::{FileState, Issue, RunRecord, RunState, Severity, TagSource};
use crate::ingest::name_pattern::{KnownIds, NamePattern};
use crate::ingest::pairs::Paired;
use crate::ingest::run_sheet::IS_SHEET;
use crate::ingest::scan::parse_display_path;
use crate::ingest::tags;
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};
use crate::show::Block;
use crate::store::FileRow;

/// Code of what is said of half a run.
pub const HALF: &str = "half-of-a-run";

/// What is said of half a run whose partner is not there.
pub fn lone(half: &LoneHalf) -> Issue {
    let message = format!(
        "it is half of a run, {}, and waits for {}",
        half.holds.label(),
        half.waits_for
    );
    Issue::warning(HALF, message).at(&half.path).mend(
        "copy that file into the folder, or say in campaign.toml which files belong together: [[pair]] current = \"...\" \
         and bending = \"...\"; until then the half is a run by itself",
    )
}

/// What is shown of them.
pub fn view(files: &[FileStory]) -> Vec<Block> {
    analysis::files::view(files)
}

/// The stories of all files, by path.
///
/// # Errors
/// The database cannot be read.
pub fn stories(context: &Context) -> Result<Vec<FileStory>, PipelineError> {
    let runs = standing::all(context)?;
    let others = context
        .store
        .dma_logs()?
        .into_iter()
        .chain(context.store.spectra()?);
    let runs: Vec<RunRecord> = runs.into_iter().chain(others).collect();
    let paired = paired(context)?;
    let mut of_file: BTreeMap<&str, Vec<&RunRecord>> = BTreeMap::new();
    for run in &runs {
        for file in &run.files {
            of_file.entry(&file.path).or_default().push(run);
            let aliases = file.aliases.iter();
            aliases.for_each(|alias| of_file.entry(alias).or_default().push(run));
        }
    }
    let logs = context.store.logs()?;
    let logs: BTreeMap<&str, _> = logs.iter().map(|log| (log.path.as_str(), log)).collect();
    let unread: BTreeMap<String, Issue> = context.store.unread_files()?.into_iter().collect();
    let files = context.store.files()?;
    let named: BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
    let mut stories: Vec<FileStory> = files
        .iter()
        .map(|file| {
            let runs = of_file.get(file.path.as_str()).map_or(&[][..], Vec::as_slice);
            let mut story = story(context, file, runs, &paired);
            if let Some(log) = logs.get(file.path.as_str()) {
                story.read_by = Some(log.format.clone());
                story.why.extend(worth_knowing(&log.issues));
            }
            story
        })
        .collect();
    let not_read = unread.iter().filter(|(path, _)| !named.contains(path.as_str()));
    stories.extend(not_read.map(|(path, issue)| FileStory {
        path: path.clone(),
        became: "not read yet".to_owned(),
        why: vec![issue.clone()],
        ..FileStory::default()
    }));
    stories.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(stories)
}

fn story(context: &Context, file: &FileRow, runs: &[&RunRecord], paired: &Paired) -> FileStory {
    let is_own = |run: &&&RunRecord| run.files.iter().any(|own| own.path == file.path);
    let run = runs.iter().find(is_own).or(runs.first()).copied();
    let pair = paired
        .pairs
        .iter()
        .find(|pair| pair.electrical == file.path || pair.bending == file.path);
    let half = paired.lone.iter().find(|half| half.path == file.path);
    let is_bending = pair.is_some_and(|pair| pair.bending == file.path);
    let mut story = FileStory {
        path: file.path.clone(),
        became: became(file, runs, (pair, half)).to_owned(),
        run: run.map(|run| run.path.clone()),
        partner: partner(file, (pair, half)),
        read_by: run.map(|run| run.format.clone()),
        words: if is_bending || file.state != FileState::Run {
            Vec::new()
        } else {
            words(context, &file.path)
        },
        // The run's tags stand with the file that it is named after.
        tags: run.filter(|_| !is_bending).map(tags_of).unwrap_or_default(),
        why: file.issue.iter().cloned().collect(),
    };
    // That the partner is missing comes before what follows from it.
    story.why.extend(half.map(lone));
    story
        .why
        .extend(run.into_iter().flat_map(|run| worth_knowing(&run.issues)));
    story
}

fn became(
    file: &FileRow,
    runs: &[&RunRecord],
    (pair, half): (Option<&Pair>, Option<&LoneHalf>),
) -> &'static str {
    let is_of = |code: &str| file.issue.as_ref().is_some_and(|issue| issue.code == code);
    match file.state {
        _ if file.missing_since.is_some() => "gone from the folder",
        FileState::Run if pair.is_some() => "half of a run",
        FileState::Run if half.is_some() => HALF_WITHOUT_PARTNER,
        FileState::Run => match runs {
            [run, ..] if run.standing.reason().is_empty() => match run.state {
                RunState::Untagged => "run that waits for tags",
                RunState::NotFitted => "run that is not fitted",
                RunState::NoSteps => "run without steps",
                RunState::Ready => "run",
            },
            [_, ..] => "run set aside",
            [] => "run",
        },
        FileState::Alias => "copy of a file",
        FileState::Refused => "refused",
        FileState::Pending => "waiting",
        FileState::Sidecar if is_of(IS_SHEET) => "run sheet",
        FileState::Sidecar if is_of("no-data") => "no data",
        FileState::Sidecar if is_statement(&file.path) => "tags",
        FileState::Sidecar => "beside a run",
        FileState::Log => "climate log",
    }
}

fn partner(file: &FileRow, (pair, half): (Option<&Pair>, Option<&LoneHalf>)) -> Option<String> {
    match (pair, half) {
        (Some(pair), _) => {
            let other = if pair.electrical == file.path {
                &pair.bending
            } else {
                &pair.electrical
            };
            Some(format!("{other}, by {}", pair.by.label()))
        }
        (None, Some(half)) => Some(format!("waits for {}", half.waits_for)),
        (None, None) => None,
    }
}

fn tags_of(run: &RunRecord) -> Vec<TagOfFile> {
    let mut seen = BTreeSet::new();
    let chosen = run.tags.iter().filter(|tag| seen.insert(tag.key.as_str()));
    let of = chosen.map(|tag| TagOfFile {
        key: tag.key.clone(),
        value: tag.value.clone(),
        from: match tag.source {
            TagSource::FileName | TagSource::Header | TagSource::Channel => tag.source.label().to_owned(),
            // What a mean rests on, or when it was said, is for the run's page.
            source => match tag.detail.split(", ").next() {
                Some(place) if !place.is_empty() => format!("{}: {place}", source.label()),
                _ => source.label().to_owned(),
            },
        },
    });
    of.collect()
}

/// What keeps a file from being used or contradicts it; notes are for its run's page. The gravest first.
fn worth_knowing(issues: &[Issue]) -> Vec<Issue> {
    let mut worth: Vec<Issue> = issues
        .iter()
        .filter(|issue| issue.severity > Severity::Note)
        .cloned()
        .collect();
    worth.sort_by_key(|issue| std::cmp::Reverse(issue.severity));
    worth
}

/// The words of a name and what the campaign's pattern takes each for; of one that it does not read, where it stops.
fn words(context: &Context, path: &str) -> Vec<WordOfName> {
    let campaign = &context.campaign;
    let Some(pattern) = campaign.name_pattern_of(campaign.kind_of(path)) else {
        return Vec::new();
    };
    let Ok(pattern) = NamePattern::compile(pattern) else {
        return Vec::new();
    };
    let samples: Vec<&str> = campaign.samples.iter().map(|sample| sample.id.as_str()).collect();
    let environments: Vec<&str> = campaign.environments.iter().map(|e| e.id.as_str()).collect();
    let known = KnownIds {
        samples: &samples,
        environments: &environments,
    };
    let stem = tags::stem(&parse_display_path(path));
    let word = |(word, taken_for): (String, String)| WordOfName { word, taken_for };
    match pattern.words(&stem, known) {
        Some(words) => words.into_iter().map(word).collect(),
        None => {
            let found = pattern.mismatch(&stem, KnownIds::default());
            let rest = (found.rest, format!("not read: {} is wanted here", found.wanted));
            let read = (found.read, "read by name_pattern".to_owned());
            [read, rest]
                .into_iter()
                .filter(|(text, _)| !text.is_empty())
                .map(word)
                .collect()
        }
    }
}
