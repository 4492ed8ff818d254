//! `ieap rebuild`.

use crate::domain::words::counted;
use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::pipeline::{Rebuild, RebuildSummary};

/// Make the database anew from archive and journal
///
/// For a database that is lost or damaged; the old one is kept under another name.
///
/// Runs, earlier revisions, tags set by hand, dropped runs and deleted files come back, and runs are fitted. `ieap run`
/// then diagnoses and renders.
#[derive(Debug, Args)]
pub struct RebuildArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &RebuildArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let rebuild = Rebuild {
        allow_network: global.i_know,
    };
    let summary = rebuild.run(&args.campaign.folder()?, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/rebuild/1", "rebuild": summary }))?;
    Ok(exit::after(summary.has_fault(), summary.is_whole()))
}

fn print(summary: &RebuildSummary, output: &Output) {
    output.result(&format!(
        "A new database: {}, {}, {} by hand; {}",
        counted(summary.runs, "run"),
        counted(summary.climate_logs, "log"),
        counted(summary.words, "word"),
        counted(summary.fit.fitted, "fit")
    ));
    output.result(&format!("content hash: {}", summary.content_hash));
    if let Some(aside) = &summary.set_aside {
        output.result(&format!("The old database is kept: {}", aside.display()));
    }
    if !summary.of_old_database.is_empty() {
        output.result("The journal lacked, and has from the old database now:");
    }
    for words in &summary.of_old_database {
        output.result(&format!("  {words}"));
    }
    for issue in &summary.journal {
        output.issue("journal", issue);
    }
    if !summary.lost.is_empty() {
        output.message(&format!(
            "{} did not come back:",
            counted(summary.lost.len(), "reading")
        ));
    }
    for (name, issue) in &summary.lost {
        output.issue(name, issue);
    }
    if !summary.without_name.is_empty() {
        output.message(&format!(
            "{} of the archive in no run: the journal does not name them. To take one in, copy it into the runs folder.",
            counted(summary.without_name.len(), "raw file")
        ));
        let paths = summary.without_name.iter();
        paths.for_each(|path| output.message(&format!("  {path}")));
    }
    if !summary.journal.is_empty() || !summary.lost.is_empty() {
        output.message(
            "Something may be lost. `ieap status` says so until you looked and said it: `ieap run --answer ...`.",
        );
    }
    ingest::left_out(&summary.ingest, output);
    output.message("`ieap run` diagnoses and renders from it.");
}
