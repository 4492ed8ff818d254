//! Backups: made beside a working program, brought up to date, damaged, restored.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ieap::pipeline::upkeep::backup::{Backup, KEEP};
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
            if path.is_dir() {
                waiting.push(path)
            } else {
                found.insert(path.clone(), std::fs::read(&path).unwrap());
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
    // The sidecar and the journal as they were stay, for the earlier lists name them.
    assert_eq!(files(&backup.join("archive")).len(), before.len() + 3);
    assert_eq!(second["earlier"].as_array().unwrap().len(), 2, "{second}");
}

/// Names in the folder of a backup that begin so.
fn named(backup: &Path, prefix: &str) -> Vec<String> {
    let names = std::fs::read_dir(backup).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut named: Vec<String> = names.filter(|name| name.starts_with(prefix)).collect();
    named.sort();
    named
}

#[test]
fn as_many_backups_as_asked_for_can_be_restored_and_no_more_is_kept() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    let mut sizes = Vec::new();
    for turn in 1..=5 {
        folder.write("runs/a.csv.toml", format!("cycle = {turn}\n"));
        folder.ieap(&["ingest"]).expect(0);
        folder.ieap(&["backup", text(&backup), "--keep", "3"]).expect(0);
        sizes.push(files(&backup.join("archive")).len());
    }
    let lists = named(&backup, "backup-");
    assert_eq!(lists.len(), 3, "{lists:?}");
    let databases: Vec<String> = named(&backup, "campaign.db.");
    assert_eq!(databases.iter().filter(|name| !name.ends_with("lock")).count(), 3);
    // A sidecar more each, until the oldest goes with its list.
    assert_eq!(
        sizes.iter().map(|size| size - sizes[0]).collect::<Vec<_>>(),
        [0, 1, 2, 2, 2]
    );
    for (turn, list) in (3..).zip(&lists) {
        let new = format!("new-{turn}");
        ieap(elsewhere.path(), &["restore", &format!("backup/{list}"), &new]).expect(0);
        let sidecar = std::fs::read_to_string(elsewhere.path().join(&new).join("runs/a.csv.toml")).unwrap();
        assert_eq!(sidecar, format!("cycle = {turn}\n"));
    }
    folder.ieap(&["backup", text(&backup), "--keep", "0"]).expect(2);
    let only = folder
        .ieap(&["backup", text(&backup), "--keep", "1", "--json"])
        .expect(0)
        .json();
    assert_eq!(only["backup"]["earlier"], serde_json::json!([]));
    assert_eq!(named(&backup, "backup-").len(), 1);
    ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(0);
}

/// Changes the list of a backup, and its checksum with it.
fn forged(backup: &Path, change: impl Fn(&mut serde_json::Value)) {
    let path = backup.join("backup.json");
    let mut list: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    change(&mut list["backup"]);
    let hash = blake3::hash(list["backup"].to_string().as_bytes())
        .to_hex()
        .to_string();
    list["checksum"] = hash.into();
    std::fs::write(path, list.to_string()).unwrap();
}

#[test]
fn a_forged_list_writes_nothing_outside_of_the_new_folder() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let sound = std::fs::read(backup.join("backup.json")).unwrap();
    let before = files(elsewhere.path());
    let outside = elsewhere.path().join("outside").display().to_string();
    let paths = [
        "../evil",
        "runs/../../evil",
        outside.as_str(),
        "runs/..\\x2f..\\x2fevil",
        "runs/NUL.csv",
        "runs/a.csv",
    ];
    for path in paths {
        forged(&backup, |list| {
            let first = list["files"]
                .as_array_mut()
                .unwrap()
                .iter_mut()
                .find(|file| file["path"] == "campaign.toml");
            first.unwrap()["path"] = path.into();
        });
        let refused = ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(4);
        for word in [
            "would not lie in the restored folder",
            path,
            "Nothing was written",
            "backup-00001-",
        ] {
            assert!(refused.stderr.contains(word), "{word}: {refused:#?}");
        }
        std::fs::write(backup.join("backup.json"), &sound).unwrap();
        assert_eq!(files(elsewhere.path()), before, "{path}");
    }
    // The database is looked for under its own name only.
    forged(&backup, |list| {
        list["database"]["path"] = "../../etc/passwd".into()
    });
    let refused = ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(4);
    assert!(
        refused.stderr.contains("is no copy of a database"),
        "{refused:#?}"
    );
    // What has no place is left out where the rest is asked for.
    std::fs::write(backup.join("backup.json"), &sound).unwrap();
    forged(&backup, |list| list["files"][0]["path"] = "../evil".into());
    let rest = ieap(elsewhere.path(), &["restore", "backup", "new", "--damaged"]);
    assert!([3, 4].contains(&rest.status), "{rest:#?}");
    assert!(!elsewhere.path().join("evil").exists());
}

