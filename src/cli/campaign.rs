//! The campaign that a verb works on: which folder is meant, and what opening it found.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::exit::CliError;
use super::global::Global;
use super::output::Output;
use crate::domain::Severity;
use crate::ingest::campaign_file::{self, NOT_READ};
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

    /// Opens that campaign to show it.
    pub fn open_to_show(&self, output: &Output) -> Result<Context, CliError> {
        open_to_show(&self.folder()?, output)
    }

    /// Opens that campaign for writing; where nothing can be written now, to read, as soon as `due` says that nothing is to
    /// be done. Beside another program that is waited for: it may be doing just that.
    pub fn open_or_read(
        &self,
        global: &Global,
        output: &Output,
        due: impl Fn(&Context) -> Result<Option<String>, CliError>,
    ) -> Result<(Context, bool), CliError> {
        match self.open(global, output) {
            Err(error) if error.cannot_write() => Ok((self.read_when_done(output, due, error)?, false)),
            opened => Ok((opened?, true)),
        }
    }

    /// Opens that campaign to read as soon as `due` says that nothing is to be done; `refused` where that takes too long.
    pub fn read_when_done(
        &self,
        output: &Output,
        due: impl Fn(&Context) -> Result<Option<String>, CliError>,
        refused: CliError,
    ) -> Result<Context, CliError> {
        let begun = Instant::now();
        loop {
            let context = Context::open_read_only(&self.folder()?)?;
            let Some(due) = due(&context)? else {
                say_what_falls_short(&context, output);
                return Ok(context);
            };
            if !refused.is_of_another() || begun.elapsed() > PATIENCE {
                return Err(refused.with(&format!(
                    " It has {due} before the results are current; `ieap table` shows those that are there."
                )));
            }
            std::thread::sleep(GLANCE);
        }
    }
}

/// How long a verb waits for another program to do what it would do itself: as long as for a lock of the database.
const PATIENCE: Duration = Duration::from_secs(30);
/// How often it looks.
const GLANCE: Duration = Duration::from_millis(300);

/// Opens a campaign to show what is stored, and says first what cannot be read of it.
pub fn open_to_show(folder: &Path, output: &Output) -> Result<Context, CliError> {
    let context = Context::open_read_only(folder)?;
    say_what_falls_short(&context, output);
    Ok(context)
}

/// A campaign.toml that cannot be read, and a database that lags behind the journal.
pub fn say_what_falls_short(context: &Context, output: &Output) {
    let settings = context.warnings.iter().filter(|issue| issue.code == NOT_READ);
    let behind = context
        .agreed
        .iter()
        .filter(|issue| issue.severity == Severity::Error);
    settings.chain(behind).for_each(|issue| output.falls_short(issue));
}

pub fn say_what_is_not_understood(context: &Context, output: &Output) {
    let warnings = context.warnings.iter().filter(|issue| issue.code != NOT_READ);
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
