//! `ieap verify` finds what is lost or damaged, and says how to mend it.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::campaign::{CampaignFolder, forge, forge_results, run_table};

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a", 1), ("b", 2)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["tag", "runs/a.csv", "note=by hand"]).expect(0);
    folder
}

/// Codes of all errors that are found, each of which says how to mend it, and the exit status.
fn found(folder: &CampaignFolder, options: &[&str]) -> (i32, Vec<String>) {
    let ended = folder.ieap(&[&["verify", "--json"], options].concat());
    let parts = ended.json()["verify"]["parts"].as_array().unwrap().clone();
    let findings = parts
        .iter()
        .flat_map(|part| part["findings"].as_array().unwrap().clone());
    let errors: Vec<Value> = findings.filter(|found| found["severity"] == "error").collect();
    for error in &errors {
        let says = |field: &str| error[field].as_str().unwrap().contains("ieap ");
        assert!(says("mend") || says("message"), "{error}");
    }
    let codes = errors
        .iter()
        .map(|error| error["code"].as_str().unwrap().to_owned());
    (ended.status, codes.collect())
}

fn is_sound(folder: &CampaignFolder) {
    assert_eq!(found(folder, &[]), (0, Vec::new()));
}

fn blob(folder: &CampaignFolder, seed: u32) -> PathBuf {
    let hash = blake3::hash(run_table(seed).as_bytes()).to_hex().to_string();
    folder.join(&format!("archive/{}/{hash}.csv", &hash[..2]))
}

fn change(folder: &CampaignFolder, sql: &str) {
    rusqlite::Connection::open(folder.join("campaign.db"))
        .unwrap()
        .execute_batch(sql)
        .unwrap();
}

#[test]
fn a_raw_file_that_is_lost_or_changed_is_found_and_the_original_mends_it() {
    let folder = campaign();
    is_sound(&folder);
    let (path, whole) = (blob(&folder, 1), run_table(1).into_bytes());
    let mut flipped = whole.clone();
    flipped[200] ^= 1;
    for left in [None, Some(&flipped)] {
        let _ = fs::remove_file(&path);
        if let Some(bytes) = left {
            fs::write(&path, bytes).unwrap();
        }
        assert_eq!(found(&folder, &[]), (4, vec!["raw-file-lost".to_owned()]));
        folder.write("runs/a.csv", &whole);
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
        is_sound(&folder);
    }
}

#[test]
fn a_number_that_changed_is_found_and_a_rebuilding_mends_it() {
    let folder = campaign();
    change(
        &folder,
        "UPDATE result SET document = replace(document, '\"value\":', '\"value\":1')",
    );
    let (status, codes) = found(&folder, &[]);
    assert_eq!((status, codes[0].as_str()), (4, "database-damaged"));
    folder.ieap(&["rebuild"]).expect(0);
    is_sound(&folder);
    fs::write(
        folder.join("campaign.db"),
        "no database at all, only some text that is long enough",
    )
    .unwrap();
    let (status, codes) = found(&folder, &[]);
    assert_eq!((status, codes[0].as_str()), (4, "database-not-opened"));
}

#[test]
fn what_is_sealed_and_wrong_is_found_by_deriving_it_again() {
    let is_found = |folder: &CampaignFolder, code: &str| {
        folder.ieap(&["report"]).expect(0);
        let (status, codes) = found(folder, &["--deep"]);
        assert_eq!(status, 4);
        assert!(codes.iter().any(|found| found == code), "{codes:?}");
    };
    let folder = campaign();
    assert_eq!(found(&folder, &["--deep"]), (0, Vec::new()));
    forge_results(folder.path(), "fit", |document| {
        let value = &mut document["found"]["parameters"][0]["estimate"]["value"];
        *value = (value.as_f64().unwrap() * 1.0000001).into();
    });
    is_found(&folder, "result-differs");
    let folder = campaign();
    forge(
        folder.path(),
        "UPDATE run SET reading = replace(reading, (SELECT hash FROM run_file WHERE path = 'runs/a.csv'),
             (SELECT hash FROM run_file WHERE path = 'runs/b.csv')) WHERE path = 'runs/a.csv'",
    );
    is_found(&folder, "readings-differ");
}

#[test]
fn a_journal_that_is_gone_damaged_or_says_something_else_is_found() {
    let folder = campaign();
    let path = folder.join("archive/journal.jsonl");
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    fs::remove_file(&path).unwrap();
    assert_eq!(found(&folder, &[]).1, ["no-journal"]);
    fs::write(&path, whole.replacen("by hand", "by haNd", 1)).unwrap();
    assert_eq!(found(&folder, &[]).1, ["journal-damaged", "journal-lags"]);
    fs::write(&path, lines[1..].concat()).unwrap();
    assert_eq!(found(&folder, &[]).1, ["journal-lines-missing", "journal-lags"]);
    // Half a line is a program that was killed.
    fs::write(&path, whole.clone() + "{\"n\":9").unwrap();
    is_sound(&folder);
    fs::write(&path, &whole).unwrap();
    is_sound(&folder);
    // What is damaged is made anew from the database, as the finding says.
    fs::write(&path, "\n").unwrap();
    assert_eq!(found(&folder, &[]).0, 4);
    fs::remove_file(&path).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    is_sound(&folder);
}

