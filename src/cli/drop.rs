//! `ieap drop`, and the way back.

use crate::domain::words::counted;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE};
use super::global::Global;
use super::output::Output;
use super::tag::{places, user_name};
use crate::ingest::campaign_file;
use crate::pipeline::campaign::standing::SetAside;
use crate::pipeline::{Context, SpeakOfRuns};

/// Take runs out of all results; --undo puts them back
///
/// They stay in the lists of runs with the reason.
#[derive(Debug, Args)]
pub struct DropArgs {
    /// The runs: their names in the report, or paths to their files. The campaign folder may stand last
    #[arg(value_name = "RUN", required_unless_present = "deleted")]
    runs: Vec<String>,
    /// Why: it is shown with the runs. With --undo it also puts back runs that the program set aside: you looked, and they
    /// are right
    #[arg(long, value_name = "TEXT", required_unless_present = "undo")]
    why: Option<String>,
    /// Put the runs back into all results
    #[arg(long, conflicts_with = "deleted")]
    undo: bool,
    /// Also every run whose files are gone from the folder
    #[arg(long)]
    deleted: bool,
    /// Who says it [default: the user's name]
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
}

pub fn run(args: &DropArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let said = SpeakOfRuns {
        runs: args.runs.clone(),
        deleted: args.deleted,
        drops: !args.undo,
        why: args.why.clone(),
        said_by: args.by.clone().unwrap_or_else(user_name),
    };
    speak(said, global, output)
}

fn speak(mut said: SpeakOfRuns, global: &Global, output: &Output) -> Result<u8, CliError> {
    let folder = take_places(&mut said.runs, said.deleted)?;
    let mut context = Context::open_beside(&folder, global.i_know)?;
    super::campaign::say_what_was_agreed(&context, output);
    let spoken = said.run(&mut context)?;
    let list = |title: &str, runs: &[SetAside], with_mend: bool| {
        if !runs.is_empty() {
            output.result(&format!("{} {title}:", counted(runs.len(), "run")));
        }
        for run in runs {
            output.result(&format!("  {}: {}", run.run, run.reason));
            if with_mend {
                output.result(&format!("    {}", run.mend));
            }
        }
    };
    list("out of all results", &spoken.set_aside, true);
    if !spoken.speaking.is_empty() {
        output.result(&format!("{} in results:", counted(spoken.speaking.len(), "run")));
        spoken
            .speaking
            .iter()
            .for_each(|run| output.result(&format!("  {run}")));
    }
    list("on your word, against the program's", &spoken.overruled, false);
    if spoken.speaking.is_empty() && spoken.set_aside.is_empty() {
        output.result("no run's files are gone: nothing was dropped")
    } else {
        output.message("The next `ieap run` (or the running `ieap watch`) makes the results anew.")
    }
    output.document(&json!({ "schema": "ieap/drop/1", "drop": spoken }))?;
    Ok(DONE)
}

/// The campaign folder; of `runs` the names in it are left.
fn take_places(runs: &mut Vec<String>, may_be_none: bool) -> Result<PathBuf, CliError> {
    let is_campaign = |last: &String| Path::new(last).join(campaign_file::FILE_NAME).is_file();
    let is_last = runs.len() > 1 || may_be_none;
    let named = runs
        .pop_if(|last| is_last && is_campaign(last))
        .map(PathBuf::from);
    places(runs, named.as_deref())
}
