//! `ieap backup` and `ieap restore`.

use crate::domain::number::fixed;
use crate::domain::words::counted;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE, SOME_REFUSED};
use super::global::Global;
use super::output::Output;
use crate::domain::Issue;
use crate::ingest::campaign_file::NOT_READ;
use crate::pipeline::upkeep::backup::manifest::LeftOut;
use crate::pipeline::upkeep::backup::{Backup, Restore};
use crate::pipeline::{Context, Observer};

/// Copy the campaign elsewhere; `restore` is the way back
///
/// Also while everything runs. The next time only what is new is copied, and takes the place of what was there. A program that keeps versions of folders, such
/// as restic or borg, keeps versions of this one.
#[derive(Debug, Args)]
pub struct BackupArgs {
    /// Folder of the backup: a new one, or that of an earlier backup of this campaign
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    #[command(flatten)]
    campaign: CampaignArg,
}

/// Make a campaign of a backup, in a new folder
///
/// And try it.
#[derive(Debug, Args)]
pub struct RestoreArgs {
    /// Folder of the backup
    #[arg(value_name = "DIR")]
    backup: PathBuf,
    /// Folder of the campaign to be: one that does not exist yet
    #[arg(value_name = "NEW_FOLDER")]
    folder: PathBuf,
    /// Restore what is whole of a damaged backup, and list the rest
    #[arg(long)]
    damaged: bool,
}

pub fn run(args: &BackupArgs, _global: &Global, output: &Output) -> Result<u8, CliError> {
    let context = Context::open_as_it_is(&args.campaign.folder()?)?;
    let settings = context.warnings.iter().filter(|issue| issue.code == NOT_READ);
    settings.for_each(|issue| output.warn(&issue.message));
    let backup = Backup {
        folder: args.folder.clone(),
    };
    let done = backup.run(&context, output)?;
    output.document(&json!({ "schema": "ieap/backup/1", "backup": done }))?;
    output.result(&format!(
        "{}: backup of {} ({}, database of {} MB); {} copied now ({} MB).",
        done.folder.display(),
        done.made_at,
        counted(done.files, "file"),
        fixed(megabytes(done.database_bytes), 1),
        counted(done.copied, "file"),
        fixed(megabytes(done.copied_bytes), 1)
    ));
    Ok(after(
        &done.left_out,
        "file",
        "not in the backup as it is now",
        output,
    ))
}

pub fn run_restore(args: &RestoreArgs, output: &Output) -> Result<u8, CliError> {
    let restore = Restore {
        backup: args.backup.clone(),
        folder: args.folder.clone(),
        damaged: args.damaged,
    };
    let done = restore.run(output)?;
    output.document(&json!({ "schema": "ieap/restore/1", "restored": done }))?;
    let runs = match done.runs {
        Some(runs) => format!("opened and looked through, {}", counted(runs, "run")),
        None => "without a database: `ieap run --new-database` makes one from the files".to_owned(),
    };
    output.result(&format!(
        "{}: the campaign as of {}, {} restored; {runs}.",
        done.folder.display(),
        done.made_at,
        counted(done.files, "file"),
    ));
    let known = after(
        &done.left_out,
        "file",
        "not as it was when the backup was made",
        output,
    );
    let lost = after(&done.lost, "file", "lost: damaged in the backup", output);
    Ok(known.max(lost))
}

/// Lists what is not there; gives the exit status that says so.
fn after(left_out: &[LeftOut], thing: &str, what: &str, output: &Output) -> u8 {
    if left_out.is_empty() {
        return DONE;
    }
    output.message(&format!("{}, {what}:", counted(left_out.len(), thing)));
    for left in left_out {
        output.issue(&left.path, &Issue::warning("left-out", &left.reason));
    }
    SOME_REFUSED
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}
