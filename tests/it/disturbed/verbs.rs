//! What the program is asked for: the only file here, beside `answers`, that knows how it keeps a campaign.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ieap::pipeline::upkeep::backup::{Backup, Restore};
use ieap::pipeline::upkeep::verify::missed;
use ieap::pipeline::{
    Context, Ingest, Intake, PipelineError, Rebuild, RenderReport, Run, SetTags, Silent, SpeakOfRuns,
};
use ieap::store::{Content, Store, StoreError};

use super::room::{AGAIN, BACKUP, CAMPAIGN, RESTORED};
use crate::world::computer::PowerLost;

/// The database in a campaign.
pub const DATABASE: &str = "campaign.db";
/// Its write-ahead log.
pub const LOG: &str = "campaign.db-wal";
/// Where people's words stand.
pub const WORDS: &str = "archive/journal.jsonl";
/// The file that keeps a second program out.
pub const LOCK: &str = "campaign.db.lock";

/// A verb that is disturbed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verb {
    /// Those that only read, which are asked after every other one.
    Read,
    Run,
    Watch,
    Tag,
    Drop,
    Rebuild,
    /// A first backup.
    Backup,
    /// One beside an earlier one.
    BackupAgain,
    Restore,
}

/// What a person said, as it is shown: a text in a cell whose name contains the key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    pub key: &'static str,
    pub text: &'static str,
}

/// How something that was asked for ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// Exit status.
    pub status: i32,
    /// A file that it said it keeps.
    pub kept: Option<PathBuf>,
}

impl Verb {
    pub const CHANGING: &[Verb] = &[
        Verb::Run,
        Verb::Watch,
        Verb::Tag,
        Verb::Drop,
        Verb::Rebuild,
        Verb::Backup,
        Verb::BackupAgain,
        Verb::Restore,
    ];
    /// Those that work in the campaign.
    pub const INSIDE: &[Verb] = &[Verb::Run, Verb::Watch, Verb::Tag, Verb::Drop, Verb::Rebuild];
    /// Those beside which somebody else comes.
    pub const BESIDE: &[Verb] = &[
        Verb::Run,
        Verb::Watch,
        Verb::Tag,
        Verb::Drop,
        Verb::Rebuild,
        Verb::BackupAgain,
    ];
    /// Those that meet a damaged campaign.
    pub const MEETING: &[Verb] = &[Verb::Read, Verb::Run, Verb::Tag, Verb::Rebuild, Verb::BackupAgain];

    pub fn name(self) -> &'static str {
        match self {
            Verb::Read => "status, table, explain",
            Verb::Run => "run",
            Verb::Watch => "watch",
            Verb::Tag => "tag",
            Verb::Drop => "drop",
            Verb::Rebuild => "rebuild",
            Verb::Backup => "backup",
            Verb::BackupAgain => "backup, again",
            Verb::Restore => "restore",
        }
    }

    /// What it says, where it is for that.
    pub fn word(self) -> Option<Word> {
        match self {
            Verb::Tag => Some(Word {
                key: "temperature_c",
                text: "24.5",
            }),
            Verb::Drop => Some(Word {
                key: "outcome",
                text: "wet",
            }),
            _ => None,
        }
    }

    /// Asks for it in a room.
    pub fn ask(self, room: &Path) -> Ended {
        let campaign = room.join(CAMPAIGN);
        let campaign = campaign.as_path();
        ended(|| match self {
            Verb::Read => Ok((0, None)),
            Verb::Run => run(campaign).map(|status| (status, None)),
            Verb::Watch => watch(campaign).map(|status| (status, None)),
            Verb::Tag => tag(campaign, "runs/b.csv", "temperature_c", "24.5").map(|status| (status, None)),
            Verb::Drop => drop_run(campaign, "runs/a.csv", "wet").map(|()| (0, None)),
            Verb::Rebuild => rebuild(campaign),
            Verb::Backup => backup(campaign, &room.join(AGAIN)).map(|status| (status, None)),
            Verb::BackupAgain => backup(campaign, &room.join(BACKUP)).map(|status| (status, None)),
            Verb::Restore => restore(&room.join(BACKUP), &room.join(RESTORED)).map(|status| (status, None)),
        })
    }
}

