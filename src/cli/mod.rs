//! The command line: one file a verb, progress and messages on stderr, results on stdout, exit status.

mod allow_command;
mod backup;
mod campaign;
mod colour;
mod compare;
mod completions;
mod convert;
mod diagnose;
mod dma;
mod drive;
mod drop;
mod effects;
mod exit;
mod explain;
mod export;
mod faults;
mod figure;
mod fit;
mod fit_choice;
mod fit_group;
mod formats;
mod global;
mod help;
mod impedance;
mod import_fits;
mod ingest;
mod init;
mod inspect;
mod interrupted;
mod list;
mod log_file;
mod man;
mod models;
mod next;
mod output;
mod plan;
mod predict;
mod printable;
mod profile;
mod rebuild;
mod report;
mod run;
mod schema;
mod sections;
mod serve;
mod signals;
mod simulate;
mod status;
mod strip_args;
mod study;
mod table;
mod tag;
mod threads;
mod told;
mod trace;
mod typed;
mod user_folders;
mod verify;
mod watch;
mod words;

use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::domain::fault::caught;
use exit::CliError;
use global::Global;
use output::Output;
pub use schema::{Schema, schema_named};

/// From the instrument files of ionic actuator strips to fitted parameters, causes and a report.
#[derive(Debug, Parser)]
#[command(name = "ieap", version, long_version = LONG_VERSION, max_term_width = 100)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    verb: Verb,
}

/// The version, and which build of it.
const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nbuilt from ",
    env!("IEAP_BUILT_FROM")
);

/// The verbs from one table: the command line, an example of each on the campaign of the thesis, and what runs it. A group is
/// in the help of the program or not; a step of `run` is in no list.
macro_rules! verbs {
    ($($group:literal hide $hide:literal { $($verb:ident($args:ty) $example:literal => $run:expr,)+ })+) => {
        #[derive(Debug, Subcommand)]
        enum Verb {
            $($(
                #[command(hide = $hide)]
                $verb($args),
            )+)+
        }

        /// Groups of verbs, each with the examples of its verbs in their order.
        const GROUPS: help::Groups = &[$(($group, &[$($example),+])),+];

        fn dispatch(cli: &Cli, output: &Output) -> Result<u8, CliError> {
            match &cli.verb {
                $($(Verb::$verb(args) => {
                    let run: fn(&$args, &Global, &Output) -> Result<u8, CliError> = $run;
                    run(args, &cli.global, output)
                })+)+
            }
        }
    };
}

// The first group in the order of a day's work.
verbs! {
    "day" hide false {
        Init(init::InitArgs) "init my-campaign --from campaigns/thesis/runs --yes" => |args, _, output| init::run(args, output),
        Inspect(inspect::InspectArgs) "inspect campaigns/thesis/runs/CNaf/air/CNaf_air_2.0V.csv" => |args, _, output| inspect::run(args, output),
        Run(run::RunArgs) "run campaigns/thesis" => run::run,
        Watch(watch::WatchArgs) "watch campaigns/thesis" => watch::run,
        Serve(serve::ServeArgs) "serve campaigns/thesis" => serve::run,
        Status(status::StatusArgs) "status campaigns/thesis" => |args, _, output| status::run(args, output),
        Tag(tag::TagArgs) "-C campaigns/thesis tag runs/CNaf/air/CNaf_air_2.0V.csv operator=Lee" => tag::run,
        Drop(drop::DropArgs) "-C campaigns/thesis drop runs/CNaf/air/CNaf_air_2.0V.csv --why slipped" => drop::run,
        Table(table::TableArgs) "table table5 campaigns/thesis" => |args, _, output| table::run(args, output),
        Figure(figure::FigureArgs) "figure parameters campaigns/thesis -o parameters.svg" => |args, _, output| figure::run(args, output),
        Diagnose(diagnose::DiagnoseArgs) "diagnose campaigns/thesis" => diagnose::run,
        Study(study::StudyArgs) "study campaigns/thesis" => |args, _, output| study::run(args, output),
        Compare(compare::CompareArgs) "compare campaigns/thesis --models lumped-1,lumped-2" => compare::run,
        Explain(explain::ExplainArgs) "explain table5 1 1 campaigns/thesis" => |args, _, output| explain::run(args, output),
        Plan(plan::PlanArgs) "plan campaigns/thesis" => plan::run,
        Predict(predict::PredictArgs) "predict campaigns/thesis --sample CNaf-1 --environment air --voltage 2V" => |args, _, output| predict::run(args, output),
        Export(export::ExportArgs) "export campaigns/thesis --what fits -o fits.parquet" => |args, _, output| export::run(args, output),
        Verify(verify::VerifyArgs) "verify campaigns/thesis" => |args, _, output| verify::run(args, output),
        Backup(backup::BackupArgs) "backup usb-disk/thesis campaigns/thesis" => backup::run,
        List(list::ListArgs) "list" => |args, _, output| list::run(args, &help::list(&Cli::command(), GROUPS, "rare"), output),
    }
    "rare" hide false {
        Restore(backup::RestoreArgs) "restore usb-disk/thesis thesis-again" => |args, _, output| backup::run_restore(args, output),
        Rebuild(rebuild::RebuildArgs) "rebuild campaigns/thesis" => rebuild::run,
        ImportFits(import_fits::ImportFitsArgs) "-C campaigns/thesis import-fits fits.parquet" => import_fits::run,
        Profile(profile::ProfileArgs) "profile campaigns/thesis/dma/CNaf.csv" => |args, _, output| profile::run(args, output),
        Trace(trace::TraceArgs) "trace frames --length-mm 5 --frames-per-second 10" => |args, _, output| trace::run(args, output),
        Simulate(simulate::SimulateArgs) "simulate campaigns/thesis/simulation.toml --overwrite" => simulate::run,
        Convert(convert::ConvertArgs) "-C campaigns/thesis convert tip-displacement=1mm --sample CNaf-1" => |args, _, output| convert::run(args, output),
        Man(man::ManArgs) "man run" => |args, _, output| man::run(args, Cli::command(), GROUPS, output),
        Completions(completions::CompletionsArgs) "completions bash" => |args, _, output| completions::run(args, &Cli::command(), output),
    }
    "step" hide true {
        Ingest(ingest::IngestArgs) "run --only ingest campaigns/thesis" => ingest::run,
        Fit(fit::FitArgs) "run --only fit campaigns/thesis" => fit::run,
        Dma(dma::DmaArgs) "run --only dma campaigns/thesis" => dma::run,
        Impedance(impedance::ImpedanceArgs) "run --only impedance campaigns/thesis" => impedance::run,
        Report(report::ReportArgs) "run --only report campaigns/thesis" => report::run,
    }
}

