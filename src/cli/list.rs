//! `ieap list`: what the program knows, each list from its registry.

use clap::{Args, ValueEnum};

use super::exit::{CliError, DONE};
use super::output::Output;
use super::{effects, figure, formats, models, schema, table};

/// List rare verbs, formats, models, effects, schemas
///
/// With the name of an effect it says everything that is known of that effect; with the name of a schema it prints the
/// JSON Schema (draft 2020-12) of that document.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// What to list; without it, what can be listed
    #[arg(value_name = "WHAT", value_enum)]
    what: Option<What>,
    /// One effect (faradaic-leak) or one schema (fits, or ieap/fits/1)
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// What can be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// Instrument formats that can be read
    Formats,
    /// Models that runs can be fitted with, their parameters, and the methods that search the minimum
    Models,
    /// Effects that a model may be missing
    Effects,
    /// JSON Schemas of what --json prints
    #[value(alias = "schema")]
    Schemas,
    /// Tables, as `ieap table` lists them
    #[value(hide = true)]
    Tables,
    /// Figures, as `ieap figure` lists them
    #[value(hide = true)]
    Figures,
}

/// Lists what is asked for; without that what can be listed, and `rare`, the verbs that `ieap help` leaves out.
pub fn run(args: &ListArgs, rare: &str, output: &Output) -> Result<u8, CliError> {
    match args.what {
        Some(what) => of(what, args.name.as_deref(), output),
        None if output.json => Err(CliError::usage(
            "list: needed what to list, as in `ieap list formats --json`",
        )),
        None => {
            output.result("`ieap list` WHAT lists:");
            for what in What::value_variants() {
                let value = what.to_possible_value().unwrap_or_default();
                if value.is_hide_set() {
                    continue;
                }
                let about = value.get_help().map(ToString::to_string).unwrap_or_default();
                output.result(&format!("  {:<12} {about}", value.get_name()));
            }
            output.result(&format!("\nVerbs that are needed rarely:\n{rare}"));
            Ok(DONE)
        }
    }
}

/// Lists one kind of thing, or says everything of one of that name.
pub fn of(what: What, name: Option<&str>, output: &Output) -> Result<u8, CliError> {
    match (what, name) {
        (What::Effects, name) => effects::run(name, output),
        (What::Schemas, name) => schema::run(name, output),
        (_, Some(name)) => Err(CliError::usage(&format!(
            "list: found {name:?}; only an effect or a schema is asked for by name"
        ))),
        (What::Formats, None) => formats::run(output),
        (What::Models, None) => models::run(output),
        (What::Tables, None) => table::list(output),
        (What::Figures, None) => figure::list(output),
    }
}
