//! `ieap tag`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::campaign::folder;
use super::exit::{CliError, DONE, SOME_REFUSED};
use super::global::Global;
use super::output::Output;
use crate::ingest::campaign_file;
use crate::pipeline::{Context, SetTags};

/// Set tags of runs by hand
///
/// They count more than any other source, and who set them when is recorded.
#[derive(Debug, Args)]
pub struct TagArgs {
    /// Runs: names in the report, patterns of them ("*_rh30_*"), or paths to files; then tags as key=value, of which `key=`
    /// takes a tag back. The campaign folder may stand last
    #[arg(value_name = "RUN... KEY=VALUE", required = true, num_args = 2..)]
    words: Vec<String>,
    /// Who sets them [default: the user's name]
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Set a voltage though the readings say one of another size
    #[arg(long)]
    even_so: bool,
}

pub fn run(args: &TagArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let (mut runs, words) = split_runs(&args.words);
    let (pairs, named) = split(words)?;
    let folder = places(&mut runs, named.as_deref())?;
    let mut context = Context::open_beside(&folder, global.i_know)?;
    super::campaign::say_what_was_agreed(&context, output);
    let set = SetTags {
        runs,
        pairs,
        set_by: args.by.clone().unwrap_or_else(user_name),
        even_so: args.even_so,
    };
    let summaries = set.run(&mut context, output)?;
    for summary in &summaries {
        output.result(&format!("{}: {}", summary.run, summary.state.replace('_', " ")));
        for (key, value, source) in &summary.tags {
            output.result(&format!("    {key} = {value} ({source})"));
        }
        let issues = summary.new_issues.iter();
        issues.for_each(|issue| output.issue(&summary.run, issue));
    }
    output.message("The next `ieap run` (or the running `ieap watch`) fits and renders with these tags.");
    let [first, others @ ..] = summaries.as_slice() else {
        return Err(CliError::usage("found no run, needed one at least"));
    };
    output.document(&json!({ "schema": "ieap/tag/1", "tag": first, "others": others }))?;
    let waits = summaries.iter().any(|summary| summary.waits);
    Ok(if waits { SOME_REFUSED } else { DONE })
}

/// Runs before the first pair, of which the first word always is one, and the words from that pair on.
fn split_runs(words: &[String]) -> (Vec<String>, &[String]) {
    let is_pair = |word: &String| word.split_once('=').is_some_and(|(key, _)| is_key(key));
    let first_pair = words.iter().skip(1).position(is_pair);
    let (runs, words) = words.split_at(first_pair.map_or(1, |place| place + 1));
    (runs.to_vec(), words)
}

/// Keys and values.
type Pairs = Vec<(String, String)>;

/// Pairs, and the campaign folder where the last argument is one.
fn split(arguments: &[String]) -> Result<(Pairs, Option<PathBuf>), CliError> {
    let (mut pairs, mut campaign) = (Vec::new(), None);
    for (index, argument) in arguments.iter().enumerate() {
        match argument.split_once('=') {
            Some((key, value)) if is_key(key) => pairs.push((key.to_owned(), value.trim().to_owned())),
            _ if index + 1 == arguments.len() && Path::new(argument).is_dir() && !pairs.is_empty() => {
                campaign = Some(PathBuf::from(argument));
            }
            _ => {
                let needed = "key=value, the key of lower-case letters, digits and _";
                return Err(CliError::usage(&format!("found {argument:?}, needed {needed}")));
            }
        }
    }
    if pairs.is_empty() {
        Err(CliError::usage(
            "found no tag, needed key=value after the runs, such as environment=air",
        ))
    } else {
        Ok((pairs, campaign))
    }
}

fn is_key(key: &str) -> bool {
    !key.is_empty()
        && key
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

/// The campaign folder of these runs, of which the names in it are left. A path to a file tells both.
pub(super) fn places(runs: &mut [String], named: Option<&Path>) -> Result<PathBuf, CliError> {
    let mut campaign = None;
    for run in runs {
        let (folder, name) = place(run, named)?;
        let folder = std::fs::canonicalize(&folder).unwrap_or(folder);
        if campaign.as_ref().is_some_and(|known| *known != folder) {
            return Err(CliError::usage(
                "the runs lie in several campaigns; name those of one at a time",
            ));
        }
        (*run, campaign) = (name, Some(folder));
    }
    campaign.map_or_else(|| folder(named), Ok)
}

/// The campaign folder, and the run's name in it. A path to a file tells both.
fn place(run: &str, named: Option<&Path>) -> Result<(PathBuf, String), CliError> {
    let file = Path::new(run);
    if named.is_none() && file.is_file() {
        let absolute = std::fs::canonicalize(file).unwrap_or_else(|_| file.to_owned());
        if let Some(campaign) = absolute.parent().and_then(campaign_file::find) {
            let inside = absolute.strip_prefix(&campaign).unwrap_or(&absolute);
            return Ok((campaign.clone(), crate::ingest::scan::display_path(inside)));
        }
    }
    Ok((folder(named)?, run.to_owned()))
}

pub(super) fn user_name() -> String {
    let variables = ["USER", "LOGNAME", "USERNAME"];
    variables
        .iter()
        .find_map(|name| std::env::var(name).ok())
        .unwrap_or_else(|| "unknown user".to_owned())
}