/// Parses the command line, runs the verb and gives its exit status.
pub fn main() -> ExitCode {
    // A verb that has to hear of signals says so where it cannot.
    let _ = signals::hear();
    ExitCode::from(status_after(std::env::args_os()))
}

/// The same for a command line that is given, the name of the program first: the exit status.
pub fn status_after(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = words::taken(arguments.into_iter().collect());
    let choice = colour::asked(arguments.iter().cloned());
    let parsed = Cli::command()
        .color(choice)
        .try_get_matches_from(&arguments)
        .and_then(|found| Cli::from_arg_matches(&found));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) if asks_for_help(&error) => {
            let is_coloured = colour::is_wanted(choice, std::io::stdout().is_terminal());
            let text = help::text(Cli::command(), GROUPS, &arguments, is_coloured);
            let print = || {
                if error.use_stderr() {
                    std::io::stderr().write_all(text.as_bytes())
                } else {
                    std::io::stdout().write_all(text.as_bytes())
                }
            };
            return said(&error, print);
        }
        Err(error) => return said(&error, || error.print()),
    };
    let output = Output::new(&cli.global);
    let work = || {
        go_to(cli.global.work_in.as_deref())?;
        threads::set(cli.global.threads, &output)?;
        dispatch(&cli, &output)
    };
    let outcome = caught(work).unwrap_or_else(|reason| {
        let what = "a fault of the program stopped it";
        Err(CliError::internal(&format!(
            "{what}: {reason}. Report it with the files of the campaign."
        )))
    });
    let status = outcome.unwrap_or_else(|error| {
        output.error(&error.to_string());
        error.status()
    });
    output.ended(status)
}

fn asks_for_help(error: &clap::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    )
}

/// Works in that folder from now on.
fn go_to(folder: Option<&Path>) -> Result<(), CliError> {
    let Some(folder) = folder else { return Ok(()) };
    std::env::set_current_dir(folder).map_err(|error| {
        CliError::usage(&format!(
            "-C {}: {error}; needed a folder that is there",
            folder.display()
        ))
    })
}

/// Prints help, or what is wrong in the command line, and gives the exit status.
fn said(error: &clap::Error, print: impl FnOnce() -> std::io::Result<()>) -> u8 {
    let printed = print().and_then(|()| std::io::stdout().flush());
    match printed {
        _ if error.use_stderr() => exit::USAGE,
        Err(failed) if failed.kind() != std::io::ErrorKind::BrokenPipe => {
            output::to_stderr(&format!("error: stdout: writing failed: {failed}"));
            exit::STORAGE
        }
        _ => exit::DONE,
    }
}