#[cfg(unix)]
#[test]
fn a_restore_goes_through_no_link() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let at = |name: &str| elsewhere.path().join(name);
    folder.ieap(&["backup", text(&at("backup"))]).expect(0);
    std::fs::create_dir(at("theirs")).unwrap();
    std::os::unix::fs::symlink(at("theirs"), at("new")).unwrap();
    std::os::unix::fs::symlink(at("nowhere"), at("newer")).unwrap();
    for name in ["new", "newer"] {
        let refused = ieap(elsewhere.path(), &["restore", "backup", name]).expect(2);
        assert!(refused.stderr.contains("it is a link"), "{refused:#?}");
    }
    assert_eq!(std::fs::read_dir(at("theirs")).unwrap().count(), 0);
    // A raw file of the backup that is a link to another file of the same bytes.
    let raw = files(&at("backup"))
        .into_keys()
        .find(|path| path.extension().is_some_and(|end| end == "csv"))
        .unwrap();
    std::fs::rename(&raw, at("moved")).unwrap();
    std::os::unix::fs::symlink(at("moved"), &raw).unwrap();
    let refused = ieap(elsewhere.path(), &["restore", "backup", "newest"]).expect(4);
    assert!(refused.stderr.contains("a link has that name"), "{refused:#?}");
}

/// Refuses to read files of that name, and interrupts every other call once.
struct Failing {
    name: &'static str,
    interrupted: std::sync::atomic::AtomicBool,
}

impl ieap::system::FaultInjector for Failing {
    fn before(&self, call: &ieap::system::Call<'_>) -> std::io::Result<()> {
        use ieap::system::Kind;
        let reads = matches!(call.kind, Kind::Open | Kind::Read);
        if reads && call.path.ends_with(self.name) && !call.path.ends_with(format!("backup/{}", self.name)) {
            return Err(std::io::Error::from_raw_os_error(5));
        }
        if self
            .interrupted
            .fetch_xor(true, std::sync::atomic::Ordering::Relaxed)
        {
            Ok(())
        } else {
            Err(std::io::ErrorKind::Interrupted.into())
        }
    }

    fn after(&self, _call: &ieap::system::Call<'_>) {}

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

#[test]
fn a_file_that_cannot_be_read_leaves_the_earlier_copy_and_an_interruption_nothing() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    for name in [
        "campaign.toml",
        "runs/a.csv.toml",
        "archive/journal.jsonl",
        "nothing",
    ] {
        let context = Context::open_read_only(folder.path()).unwrap();
        let verb = Backup {
            folder: backup.clone(),
            deep: false,
            keep: 1,
        };
        let world = std::sync::Arc::new(Failing {
            name,
            interrupted: false.into(),
        });
        let done = ieap::system::with_fs(world, || verb.run(&context, &Silent)).unwrap();
        let told: Vec<&str> = done.left_out.iter().map(|left| left.path.as_str()).collect();
        assert_eq!(told, if name == "nothing" { vec![] } else { vec![name] });
        for left in &done.left_out {
            assert!(left.reason.contains("an earlier copy"), "{left:?}");
        }
        let restored = format!("new-{}", name.replace('/', "-"));
        let status = if name == "nothing" { 0 } else { 3 };
        ieap(elsewhere.path(), &["restore", "backup", &restored]).expect(status);
        if name != "nothing" {
            let copy = std::fs::read(elsewhere.path().join(restored).join(name)).unwrap();
            assert_eq!(copy, std::fs::read(folder.join(name)).unwrap());
        }
    }
}

/// Refuses the listing of that number: of a folder, or of the names in one that was opened.
struct RefusesListing {
    number: usize,
    asked: std::sync::atomic::AtomicUsize,
    /// The folder of that listing.
    refused: std::sync::Mutex<Option<std::path::PathBuf>>,
    /// Whether it is refused once only, and whether it was listed again then.
    is_once: bool,
    again: std::sync::atomic::AtomicBool,
}

impl ieap::system::FaultInjector for RefusesListing {
    fn before(&self, call: &ieap::system::Call<'_>) -> std::io::Result<()> {
        if call.kind != ieap::system::Kind::List {
            return Ok(());
        }
        let asked = self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let mut refused = self.refused.lock().unwrap();
        if asked == self.number {
            *refused = Some(call.path.to_owned());
        } else if refused.as_deref() != Some(call.path) {
            return Ok(());
        } else if self.is_once {
            self.again.store(true, std::sync::atomic::Ordering::Relaxed);
            return Ok(());
        }
        Err(std::io::Error::from_raw_os_error(5))
    }

