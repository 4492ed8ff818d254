//! `--allow-command`: what a campaign may run, and what it may not.

use clap::Args;

use super::exit::CliError;
use super::output::Output;
use super::user_folders;
use crate::pipeline::infra::allowed::{as_stated, not_allowed};
use crate::pipeline::{AllowedCommands, Context};

/// Whether the campaign's command is allowed now.
#[derive(Debug, Clone, Args)]
pub struct AllowCommandArg {
    /// Allow the command of [monitoring] in campaign.toml to be run for alarms, here and from now on; without it none is run
    /// that was not allowed before
    #[arg(long)]
    allow_command: bool,
}

impl AllowCommandArg {
    /// What is allowed, after this campaign's command was where that is asked for. What is allowed now, or would not be run, is
    /// said.
    pub fn allowed(&self, context: &Context, output: &Output) -> Result<AllowedCommands, CliError> {
        let allowed = kept();
        let command = &context.campaign.monitoring.command;
        if !self.allow_command {
            say_what_is_not_allowed(context, output);
        } else if command.is_empty() {
            output.message(
                "--allow-command: campaign.toml names no command under [monitoring]; nothing to allow",
            );
        } else {
            let file = allowed.allow(&context.folder, command)?;
            output.message(&format!(
                "Allowed to be run for alarms of this campaign, in its folder: {}. To take it back, delete {}.",
                as_stated(command),
                file.display()
            ));
        }
        Ok(allowed)
    }
}

/// Says that the campaign has a command that would not be run here, where it has one.
pub fn say_what_is_not_allowed(context: &Context, output: &Output) {
    let command = &context.campaign.monitoring.command;
    let is_allowed = || kept().has(&context.folder, command).unwrap_or(false);
    if !command.is_empty() && !is_allowed() {
        output.message(&format!(
            "warning: the command of [monitoring] is not run for alarms: {}",
            not_allowed(command)
        ));
    }
}

fn kept() -> AllowedCommands {
    AllowedCommands::kept_in(user_folders::state().map(|state| state.join("ieap/allowed-commands")))
}
