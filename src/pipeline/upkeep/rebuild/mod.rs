//! A new database from what cannot be made again: the raw files of the archive and the journal, and the files that stand in
//! the campaign beside them (campaign.toml, profiles, tag files, run sheets), as they are now.
//!
//! What only the old database knows is brought into the journal before. It is made beside the old one and takes its place when it is whole. Runs come back in the order in which they came, with
//! their names, revisions, times and all that was said of them; then the folder is scanned, and runs are fitted.

pub(crate) mod archived;
pub(crate) mod aside;
mod fingerprints;
mod old;
mod plan;
pub(crate) mod replay;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::Issue;
use crate::ingest::archive::Archive;
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::ingest::retag_runs;
use crate::pipeline::{
    AnalyseModulus, Context, FitRuns, FitSummary, Ingest, IngestSummary, ModulusSummary, Observer,
    PipelineError,
};
use crate::store::journal::{self, Entry, Found, HeldJournal};
use old::Old;
use replay::Lost;

/// The verb `rebuild`.
#[derive(Debug, Clone, Default)]
pub struct Rebuild {
    /// Whether the database may lie on a network file system.
    pub allow_network: bool,
}

/// What `rebuild` did.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RebuildSummary {
    /// Current runs and modulus logs in the new database.
    pub runs: usize,
    /// Current climate logs in it.
    pub climate_logs: usize,
    /// Tags set by hand, words on runs and wishes how to fit that came back.
    pub words: usize,
    /// What the journal lacked and the old database had, in words.
    pub of_old_database: Vec<String>,
    /// Runs and logs that did not come back, by name, and why.
    pub lost: Vec<(String, Issue)>,
    /// What is wrong with the journal.
    pub journal: Vec<Issue>,
    /// Raw files of the archive that no run or log is of: the journal does not name them.
    pub without_name: Vec<String>,
    /// What the folder holds beside.
    pub ingest: IngestSummary,
    /// Fits.
    pub fit: FitSummary,
    /// Modulus logs.
    pub modulus: ModulusSummary,
    /// Hash of all that the new database says.
    pub content_hash: String,
    /// Where the old database is now; none where there was none.
    pub set_aside: Option<PathBuf>,
}

impl RebuildSummary {
    /// Whether everything came back and every file of the folder was taken.
    pub fn is_whole(&self) -> bool {
        self.lost.is_empty() && self.journal.is_empty() && !self.ingest.left_out_inputs()
    }

    /// Whether a fault of the program left something undone.
    pub fn has_fault(&self) -> bool {
        self.fit.has_fault() || self.modulus.has_fault()
    }
}

impl Rebuild {
    /// Makes the database of the campaign in `folder` anew, of all that the old one and the journal know.
    ///
    /// # Errors
    /// campaign.toml is wrong; another instance works; the old database and the journal say different things; the disk, the
    /// archive or the new database refuses. The old database then is as it was.
    pub fn run(&self, folder: &Path, observer: &dyn Observer) -> Result<RebuildSummary, PipelineError> {
        let old = old::brought_in(folder, self.allow_network)?;
        let mut context = Context::open_aside(folder, self.allow_network)?;
        match made(&mut context, old, observer) {
            Ok((summary, _held)) => {
                let set_aside = context.put_in_place()?;
                Ok(RebuildSummary { set_aside, ..summary })
            }
            Err(error) => {
                context.leave_aside();
                Err(error)
            }
        }
    }
}

