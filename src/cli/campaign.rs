//! The campaign that a verb works on: which folder is meant, and what opening it found.

use std::path::{Path, PathBuf};

use clap::Args;

use super::exit::CliError;
use super::global::Global;
use super::output::Output;
use crate::ingest::campaign_file;
use crate::pipeline::Context;

/// The campaign a verb works on.
#[derive(Debug, Clone, Args)]
pub struct CampaignArg {
    /// Campaign folder [default: this folder, or the nearest one above it with a campaign.toml]
    #[arg(value_name = "CAMPAIGN")]
    campaign: Option<PathBuf>,
}

impl CampaignArg {
    /// The folder meant.
    pub fn folder(&self) -> Result<PathBuf, CliError> {
        folder(self.given())
    }

    /// The folder named, if any.
    pub fn given(&self) -> Option<&Path> {
        self.campaign.as_deref()
    }

    /// What a verb is asked for by name, and the folder named: `table table5`, `table table5 FOLDER`, `table FOLDER` and
    /// `table FOLDER table5` mean what they seem to. A name that is known goes before a folder of that name.
    pub fn with_name(
        &self,
        name: Option<&str>,
        is_known: impl Fn(&str) -> bool,
    ) -> (Option<String>, Option<PathBuf>) {
        let folder = name.filter(|name| !is_known(name) && Path::new(name).is_dir());
        match folder {
            None => (name.map(str::to_owned), self.given().map(Path::to_owned)),
            Some(folder) => {
                let second = self.given().map(|second| second.to_string_lossy().into_owned());
                (second, Some(folder.into()))
            }
        }
    }

    /// Opens that campaign for writing, and says what in its campaign.toml is not understood.
    pub fn open(&self, global: &Global, output: &Output) -> Result<Context, CliError> {
        let context = Context::open(&self.folder()?, global.i_know)?;
        say_what_is_not_understood(&context, output);
        Ok(context)
    }

    /// The same for reading only.
    pub fn open_read_only(&self, output: &Output) -> Result<Context, CliError> {
        let context = Context::open_read_only(&self.folder()?)?;
        say_what_is_not_understood(&context, output);
        Ok(context)
    }
}

pub fn say_what_is_not_understood(context: &Context, output: &Output) {
    let warnings = context.warnings.iter();
    warnings.for_each(|issue| output.issue("campaign.toml", issue));
    say_what_opening_found(context, output);
}

/// What opening the campaign found and put right.
pub fn say_what_opening_found(context: &Context, output: &Output) {
    say_what_was_agreed(context, output);
    if !context.damage.is_empty() {
        output.message(
            "After the disorderly end of the last ieap, this was found (`ieap verify` looks at everything):",
        );
        let damage = context.damage.iter();
        damage.for_each(|issue| output.issue("damage", issue));
    }
}

/// What the database and the journal lacked of each other, and what may be lost.
pub fn say_what_was_agreed(context: &Context, output: &Output) {
    let agreed = context.agreed.iter();
    agreed.for_each(|issue| output.issue("database and journal", issue));
}

/// The campaign folder meant by `given`, or found from the current folder upward.
pub fn folder(given: Option<&Path>) -> Result<PathBuf, CliError> {
    match given {
        Some(folder) => Ok(folder.to_owned()),
        None => campaign_file::find(Path::new(".")).ok_or_else(|| {
            CliError::usage(
                "there is no campaign.toml in this folder or above it. Name a campaign folder, or make one with `ieap init FOLDER`.",
            )
        }),
    }
}
