//! A database that is gone or damaged is made anew from archive and journal, and says the same.

use std::fs;
use std::path::Path;

use ieap::pipeline::{Context, DiagnoseChoice, DiagnoseRuns, Silent};
use ieap::store::{Content, Store};

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

/// A campaign with all that only a database holds: earlier revisions, a run that took another name, a run of two files, one
/// file under two names, deleted files, tags and words by hand, a fit that was asked for, an adopted model.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let adopted = "\n[[adopted]]\ngroup = \"sample=S1,environment=air\"\nmodel = \"lumped-2\"\n";
    folder.write("campaign.toml", CAMPAIGN_TOML.to_owned() + adopted);
    for (name, seed) in [("a", 1), ("b", 2), ("c", 3), ("deleted", 4), ("copy", 1)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.write("runs/deleted.csv.toml", "note = \"gone with its file\"\n");
    folder.write("runs/refused.csv", "no table\n");
    for (part, column) in [("current", 2), ("curvature", 3)] {
        folder.write(&format!("runs/joined.{part}.csv"), columns(&run_table(5), column));
    }
    let log = "Time,Temperature (°C),Relative Humidity (%)\n2026-01-10 08:00:00,21.0,40.0\n2026-01-10 08:01:00,21.5,41.0\n";
    folder.write("ambient/bench.csv", log);
    run(&folder);
    folder.write("runs/a.csv", run_table(6));
    fs::rename(folder.join("runs/b.csv"), folder.join("runs/moved.csv")).unwrap();
    fs::remove_file(folder.join("runs/deleted.csv")).unwrap();
    fs::remove_file(folder.join("runs/deleted.csv.toml")).unwrap();
    folder
        .ieap(&["tag", "runs/b.csv", "note=said before it was moved"])
        .expect(0);
    run(&folder);
    folder
        .ieap(&["tag", "runs/c.csv", "cycle=3", "note=wet", "--by", "ann"])
        .expect(0);
    folder
        .ieap(&["tag", "runs/c.csv", "note=", "--by", "ben"])
        .expect(0);
    folder
        .ieap(&["drop", "runs/c.csv", "--why", "clip slipped"])
        .expect(0);
    folder
        .ieap(&["drop", "runs/deleted.csv", "--why", "wet"])
        .expect(0);
    folder.ieap(&["drop", "--undo", "runs/deleted.csv"]).expect(0);
    folder.ieap(&["fit", "--simultaneous"]).expect(3);
    run(&folder);
    folder
}

fn run(folder: &CampaignFolder) {
    folder.ieap(&["run", "--no-diagnose"]).expect(3);
}

/// The time, the voltage and one more column of a table.
fn columns(table: &str, column: usize) -> String {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{},{}\n", cells[0], cells[1], cells[column])
    };
    table.lines().map(row).collect()
}

pub fn content(folder: &CampaignFolder) -> Content {
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    store.content().unwrap()
}

pub fn without_database(folder: &Path) {
    for companion in ["", "-wal", "-shm"] {
        let _ = fs::remove_file(folder.join(format!("campaign.db{companion}")));
    }
}

pub fn same(one: &Content, other: &Content) {
    assert_eq!(one.differences(other), []);
    assert_eq!(one.hash(), other.hash());
}

/// A campaign is sound, and its database comes back as it is when it is deleted.
pub fn comes_back(folder: &CampaignFolder) {
    folder.ieap(&["verify"]).expect(0);
    let before = content(folder);
    without_database(folder.path());
    let rebuilt = folder.ieap(&["rebuild"]);
    assert!([0, 3].contains(&rebuilt.status), "{rebuilt:#?}");
    same(&content(folder), &before);
}

#[test]
fn a_lost_or_broken_database_is_made_anew_and_says_the_same() {
    let folder = campaign();
    let before = content(&folder);
    without_database(folder.path());
    // One file of the folder is refused, as ever.
    let rebuilt = folder.ieap(&["rebuild"]).expect(3);
    assert!(rebuilt.stdout.contains(&before.hash()), "{rebuilt:#?}");
    same(&content(&folder), &before);
    folder.ieap(&["verify", "--deep"]).expect(0);
    let made = folder.run_json();
    assert_eq!(
        (&made["fit"]["fitted"], &made["ingest"]["new"]),
        (&0.into(), &serde_json::json!([]))
    );
    // A byte in each of its pages, its head as well.
    let mut bytes = fs::read(folder.join("campaign.db")).unwrap();
    bytes.iter_mut().step_by(4096).for_each(|byte| *byte ^= 0x55);
    without_database(folder.path());
    folder.write("campaign.db", &bytes);
    folder.ieap(&["status"]).expect(4);
    let rebuilt = folder.ieap(&["rebuild", "--json"]).expect(3).json();
    let aside = rebuilt["rebuild"]["set_aside"].as_str().unwrap();
    assert_eq!(
        fs::read(folder.join(aside)).unwrap(),
        bytes,
        "the old one is kept"
    );
    same(&content(&folder), &before);
    folder
        .ieap(&["drop", "runs/moved.csv", "--why", "it still listens"])
        .expect(0);
}

