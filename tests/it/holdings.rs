//! A database or an archive that is gone, foreign or damaged is noticed, said, and never written over.

use std::fs;
use std::path::Path;

use serde_json::json;

use crate::campaign::{CampaignFolder, run_table};
#[cfg(unix)]
use crate::watch::Watching;

/// A campaign with two runs and a report.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder
}

/// Takes the database with its companions away; gives its bytes.
fn without_database(folder: &CampaignFolder) -> Vec<u8> {
    let bytes = fs::read(folder.join("campaign.db")).unwrap();
    for companion in ["", "-wal", "-shm"] {
        let _ = fs::remove_file(folder.join(&format!("campaign.db{companion}")));
    }
    bytes
}

/// The only raw file that was archived from these bytes.
fn blob_of(folder: &CampaignFolder, bytes: &[u8]) -> std::path::PathBuf {
    let hash = blake3::hash(bytes).to_hex().to_string();
    folder.join(&format!("archive/{}/{hash}.csv", &hash[..2]))
}

/// Writes over a raw file, which nobody may write to.
fn overwrite(path: &Path, bytes: &[u8]) {
    fs::remove_file(path).unwrap();
    fs::write(path, bytes).unwrap();
}

fn lost_in_status(folder: &CampaignFolder) -> usize {
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    status["status"]["raw_files_lost"].as_array().unwrap().len()
}

#[test]
fn a_lost_or_emptied_database_is_refused_and_the_report_stays() {
    let folder = campaign();
    let report = folder.report("index.html");
    let good = without_database(&folder);
    for left in [None, Some(&b""[..]), Some(&b"S"[..])] {
        if let Some(bytes) = left {
            folder.write("campaign.db", bytes);
        }
        for verb in [
            &["run", "--no-diagnose"][..],
            &["fit"],
            &["status"],
            &["table", "runs"],
            &["export"],
        ] {
            let refused = folder.ieap(verb).expect(4);
            assert!(refused.stderr.contains("--new-database"), "{verb:?} {refused:?}");
        }
        folder.ieap(&["tag", "runs/a.csv", "note=x"]).expect(4);
        assert_eq!(fs::read(folder.join("campaign.db")).ok().as_deref(), left);
        assert_eq!(folder.report("index.html"), report);
    }
    folder.write("campaign.db", good);
    assert_eq!(folder.run_json()["ingest"]["new"], json!([]));
}

#[test]
fn a_new_database_is_made_where_it_is_asked_for_and_the_old_one_is_kept() {
    let folder = campaign();
    folder.write("campaign.db", "");
    let ended = folder.ieap(&["run", "--no-diagnose", "--new-database"]).expect(0);
    assert!(ended.stderr.contains("tags set by hand"), "{}", ended.stderr);
    assert!(ended.stdout.contains("2 new"), "{}", ended.stdout);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let aside = fs::read_dir(folder.path()).unwrap().flatten();
    let aside = aside.filter(|entry| entry.file_name().to_string_lossy().contains("set-aside"));
    assert!(aside.count() > 0);
}

#[test]
fn raw_files_or_a_report_alone_say_that_there_was_a_database() {
    let folder = campaign();
    without_database(&folder);
    fs::remove_file(folder.join("archive/database-id")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(4);
    fs::remove_dir_all(folder.join("archive")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(4);
    fs::remove_dir_all(folder.join("report")).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
}

#[test]
fn the_database_of_another_campaign_is_noticed() {
    let (one, other) = (campaign(), campaign());
    without_database(&one);
    fs::copy(other.join("campaign.db"), one.join("campaign.db")).unwrap();
    let refused = one.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(
        refused.stderr.contains("archive/database-id"),
        "{}",
        refused.stderr
    );
    fs::remove_file(one.join("archive/database-id")).unwrap();
    fs::remove_file(one.join("archive/journal.jsonl")).unwrap();
    one.ieap(&["run", "--no-diagnose"]).expect(0);
}

#[test]
fn an_absent_archive_is_noticed_and_made_anew_where_it_is_asked_for() {
    let folder = campaign();
    fs::remove_dir_all(folder.join("archive")).unwrap();
    let refused = folder.ieap(&["run", "--no-diagnose"]).expect(4);
    assert!(refused.stderr.contains("--new-archive"), "{}", refused.stderr);
    assert!(!folder.join("archive").exists());
    assert_eq!(lost_in_status(&folder), 2);
    fs::remove_file(folder.join("runs/b.csv")).unwrap();
    let ended = folder.ieap(&["run", "--no-diagnose", "--new-archive"]).expect(3);
    assert!(ended.stderr.contains("runs/b.csv"), "{}", ended.stderr);
    assert_eq!(lost_in_status(&folder), 1);
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(text.contains("1 raw file lost from the archive"), "{text}");
    folder.write("runs/b.csv", run_table(2));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert_eq!(lost_in_status(&folder), 0);
}

#[test]
fn a_broken_raw_file_is_whole_again_when_the_original_is_read_again() {
    let folder = campaign();
    let (table, blob) = (run_table(1), blob_of(&folder, run_table(1).as_bytes()));
    let mut flipped = table.clone().into_bytes();
    flipped[100] ^= 1;
    overwrite(&blob, &flipped);
    // The same bytes under another name.
    folder.write("runs/copy.csv", &table);
    let ended = folder.ieap(&["run", "--no-diagnose", "--json"]).expect(0);
    assert!(ended.stderr.contains("whole again"), "{}", ended.stderr);
    assert_eq!(
        ended.json()["run"]["ingest"]["mended"].as_array().unwrap().len(),
        1
    );
    assert_eq!(fs::read(&blob).unwrap(), table.as_bytes());
    // Gone, and the original touched.
    fs::remove_file(&blob).unwrap();
    assert_eq!(lost_in_status(&folder), 1);
    folder.write("runs/a.csv", &table);
    assert_eq!(folder.run_json()["ingest"]["mended"].as_array().unwrap().len(), 1);
    assert_eq!(fs::read(&blob).unwrap(), table.as_bytes());
}

#[cfg(unix)]
#[test]
fn a_watch_whose_database_is_taken_away_or_replaced_ends_and_says_so() {
    for replaced in [false, true] {
        let folder = CampaignFolder::new();
        folder.write("runs/a.csv", run_table(1));
        let mut watching = Watching::start(&folder, &["--poll-s", "0.2"]);
        crate::watch::until("the first run", || crate::watch::fitted(&folder) == 1);
        let bytes = without_database(&folder);
        if replaced {
            folder.write("campaign.db", bytes);
        }
        folder.write("runs/b.csv", run_table(2));
        let (status, said) = watching.end();
        assert_eq!(status, 4, "{said}");
        assert!(said.contains("deleted or replaced"), "{said}");
    }
}
