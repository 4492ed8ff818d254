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

#[derive(Debug, Subcommand)]
enum Verb {
    Init(init::InitArgs),
    Run(run::RunArgs),
    Watch(watch::WatchArgs),
    Serve(serve::ServeArgs),
    Ingest(ingest::IngestArgs),
    Fit(fit::FitArgs),
    ImportFits(import_fits::ImportFitsArgs),
    Dma(dma::DmaArgs),
    Impedance(impedance::ImpedanceArgs),
    Diagnose(diagnose::DiagnoseArgs),
    Study(study::StudyArgs),
    Compare(compare::CompareArgs),
    Next(next::NextArgs),
    Report(report::ReportArgs),
    Tag(tag::TagArgs),
    Drop(drop::DropArgs),
    Status(status::StatusArgs),
    Verify(verify::VerifyArgs),
    Rebuild(rebuild::RebuildArgs),
    Table(table::TableArgs),
    Explain(explain::ExplainArgs),
    Figure(figure::FigureArgs),
    Inspect(inspect::InspectArgs),
    Profile(profile::ProfileArgs),
    Simulate(simulate::SimulateArgs),
    Trace(trace::TraceArgs),
    Export(export::ExportArgs),
    Predict(predict::PredictArgs),
    Plan(plan::PlanArgs),
    Drive(drive::DriveArgs),
    Convert(convert::ConvertArgs),
    Backup(backup::BackupArgs),
    Restore(backup::RestoreArgs),
    List(list::ListArgs),
    Man(man::ManArgs),
    Completions(completions::CompletionsArgs),
    #[command(flatten)]
    Former(former::Former),
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
            let text = help::text(Cli::command(), &arguments, is_coloured);
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

fn dispatch(cli: &Cli, output: &Output) -> Result<u8, CliError> {
    let global = &cli.global;
    match &cli.verb {
        Verb::Init(args) => init::run(args, output),
        Verb::Run(args) => run::run(args, global, output),
        Verb::Watch(args) => watch::run(args, global, output),
        Verb::Serve(args) => serve::run(args, global, output),
        Verb::Ingest(args) => ingest::run(args, global, output),
        Verb::Fit(args) => fit::run(args, global, output),
        Verb::ImportFits(args) => import_fits::run(args, global, output),
        Verb::Dma(args) => dma::run(args, global, output),
        Verb::Impedance(args) => impedance::run(args, global, output),
        Verb::Diagnose(args) => diagnose::run(args, global, output),
        Verb::Study(args) => study::run(args, global, output),
        Verb::Compare(args) => compare::run(args, global, output),
        Verb::Next(args) => next::run(args, output),
        Verb::Report(args) => report::run(args, global, output),
        Verb::Tag(args) => tag::run(args, global, output),
        Verb::Drop(args) => drop::run(args, global, output),
        Verb::Status(args) => status::run(args, output),
        Verb::Verify(args) => verify::run(args, output),
        Verb::Rebuild(args) => rebuild::run(args, global, output),
        Verb::Table(args) => table::run(args, output),
        Verb::Explain(args) => explain::run(args, output),
        Verb::Figure(args) => figure::run(args, output),
        Verb::Inspect(args) => inspect::run(args, output),
        Verb::Profile(args) => profile::run(args, output),
        Verb::Simulate(args) => simulate::run(args, global, output),
        Verb::Trace(args) => trace::run(args, output),
        Verb::Export(args) => export::run(args, output),
        Verb::Predict(args) => predict::run(args, output),
        Verb::Plan(args) => plan::run(args, global, output),
        Verb::Drive(args) => drive::run(args, output),
        Verb::Convert(args) => convert::run(args, output),
        Verb::Backup(args) => backup::run(args, global, output),
        Verb::Restore(args) => backup::run_restore(args, output),
        Verb::List(args) => list::run(args, output),
        Verb::Man(args) => man::run(args, Cli::command(), output),
        Verb::Completions(args) => completions::run(args, &mut Cli::command(), output),
        Verb::Former(word) => former::run(word, global, output),
    }
}
