//! What `--help` says of the program and of each verb: a change of the command line is seen here.

use std::path::Path;

use super::campaign::{CampaignFolder, command, ieap, run_table};

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

/// The verbs that the help of the program lists, then those that are needed rarely.
fn verbs(help: &str) -> Vec<String> {
    let (_, list) = help.split_once("\nIn the order of a day's work:\n").unwrap();
    let (list, _) = list.split_once("\n\nOptions of every verb:").unwrap();
    assert!(list.lines().count() <= 20, "{list}");
    let known = asked(&["list"]);
    let (_, rare) = known.split_once("rarely:\n").unwrap();
    let lines = list.lines().chain(rare.lines());
    lines
        .filter_map(|line| Some(line.split_whitespace().next()?.to_owned()))
        .collect()
}

#[test]
fn every_verb_says_what_it_does_and_takes() {
    let whole = help(&[]);
    let verbs = verbs(&whole);
    assert!(verbs.len() > 25, "{verbs:?}");
    assert_eq!(whole, asked(&["help"]));
    let mut told = format!("$ ieap --help\n{whole}");
    let steps = ["ingest", "fit", "dma", "impedance", "report"].map(str::to_owned);
    for verb in verbs.into_iter().chain(steps) {
        let own = help(&[&verb]);
        assert_eq!(own, asked(&["help", &verb]), "`ieap help {verb}`");
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
    for step in ["ingest", "fit", "dma", "impedance", "diagnose", "report"] {
        same(&[step, "--help"], &["run", "--only", step, "--help"]);
    }
    let shown = verbs(&help(&[]));
    for word in ["undrop", "formats", "schema", "fit", "report", "next", "drive"] {
        assert!(!shown.iter().any(|verb| verb == word), "{word}: {shown:?}");
    }
}

/// A step, the runs to make next and the voltage for a motion say under their new words what they said under the old ones.
#[test]
fn new_words_say_what_the_old_ones_said() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let same = |former: &[&str], now: &[&str]| {
        let [former, now] = [former, now].map(|words| folder.ieap(words));
        assert_eq!(former.status, now.status, "{now:?}");
        assert_eq!(former.stdout, now.stdout, "{}", now.stderr);
    };
    same(&["fit", "--json"], &["run", "--only", "fit", "--json"]);
    same(&["fit", "--group"], &["run", "--group", "--only=fit"]);
    same(&["report"], &["--color", "never", "run", "--only", "report"]);
    same(&["next", "--json"], &["plan", "--json"]);
    let strip = ["--sample", "S1", "--json"];
    let all = |words: &[&'static str]| [words, &strip[..]].concat();
    same(
        &all(&["drive", "--hold", "0.1mm", "--for", "60s"]),
        &all(&["predict", "--wanted", "0.1mm", "--for", "60s"]),
    );
    folder.write("course.csv", "time_s,tip_displacement_mm\n0,0\n30,0.1\n60,0.1\n");
    same(
        &all(&["drive", "--course", "course.csv"]),
        &all(&["predict", "--wanted", "course.csv"]),
    );
    // What does not go together is refused, and nothing is done in its place.
    for wrong in [
        &["run", "--only", "table"][..],
        &["run", "--only", "fit", "--only", "report"],
        &["plan", "--every", "1s"],
        &["plan", "--sheet", "a.csv", "--study"],
        &["plan", "--sample", "S1", "--voltage", "1V"],
        &all(&["predict", "--wanted", "0.1mm"]),
        &all(&["predict", "--wanted", "0.1mm", "--for", "60s", "--voltage", "1V"]),
        &all(&["predict", "--wanted", "course.csv", "--for", "60s"]),
        &all(&["predict", "--voltage", "1V", "--max-voltage", "2V"]),
        &all(&["predict", "--voltage", "1V", "--for", "60s"]),
        &all(&["predict", "--wanted", "0.1mm", "--for", "60s", "--at", "1s"]),
        &["plan", "--sheet", "a.csv", "--every", "1s"],
        &["plan", "--draws", "9"],
    ] {
        folder.ieap(wrong).expect(2);
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
