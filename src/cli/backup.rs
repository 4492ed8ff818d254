//! `ieap backup` and `ieap restore`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE, SOME_REFUSED};
use super::output::{Output, counted};
use super::{CampaignArg, Global};
use crate::domain::Issue;
use crate::pipeline::backup::manifest::LeftOut;
use crate::pipeline::backup::{Backup, Restore};

/// Copy the campaign into a folder elsewhere, while everything runs; the next time only what is new is copied
#[derive(Debug, Args)]
pub struct BackupArgs {
    /// Folder of the backup: a new one, or that of an earlier backup of this campaign
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    #[command(flatten)]
    campaign: CampaignArg,
    /// Read every file that is in the backup already, and copy damaged ones again
    #[arg(long)]
    deep: bool,
}

/// Make a campaign of a backup, in a new folder, and try it
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
    let context = args.campaign.open_read_only(output)?;
    let backup = Backup {
        folder: args.folder.clone(),
        deep: args.deep,
    };
    let done = backup.run(&context, output)?;
    output.document(&json!({ "schema": "ieap/backup/1", "backup": done }))?;
    if done.mended > 0 {
        let mended = counted(done.mended, "file");
        output.message(&format!(
            "{mended} of the backup had been damaged and were copied again."
        ));
    }
    output.result(&format!(
        "{}: backup of {} ({}, database of {:.1} MB); {} copied now ({:.1} MB).",
        done.folder.display(),
        done.made_at,
        counted(done.files, "file"),
        megabytes(done.database_bytes),
        counted(done.copied, "file"),
        megabytes(done.copied_bytes),
    ));
    Ok(after(&done.left_out, "not in the backup", output))
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
    let known = after(&done.left_out, "never in the backup", output);
    let lost = after(&done.lost, "lost: damaged in the backup", output);
    Ok(known.max(lost))
}

/// Lists what is not there; gives the exit status that says so.
fn after(left_out: &[LeftOut], what: &str, output: &Output) -> u8 {
    if left_out.is_empty() {
        return DONE;
    }
    output.message(&format!("{}, {what}:", counted(left_out.len(), "file")));
    for left in left_out {
        output.issue(&left.path, &Issue::warning("left-out", &left.reason));
    }
    SOME_REFUSED
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}
