//! `ieap completions`.

use clap::{Args, Command};
use clap_complete::Shell;

use super::exit::{CliError, DONE};
use super::output::Output;

/// Print a completion script for a shell; source it, or save it where your shell looks for completions
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

pub fn run(args: &CompletionsArgs, command: &mut Command, output: &Output) -> Result<u8, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, command, "ieap", &mut script);
    output.write(&script);
    Ok(DONE)
}
