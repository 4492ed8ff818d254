//! `ieap watch`.

use crate::domain::number::significant;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::allow_command::AllowCommandArg;
use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::fit_choice::FitChoiceArgs;
use super::global::Global;
use super::log_file::LogFile;
use super::output::Output;
use super::{ingest, report, run, signals};
use crate::pipeline::{Run, Watch, WatchSettings, Watched, failed};

/// Do what `run` does for every file that arrives
///
/// Until stopped with Ctrl-C.
#[derive(Debug, Args)]
pub struct WatchArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Take a file when it has not changed for this many seconds; 30 suits a network share
    #[arg(long, value_name = "SECONDS", default_value = "5")]
    quiet_s: f64,
    /// Look every so many seconds instead of waiting for events, as on network shares
    #[arg(long, value_name = "SECONDS")]
    poll_s: Option<f64>,
    #[command(flatten)]
    fit: FitChoiceArgs,
    /// Leave the diagnosis for later (`ieap diagnose`)
    #[arg(long)]
    no_diagnose: bool,
    /// Write every line into this file too; at 4 MiB it becomes FILE.1, in place of an earlier one, and a new one is begun
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    #[command(flatten)]
    command: AllowCommandArg,
}

pub fn run(args: &WatchArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let settings = WatchSettings {
        quiet: seconds("--quiet-s", args.quiet_s)?,
        poll: args
            .poll_s
            .map(|poll_s| seconds("--poll-s", poll_s))
            .transpose()?,
    };
    let stop = signals::listen(global.quiet, Some(DONE), CUT_OFF)?;
    let mut context = args.campaign.open(global, output)?;
    output.time_lines(crate::pipeline::Zone::of(&context.campaign).zone().clone());
    if let Some(path) = &args.log {
        let opened = LogFile::open(path).map_err(failed(path, "opening the log"));
        output.log_into(opened?);
    }
    output.message(&format!(
        "Watching {}; stop with Ctrl-C.",
        context.folder.join(&context.campaign.runs_folder).display()
    ));
    let watch = Watch {
        settings,
        job: Run {
            fit: args.fit.choice(global),
            skip_diagnosis: args.no_diagnose,
            commands: args.command.allowed(&context, output)?,
        },
    };
    watch.run(&mut context, output, &stop, &|watched| tell(watched, output))?;
    output.message("Stopped.");
    Ok(DONE)
}

/// Said where the work under way did not end by itself in time.
const CUT_OFF: &str = "Stopped; what was under way is made when the watch starts again.";

fn tell(watched: &Watched, output: &Output) {
    match watched {
        Watched::Taken(summary) => ingest::print(summary, output),
        Watched::Fitted(line) => output.result(line),
        Watched::Made(made, rendered) => {
            run::print_made(made, output);
            report::print(rendered, output);
        }
        Watched::Diagnosed(summary) => {
            run::print_diagnosed(summary, output);
            for claimed in &summary.claimed {
                output.message(&format!(
                    "{}: the simulation is wrong (p = {}, at or below the level {} of its turn)",
                    claimed.run,
                    significant(claimed.p_misfit, 3),
                    significant(claimed.level, 3)
                ));
            }
        }
    }
}

fn seconds(option: &str, seconds: f64) -> Result<Duration, CliError> {
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        CliError::usage(&format!(
            "{option}: found {seconds}, needed a number of seconds not below 0"
        ))
    })
}
