//! Backups: made beside a working program, brought up to date, damaged, restored.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ieap::pipeline::backup::Backup;
use ieap::pipeline::{Context, Silent};

use crate::campaign::{CampaignFolder, command, counted, ieap, run_table};

/// A campaign with fits, a sidecar, a run sheet, tags by hand and a dropped run.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (name, seed) in [("a", 1), ("b", 2), ("c", 3)] {
        folder.write(&format!("runs/{name}.csv"), run_table(seed));
    }
    folder.write("runs/a.csv.toml", "cycle = 2\n");
    folder.write("runs/plan.csv", "planned,file,note\nP01,b,as planned\n");
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["tag", "runs/b.csv", "note=by hand"]).expect(0);
    folder
        .ieap(&["drop", "runs/c.csv", "--why", "clip slipped"])
        .expect(0);
    folder
}

/// Every file of a folder by its path, with its bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut found, mut waiting) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(below) = waiting.pop() {
        for entry in std::fs::read_dir(&below).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => waiting.push(path),
                false => {
                    found.insert(path.clone(), std::fs::read(&path).unwrap());
                }
            }
        }
    }
    found
}

/// What a campaign answers: tables, fits, what was set aside.
fn answers(folder: &Path) -> Vec<String> {
    let asked: [&[&str]; 4] = [
        &["table", "table5", "--format", "json"],
        &["table", "conditions", "--format", "csv"],
        &["export", "--what", "fits", "--json"],
        // Last: it looks into runs/, where every file of the copy is a new one of the same bytes, and notes that.
        &["fit", "--json"],
    ];
    asked
        .map(|arguments| ieap(folder, arguments).expect(0).stdout)
        .into()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn a_restored_campaign_answers_as_the_original() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let (backup, restored) = (elsewhere.path().join("backup"), elsewhere.path().join("new"));
    let made = folder.ieap(&["backup", text(&backup), "--json"]).expect(0).json();
    assert_eq!(made["schema"], "ieap/backup/1");
    let done = ieap(elsewhere.path(), &["restore", "backup", "new", "--json"])
        .expect(0)
        .json();
    assert_eq!(
        (&done["schema"], &done["restored"]["runs"]),
        (&"ieap/restore/1".into(), &3.into())
    );
    assert_eq!(answers(&restored), answers(folder.path()));
    let status = |folder: &Path| ieap(folder, &["status", "--json"]).json()["status"].clone();
    assert_eq!(status(&restored)["set_aside"], status(folder.path())["set_aside"]);
    assert!(status(folder.path())["set_aside"][0].is_object());
    for name in [
        "campaign.toml",
        "runs/tags.toml",
        "runs/a.csv.toml",
        "runs/plan.csv",
        "runs/c.csv",
    ] {
        assert_eq!(
            std::fs::read(restored.join(name)).unwrap(),
            std::fs::read(folder.join(name)).unwrap(),
            "{name}"
        );
    }
    // It is a campaign to go on with.
    std::fs::write(restored.join("runs/d.csv"), run_table(4)).unwrap();
    let taken = ieap(&restored, &["ingest", "--json"]).expect(0).json();
    assert_eq!(
        taken["ingest"]["new"],
        serde_json::json!(["runs/d.csv"]),
        "{taken}"
    );
    assert_eq!(taken["ingest"]["revised"], serde_json::json!([]), "{taken}");
}

#[test]
fn the_second_backup_copies_only_what_is_new() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    let back_up = || folder.ieap(&["backup", text(&backup), "--json"]).expect(0).json()["backup"].clone();
    let first = back_up();
    // Three runs, once each though they lie in runs/ and in the archive; campaign.toml, tags.toml, a sidecar, a sheet; the
    // journal.
    assert_eq!(first["copied"], 8, "{first}");
    let before = files(&backup.join("archive"));
    assert_eq!(back_up()["copied"], 0);
    assert_eq!(files(&backup.join("archive")), before);
    folder.write("runs/d.csv", run_table(4));
    folder.write("runs/a.csv.toml", "cycle = 3\n");
    folder.ieap(&["ingest"]).expect(0);
    let second = back_up();
    // The run, its sidecar, and the journal, which names the run.
    assert_eq!(second["copied"], 3, "{second}");
    // The sidecar and the journal as they were are in no list any more; the database is there once.
    assert_eq!(files(&backup.join("archive")).len(), before.len() + 1);
    let databases = files(&backup).into_keys().filter(|path| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        name.starts_with("campaign.db.") && name != "campaign.db.lock"
    });
    assert_eq!(databases.count(), 1);
}

