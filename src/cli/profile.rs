//! `ieap profile`.

use std::path::PathBuf;

use clap::Args;

use super::campaign::folder;
use super::exit::{CliError, DONE, SOME_REFUSED};
use super::inspect;
use super::output::Output;
use crate::domain::Quantity;
use crate::ingest::campaign_file;
use crate::ingest::profiles::StatedColumn;
use crate::ingest::table::Answers;
use crate::pipeline::standalone::profile::{ProposedProfile, propose};

/// Propose how to read a file that no reader knows
///
/// What the rows show is written down; what they do not show, such as a unit, is left open with a comment.
#[derive(Debug, Args)]
pub struct ProfileArgs {
    /// The file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What a column measures that nobody knows by its name: "d [mm]=tip_displacement", or with its unit
    /// "Weg=tip_displacement,mm"
    #[arg(long, value_name = "NAME=QUANTITY[,UNIT]", value_parser = stated)]
    column: Vec<StatedColumn>,
    /// Answer what the file leaves open, for all files with the same names of columns: clock=mm:ss, decimal=comma, thousands=point,
    /// elapsed=ms, humidity=fraction, temperature=°F
    #[arg(long, value_name = "KEY=ANSWER", value_parser = answer, conflicts_with = "column")]
    answer: Vec<(String, String)>,
    /// Save it as profiles/NAME.toml of the campaign (NAME.toml.draft where something is open)
    #[arg(long, value_name = "NAME")]
    write: Option<String>,
}

pub fn run(args: &ProfileArgs, output: &Output) -> Result<u8, CliError> {
    let mut proposed = propose(
        &args.file,
        args.write.as_deref().unwrap_or("proposed"),
        &args.column,
        &answers(&args.answer)?,
    )
    .map_err(|error| CliError::usage(&error.to_string()))?;
    if let Some(name) = &args.write {
        proposed.write(&campaign(args)?, name)?;
    }
    print(&proposed, output);
    output.document(&proposed)?;
    let is_read = proposed.read.as_ref().is_some_and(|read| read.format.is_some());
    Ok(if is_read && proposed.open.is_empty() {
        DONE
    } else {
        SOME_REFUSED
    })
}

/// `clock=mm:ss`.
fn answer(text: &str) -> Result<(String, String), String> {
    let (key, answer) = text
        .split_once('=')
        .ok_or("needed KEY=ANSWER, such as clock=mm:ss")?;
    let pair = (key.trim().to_owned(), answer.trim().to_owned());
    Answers::default().add(&pair.0, &pair.1).map(|()| pair)
}

fn answers(given: &[(String, String)]) -> Result<Answers, CliError> {
    let mut answers = Answers::default();
    for (key, answer) in given {
        answers
            .add(key, answer)
            .map_err(|reason| CliError::usage(&reason))?;
    }
    Ok(answers)
}

/// `Weg=tip_displacement,mm`.
fn stated(text: &str) -> Result<StatedColumn, String> {
    let (column, what) = text
        .rsplit_once('=')
        .ok_or("needed NAME=QUANTITY, such as \"d [mm]=tip_displacement\"")?;
    let (key, unit) = match what.split_once(',') {
        Some((key, unit)) => (key, Some(unit.trim().to_owned())),
        None => (what, None),
    };
    let quantity = Quantity::from_key(key.trim()).ok_or_else(|| {
        format!("no quantity is called {key:?}; such are tip_displacement, curvature, current, voltage, blocking_force")
    })?;
    Ok(StatedColumn {
        column: column.trim().to_owned(),
        quantity,
        unit,
    })
}

fn campaign(args: &ProfileArgs) -> Result<PathBuf, CliError> {
    let absolute = std::path::absolute(&args.file).unwrap_or_else(|_| args.file.clone());
    let beside = absolute.parent().and_then(campaign_file::find);
    beside.map_or_else(|| folder(None), Ok)
}

fn print(proposed: &ProposedProfile, output: &Output) {
    output.result(&proposed.profile);
    for open in &proposed.open {
        output.message(&format!("to fill in: {open}"));
    }
    match (&proposed.read, &proposed.refusal) {
        (Some(read), _) => inspect::print(read, output),
        (None, Some(refusal)) => output.message(&format!("not usable yet: {refusal}")),
        (None, None) => {}
    }
    if let Some(path) = &proposed.written {
        output.message(&format!("written: {}", path.display()));
    }
}
