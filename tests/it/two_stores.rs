//! The database and the journal say the same, or a person is told: files that go back in time, are lost or damaged, a program
//! that was ended between the two, campaigns of earlier versions.

use std::fs;
use std::path::PathBuf;

use ieap::store::InstanceLock;

use crate::campaign::{CampaignFolder, Ended, run_table};
use crate::rebuild::{content, same, without_database};

/// A campaign of three runs, of which one is tagged by hand.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for seed in 1..4 {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["tag", "runs/1.csv", "note=wet"]).expect(0);
    folder
}

fn drops(folder: &CampaignFolder, run: &str) {
    folder.ieap(&["drop", run, "--why", "clip slipped"]).expect(0);
}

fn is_dropped(folder: &CampaignFolder, run: &str) -> bool {
    let status = folder.ieap(&["status"]);
    status
        .stdout
        .contains(&format!("{run}\n      dropped: clip slipped"))
}

fn journal(folder: &CampaignFolder) -> PathBuf {
    folder.join("archive/journal.jsonl")
}

fn run(folder: &CampaignFolder) -> Ended {
    folder.ieap(&["run", "--no-diagnose"])
}

/// The database as it is now, in one file.
fn database(folder: &CampaignFolder) -> Vec<u8> {
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    connection
        .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))
        .unwrap();
    fs::read(folder.join("campaign.db")).unwrap()
}

fn with_database(folder: &CampaignFolder, bytes: &[u8]) {
    without_database(folder.path());
    folder.write("campaign.db", bytes);
}

#[test]
fn a_rebuilding_carries_over_what_only_the_database_knows() {
    let folder = campaign();
    let older = fs::read(journal(&folder)).unwrap();
    drops(&folder, "runs/2.csv");
    run(&folder).expect(0);
    let (before, whole) = (content(&folder), fs::read(journal(&folder)).unwrap());
    let cut = &whole[..whole[..whole.len() - 1]
        .iter()
        .rposition(|&b| b == b'\n')
        .unwrap()
        + 1];
    for journal_now in [Some(&older[..]), Some(cut), Some(b""), None] {
        let _ = fs::remove_file(journal(&folder));
        if let Some(bytes) = journal_now {
            fs::write(journal(&folder), bytes).unwrap();
        }
        let rebuilt = folder.ieap(&["rebuild", "--json"]).expect(0).json();
        let carried = rebuilt["rebuild"]["of_old_database"].as_array().unwrap();
        assert!(
            carried
                .last()
                .unwrap()
                .as_str()
                .unwrap()
                .contains("runs/2.csv dropped")
        );
        same(&content(&folder), &before);
        assert!(is_dropped(&folder, "runs/2.csv"));
        folder.ieap(&["verify"]).expect(0);
    }
    assert_eq!(fs::read(journal(&folder)).unwrap(), whole);
}

#[test]
fn an_older_database_catches_up_whoever_works_on_it() {
    for verb in [&["run", "--no-diagnose"][..], &["tag", "runs/3.csv", "note=x"]] {
        let folder = campaign();
        let older = database(&folder);
        drops(&folder, "runs/2.csv");
        folder.write("runs/new.csv", run_table(9));
        fs::remove_file(folder.join("runs/3.csv")).unwrap();
        folder.ieap(&["fit", "--simultaneous"]).expect(0);
        let before = content(&folder);
        with_database(&folder, &older);
        let found = folder.ieap(&["verify", "--json"]).expect(4).json();
        assert!(found.to_string().contains("database-lags"), "{found}");
        // Who only reads tells it, and mends nothing.
        let shown = folder.ieap(&["status"]).expect(3);
        let told = folder.ieap(verb).expect(0);
        for said in [shown, told] {
            let words = "runs/2.csv dropped by tester (clip slipped)";
            assert!(said.stderr.contains(words), "{said:#?}");
        }
        assert!(is_dropped(&folder, "runs/2.csv"));
        folder.ieap(&["verify"]).expect(0);
        if verb[0] == "run" {
            same(&content(&folder), &before);
        }
    }
}

#[test]
fn a_lost_or_damaged_write_ahead_log_loses_no_word() {
    for damage in [None, Some(100)] {
        let folder = campaign();
        let reader = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
        let runs = "SELECT count(*) FROM run";
        let _: i64 = reader.query_row(runs, [], |row| row.get(0)).unwrap();
        drops(&folder, "runs/2.csv");
        let kept = ["campaign.db", "campaign.db-wal"].map(|name| fs::read(folder.join(name)).unwrap());
        drop(reader);
        with_database(&folder, &kept[0]);
        if let Some(at) = damage {
            let mut log = kept[1].clone();
            assert!(log.len() > at);
            log[at] ^= 1;
            folder.write("campaign.db-wal", log);
        }
        run(&folder).expect(0);
        assert!(is_dropped(&folder, "runs/2.csv"));
        folder.ieap(&["verify"]).expect(0);
    }
}

#[test]
fn a_database_that_lags_is_not_written_while_another_program_holds_the_campaign() {
    let folder = campaign();
    let older = database(&folder);
    drops(&folder, "runs/2.csv");
    with_database(&folder, &older);
    let lock = InstanceLock::take(folder.path()).unwrap();
    let refused = folder.ieap(&["tag", "runs/1.csv", "note=x"]).expect(4);
    assert!(refused.stderr.contains("another ieap works"), "{refused:#?}");
    let shown = folder.ieap(&["table", "table5"]).expect(3);
    assert!(shown.stderr.contains("the database lacks"), "{shown:#?}");
    drop(lock);
    run(&folder).expect(0);
    folder.ieap(&["status"]).expect(0);
    fs::remove_file(journal(&folder)).unwrap();
    let _lock = InstanceLock::take(folder.path()).unwrap();
    assert!(is_dropped(&folder, "runs/2.csv"));
}

