//! Conventions of the terminal: where a verb works, what goes to stdout, colours, man pages, completions, widths, commas.

use std::path::Path;

use crate::campaign::{CampaignFolder, Ended, command, ieap, run_table};

fn with_environment(folder: &Path, words: &[&str], variables: &[(&str, &str)]) -> Ended {
    let mut command = command(folder, words);
    command.envs(variables.iter().copied());
    let output = command.output().unwrap();
    Ended {
        status: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

fn fitted() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.run_json();
    folder
}

#[test]
fn before_the_verb_the_folder_is_where_it_works() {
    let folder = fitted();
    let elsewhere = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let there = ieap(elsewhere.path(), &["-C", path, "status"]).expect(0);
    assert_eq!(there.stdout, folder.ieap(&["status"]).stdout);
    ieap(elsewhere.path(), &["-C", path, "inspect", "runs/a.csv"]).expect(0);
    ieap(
        elsewhere.path(),
        &["-C", path, "table", "fits-wide", "-o", "fits.tex"],
    )
    .expect(0);
    assert!(folder.join("fits.tex").is_file(), "files go there too");
    let refused = ieap(elsewhere.path(), &["-C", "nowhere", "status"]).expect(2);
    assert!(refused.stderr.contains("nowhere"), "{refused:?}");
}

#[test]
fn a_dash_is_stdout() {
    let folder = fitted();
    let table = folder
        .ieap(&["table", "fits-wide", "--format", "csv"])
        .expect(0)
        .stdout;
    assert_eq!(
        folder
            .ieap(&["table", "fits-wide", "--format", "csv", "-o", "-"])
            .stdout,
        table
    );
    let export = folder.ieap(&["export", "--what", "fits", "-o", "-"]).expect(0);
    assert!(export.stdout.starts_with("run,sample,material"), "{export:?}");
    assert!(export.stderr.contains("rows"), "{export:?}");
    assert!(!folder.join("-").exists());
    let parquet = folder
        .ieap(&["export", "-o", "-", "--format", "parquet"])
        .expect(0);
    assert!(parquet.stdout.starts_with("PAR1"));
    folder.ieap(&["export", "-o", "-", "--json"]).expect(2);
    folder.ieap(&["export", "--what", "all", "-o", "-"]).expect(2);
}

#[test]
fn colours_are_for_people_and_only_where_wanted() {
    let folder = fitted();
    let plain = with_environment(folder.path(), &["fit"], &[]);
    assert!(!plain.stdout.contains('\u{1b}'), "no terminal, no colours");
    let coloured = with_environment(folder.path(), &["--color", "always", "fit"], &[("NO_COLOR", "1")]);
    assert!(coloured.stdout.contains("\u{1b}[1m"), "said in so many words");
    let refused = with_environment(folder.path(), &["--color=always", "table", "nothing"], &[]);
    assert!(
        refused.stderr.contains("\u{1b}[1;31merror:\u{1b}[0m"),
        "{refused:?}"
    );
    let help = with_environment(folder.path(), &["--color", "always", "--help"], &[]);
    assert!(help.stdout.contains('\u{1b}'), "help too");
    let document = with_environment(folder.path(), &["--color", "always", "fit", "--json"], &[]);
    assert!(!document.stdout.contains('\u{1b}'), "never in what machines read");
    folder.ieap(&["--color", "red", "fit"]).expect(2);
}

#[test]
fn man_pages_are_printed_and_installed() {
    let home = tempfile::tempdir().unwrap();
    let data = home.path().to_str().unwrap();
    let printed = ieap(home.path(), &["man", "fit"]).expect(0).stdout;
    assert!(
        printed.contains(".TH ieap-fit 1") && printed.contains("\\-\\-json"),
        "{printed}"
    );
    let install = |words: &[&str]| with_environment(home.path(), words, &[("XDG_DATA_HOME", data)]);
    install(&["man", "--install"]).expect(0);
    let page = home.path().join("man/man1/ieap-fit.1");
    assert_eq!(std::fs::read_to_string(&page).unwrap(), printed);
    assert!(home.path().join("man/man1/ieap.1").is_file());
    let again = install(&["man", "--install"]).expect(2);
    assert!(again.stderr.contains("--overwrite"), "{again:?}");
    install(&["man", "--install", "--overwrite"]).expect(0);
    ieap(home.path(), &["man", "nothing"]).expect(2);
}

#[test]
fn completions_are_installed_where_the_shell_looks() {
    let home = tempfile::tempdir().unwrap();
    let data = home.path().to_str().unwrap();
    let variables = [
        ("XDG_DATA_HOME", data),
        ("XDG_CONFIG_HOME", data),
        ("SHELL", "/bin/bash"),
    ];
    let install = |words: &[&str]| with_environment(home.path(), words, &variables);
    install(&["completions", "--install"]).expect(0);
    let script = std::fs::read_to_string(home.path().join("bash-completion/completions/ieap")).unwrap();
    assert_eq!(script, ieap(home.path(), &["completions", "bash"]).stdout);
    install(&["completions", "fish", "--install"]).expect(0);
    assert!(home.path().join("fish/completions/ieap.fish").is_file());
    install(&["completions", "zsh", "--install"]).expect(0);
    assert!(home.path().join("zsh/site-functions/_ieap").is_file());
    install(&["completions", "powershell", "--install"]).expect(2);
}

#[test]
fn a_table_has_the_columns_that_are_asked_for_and_fits_its_lines() {
    let folder = fitted();
    let csv = folder
        .ieap(&[
            "table",
            "fits-wide",
            "--columns",
            "alpha_per_c_cm,run",
            "--format",
            "csv",
        ])
        .expect(0)
        .stdout;
    assert!(
        csv.starts_with("alpha_per_c_cm,alpha_per_c_cm_standard_error,"),
        "{csv}"
    );
    assert!(csv.lines().next().unwrap().ends_with(",run,notes"), "{csv}");
    let refused = folder
        .ieap(&["table", "fits-wide", "--columns", "nothing"])
        .expect(2);
    assert!(
        refused.stderr.contains("alpha_per_c_cm"),
        "lists what there is: {refused:?}"
    );
    let wide = folder.ieap(&["table", "fits-wide"]).expect(0).stdout;
    let narrow = folder
        .ieap(&["table", "fits-wide", "--width", "60"])
        .expect(0)
        .stdout;
    let blocks = |text: &str| text.lines().filter(|line| line.starts_with('─')).count();
    assert_eq!(blocks(&wide), 1);
    assert!(blocks(&narrow) > 1, "{narrow}");
    let ruled = narrow.lines().filter(|line| line.starts_with('─'));
    assert!(
        ruled.map(|line| line.chars().count()).all(|width| width <= 60),
        "{narrow}"
    );
}

#[test]
fn a_decimal_comma_is_for_csv_and_numbers_stay_what_they_are() {
    let folder = fitted();
    let point = folder
        .ieap(&["export", "--what", "fits", "-o", "-"])
        .expect(0)
        .stdout;
    let comma = folder
        .ieap(&["export", "--what", "fits", "-o", "-", "--decimal-comma"])
        .expect(0)
        .stdout;
    let read = |text: &str, delimiter: u8| -> Vec<csv::StringRecord> {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .from_reader(text.as_bytes());
        reader.records().map(Result::unwrap).collect()
    };
    let (point, comma) = (read(&point, b','), read(&comma, b';'));
    assert!(point.len() > 5 && point.len() == comma.len());
    for (with_point, with_comma) in point.iter().zip(&comma) {
        for (one, other) in with_point.iter().zip(with_comma) {
            let number = |text: &str| text.parse::<f64>().ok();
            match number(one) {
                Some(value) => assert_eq!(number(&other.replace(',', ".")), Some(value)),
                None => assert_eq!(one, other),
            }
        }
    }
    assert!(comma.iter().flatten().any(|field| field.contains(',')));
    let table = folder
        .ieap(&["table", "fits-wide", "--decimal-comma"])
        .expect(0)
        .stdout;
    assert!(table.lines().next().unwrap().contains(';'), "{table}");
    folder
        .ieap(&["table", "fits-wide", "--decimal-comma", "--format", "latex"])
        .expect(2);
    folder
        .ieap(&["export", "-o", "fits.parquet", "--decimal-comma"])
        .expect(2);
}