/// Asks for something that may fail, also by a fault of the program, and gives the status that the command line gives.
pub fn ended(work: impl FnOnce() -> Result<(i32, Option<PathBuf>), PipelineError>) -> Ended {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok((status, kept))) => Ended { status, kept },
        Ok(Err(error)) => {
            if std::env::var_os("IEAP_DISTURBED").is_some() {
                eprintln!("    {error}");
            }
            let status = match () {
                () if error.is_storage() => 4,
                () if error.is_fault() => 1,
                () => 2,
            };
            Ended { status, kept: None }
        }
        Err(panic) if panic.is::<PowerLost>() => std::panic::resume_unwind(panic),
        Err(_) => Ended {
            status: 1,
            kept: None,
        },
    }
}

fn after(has_fault: bool, is_all: bool) -> i32 {
    match (has_fault, is_all) {
        (true, _) => 1,
        (false, false) => 3,
        (false, true) => 0,
    }
}

/// `ieap run --no-diagnose`.
fn run(campaign: &Path) -> Result<i32, PipelineError> {
    let mut context = Context::open(campaign, false)?;
    let done = job().run(&mut context, &Silent)?;
    let is_all = !done.ingest.left_out_inputs() && missed(&context)?.is_empty();
    match done.report.refused {
        Some(_) if !done.has_fault() => Ok(4),
        _ => Ok(after(done.has_fault(), is_all)),
    }
}

/// The same without a report, which no number comes from.
pub fn settle(campaign: &Path) -> Result<i32, PipelineError> {
    let mut context = Context::open(campaign, false)?;
    let taken = Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
    let made = job().make(&mut context, &Silent)?;
    let is_all = !taken.left_out_inputs() && missed(&context)?.is_empty();
    let has_fault = made.fit.has_fault() || made.modulus.has_fault() || !made.faults.is_empty();
    Ok(after(has_fault, is_all))
}

fn job() -> Run {
    Run {
        skip_diagnosis: true,
        ..Run::default()
    }
}

/// The intake and the work of `ieap watch`, in a minute of simulated time, with what the system refused tried again.
fn watch(campaign: &Path) -> Result<i32, PipelineError> {
    let mut context = Context::open(campaign, false)?;
    let (mut intake, begun) = (Intake::new(Duration::from_secs(5)), Instant::now());
    for turn in 0..3 {
        let at = begun + Duration::from_secs(30 * turn);
        intake.look(&mut context, &|| at, &Silent)?;
    }
    let made = |context: &mut Context| -> Result<(), PipelineError> {
        context.check_in_place()?;
        job().make(context, &Silent)?;
        RenderReport::default().run(context, &Silent).map(drop)
    };
    match made(&mut context) {
        Err(error) if error.may_pass() => made(&mut context)?,
        done => done?,
    }
    Ok(0)
}

pub fn tag(campaign: &Path, run: &str, key: &str, value: &str) -> Result<i32, PipelineError> {
    let mut context = Context::open_beside(campaign, false)?;
    let tags = SetTags {
        runs: vec![run.to_owned()],
        pairs: vec![(key.to_owned(), value.to_owned())],
        even_so: false,
        set_by: "ann".to_owned(),
    };
    let tagged = tags.run(&mut context, &Silent)?;
    Ok(after(false, tagged.iter().all(|run| !run.waits)))
}

pub fn drop_run(campaign: &Path, run: &str, why: &str) -> Result<(), PipelineError> {
    let mut context = Context::open_beside(campaign, false)?;
    let word = SpeakOfRuns {
        runs: vec![run.to_owned()],
        deleted: false,
        drops: true,
        why: Some(why.to_owned()),
        said_by: "ann".to_owned(),
    };
    word.run(&mut context).map(drop)
}

pub fn rebuild(campaign: &Path) -> Result<(i32, Option<PathBuf>), PipelineError> {
    let done = Rebuild::default().run(campaign, &Silent)?;
    Ok((after(done.has_fault(), done.is_whole()), done.set_aside))
}

pub fn backup(campaign: &Path, folder: &Path) -> Result<i32, PipelineError> {
    let context = Context::open_read_only(campaign)?;
    let verb = Backup {
        folder: folder.to_owned(),
    };
    let done = verb.run(&context, &Silent)?;
    Ok(after(false, done.left_out.is_empty()))
}

pub fn restore(backup: &Path, folder: &Path) -> Result<i32, PipelineError> {
    let verb = Restore {
        backup: backup.to_owned(),
        folder: folder.to_owned(),
        damaged: false,
    };
    let done = verb.run(&Silent)?;
    Ok(after(false, done.left_out.is_empty() && done.lost.is_empty()))
}

/// All that a campaign's database says, as it is compared with what `rebuild` makes.
pub fn stored(campaign: &Path) -> Result<Content, StoreError> {
    Store::open_read_only(campaign)?.unwrap().content()
}
