//! `ieap ingest`.

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE, SOME_REFUSED};
use super::output::Output;
use super::{CampaignArg, Global};
use crate::pipeline::{Context, Ingest, IngestSummary};

/// Take in new files: recognise, read, tag, archive and store them
#[derive(Debug, Args)]
pub struct IngestArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &IngestArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = Context::open(&args.campaign.folder()?, global.i_know)?;
    context
        .warnings
        .iter()
        .for_each(|issue| output.issue("campaign.toml", issue));
    let summary = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/ingest/1", "ingest": summary }))?;
    Ok(if summary.refused.is_empty() {
        DONE
    } else {
        SOME_REFUSED
    })
}

/// What came in, and what did not.
pub fn print(summary: &IngestSummary, output: &Output) {
    output.result(&format!(
        "files: {} in the folder; runs: {} new, {} with new content, {} renamed, {} tagged again",
        summary.files,
        summary.new.len(),
        summary.revised.len(),
        summary.renamed.len(),
        summary.retagged.len()
    ));
    if !summary.aliases.is_empty() {
        output.message(&format!(
            "{} files hold the same bytes as a run's file",
            summary.aliases.len()
        ));
    }
    list(
        output,
        "files are no longer there; their runs stay",
        &summary.gone,
    );
    list(
        output,
        "files wait (empty, header only, or still growing)",
        &summary.waiting,
    );
    list(
        output,
        "runs lack tags and are not fitted (`ieap status` says which)",
        &summary.untagged,
    );
    if !summary.refused.is_empty() {
        output.message(&format!("{} files refused:", summary.refused.len()));
        summary
            .refused
            .iter()
            .for_each(|(path, issue)| output.issue(path, issue));
    }
}

/// A long list is cut; `ieap status` has it whole.
fn list(output: &Output, title: &str, paths: &[String]) {
    const SHOWN: usize = 10;
    if paths.is_empty() {
        return;
    }
    output.message(&format!("{} {title}:", paths.len()));
    paths
        .iter()
        .take(SHOWN)
        .for_each(|path| output.message(&format!("  {path}")));
    if paths.len() > SHOWN {
        output.message(&format!("  ... and {} more", paths.len() - SHOWN));
    }
}
