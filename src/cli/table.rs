//! `ieap table`.

use crate::domain::number::fixed;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use super::printable::printable;
use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::show::tables::{
    MovedDocument, chosen_columns, compared_by, find_format, find_table, listed, moment, moved_since, table,
    write_with_decimal_comma, write_within,
};
use crate::pipeline::{Context, Earlier};

/// Print a table with uncertainties, in any format
///
/// Text, CSV, Markdown, LaTeX, Typst, HTML or JSON.
///
/// Without a name it lists the tables.
#[derive(Debug, Args)]
pub struct TableArgs {
    /// Which table; none: list them
    name: Option<String>,
    #[command(flatten)]
    campaign: CampaignArg,
    /// List the tables
    #[arg(long, hide = true)]
    list: bool,
    /// text, csv, markdown, latex, typst, html or json [default: by the ending of --output, else text]
    #[arg(long, short, value_name = "FORMAT")]
    format: Option<String>,
    /// Only these columns, in this order: number, key, symbol, or a part of one, with commas between
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',')]
    columns: Vec<String>,
    /// Put materials together by what campaign.toml says they are made of: electrode, membrane or electrolyte
    #[arg(long, value_name = "CLASS")]
    by: Option<String>,
    /// Characters to a line of text: columns without room stand below [default: the terminal's; 0: as wide as it gets]
    #[arg(long, value_name = "N")]
    width: Option<usize>,
    /// Decimal commas, and semicolons between fields: for CSV that a spreadsheet of such a language opens
    #[arg(long)]
    decimal_comma: bool,
    /// Write to a file in place of stdout; - is stdout
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
    /// Show which cells moved when runs were last fitted again, and by how many standard errors
    #[arg(long)]
    moved: bool,
    /// Show which cells moved since a date or time
    #[arg(long, value_name = "WHEN", conflicts_with = "moved")]
    since: Option<String>,
}

pub fn run(args: &TableArgs, output: &Output) -> Result<u8, CliError> {
    let is_known = |name: &str| find_table(name).is_ok();
    let (name, folder) = args.campaign.with_name(args.name.as_deref(), is_known);
    let Some(name) = name.as_deref().filter(|_| !args.list) else {
        return list(output);
    };
    find_table(name)?;
    let mut context = super::campaign::open_to_show(&super::campaign::folder(folder.as_deref())?, output)?;
    if let Some(class) = &args.by {
        compared_by(&mut context, name, class)?;
    }
    let earlier = match &args.since {
        Some(typed) => Some(Earlier::At(moment(&context, typed)?)),
        None => args.moved.then_some(Earlier::BeforeRefit),
    };
    if let Some(earlier) = earlier {
        let document = moved_since(&context, name, &earlier)?;
        print_moved(&document, output);
        output.document(&document)?;
        return Ok(DONE);
    }
    let text = text_of(args, &context, name, output)?;
    match args.output.as_deref().filter(|path| *path != Path::new("-")) {
        None => {
            // Of what stands in files only text reaches the terminal unescaped.
            output.write(printable(&text).as_bytes());
        }
        Some(path) => write(path, text.as_bytes(), args.overwrite, output)?,
    }
    Ok(DONE)
}

/// The table as it is asked for.
fn text_of(args: &TableArgs, context: &Context, name: &str, output: &Output) -> Result<String, CliError> {
    let format = find_format(&format_of(args, output)?)?;
    if args.decimal_comma && format.name != "csv" {
        return Err(CliError::usage(&format!(
            "--decimal-comma is for CSV; the format is {}. Add `--format csv`, or leave it out",
            format.name
        )));
    }
    let mut table = table(context, name)?;
    if !args.columns.is_empty() {
        table = chosen_columns(&table, &args.columns)?;
    }
    Ok(match format.name {
        "csv" if args.decimal_comma => write_with_decimal_comma(&table),
        "text" => write_within(&table, width(args, output)),
        _ => (format.write)(&table),
    })
}

/// Characters to a line: as asked for, else the terminal's, else without end.
fn width(args: &TableArgs, output: &Output) -> usize {
    let is_file = args.output.is_some();
    match (args.width, is_file) {
        (Some(0), _) | (None, true) => usize::MAX,
        (Some(width), _) => width,
        (None, false) => output.width().unwrap_or(usize::MAX),
    }
}

/// `--format`, else `--json`, else the ending of the file, else text.
fn format_of(args: &TableArgs, output: &Output) -> Result<String, CliError> {
    if let Some(format) = &args.format {
        return Ok(format.clone());
    }
    if output.json {
        return Ok("json".to_owned());
    }
    let ending = args.output.as_deref().and_then(Path::extension);
    if ending.is_none() && args.decimal_comma {
        return Ok("csv".to_owned());
    }
    Ok(ending.map_or("text".to_owned(), |ending| ending.to_string_lossy().into_owned()))
}

/// Writes a file that is not there yet, or over one where that is allowed.
pub(super) fn write(path: &Path, bytes: &[u8], overwrite: bool, output: &Output) -> Result<(), CliError> {
    put_bytes(path, overwrite, bytes)?;
    output.message(&format!("{}: {} bytes", path.display(), bytes.len()));
    Ok(())
}

pub(super) fn list(output: &Output) -> Result<u8, CliError> {
    for (name, about) in listed() {
        output.result(&format!("{name:<12} {about}"));
    }
    let tables = listed().map(|(name, about)| json!({ "name": name, "about": about }));
    output.document(&json!({ "schema": "ieap/tables/1", "tables": tables.collect::<Vec<_>>() }))?;
    Ok(DONE)
}

fn print_moved(document: &MovedDocument, output: &Output) {
    output.result(&format!(
        "{}: {} of {} cells moved against {}, {} of them by more than one standard error or to something else",
        document.table,
        document.cells.len(),
        document.compared,
        document.against,
        document.beyond_one_sigma
    ));
    for cell in &document.cells {
        let sigma = cell
            .sigma
            .map_or("    –".to_owned(), |sigma| format!("{:>5} σ", fixed(sigma, 1)));
        output.result(&format!(
            "{sigma}  {}  {}: {} → {} {}",
            cell.row, cell.column, cell.before, cell.after, cell.unit
        ));
    }
    for row in &document.rows_gone {
        output.result(&format!("row gone: {row}"));
    }
    for row in &document.rows_new {
        output.result(&format!("row new: {row}"));
    }
}
