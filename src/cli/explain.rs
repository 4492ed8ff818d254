//! `ieap explain`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::output::Output;
use crate::domain::number::estimates::{ends, in_words};
use crate::pipeline::Context;
use crate::pipeline::show::explain::{Evidence, Explanation, explain, rows_and_columns};

/// Say which runs and files a number is made from
///
/// Also which fits and versions.
///
/// Without a row and a column it lists those of the table.
#[derive(Debug, Args)]
pub struct ExplainArgs {
    /// Which table, as `ieap table` lists them
    table: String,
    /// Its row: number, label, or a part of a label that fits one row only
    row: Option<String>,
    /// Its column: number, key, symbol, or a part of one
    column: Option<String>,
    /// Campaign folder [default: this folder, or the nearest one above it with a campaign.toml]
    #[arg(value_name = "CAMPAIGN")]
    folder: Option<PathBuf>,
}

pub fn run(args: &ExplainArgs, output: &Output) -> Result<u8, CliError> {
    let folder = args.folder.as_deref();
    let (row, folder) = match (&args.row, &args.column) {
        // `explain TABLE FOLDER` lists, as `explain TABLE` does.
        (Some(only), None) if folder.is_none() && Path::new(only).is_dir() => (None, Some(Path::new(only))),
        (Some(only), None) => {
            let needed = "needed a row and a column, or neither to list them";
            return Err(CliError::usage(&format!(
                "found the row {only:?} alone, {needed}"
            )));
        }
        (row, _) => (row.as_ref(), folder),
    };
    let context = super::campaign::open_to_show(&super::campaign::folder(folder)?, output)?;
    let (Some(row), Some(column)) = (row, &args.column) else {
        return list(args, &context, output);
    };
    let explanation = explain(&context, &args.table, row, column)?;
    print(&explanation, output);
    output.document(&explanation)?;
    Ok(DONE)
}

fn list(args: &ExplainArgs, context: &Context, output: &Output) -> Result<u8, CliError> {
    let table = rows_and_columns(context, &args.table)?;
    output.result("Rows:");
    for (at, row) in table.rows.iter().enumerate() {
        output.result(&format!("  {:>3} {}", at + 1, row.label));
    }
    output.result("Columns:");
    for (at, column) in table.columns.iter().enumerate() {
        output.result(&format!("  {:>3} {:<28} {}", at + 1, column.key, column.quantity));
    }
    let rows: Vec<&str> = table.rows.iter().map(|row| row.label.as_str()).collect();
    let columns: Vec<&str> = table.columns.iter().map(|column| column.key.as_str()).collect();
    output.document(
        &json!({ "schema": "ieap/explain/1", "table": table.name, "rows": rows, "columns": columns }),
    )?;
    Ok(DONE)
}

fn print(found: &Explanation, output: &Output) {
    output.result(&format!(
        "{} / {} / {} ({})",
        found.table, found.row, found.column, found.quantity
    ));
    output.result(&format!("  {} {}", found.text, found.unit));
    output.result(&format!("  {}", found.how));
    if let (Some(low), Some(high)) = (found.low_95, found.high_95) {
        output.result(&format!("  95 % interval {} {}", ends(low, high), found.unit));
    }
    for note in &found.notes {
        output.result(&format!("  note: {note}"));
    }
    if found.from.is_empty() {
        output.result("made from no run");
    }
    for evidence in &found.from {
        print_evidence(evidence, output);
    }
    output.result(&format!("explained by {}", found.origin));
}

fn print_evidence(evidence: &Evidence, output: &Output) {
    let revision = evidence
        .revision
        .map_or(String::new(), |revision| format!(", revision {revision}"));
    output.result(&format!("{} {}{revision}", evidence.kind, evidence.name));
    if let Some(reason) = &evidence.left_out {
        output.result(&format!("  left out: {reason}"));
    }
    if let (Some(key), Some(estimate)) = (&evidence.key, &evidence.estimate) {
        output.result(&format!("  {key} {}", in_words(estimate)));
    }
    for file in &evidence.files {
        output.result(&format!("  file {} ({} bytes)", file.path, file.size_bytes));
        output.result(&format!("    BLAKE3 {}", file.hash));
    }
    if let (Some(reader), Some(hash)) = (&evidence.reader, &evidence.data_hash) {
        output.result(&format!("  read as {reader}, readings {hash}"));
    }
    if let Some(result) = &evidence.result {
        let id = result.id.map_or(String::new(), |id| format!(" {id}"));
        output.result(&format!(
            "  result{id}: {}, made by ieap {} ({}) at {}",
            result.model, result.code_version, result.built_from, result.made_at
        ));
        output.result(&format!("    inputs {}", result.input_hash));
    }
}
