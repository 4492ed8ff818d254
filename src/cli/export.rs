//! `ieap export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::export::{Export, Table};
use crate::pipeline::fits_document::fits_document;
use crate::pipeline::{Context, PipelineError};

/// Write runs, tags, fits, conditions, traces or modulus logs as CSV, Parquet or JSON, units in the column names
#[derive(Debug, Args)]
pub struct ExportArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// What to write
    #[arg(long, value_enum, default_value = "fits")]
    what: What,
    /// File to write; its ending (.csv, .parquet, .json) tells the format; with `--what all` a folder [default: WHAT.csv]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format of the files of `--what all`
    #[arg(long, value_enum, default_value = "parquet")]
    format: FileFormat,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// One row a run: tags, state, files with hashes, quality of the fit
    Runs,
    /// One row a run and tag, with its source
    Tags,
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
    /// All of these, one file each, into a folder
    All,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FileFormat {
    /// Apache Parquet
    Parquet,
    /// Comma-separated text
    Csv,
}

impl What {
    fn tables(self) -> Vec<Table> {
        match self {
            What::Runs => vec![Table::Runs],
            What::Tags => vec![Table::Tags],
            What::Fits => vec![Table::Fits],
            What::FitsWide => vec![Table::FitsWide],
            What::Conditions => vec![Table::Conditions],
            What::Traces => vec![Table::Traces],
            What::Dma => vec![Table::Dma],
            What::All => Table::ALL.to_vec(),
        }
    }
}

pub fn run(args: &ExportArgs, output: &Output) -> Result<u8, CliError> {
    let context = Context::open_read_only(&args.campaign.folder()?)?;
    if output.json && args.output.is_none() && matches!(args.what, What::Fits) {
        output.document(&fits_document(&context)?)?;
        return Ok(DONE);
    }
    let mut files = Vec::new();
    for (table, path) in targets(args)? {
        let overwrite = args.overwrite;
        let rows = Export {
            table,
            path: path.clone(),
            overwrite,
        }
        .run(&context)?;
        output.result(&format!("{}: {rows} rows", path.display()));
        files.push(json!({ "file": path.display().to_string(), "rows": rows }));
    }
    let first = files.first().cloned().unwrap_or_default();
    output.document(
        &json!({ "schema": "ieap/export/1", "file": first["file"], "rows": first["rows"], "files": files }),
    )?;
    Ok(DONE)
}

/// Which table goes where.
fn targets(args: &ExportArgs) -> Result<Vec<(Table, PathBuf)>, CliError> {
    let tables = args.what.tables();
    if !matches!(args.what, What::All) {
        let path = |table: &Table| {
            args.output
                .clone()
                .unwrap_or_else(|| format!("{}.csv", table.name()).into())
        };
        return Ok(tables.iter().map(|table| (*table, path(table))).collect());
    }
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from("export"));
    std::fs::create_dir_all(&folder).map_err(|source| PipelineError::File {
        path: folder.clone(),
        doing: "making the folder",
        source,
    })?;
    let ending = match args.format {
        FileFormat::Parquet => "parquet",
        FileFormat::Csv => "csv",
    };
    let path = |table: &Table| folder.join(format!("{}.{ending}", table.name()));
    Ok(tables.iter().map(|table| (*table, path(table))).collect())
}
