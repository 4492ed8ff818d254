//! What `--help` says of the program and of each verb: a change of the command line is seen here.

use std::path::Path;

use super::campaign::{CampaignFolder, command, ieap};

fn help(words: &[&str]) -> String {
    asked(&[words, &["--help"]].concat())
}

/// What is printed, as where no terminal says how wide it is.
fn asked(words: &[&str]) -> String {
    let output = command(Path::new("."), words)
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    assert!(output.status.success(), "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The verbs that the help of the program lists, in its order: indented by two, under a group's name.
fn verbs(help: &str) -> Vec<&str> {
    let (_, list) = help.split_once("\nstart\n").unwrap();
    let (list, _) = list.split_once("\nOptions of every verb:").unwrap();
    list.lines()
        .filter(|line| line.starts_with("  "))
        .filter_map(|line| line.split_whitespace().next())
        .collect()
}

#[test]
fn every_verb_says_what_it_does_and_takes() {
    let whole = help(&[]);
    let verbs = verbs(&whole);
    assert!(verbs.len() > 25, "{verbs:?}");
    assert_eq!(whole, asked(&["help"]));
    let mut told = format!("$ ieap --help\n{whole}");
    for verb in verbs {
        let own = help(&[verb]);
        assert_eq!(own, asked(&["help", verb]), "`ieap help {verb}`");
        // They stand in the help of the program, once.
        assert!(!own.contains("--no-progress"), "{own}");
        assert!(
            !own.contains("\nCommands:\n"),
            "{verb} has verbs of its own: list them too"
        );
        told += &format!("\n$ ieap {verb} --help\n{own}");
    }
    insta::assert_snapshot!("every_verb", told);
}

/// Words of earlier versions go on working, and no help shows them.
#[test]
fn former_words_mean_what_they_meant() {
    let here = Path::new(".");
    let same = |former: &[&str], now: &[&str]| {
        let [former, now] = [former, now].map(|words| ieap(here, words).expect(0).stdout);
        assert_eq!(former, now);
    };
    same(&["formats"], &["list", "formats"]);
    same(&["models", "--json"], &["list", "models", "--json"]);
    same(
        &["effects", "faradaic-leak"],
        &["list", "effects", "faradaic-leak"],
    );
    same(&["schema", "fits"], &["list", "schemas", "fits"]);
    same(&["table"], &["list", "tables"]);
    same(&["figure"], &["list", "figures"]);
    let whole = help(&[]);
    for word in ["undrop", "  formats", "  schema"] {
        assert!(!whole.contains(word), "{word}: {whole}");
    }
}

/// `-C` is the folder to work in, wherever it stands.
#[test]
fn one_option_names_the_folder() {
    let folder = CampaignFolder::new();
    let path = folder.path().to_str().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let told = |words: &[&str]| ieap(elsewhere.path(), words).expect(0).stdout;
    let here = folder.ieap(&["status"]).expect(0).stdout;
    assert_eq!(told(&["-C", path, "status"]), here);
    assert_eq!(told(&["status", "-C", path]), here);
    assert_eq!(told(&["status", path]), here);
}