#[test]
fn two_courses_are_refused_until_a_person_takes_one_away() {
    let folder = campaign();
    let (older, early) = (database(&folder), fs::read(journal(&folder)).unwrap());
    drops(&folder, "runs/2.csv");
    let (first, later) = (database(&folder), fs::read(journal(&folder)).unwrap());
    with_database(&folder, &older);
    fs::write(journal(&folder), early).unwrap();
    folder.ieap(&["tag", "runs/3.csv", "note=other"]).expect(0);
    let (second, other) = (database(&folder), fs::read(journal(&folder)).unwrap());
    for (database, said) in [(&first, &other), (&second, &later)] {
        with_database(&folder, database);
        fs::write(journal(&folder), said).unwrap();
        for verb in [
            &["run"][..],
            &["status"],
            &["rebuild"],
            &["tag", "runs/1.csv", "note=x"],
        ] {
            let refused = folder.ieap(verb).expect(4);
            let both = ["runs/2.csv dropped", "runs/3.csv tagged note=other"];
            assert!(
                both.iter().all(|said| refused.stderr.contains(said)),
                "{refused:#?}"
            );
        }
        assert_eq!(&fs::read(journal(&folder)).unwrap(), said);
        folder.ieap(&["verify"]).expect(4);
        assert!(errors(&folder).contains(&"journal-parted".to_owned()));
    }
    // The database is right.
    fs::rename(journal(&folder), folder.join("away")).unwrap();
    run(&folder).expect(0);
    assert!(!is_dropped(&folder, "runs/2.csv"));
    folder.ieap(&["verify"]).expect(0);
    // The journal is.
    without_database(folder.path());
    fs::write(journal(&folder), later).unwrap();
    folder.ieap(&["rebuild"]).expect(0);
    assert!(is_dropped(&folder, "runs/2.csv"));
}

#[test]
fn words_that_may_be_lost_are_told_until_a_person_answers() {
    let folder = campaign();
    drops(&folder, "runs/2.csv");
    let said = fs::read_to_string(journal(&folder)).unwrap();
    for damaged in [
        said.replace("note", "nOte"),
        said.replacen("{\"n\":2", "{\"n\":5", 1),
    ] {
        without_database(folder.path());
        fs::write(journal(&folder), damaged).unwrap();
        let told = folder.ieap(&["rebuild"]).expect(3);
        assert!(told.stderr.contains("ieap run --answer"), "{told:#?}");
        let status = folder.ieap(&["status", "--json"]).expect(3).json();
        let missed = status["status"]["words_missed"].as_array().unwrap();
        assert!(
            missed[0]["message"].as_str().unwrap().contains("checksum"),
            "{missed:?}"
        );
        run(&folder).expect(3);
        assert_eq!(errors(&folder), ["words-may-be-lost"]);
        // Another rebuilding does not forget it.
        folder.ieap(&["rebuild"]).expect(0);
        folder.ieap(&["status"]).expect(3);
        folder.ieap(&["run", "--answer", " "]).expect(2);
        let why = &["run", "--no-diagnose", "--answer", "the tag is said again"];
        let answered = folder.ieap(why).expect(0);
        assert_eq!(answered.stderr.matches("answered: ").count(), 1, "{answered:?}");
        folder.ieap(&["status"]).expect(0);
        assert_eq!(errors(&folder), Vec::<String>::new());
        folder.ieap(&["rebuild"]).expect(0);
        folder.ieap(&["status"]).expect(0);
        let nothing = folder.ieap(why).expect(0);
        assert!(nothing.stderr.contains("nothing to answer"), "{nothing:?}");
        assert!(is_dropped(&folder, "runs/2.csv"));
    }
}

/// Journal and database of yesterday agree with each other; the report knows better.
#[test]
fn words_that_both_lost_are_told_by_the_report() {
    let folder = campaign();
    let [database, journal] = [folder.join("campaign.db"), journal(&folder)];
    let before = [&database, &journal].map(|path| fs::read(path).unwrap());
    drops(&folder, "runs/2.csv");
    folder.ieap(&["report"]).expect(0);
    assert_eq!(errors(&folder), Vec::<String>::new());
    without_database(folder.path());
    fs::write(&database, &before[0]).unwrap();
    fs::write(&journal, &before[1]).unwrap();
    assert_eq!(errors(&folder), ["words-may-be-lost"]);
    // Told also when the report that knew of it is made anew.
    for _ in 0..2 {
        let told = run(&folder).expect(3);
        assert!(told.stderr.contains("both end at line 4"), "{told:?}");
    }
    let why = &["run", "--no-diagnose", "--answer", "the drop is said again"];
    folder.ieap(why).expect(0);
    run(&folder).expect(0);
    assert_eq!(errors(&folder), Vec::<String>::new());
}

/// Codes of the errors that `verify` finds.
fn errors(folder: &CampaignFolder) -> Vec<String> {
    let found = folder.ieap(&["verify", "--json"]).json();
    let parts = found["verify"]["parts"].as_array().unwrap().iter();
    let findings = parts.flat_map(|part| part["findings"].as_array().unwrap().clone());
    let errors = findings.filter(|finding| finding["severity"] == "error");
    errors
        .map(|error| error["code"].as_str().unwrap().to_owned())
        .collect()
}