/// Makes the new database, up to its last word; from there on nobody can say any, as long as the file is held that is given.
fn made(
    context: &mut Context,
    old: Old,
    observer: &dyn Observer,
) -> Result<(RebuildSummary, HeldJournal), PipelineError> {
    let folder = context.folder.clone();
    let folder = folder.as_path();
    let found = journal::read(folder)?.unwrap_or_default();
    let replayed = replay::replay(context, &found.lines, observer)?;
    if let Some(id) = Archive::new(folder).owner()? {
        context.store.take_identity(&now(), &id)?;
    }
    fingerprints::note(context)?;
    // What is new from here on was never said before; others say words meanwhile, which come before it.
    context.store.keep_journal_for_later();
    let ingest = Ingest { ready: &mut |_| true }.run(context, observer)?;
    let fit = FitRuns::default().run(context, observer)?;
    let modulus = AnalyseModulus::default().run(context, observer)?;
    let lost = still_lost(context, replayed.lost)?;
    // Until the new database is there.
    let held = journal::hold(folder)?;
    let mut kept = context.store.kept_for_later();
    say_what_came_meanwhile(context, &found, observer)?;
    let of_journal = old
        .wrong
        .iter()
        .map(|issue| format!("{}: {}", issue.place, issue.message));
    let of_runs = lost
        .iter()
        .map(|(name, issue)| format!("{name} did not come back: {}", issue.message));
    let missed = of_journal.chain(of_runs);
    kept.extend(missed.map(|lost| (now(), Entry::Missed { lost })));
    context.store.say_held(&now(), (folder, &held), kept)?;
    Archive::new(folder).set_owner(&context.store.identity()?)?;
    let summary = RebuildSummary {
        runs: context.store.run_names()?.len(),
        climate_logs: context.store.logs()?.len(),
        words: replayed.words,
        of_old_database: old.of_database,
        lost,
        journal: old.wrong,
        without_name: without_name(context)?,
        ingest,
        fit,
        modulus,
        content_hash: context.store.content()?.hash(),
        set_aside: None,
    };
    Ok((summary, held))
}

/// Of what could not be read from the archive, that which did not come in again from the folder either.
fn still_lost(context: &Context, lost: Vec<Lost>) -> Result<Vec<(String, Issue)>, PipelineError> {
    let mut still = Vec::new();
    for lost in lost {
        let mut came = !lost.hashes.is_empty();
        for hash in &lost.hashes {
            came &= context.store.names_content(Some(hash))?;
        }
        if !came {
            still.push((lost.name, lost.issue));
        }
    }
    Ok(still)
}

/// Tags and words may be said while a database is rebuilt: they are in the journal since it was read.
fn say_what_came_meanwhile(
    context: &mut Context,
    known: &Found,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let mut said = journal::read(&context.folder)?.unwrap_or_default().lines;
    said.retain(|line| line.n > known.last_number);
    if said.is_empty() {
        return Ok(());
    }
    replay::replay(context, &said, observer)?;
    retag_runs(context, &mut IngestSummary::default(), observer)
}

/// Raw files of the archive that the database does not name.
fn without_name(context: &Context) -> Result<Vec<String>, PipelineError> {
    let named: BTreeSet<String> = (context.store.contents()?.into_iter())
        .map(|content| content.hash)
        .collect();
    let mut all = Archive::new(&context.folder).entries()?;
    all.retain(|entry| !named.contains(&entry.hash));
    Ok(all.into_iter().map(|entry| entry.path).collect())
}

/// What a user must know of the journal, with the way to mend it.
pub(crate) fn what_is_wrong(found: Option<&Found>) -> Vec<Issue> {
    const JOURNAL: &str = "archive/journal.jsonl";
    let Some(found) = found else {
        let issue = Issue::error("no-journal", "there is none: what no file holds cannot be brought back")
            .mend("put it back from a backup; where the database is sound, the next `ieap run` writes it from there");
        return vec![issue.at(JOURNAL)];
    };
    let mend = "put it back from a backup; where the database is sound, move the journal away, and the next `ieap run` \
                writes it from there";
    let damaged = found.damaged.iter().map(|(line, reason)| {
        Issue::error("journal-damaged", reason.clone()).at(format!("{JOURNAL}, line {line}"))
    });
    // What a rebuilding found missing is asked of a person, and no gap any more.
    let told = found
        .lines
        .iter()
        .filter(|line| matches!(line.entry, Entry::Missed { .. }));
    let told = told.map(|line| line.n).max().unwrap_or(0);
    let gaps = found.gaps.iter().filter(|n| **n >= told).map(|n| {
        Issue::error(
            "journal-lines-missing",
            format!("lines before number {} are missing", n + 1),
        )
        .at(JOURNAL)
    });
    damaged.chain(gaps).map(|issue| issue.mend(mend)).collect()
}
