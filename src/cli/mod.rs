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
mod former;
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
#[command(name = "ieap", version, max_term_width = 100)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    verb: Verb,
}

/// The verbs from one table: the command line, the groups of its help, and what runs each.
macro_rules! verbs {
    ($($group:literal { $($verb:ident($args:ty) => $run:expr,)+ })+) => {
        #[derive(Debug, Subcommand)]
        enum Verb {
            $($($verb($args),)+)+
            #[command(flatten)]
            Former(former::Former),
        }

        /// Groups of the help, each with how many of the verbs, in their order, it has.
        const GROUPS: &[(&str, usize)] = &[$(($group, [$(stringify!($verb)),+].len())),+];

        fn dispatch(cli: &Cli, output: &Output) -> Result<u8, CliError> {
            match &cli.verb {
                $($(Verb::$verb(args) => {
                    let run: fn(&$args, &Global, &Output) -> Result<u8, CliError> = $run;
                    run(args, &cli.global, output)
                })+)+
                Verb::Former(word) => former::run(word, &cli.global, output),
            }
        }
    };
}

// By what a person is about to do, what everybody needs first.
verbs! {
    "start" {
        Init(init::InitArgs) => |args, _, output| init::run(args, output),
        Run(run::RunArgs) => run::run,
        Watch(watch::WatchArgs) => watch::run,
        Serve(serve::ServeArgs) => serve::run,
        Status(status::StatusArgs) => |args, _, output| status::run(args, output),
    }
    "look" {
        Inspect(inspect::InspectArgs) => |args, _, output| inspect::run(args, output),
        Table(table::TableArgs) => |args, _, output| table::run(args, output),
        Figure(figure::FigureArgs) => |args, _, output| figure::run(args, output),
        Report(report::ReportArgs) => report::run,
        Export(export::ExportArgs) => |args, _, output| export::run(args, output),
    }
    "say" {
        Tag(tag::TagArgs) => tag::run,
        Drop(drop::DropArgs) => drop::run,
    }
    "why" {
        Diagnose(diagnose::DiagnoseArgs) => diagnose::run,
        Compare(compare::CompareArgs) => compare::run,
        Explain(explain::ExplainArgs) => |args, _, output| explain::run(args, output),
    }
    "next" {
        Next(next::NextArgs) => |args, _, output| next::run(args, output),
        Plan(plan::PlanArgs) => plan::run,
        Predict(predict::PredictArgs) => |args, _, output| predict::run(args, output),
        Drive(drive::DriveArgs) => |args, _, output| drive::run(args, output),
    }
    "keep" {
        Verify(verify::VerifyArgs) => |args, _, output| verify::run(args, output),
        Backup(backup::BackupArgs) => backup::run,
        Restore(backup::RestoreArgs) => |args, _, output| backup::run_restore(args, output),
        Rebuild(rebuild::RebuildArgs) => rebuild::run,
    }
    "more" {
        Ingest(ingest::IngestArgs) => ingest::run,
        Fit(fit::FitArgs) => fit::run,
        Dma(dma::DmaArgs) => dma::run,
        Impedance(impedance::ImpedanceArgs) => impedance::run,
        Study(study::StudyArgs) => |args, _, output| study::run(args, output),
        List(list::ListArgs) => |args, _, output| list::run(args, output),
        Convert(convert::ConvertArgs) => |args, _, output| convert::run(args, output),
        Profile(profile::ProfileArgs) => |args, _, output| profile::run(args, output),
        Trace(trace::TraceArgs) => |args, _, output| trace::run(args, output),
        Simulate(simulate::SimulateArgs) => simulate::run,
        ImportFits(import_fits::ImportFitsArgs) => import_fits::run,
        Man(man::ManArgs) => |args, _, output| man::run(args, Cli::command(), output),
        Completions(completions::CompletionsArgs) => |args, _, output| completions::run(args, &mut Cli::command(), output),
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
    let arguments: Vec<OsString> = arguments.into_iter().collect();
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