    fn after(&self, _call: &ieap::system::Call<'_>) {}

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

/// An error of the disk while the names in a folder were read left out its tag files without a word.
#[test]
fn a_folder_that_cannot_be_listed_is_told_and_its_tag_files_stay_in_the_backup() {
    let folder = campaign();
    folder.write("tags.toml", "operator = \"A\"\n");
    let elsewhere = tempfile::tempdir().unwrap();
    let verb = Backup {
        folder: elsewhere.path().join("backup"),
        deep: false,
        keep: 1,
    };
    let context = Context::open_read_only(folder.path()).unwrap();
    let whole = verb.run(&context, &Silent).unwrap();
    assert_eq!(whole.left_out, []);
    let mut told = Vec::new();
    for is_once in [true, false] {
        let mut number = 0;
        loop {
            let world = std::sync::Arc::new(RefusesListing {
                number,
                asked: 0.into(),
                refused: None.into(),
                is_once,
                again: false.into(),
            });
            let done = ieap::system::with_fs(world.clone(), || verb.run(&context, &Silent));
            if world.asked.load(std::sync::atomic::Ordering::Relaxed) <= number {
                break;
            }
            if let Ok(done) = done {
                // One refusal is made good by listing the folder again, and by nothing else.
                let is_good_again = world.again.load(std::sync::atomic::Ordering::Relaxed);
                assert!(!done.left_out.is_empty() || is_good_again, "listing {number}");
                assert_eq!(done.files, whole.files, "listing {number}: {:?}", done.left_out);
                told.extend(done.left_out.into_iter().map(|left| left.path));
            }
            number += 1;
        }
    }
    for path in [".", "runs"] {
        assert!(told.iter().any(|told| told == path), "{path}: {told:?}");
    }
    assert_eq!(verb.run(&context, &Silent).unwrap().left_out, []);
}

/// Refuses the call of that number, and all after it where the disk is gone for good.
struct RefusesFrom {
    call: usize,
    for_good: bool,
    asked: std::sync::atomic::AtomicUsize,
}

impl ieap::system::FaultInjector for RefusesFrom {
    fn before(&self, _call: &ieap::system::Call<'_>) -> std::io::Result<()> {
        let asked = self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let refuses = asked == self.call || self.for_good && asked > self.call;
        // ENOSPC for good, EIO once.
        let errno = if self.for_good { 28 } else { 5 };
        if refuses {
            Err(std::io::Error::from_raw_os_error(errno))
        } else {
            Ok(())
        }
    }

    fn after(&self, _call: &ieap::system::Call<'_>) {}

    fn now(&self) -> std::time::SystemTime {
        std::time::SystemTime::now()
    }
}

/// Also where only one is kept, and every backup has something new.
#[test]
fn whatever_call_the_system_refuses_a_backup_can_be_restored() {
    use ieap::pipeline::upkeep::backup::Restore;
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let context = Context::open_read_only(folder.path()).unwrap();
    let (mut call, mut refused, mut is_through) = (0, 0, false);
    while !is_through {
        folder.write("runs/a.csv.toml", format!("cycle = {}\n", call + 3));
        for for_good in [false, true] {
            let world = std::sync::Arc::new(RefusesFrom {
                call,
                for_good,
                asked: 0.into(),
            });
            let verb = Backup {
                folder: backup.clone(),
                deep: false,
                keep: 1,
            };
            let done = ieap::system::with_fs(world.clone(), || verb.run(&context, &Silent));
            refused += usize::from(done.is_err());
            is_through = world.asked.load(std::sync::atomic::Ordering::Relaxed) <= call;
            let new = elsewhere.path().join("new");
            let restore = Restore {
                backup: backup.clone(),
                folder: new.clone(),
                damaged: false,
            };
            let restored = restore.run(&Silent);
            let runs = restored
                .unwrap_or_else(|error| panic!("call {call}: {error}, after {done:?}"))
                .runs;
            assert_eq!(runs, Some(3), "call {call}");
            std::fs::remove_dir_all(new).unwrap();
        }
        call += counted(11, 1);
    }
    assert!(refused > 10, "{refused} of {call} calls");
}

#[test]
fn a_journal_that_is_damaged_cut_or_missing_takes_the_place_of_no_good_copy() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let path = folder.join("archive/journal.jsonl");
    let sound = std::fs::read(&path).unwrap();
    let lines: Vec<&[u8]> = sound.split_inclusive(|byte| *byte == b'\n').collect();
    let mut flipped = sound.clone();
    flipped[sound.len() / 2] ^= 1;
    let cut = lines[..lines.len() - 1].concat();
    let without_first = lines[1..].concat();
    // Whoever backs up mends nothing: what is wrong is told, and the good copy stays.
    let wrong: [(Option<&[u8]>, &str); 5] = [
        (Some(&flipped), "line"),
        (Some(&cut), "it was cut to"),
        (Some(&without_first), "missing"),
        (Some(b""), "it was cut to"),
        (None, "it is not there"),
    ];
    for (turn, (bytes, said)) in wrong.into_iter().enumerate() {
        std::fs::remove_file(&path).unwrap();
        if let Some(bytes) = bytes {
            std::fs::write(&path, bytes).unwrap();
        }
        let told = folder.ieap(&["backup", text(&backup), "--keep", "1"]).expect(3);
        assert!(
            told.stderr.contains(said) && told.stderr.contains("an earlier copy"),
            "{said}: {told:#?}"
        );
        let new = format!("new-{turn}");
        ieap(elsewhere.path(), &["restore", "backup", &new]).expect(3);
        let copy = std::fs::read(elsewhere.path().join(&new).join("archive/journal.jsonl")).unwrap();
        assert_eq!(copy, sound);
        std::fs::write(&path, &sound).unwrap();
    }
    // It goes on where the copy ends.
    folder.ieap(&["tag", "runs/b.csv", "note=later"]).expect(0);
    folder.ieap(&["backup", text(&backup)]).expect(0);
    // Written anew from the database it is another one, and says all that it did.
    std::fs::remove_file(&path).unwrap();
    folder.ieap(&["ingest"]).expect(0);
    assert!(path.exists());
    folder.ieap(&["backup", text(&backup)]).expect(0);
}

#[test]
fn a_list_that_is_damaged_is_told_and_another_one_can_be_restored() {
    let folder = campaign();
    let elsewhere = tempfile::tempdir().unwrap();
    let backup = elsewhere.path().join("backup");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    // As an earlier version of the program left it.
    for name in named(&backup, "backup-") {
        std::fs::remove_file(backup.join(name)).unwrap();
    }
    forged(&backup, |list| {
        drop(list.as_object_mut().unwrap().remove("number"))
    });
    folder.write("runs/a.csv.toml", "cycle = 7\n");
    folder.ieap(&["backup", text(&backup)]).expect(0);
    let lists = named(&backup, "backup-");
    assert_eq!(lists.len(), 2, "{lists:?}");
    assert!(lists[0].starts_with("backup-00000-"), "{lists:?}");
    for name in ["backup.json", lists[1].as_str()] {
        let mut bytes = std::fs::read(backup.join(name)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(backup.join(name), bytes).unwrap();
    }
    let refused = ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(4);
    assert!(
        refused
            .stderr
            .contains(&format!("ieap restore backup/{}", lists[0])),
        "{refused:#?}"
    );
    ieap(
        elsewhere.path(),
        &["restore", &format!("backup/{}", lists[0]), "old"],
    )
    .expect(0);
    assert_eq!(
        std::fs::read(elsewhere.path().join("old/runs/a.csv.toml")).unwrap(),
        b"cycle = 2\n"
    );
    let told = folder.ieap(&["backup", text(&backup), "--keep", "1"]).expect(3);
    assert!(told.stderr.contains(&lists[1]), "{told:#?}");
    // Nobody knows what the damaged one names: its bytes stay, and the database with them.
    assert!(named(&backup, "backup-").contains(&lists[1]));
    ieap(elsewhere.path(), &["restore", "backup", "new"]).expect(0);
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
        // A numbered list is looked at where it is named.
        !["campaign.db.lock", "database-id"].contains(&name) && !name.starts_with("backup-")
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
            assert!(refused.stderr.contains("ieap backup"), "{refused:#?}");
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
        .execute_batch("UPDATE result SET document = replace(document, '\"value\":', '\"value\":1')")
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
            keep: KEEP,
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
