//! `ieap export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::Context;
use crate::pipeline::export::{Export, Table};
use crate::pipeline::fits_document::fits_document;

/// Write fits, conditions, traces or modulus logs as CSV or Parquet, units in the column names
#[derive(Debug, Args)]
pub struct ExportArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// What to write
    #[arg(long, value_enum, default_value = "fits")]
    what: What,
    /// File to write; its ending (.csv, .parquet) tells the format [default: WHAT.csv]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// One row a run and parameter: value, standard error, interval
    Fits,
    /// One row a run, parameters side by side
    FitsWide,
    /// One row a condition
    Conditions,
    /// Every reading of every run, one row a reading
    Traces,
    /// Modulus logs: one row a humidity step and number
    Dma,
}

pub fn run(args: &ExportArgs, output: &Output) -> Result<u8, CliError> {
    let context = Context::open_read_only(&args.campaign.folder()?)?;
    if output.json && args.output.is_none() {
        output.document(&fits_document(&context)?)?;
        return Ok(DONE);
    }
    let (table, name) = match args.what {
        What::Fits => (Table::Fits, "fits.csv"),
        What::FitsWide => (Table::FitsWide, "fits-wide.csv"),
        What::Conditions => (Table::Conditions, "conditions.csv"),
        What::Traces => (Table::Traces, "traces.csv"),
        What::Dma => (Table::Dma, "dma.csv"),
    };
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from(name));
    let rows = Export {
        table,
        path: path.clone(),
        overwrite: args.overwrite,
    }
    .run(&context)?;
    output.result(&format!("{}: {rows} rows", path.display()));
    output
        .document(&json!({ "schema": "ieap/export/1", "file": path.display().to_string(), "rows": rows }))?;
    Ok(DONE)
}
