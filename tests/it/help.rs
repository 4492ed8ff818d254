//! What `--help` says of the program and of each verb: a change of the command line is seen here.

use std::path::Path;

use super::campaign::command;

/// What is printed, as where no terminal says how wide it is.
fn help(words: &[&str]) -> String {
    let asked: Vec<&str> = words.iter().copied().chain(["--help"]).collect();
    let output = command(Path::new("."), &asked)
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    assert!(output.status.success(), "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The words under `Commands:`, but for clap's own `help`.
fn verbs(help: &str) -> Vec<&str> {
    let (_, list) = help.split_once("Commands:\n").unwrap_or_default();
    list.lines()
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|verb| *verb != "help")
        .collect()
}

#[test]
fn every_verb_says_what_it_does_and_takes() {
    let whole = help(&[]);
    let verbs = verbs(&whole);
    assert!(verbs.len() > 25, "{verbs:?}");
    let mut told = format!("$ ieap --help\n{whole}");
    for verb in verbs {
        let own = help(&[verb]);
        assert!(
            !own.contains("\nCommands:\n"),
            "{verb} has verbs of its own: list them too"
        );
        told += &format!("\n$ ieap {verb} --help\n{own}");
    }
    insta::assert_snapshot!("every_verb", told);
}
