//! What `ieap --help` shows: verbs by what a person is about to do, and the options of every verb once.

use std::ffi::OsString;

use clap::Command;

/// Groups of verbs, each with how many of the verbs, in their order, it has.
type Groups = &'static [(&'static str, usize)];

/// The help that a command line asks for: of the program, or of the first verb in it. Short where `-h` asks.
pub fn text(program: Command, groups: Groups, words: &[OsString], is_coloured: bool) -> String {
    let mut program = arranged(program, groups);
    let verb = words.iter().skip(1).find_map(|word| {
        let word = word.to_str().filter(|word| *word != "help")?;
        Some(program.find_subcommand(word)?.get_name().to_owned())
    });
    let verb = verb.and_then(|verb| program.find_subcommand_mut(&verb).cloned());
    let help = match verb {
        Some(mut verb) if words.iter().all(|word| word != "-h") => verb.render_long_help(),
        Some(mut verb) => verb.render_help(),
        None => program.render_help(),
    };
    if is_coloured {
        help.ansi().to_string()
    } else {
        help.to_string()
    }
}

/// The command line with its help arranged. It parses nothing: options that were changed once all is built are lost to it.
fn arranged(program: Command, groups: Groups) -> Command {
    let template = format!(
        "{{about-with-newline}}\n\
         A campaign is a folder with a campaign.toml and instrument files under runs/. `ieap init FOLDER\n\
         --from FILES` makes one of your files, `ieap run FOLDER` makes its report.\n\n\
         {{usage-heading}} {{usage}}\n{}\n\nOptions of every verb:\n{{options}}\n\n\
         `ieap help VERB` says more of a verb. Exit status: 0 done, 1 a fault of the program, 2 wrong usage,\n\
         3 done but some inputs were refused, 4 the database or the disk refused, 5 an alarm.\n",
        verbs(&program, groups)
    );
    let global: Vec<String> = program
        .get_arguments()
        .filter(|option| option.is_global_set())
        .map(|option| option.get_id().to_string())
        .collect();
    let mut program = program.help_template(template);
    // Only then have the verbs the options of the program.
    program.build();
    let names: Vec<String> = program
        .get_subcommands()
        .map(|verb| verb.get_name().to_owned())
        .filter(|name| name != "help")
        .collect();
    names.iter().fold(program, |program, name| {
        program.mut_subcommand(name, |verb| {
            global
                .iter()
                .fold(verb, |verb, id| verb.mut_arg(id, |option| option.hide(true)))
                .after_help("Options of every verb: `ieap help`")
        })
    })
}

/// A heading for each group, and a line for each verb of it.
fn verbs(program: &Command, groups: Groups) -> String {
    let (mut text, mut verbs) = (String::new(), program.get_subcommands());
    for (group, count) in groups {
        text += &format!("\n{group}\n");
        for verb in verbs.by_ref().take(*count) {
            let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
            text += &format!("  {:<12} {about}\n", verb.get_name());
        }
    }
    text.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_verb_is_shown_on_one_line() {
        let program = super::super::Cli::command();
        let shown = program.get_subcommands().filter(|verb| !verb.is_hide_set());
        let text = verbs(&program, super::super::GROUPS);
        let lines = text.lines().filter(|line| line.starts_with("  "));
        let listed = lines.filter_map(|line| line.split_whitespace().next());
        assert!(listed.eq(shown.map(Command::get_name)), "{text}");
        let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > 70).collect();
        assert!(long.is_empty(), "{long:#?}");
        assert!(text.lines().all(|line| !line.ends_with(' ')), "{text}");
    }
}