#[test]
fn a_damaged_backup_is_refused_and_mended_by_a_deep_one() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let sound = files(&backup);
    let is_checked = |path: &&PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        !["campaign.db.lock", "database-id"].contains(&name)
    };
    for path in sound.keys().filter(is_checked) {
        let mut flipped = sound[path].clone();
        let middle = flipped.len() / 2;
        flipped[middle] ^= 1;
        std::fs::remove_file(path).unwrap();
        for damaged in [Some(flipped), None] {
            if let Some(bytes) = damaged {
                std::fs::write(path, bytes).unwrap();
            }
            let refused = ieap(elsewhere.path(), &["restore", "backup", "new"]);
            assert!(
                [2, 4].contains(&refused.status),
                "{}: {refused:#?}",
                path.display()
            );
            assert!(
                refused.stderr.contains("ieap backup") || refused.stderr.contains("new folder"),
                "{refused:#?}"
            );
            assert!(!elsewhere.path().join("new").exists(), "{}", path.display());
            let left = std::fs::read_dir(elsewhere.path()).unwrap().count();
            assert_eq!(left, 1, "a stump was left");
            let _ = std::fs::remove_file(path);
        }
        std::fs::write(path, &sound[path]).unwrap();
    }
    // One that is damaged, and one that is missing.
    let mut raw = sound
        .keys()
        .filter(|path| path.extension().is_some_and(|end| end == "csv"));
    let (one, other) = (raw.next().unwrap(), raw.next().unwrap());
    std::fs::remove_file(one).unwrap();
    std::fs::write(one, vec![b'x'; sound[one].len()]).unwrap();
    std::fs::remove_file(other).unwrap();
    let kept = ieap(
        elsewhere.path(),
        &["restore", "backup", "part", "--damaged", "--json"],
    )
    .expect(3)
    .json();
    // Each lies in runs/ and in the archive.
    assert!(kept["restored"]["lost"].as_array().unwrap().len() >= 2, "{kept}");
    assert!(elsewhere.path().join("part/campaign.db").exists());
    let mended = folder
        .ieap(&["backup", text(&backup), "--deep", "--json"])
        .expect(0)
        .json();
    assert_eq!(mended["backup"]["copied"], 2, "{mended}");
    ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(0);
}

#[test]
fn a_backup_touches_nothing_of_others_and_a_restore_fills_no_folder() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let thesis = elsewhere.path().join("documents/thesis.tex");
    std::fs::create_dir_all(thesis.parent().unwrap()).unwrap();
    std::fs::write(&thesis, "x").unwrap();
    let before = files(elsewhere.path());
    let refused = folder
        .ieap(&["backup", text(&elsewhere.path().join("documents"))])
        .expect(2);
    assert!(refused.stderr.contains("thesis.tex"), "{refused:#?}");
    let refused = folder.ieap(&["backup", "saved"]).expect(2);
    assert!(
        refused.stderr.contains("lost together") && !folder.join("saved").exists(),
        "{refused:#?}"
    );
    // A copy of the campaign is no backup of it, and another campaign has another database.
    let other = campaign();
    let refused = folder.ieap(&["backup", text(other.path())]).expect(2);
    assert!(refused.stderr.contains("another database"), "{refused:#?}");
    assert_eq!(files(elsewhere.path()), before);
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    other.ieap(&["backup", text(&backup)]).expect(2);
    ieap(elsewhere.path(), &["restore", "backup", "documents"]).expect(2);
    ieap(elsewhere.path(), &["restore", "documents", "new"]).expect(2);
    assert_eq!(std::fs::read(&thesis).unwrap(), b"x");
}

#[test]
fn a_damaged_database_leaves_the_earlier_backup_as_it_is() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let before = files(&backup);
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    connection
        .execute_batch("UPDATE fit_parameter SET value = value + 1")
        .unwrap();
    let refused = folder.ieap(&["backup", text(&backup)]).expect(4);
    assert!(refused.stderr.contains("was not changed"), "{refused:#?}");
    let mut after = files(&backup);
    after.retain(|path, _| !path.ends_with("campaign.db.lock"));
    assert!(after.iter().all(|(path, bytes)| before[path] == *bytes));
    ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(0);
}

/// Files come in and are stored while one backup after another is made; each is restored and holds a moment.
#[test]
fn backups_under_load_hold_a_moment_each() {
    let folder = CampaignFolder::new();
    folder.write("runs/r0.csv", run_table(0));
    folder.ieap(&["ingest"]).expect(0);
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    let mut watch = command(
        folder.path(),
        &[
            "watch",
            "--quiet-s",
            "0",
            "--poll-s",
            "0.1",
            "--no-diagnose",
            "--quiet",
        ],
    )
    .stdout(std::process::Stdio::null())
    .stderr(std::process::Stdio::null())
    .spawn()
    .unwrap();
    let mut seen = Vec::new();
    for turn in 1..=counted(4, 100) {
        for one in 0..5 {
            folder.write(
                &format!("runs/r{turn}-{one}.csv"),
                run_table((10 * turn + one) as u32),
            );
        }
        let context = Context::open_read_only(folder.path()).unwrap();
        let verb = Backup {
            folder: backup.clone(),
            deep: false,
        };
        verb.run(&context, &Silent).unwrap();
        drop(context);
        let new = format!("new-{turn}");
        let done = ieap(elsewhere.path(), &["restore", "backup", &new, "--json"])
            .expect(0)
            .json();
        seen.push(done["restored"]["runs"].as_u64().unwrap());
        // What the backup found in runs/ and the database did not know yet comes in now, once.
        let restored = elsewhere.path().join(&new);
        ieap(&restored, &["ingest"]).expect(0);
        let runs = ieap(&restored, &["status", "--json"]).json()["status"]["runs"]
            .as_u64()
            .unwrap();
        assert_eq!(runs as usize, 1 + 5 * turn, "{seen:?}");
        std::fs::remove_dir_all(restored).unwrap();
    }
    watch.kill().unwrap();
    let _ = watch.wait();
    assert!(seen.is_sorted(), "{seen:?}");
}