#[test]
fn a_page_of_the_report_that_is_gone_is_found() {
    let folder = campaign();
    folder.ieap(&["report"]).expect(0);
    is_sound(&folder);
    fs::remove_file(folder.join("report/index.html")).unwrap();
    assert_eq!(found(&folder, &[]), (4, vec!["report-file-missing".to_owned()]));
    folder.write("report/index.html", "another page");
    assert_eq!(found(&folder, &[]), (4, vec!["report-file-changed".to_owned()]));
    folder.ieap(&["report", "--again"]).expect(0);
    is_sound(&folder);
}

#[test]
fn raw_files_are_looked_for_after_a_disorderly_end() {
    let folder = campaign();
    fs::remove_file(blob(&folder, 2)).unwrap();
    let quiet = folder.ieap(&["report"]).expect(0);
    assert!(!quiet.stderr.contains("disorderly"), "{}", quiet.stderr);
    folder.write("campaign.db.lock", "process 1 on another\n");
    let told = folder.ieap(&["report"]).expect(0);
    assert!(
        told.stderr.contains("disorderly") && told.stderr.contains("it is not in the archive"),
        "{}",
        told.stderr
    );
}

/// The report is what people look at: a number in it that nobody computed is found, and made anew.
#[test]
fn a_report_that_was_changed_is_damage_and_is_made_anew() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let path = folder.join("report/table5.csv");
    let sound = std::fs::read(&path).unwrap();
    let again = folder.ieap(&["report"]).expect(0);
    assert!(again.stdout.contains("(unchanged)"), "{again:#?}");
    let names = std::fs::read_to_string(folder.join("report/.written")).unwrap();
    assert!(names.lines().count() > 10, "{names}");
    let mut flips = 0;
    for name in names
        .lines()
        .map(|line| line.split_once("  ").unwrap().1)
        .chain([".written"])
    {
        let path = folder.join("report").join(name);
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let verified = folder.ieap(&["verify", "--json"]).expect(4).json();
        let report = &verified["verify"]["parts"]
            .as_array()
            .unwrap()
            .iter()
            .find(|part| part["part"] == "report")
            .unwrap()["findings"];
        assert_eq!(report[0]["severity"], "error", "{name}: {report}");
        if name != ".written" {
            assert_eq!(report[0]["place"], format!("report/{name}"));
        }
        let made = folder.ieap(&["report", "--json"]);
        let document = made.json();
        match made.status {
            0 => assert_eq!(document["report"]["rendered"], true),
            // A name in the list that is no name of a file: whose the file is nobody knows.
            _ => assert!(name == ".written" && document["report"]["refused"].is_string()),
        }
        flips += 1;
    }
    assert!(flips > 10);
    assert_eq!(std::fs::read(&path).unwrap(), sound);
}

#[test]
fn a_report_without_hashes_of_an_earlier_version_is_made_anew_once() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let list = folder.join("report/.written");
    let names = std::fs::read_to_string(&list).unwrap();
    let names: String = names
        .lines()
        .map(|line| format!("{}\n", line.split_once("  ").unwrap().1))
        .collect();
    std::fs::write(&list, names).unwrap();
    folder.ieap(&["verify"]).expect(0);
    assert!(!folder.ieap(&["report"]).expect(0).stdout.contains("(unchanged)"));
    assert!(folder.ieap(&["report"]).expect(0).stdout.contains("(unchanged)"));
}

#[test]
fn a_result_of_no_run_is_found_and_runs_that_wait_for_results_are_told_and_no_damage() {
    let folder = campaign();
    folder.write("runs/c.csv", run_table(3));
    folder.ieap(&["ingest"]).expect(0);
    let told = folder.ieap(&["verify", "--json"]).expect(0);
    assert!(told.stdout.contains("result-waits"), "{told:#?}");
    assert!(told.stdout.contains("runs/c.csv waits for the fit"), "{told:#?}");
    forge(
        folder.path(),
        "UPDATE run SET superseded_at = '2026-01-02T00:00:00Z' WHERE path = 'runs/a.csv'",
    );
    let (status, codes) = found(&folder, &[]);
    assert_eq!(status, 4);
    assert!(codes.contains(&"result-stray".to_owned()), "{codes:?}");
    folder.ieap(&["rebuild"]).expect(0);
    is_sound(&folder);
}
