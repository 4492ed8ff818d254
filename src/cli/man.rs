//! `ieap man`.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man;

use super::exit::{CliError, DONE};
use super::help::{Groups, rows};
use super::output::Output;
use super::user_folders;
use crate::pipeline::CODE_VERSION;

/// Print or install man pages
///
/// All of them with --install, for `man ieap` and `man ieap-run`.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// A verb [default: the program]
    verb: Option<String>,
    /// Write every page into the folder of your own man pages [~/.local/share/man/man1]
    #[arg(long, conflicts_with = "verb")]
    install: bool,
    /// Write every page into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["verb", "install"])]
    into: Option<PathBuf>,
    /// Write over pages that are there
    #[arg(long)]
    overwrite: bool,
}

pub fn run(args: &ManArgs, mut program: Command, groups: Groups, output: &Output) -> Result<u8, CliError> {
    // What the verbs take from the program (--json and the like) is known to them only then.
    program.build();
    let folder = match (&args.into, args.install) {
        (Some(folder), _) => Some(folder.clone()),
        (None, true) => Some(user_folders::data()?.join("man/man1")),
        (None, false) => None,
    };
    let Some(folder) = folder else {
        let command = match &args.verb {
            None => &program,
            Some(verb) => program.find_subcommand(verb).ok_or_else(|| {
                CliError::usage(&format!(
                    "man: found {verb:?}, needed a verb; `ieap --help` lists them"
                ))
            })?,
        };
        if output.json {
            return Err(CliError::usage(
                "man: a page is no document; leave --json out, or ask `ieap list schemas` for what the verbs print with it",
            ));
        }
        output.write(&page(command, &program, groups)?);
        return Ok(DONE);
    };
    let verbs = rows(&program, groups).map(|(_, verb, _)| verb);
    for command in std::iter::once(&program).chain(verbs) {
        let name = format!("{}.1", name(command));
        let page = page(command, &program, groups)?;
        user_folders::put(&folder, &name, &page, args.overwrite, output)?;
    }
    output.result(&format!(
        "{}: `man ieap`, `man ieap-run` and so on show them",
        folder.display()
    ));
    Ok(DONE)
}

/// `ieap`, `ieap-run`.
fn name(command: &Command) -> String {
    let whole = command.get_display_name().unwrap_or(command.get_name());
    whole.to_owned()
}

/// The page of a verb, or of the program.
fn page(command: &Command, program: &Command, groups: Groups) -> Result<Vec<u8>, CliError> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .title(name(command))
        .source(format!("ieap {}", CODE_VERSION))
        .manual("ieap manual")
        .render(&mut page)
        .map_err(|error| CliError::internal(&error.to_string()))?;
    page.extend_from_slice(END.as_bytes());
    // Of the verb one example, of the program those of a day's work.
    for (group, verb, example) in rows(program, groups) {
        if verb.get_name() == command.get_name() || command.has_subcommands() && group == "day" {
            let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
            let line = format!(".TP\n{about}:\nieap {example}\n");
            page.extend_from_slice(line.replace('-', "\\-").as_bytes());
        }
    }
    Ok(page)
}

/// What every page ends with.
const END: &str = r#".SH "EXIT STATUS"
.TP
\fB0\fR
done
.TP
\fB1\fR
a fault of the program ended the work; please report it
.TP
\fB2\fR
wrong usage: an option, an argument, campaign.toml
.TP
\fB3\fR
done, but some inputs were refused, or a fault of the program left out a part
.TP
\fB4\fR
the database or the disk refused
.TP
\fB5\fR
done, and an alarm stands (ieap status \-\-alarms)
.TP
\fB130\fR
interrupted; what was made is kept
.SH EXAMPLES
"#;