#[test]
fn a_journal_that_is_lost_is_written_from_the_database_and_serves_as_well() {
    let folder = campaign();
    let before = content(&folder);
    fs::remove_file(folder.join("archive/journal.jsonl")).unwrap();
    folder.ieap(&["verify"]).expect(4);
    run(&folder);
    folder.ieap(&["verify"]).expect(0);
    without_database(folder.path());
    folder.ieap(&["rebuild"]).expect(3);
    same(&content(&folder), &before);
}

#[test]
fn findings_come_again_as_they_were() {
    let folder = CampaignFolder::new();
    for seed in [1, 2] {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let diagnose = || {
        let choice = DiagnoseChoice {
            draws: Some(20),
            ..DiagnoseChoice::default()
        };
        let diagnosis = DiagnoseRuns {
            choice,
            ..DiagnoseRuns::default()
        };
        let mut context = Context::open(folder.path(), false).unwrap();
        diagnosis.run(&mut context, &Silent).unwrap();
    };
    diagnose();
    let before = content(&folder);
    without_database(folder.path());
    folder.ieap(&["rebuild"]).expect(0);
    let kinds = |content: &Content| -> Vec<&str> {
        let differ = before.differences(content).into_iter();
        differ.map(|(kind, _)| kind).collect()
    };
    let lacking = kinds(&content(&folder));
    assert!(
        !lacking.is_empty() && lacking.iter().all(|kind| *kind == "diagnosis"),
        "{lacking:?}"
    );
    diagnose();
    same(&content(&folder), &before);
}

#[test]
fn what_cannot_come_back_is_named_and_the_rest_comes() {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a", 1), ("b", 2), ("c", 3)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    for name in ["b", "c"] {
        let hash = blake3::hash(&fs::read(folder.join(&format!("runs/{name}.csv"))).unwrap())
            .to_hex()
            .to_string();
        fs::remove_file(folder.join(&format!("archive/{}/{hash}.csv", &hash[..2]))).unwrap();
    }
    // Of b neither the archive nor the folder has the bytes; of c the folder has them.
    fs::remove_file(folder.join("runs/b.csv")).unwrap();
    without_database(folder.path());
    let rebuilt = folder.ieap(&["rebuild", "--json"]).expect(3).json();
    let lost = rebuilt["rebuild"]["lost"].as_array().unwrap();
    assert_eq!((lost.len(), lost[0][0].as_str()), (1, Some("runs/b.csv")));
    assert_eq!(rebuilt["rebuild"]["runs"], 2);
    let said = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(said.stdout.contains("fits: 0 new, 2 up to date"), "{said:?}");
    assert!(said.stderr.contains("runs/b.csv did not come back"), "{said:?}");
    folder
        .ieap(&["run", "--no-diagnose", "--answer", "it is gone"])
        .expect(0);
}

#[test]
fn a_rebuilding_that_was_cut_short_is_begun_again_and_a_file_of_somebody_stays() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.write(".ieap-rebuild/campaign.db", "half of one");
    folder.ieap(&["rebuild"]).expect(0);
    assert!(!folder.join(".ieap-rebuild").exists());
    // Whoever works next removes what one left that was killed.
    folder.write(".ieap-rebuild/campaign.db", "half of one");
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(!folder.join(".ieap-rebuild").exists());
    folder.write(".ieap-rebuild/thesis.tex", "mine");
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let refused = folder.ieap(&["rebuild"]).expect(4);
    assert!(refused.stderr.contains("not written by ieap"), "{refused:?}");
    assert_eq!(
        fs::read_to_string(folder.join(".ieap-rebuild/thesis.tex")).unwrap(),
        "mine"
    );
}

/// The run kept the name of who said it first, until a rebuilding.
#[test]
fn a_tag_that_is_said_again_is_told_as_said_last() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    for by in ["ann", "ben"] {
        folder
            .ieap(&["tag", "runs/a.csv", "note=wet", "--by", by])
            .expect(0);
    }
    let before = content(&folder);
    folder.ieap(&["rebuild"]).expect(0);
    same(&content(&folder), &before);
}

/// Whatever the reason: it may have held words that nothing else does. What was there is kept beside the new one, also where two
/// are set aside in one second.
#[test]
fn an_old_database_that_cannot_be_read_is_a_loss_that_is_said() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["tag", "runs/a.csv", "note=said"]).expect(0);
    let mut aside = Vec::new();
    for text in [
        "no database at all, only some text",
        "another text, of another length",
    ] {
        without_database(folder.path());
        folder.write("campaign.db", text);
        let rebuilt = folder.ieap(&["rebuild", "--json"]).expect(3).json();
        let told = &rebuilt["rebuild"]["journal"];
        assert_eq!(told[0]["code"], "old-database-not-read", "{told}");
        let moved = rebuilt["rebuild"]["set_aside"].as_str().unwrap().to_owned();
        assert_eq!(fs::read_to_string(&moved).unwrap(), text);
        aside.push(moved);
        // It is said until a person looked.
        folder.ieap(&["status"]).expect(3);
        folder
            .ieap(&["run", "--no-diagnose", "--answer", "all tags are there"])
            .expect(0);
        let tags = folder.ieap(&["tag", "runs/a.csv", "cycle=1"]).expect(0);
        assert!(tags.stdout.contains("note = said"), "{tags:?}");
        folder.ieap(&["run", "--no-diagnose"]).expect(0);
    }
    assert_ne!(aside[0], aside[1]);
}
