//! `ieap watch`.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;

use super::exit::{CliError, DONE};
use super::fit_choice::FitChoiceArgs;
use super::output::{Output, to_stderr};
use super::{CampaignArg, Global, run};
use crate::pipeline::{Run, Watch, WatchSettings};

/// Do what `run` does, then the same for every file that arrives, until stopped (Ctrl-C)
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
}

pub fn run(args: &WatchArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let settings = WatchSettings {
        quiet: seconds("--quiet-s", args.quiet_s)?,
        poll: args
            .poll_s
            .map(|poll_s| seconds("--poll-s", poll_s))
            .transpose()?,
    };
    let stop = Arc::new(AtomicBool::new(false));
    let (heard, quiet) = (stop.clone(), global.quiet);
    ctrlc::set_handler(move || end(&heard, quiet))
        .map_err(|error| CliError::internal(&format!("cannot listen for Ctrl-C: {error}")))?;
    let mut context = args.campaign.open(global, output)?;
    output.message(&format!(
        "Watching {}; stop with Ctrl-C.",
        context.folder.join(&context.campaign.runs_folder).display()
    ));
    let watch = Watch {
        settings,
        job: Run {
            fit: args.fit.choice(global),
            skip_diagnosis: args.no_diagnose,
        },
    };
    watch.run(&mut context, output, &stop, &mut |summary| {
        run::print(summary, output);
        for claimed in &summary.diagnose.claimed {
            output.message(&format!(
                "{}: the simulation is wrong (p = {:.2e}, at or below the level {:.2e} of its turn)",
                claimed.run, claimed.p_misfit, claimed.level
            ));
        }
    })?;
    output.message("Stopped.");
    Ok(DONE)
}

/// Asks the watch to stop, and ends the program where a long diagnosis does not hear of it: what is saved is whole at any
/// time, and the watch makes the rest when it starts again.
fn end(stop: &AtomicBool, quiet: bool) {
    stop.store(true, Ordering::SeqCst);
    std::thread::sleep(GRACE);
    if !quiet {
        to_stderr("Stopped within a diagnosis, which is made when the watch starts again.");
    }
    std::process::exit(i32::from(DONE));
}

/// How long a watch that is asked to stop may take for what it is at.
const GRACE: Duration = Duration::from_secs(10);

fn seconds(option: &str, seconds: f64) -> Result<Duration, CliError> {
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        CliError::usage(&format!(
            "{option}: found {seconds}, needed a number of seconds not below 0"
        ))
    })
}
