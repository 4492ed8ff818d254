//! `ieap import-fits`.

use crate::domain::words::counted;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::campaign::{folder, say_what_is_not_understood};
use super::exit::{self, CliError};
use super::global::Global;
use super::output::Output;
use crate::pipeline::upkeep::import_fits::{ImportFits, ImportSummary};
use crate::pipeline::{CODE_VERSION, Context};

/// Bring in fits that were computed elsewhere
///
/// A row is taken where its checksum holds, it is of a run as it is now and was fitted as the campaign would fit it; every other
/// row is listed with the reason. Every twentieth run, the first 20 rows and those that look odd are fitted again before: where
/// one differs all rows of its file are.
#[derive(Debug, Args)]
pub struct ImportFitsArgs {
    /// Parquet files with a row a run, or folders of them
    #[arg(value_name = "FILES", required = true)]
    files: Vec<PathBuf>,
}

pub fn run(args: &ImportFitsArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = Context::open(&folder(None)?, global.i_know)?;
    say_what_is_not_understood(&context, output);
    let import = ImportFits {
        files: args.files.clone(),
    };
    let summary = import.run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/import-fits/2", "imported": summary }))?;
    Ok(exit::after(false, summary.refused.is_empty()))
}

fn print(summary: &ImportSummary, output: &Output) {
    output.result(&format!(
        "{} of {}: {} imported, {} there already, {} could not be fitted, {} refused; {} fitted again to hold them against",
        counted(summary.rows, "row"),
        counted(summary.files, "file"),
        summary.imported,
        summary.up_to_date,
        summary.failed.len(),
        summary.refused.len(),
        summary.fitted_again
    ));
    for (version, count) in &summary.of_other_versions {
        output.message(&format!(
            "{} made by ieap {version}, this is {}: `ieap status` lists them, `code_version` in fits_view tells \
             them apart, and `ieap run --only fit --again` makes them anew.",
            counted(*count, "fit"),
            CODE_VERSION
        ));
    }
    summary
        .failed
        .iter()
        .for_each(|(path, issue)| output.issue(path, issue));
    for row in &summary.refused {
        let run = row.run.as_deref().map_or(String::new(), |run| format!(", {run}"));
        output.message(&format!(
            "  {}, row {}{run}: {}",
            row.file.display(),
            row.row,
            row.reason
        ));
    }
    if summary.imported > 0 {
        output.message("`ieap run` diagnoses and renders from them.");
    }
}
