//! Words of earlier versions that scripts may still use; no help shows them.

use clap::{Args, Subcommand};

use super::drive::{self, DriveArgs};
use super::drop::{self, DropArgs};
use super::exit::CliError;
use super::global::Global;
use super::list::{self, What};
use super::next::{self, NextArgs};
use super::output::Output;

/// Each with the words that took its place.
#[derive(Debug, Subcommand)]
pub enum Former {
    /// `plan`
    #[command(hide = true)]
    Next(NextArgs),
    /// `predict --wanted`
    #[command(hide = true)]
    Drive(DriveArgs),
    /// `drop --undo`
    #[command(hide = true)]
    Undrop(UndropArgs),
    /// `list formats`
    #[command(hide = true)]
    Formats,
    /// `list models`
    #[command(hide = true)]
    Models,
    /// `list effects`
    #[command(hide = true)]
    Effects { id: Option<String> },
    /// `list schemas`
    #[command(hide = true)]
    Schema { name: Option<String> },
}

#[derive(Debug, Args)]
pub struct UndropArgs {
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    #[arg(long, value_name = "TEXT")]
    why: Option<String>,
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
}

pub fn run(word: &Former, global: &Global, output: &Output) -> Result<u8, CliError> {
    match word {
        Former::Next(args) => next::run(args, output),
        Former::Drive(args) => drive::run(args, output),
        Former::Undrop(UndropArgs { runs, why, by }) => drop::run(
            &DropArgs::undo(runs.clone(), why.clone(), by.clone()),
            global,
            output,
        ),
        Former::Formats => list::of(What::Formats, None, output),
        Former::Models => list::of(What::Models, None, output),
        Former::Effects { id } => list::of(What::Effects, id.as_deref(), output),
        Former::Schema { name } => list::of(What::Schemas, name.as_deref(), output),
    }
}
