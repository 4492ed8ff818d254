//! `ieap completions`.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;

use super::exit::{CliError, DONE};
use super::output::Output;
use super::user_folders;
use crate::pipeline::CODE_VERSION;

/// Print or install completions for a shell
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell [default: the one that $SHELL names]
    shell: Option<Shell>,
    /// Install it for you alone: bash, fish and zsh have a folder for that
    #[arg(long)]
    install: bool,
    /// Write over a script that is there
    #[arg(long, requires = "install")]
    overwrite: bool,
}

pub fn run(args: &CompletionsArgs, command: &Command, output: &Output) -> Result<u8, CliError> {
    let shell = args.shell.or_else(Shell::from_env).ok_or_else(|| {
        CliError::usage(
            "completions: $SHELL names no shell that is known; needed bash, elvish, fish, powershell or zsh",
        )
    })?;
    // Words that no help shows are offered to nobody.
    let shown = command.get_subcommands().filter(|verb| !verb.is_hide_set());
    let mut shown = Command::new("ieap")
        .args(command.get_arguments())
        .subcommands(shown)
        .version(CODE_VERSION);
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut shown, "ieap", &mut script);
    if !args.install {
        output.write(&script);
        return Ok(DONE);
    }
    let Place { folder, file, note } = place(shell)?;
    user_folders::put(&folder, file, &script, args.overwrite, output)?;
    output.result(&format!("{}: {note}", folder.join(file).display()));
    Ok(DONE)
}

/// Where a shell looks for a person's own completions, and what to do then.
struct Place {
    folder: PathBuf,
    file: &'static str,
    note: &'static str,
}

fn place(shell: Shell) -> Result<Place, CliError> {
    let (folder, file, note) = match shell {
        Shell::Bash => (
            user_folders::data()?.join("bash-completion/completions"),
            "ieap",
            "known in the next shell where the package bash-completion is installed",
        ),
        Shell::Fish => (
            user_folders::config()?.join("fish/completions"),
            "ieap.fish",
            "known in the next shell",
        ),
        Shell::Zsh => (
            user_folders::data()?.join("zsh/site-functions"),
            "_ieap",
            "known in the next shell once its folder stands in fpath: write `fpath=(~/.local/share/zsh/site-functions $fpath)` \
             before compinit in ~/.zshrc",
        ),
        other => {
            return Err(CliError::usage(&format!(
                "{other} has no folder for completions; print the script (`ieap completions {other}`) into a file that your \
                 profile reads"
            )));
        }
    };
    Ok(Place { folder, file, note })
}
