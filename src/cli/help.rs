//! What `ieap --help` shows: verbs in the order of a day's work, and the options of every verb once. A verb's own help begins with
//! an example.

use std::ffi::OsString;

use clap::Command;

/// Groups of verbs, each with the examples of its verbs in their order.
pub type Groups = &'static [(&'static str, &'static [&'static str])];

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
         {{usage-heading}} {{usage}}\n\nIn the order of a day's work:\n{}\n\nOptions of every verb:\n{{options}}\n\n\
         `ieap help VERB` says more of a verb. Exit status: 0 done, 1 a fault of the program, 2 wrong usage,\n\
         3 done but some inputs were refused, 4 the database or the disk refused, 5 an alarm.\n",
        list(&program, groups, "day")
    );
    let global: Vec<String> = program
        .get_arguments()
        .filter(|option| option.is_global_set())
        .map(|option| option.get_id().to_string())
        .collect();
    let mut program = program.help_template(template);
    // Only then have the verbs the options of the program.
    program.build();
    let examples: Vec<(String, String)> = rows(&program, groups)
        .map(|(_, verb, example)| (verb.get_name().to_owned(), example.to_owned()))
        .collect();
    examples.iter().fold(program, |program, (name, example)| {
        program.mut_subcommand(name, |verb| {
            global
                .iter()
                .fold(verb, |verb, id| verb.mut_arg(id, |option| option.hide(true)))
                .before_help(format!("    ieap {example}"))
                .after_help("Options of every verb: `ieap help`")
        })
    })
}

/// Every verb of a group with the group's name and its example.
pub fn rows(
    program: &Command,
    groups: Groups,
) -> impl Iterator<Item = (&'static str, &Command, &'static str)> {
    let examples = groups
        .iter()
        .flat_map(|(group, examples)| examples.iter().map(move |example| (*group, *example)));
    let verbs = program.get_subcommands().zip(examples);
    verbs.map(|(verb, (group, example))| (group, verb, example))
}

/// A line for each verb of a group.
pub fn list(program: &Command, groups: Groups, wanted: &str) -> String {
    let verbs = rows(program, groups).filter(|(group, ..)| *group == wanted);
    let lines = verbs.map(|(_, verb, _)| {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        format!("  {:<12} {about}", verb.get_name())
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::super::{Cli, GROUPS, words};
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_verb_is_shown_on_one_line_of_one_list() {
        let program = Cli::command();
        let shown = program.get_subcommands().filter(|verb| !verb.is_hide_set());
        let [day, rare] = ["day", "rare"].map(|group| list(&program, GROUPS, group));
        let both = format!("{day}\n{rare}");
        let listed = both.lines().filter_map(|line| line.split_whitespace().next());
        assert!(listed.eq(shown.map(Command::get_name)), "{both}");
        assert!(day.lines().count() <= 20, "{day}");
        let long: Vec<&str> = both.lines().filter(|line| line.chars().count() > 70).collect();
        assert!(long.is_empty(), "{long:#?}");
        assert!(both.lines().all(|line| !line.ends_with(' ')), "{both}");
    }

    #[test]
    fn every_example_is_one_of_its_verb() {
        let program = Cli::command();
        for (_, verb, example) in rows(&program, GROUPS) {
            let line = format!("ieap {example}").split(' ').map(OsString::from).collect();
            let found = Cli::command().try_get_matches_from(words::taken(line));
            let found = found.unwrap_or_else(|error| panic!("{example}: {error}"));
            assert_eq!(found.subcommand_name(), Some(verb.get_name()), "{example}");
        }
        let steps = rows(&program, GROUPS).filter(|(group, ..)| *group == "step");
        let own = words::STEPS.iter().filter(|step| **step != "diagnose");
        assert!(steps.map(|(_, verb, _)| verb.get_name()).eq(own.copied()));
    }
}
