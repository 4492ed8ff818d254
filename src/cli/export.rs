//! `ieap export`.

use crate::domain::words::counted;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::documents::fits::fits_document;
use crate::pipeline::show::export::{Export, TRACES, TableFormat, written};
use crate::pipeline::show::partitioned::ExportPartitioned;
use crate::pipeline::show::research_crate::export_crate;
use crate::pipeline::{Context, failed};

/// Write data and results as CSV, Parquet or JSON
///
/// Runs, fits, findings, laws, readings and other tables, with units in the column names.
#[derive(Debug, Args)]
pub struct ExportArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// What to write
    #[arg(long, value_enum, default_value = "fits")]
    what: What,
    /// File to write; its ending (.csv, .parquet, .json) tells the format; - is stdout; with `--what all` a folder [default:
    /// WHAT.csv]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format where no ending tells it: of the files of `--what all` [default: parquet], and of `-o -` [default: csv]
    #[arg(long, value_enum)]
    format: Option<FileFormat>,
    /// Decimal commas, and semicolons between fields: for CSV that a spreadsheet of such a language opens
    #[arg(long)]
    decimal_comma: bool,
    /// With `--what traces`: a folder of Parquet files in partitions by material and environment, one row a run with lists of
    /// readings, as clusters read them [default: traces]
    #[arg(long)]
    partitioned: bool,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
}

/// One of the tables, or more than one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    One(&'static str, &'static str),
    All,
    Crate,
}

static EVERYTHING: LazyLock<Vec<What>> = LazyLock::new(|| {
    let tables = written().map(|(name, about)| What::One(name, about));
    tables.chain([What::All, What::Crate]).collect()
});

impl ValueEnum for What {
    fn value_variants<'a>() -> &'a [What] {
        &EVERYTHING
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, about) = match self {
            What::One(name, about) => (*name, *about),
            What::All => ("all", "All of these, one file each, into a folder"),
            What::Crate => (
                "crate",
                "Everything to publish: raw files, tables, figures, campaign.toml and what they are, as one ZIP (RO-Crate)",
            ),
        };
        Some(PossibleValue::new(name).help(about))
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FileFormat {
    /// Apache Parquet
    Parquet,
    /// Comma-separated text
    Csv,
}

impl What {
    fn tables(self) -> Vec<&'static str> {
        match self {
            What::One(table, _) => vec![table],
            What::All | What::Crate => written().map(|(name, _)| name).collect(),
        }
    }

    fn is(self, table: &str) -> bool {
        matches!(self, What::One(own, _) if own == table)
    }
}

pub fn run(args: &ExportArgs, output: &Output) -> Result<u8, CliError> {
    let context = args.campaign.open_to_show(output)?;
    if output.json && args.output.is_none() && args.what.is("fits") {
        output.document(&fits_document(&context)?)?;
        return Ok(DONE);
    }
    if args.what == What::Crate {
        return research_crate(args, &context, output);
    }
    if args.partitioned {
        return partitioned(args, &context, output);
    }
    if args.output.as_deref() == Some(Path::new("-")) {
        return to_stdout(args, &context, output);
    }
    let mut files = Vec::new();
    for (table, path) in targets(args)? {
        let rows = Export {
            table,
            path: path.clone(),
            format: with_comma(args, path.extension().is_some_and(|ending| ending == "csv"))?,
            overwrite: args.overwrite,
        }
        .run(&context)?;
        output.result(&format!("{}: {}", path.display(), counted(rows, "row")));
        files.push(json!({ "file": path.display().to_string(), "rows": rows }));
    }
    let first = files.first().cloned().unwrap_or_default();
    output.document(
        &json!({ "schema": "ieap/export/1", "file": first["file"], "rows": first["rows"], "files": files }),
    )?;
    Ok(DONE)
}

/// A campaign to publish.
fn research_crate(args: &ExportArgs, context: &Context, output: &Output) -> Result<u8, CliError> {
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from("crate.zip"));
    let summary = export_crate(context, &path, args.overwrite)?;
    output.result(&format!("{}: {}", path.display(), counted(summary.files, "file")));
    for (name, reason) in &summary.left_out {
        output.message(&format!("  not in it: {name}: {reason}"));
    }
    let file = json!({ "file": path.display().to_string(), "rows": summary.files });
    output.document(
        &json!({ "schema": "ieap/export/1", "file": file["file"], "rows": summary.files, "files": [file] }),
    )?;
    Ok(DONE)
}

/// Runs for a cluster.
fn partitioned(args: &ExportArgs, context: &Context, output: &Output) -> Result<u8, CliError> {
    if !args.what.is(TRACES) {
        return Err(CliError::usage(
            "--partitioned is for readings: add `--what traces`, or leave it out",
        ));
    }
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from("traces"));
    let export = ExportPartitioned {
        folder: folder.clone(),
        overwrite: args.overwrite,
    };
    let rows = export.run(context)?;
    output.result(&format!("{}: {}", folder.display(), counted(rows, "row")));
    let file = json!({ "file": folder.display().to_string(), "rows": rows });
    output.document(
        &json!({ "schema": "ieap/export/1", "file": file["file"], "rows": rows, "files": [file] }),
    )?;
    Ok(DONE)
}

/// The table's bytes for the next program.
fn to_stdout(args: &ExportArgs, context: &Context, output: &Output) -> Result<u8, CliError> {
    if output.json {
        return Err(CliError::usage(
            "`-o -` writes the table to stdout, `--json` a document: ask for one of them",
        ));
    }
    let &[table] = args.what.tables().as_slice() else {
        return Err(CliError::usage("`-o -` writes one table: name it with --what"));
    };
    let is_csv = !matches!(args.format, Some(FileFormat::Parquet));
    if !is_csv && output.is_terminal() {
        return Err(CliError::usage("stdout is a terminal: name a file with --output"));
    }
    let plain = if is_csv {
        TableFormat::Csv
    } else {
        TableFormat::Parquet
    };
    let format = with_comma(args, is_csv)?.unwrap_or(plain);
    let (bytes, rows) = Export::bytes(context, table, format)?;
    output.write(&bytes);
    output.message(&format!("{}: {}", table, counted(rows, "row")));
    Ok(DONE)
}

/// CSV with decimal commas where that is asked for; none leaves the format to the file's ending.
fn with_comma(args: &ExportArgs, is_csv: bool) -> Result<Option<TableFormat>, CliError> {
    match (args.decimal_comma, is_csv) {
        (true, false) => Err(CliError::usage(
            "--decimal-comma is for CSV. Add `--format csv` or name a file that ends in .csv, or leave it out",
        )),
        (true, true) => Ok(Some(TableFormat::CsvWithDecimalComma)),
        (false, _) => Ok(None),
    }
}

/// Which table goes where.
fn targets(args: &ExportArgs) -> Result<Vec<(&'static str, PathBuf)>, CliError> {
    let tables = args.what.tables();
    if args.what != What::All {
        let path = |table: &&'static str| {
            args.output
                .clone()
                .unwrap_or_else(|| format!("{}.csv", table).into())
        };
        return Ok(tables.iter().map(|table| (*table, path(table))).collect());
    }
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from("export"));
    std::fs::create_dir_all(&folder).map_err(failed(&folder, "making the folder"))?;
    let ending = match args.format {
        Some(FileFormat::Parquet) | None => "parquet",
        Some(FileFormat::Csv) => "csv",
    };
    let path = |table: &&'static str| folder.join(format!("{}.{ending}", table));
    Ok(tables.iter().map(|table| (*table, path(table))).collect())
}
