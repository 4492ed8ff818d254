//! What only shows: whatever settings say, whoever writes meanwhile, and where nothing may be written.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, Ended, command, counted, run_table};
use crate::watch::Watching;

/// Verbs that show what is stored.
const SHOWING: [&[&str]; 11] = [
    &["status"],
    &["status", "--files"],
    &["status", "--alarms"],
    &["table", "fits-wide"],
    &["table", "conditions", "--format", "csv"],
    &["explain", "fits-wide"],
    &["export", "--what", "fits", "-o", "-"],
    &["study"],
    &["next"],
    &["figure", "figure23", "-o", "-", "--format", "svg"],
    &["predict", "--sample", "S1", "--voltage", "1", "--at", "1"],
];

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for name in 1..=2 {
        folder.write(&format!("runs/{name}.csv"), run_table(name));
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder
}

fn copied(from: &CampaignFolder) -> CampaignFolder {
    let folder = CampaignFolder::new();
    let done = Command::new("cp")
        .args(["-a", "--"])
        .arg(from.path().join("."))
        .arg(folder.path())
        .status();
    assert!(done.unwrap().success());
    folder
}

/// What a slip makes of campaign.toml, each of another kind; none: it is gone.
fn broken() -> Vec<Option<Vec<u8>>> {
    let with = |text: &str| Some(format!("{CAMPAIGN_TOML}\n{text}\n").into_bytes());
    let mut all = vec![
        None,
        Some(Vec::new()),
        Some(b"\xff\xfe\x00".to_vec()),
        Some(CAMPAIGN_TOML.replace("id = \"test\"", "id = \"").into_bytes()),
        Some(
            CAMPAIGN_TOML
                .replace("length_mm = 5.0", "length_mm = \"5\"")
                .into_bytes(),
        ),
        Some(
            CAMPAIGN_TOML
                .replace("length_mm = 5.0", "length_mm = -5.0")
                .into_bytes(),
        ),
        Some(
            CAMPAIGN_TOML
                .replace("Europe/Tallinn", "Europe/Talinn")
                .into_bytes(),
        ),
        with("[runs]\nfolder = \"../elsewhere\""),
        with("[runs]\nname_pattern = \"{sample\""),
        with("[[sample]]\nid = \"S1\"\nmaterial = \"twice\""),
        with("[campaign]\nid = \"twice\""),
        with("[fit]\nsimultaneous = \"yes\""),
    ];
    // And a line that is no TOML, anywhere.
    let lines: Vec<&str> = CAMPAIGN_TOML.lines().collect();
    all.extend((0..=lines.len()).map(|at| {
        let mut lines = lines.clone();
        lines.insert(at, "oh no");
        Some(lines.join("\n").into_bytes())
    }));
    all
}

fn put(folder: &CampaignFolder, text: Option<&Vec<u8>>) {
    match text {
        Some(text) => folder.write("campaign.toml", text),
        None => fs::remove_file(folder.join("campaign.toml")).unwrap(),
    }
}

#[test]
fn whatever_is_wrong_in_campaign_toml_what_is_stored_is_shown_as_before() {
    let folder = campaign();
    let shown: Vec<Ended> = SHOWING.iter().map(|verb| folder.ieap(verb)).collect();
    let broken = broken();
    let mut tried = 0;
    for (which, text) in broken.iter().enumerate() {
        put(&folder, text.as_ref());
        for (nth, verb) in SHOWING.iter().enumerate() {
            // All of them of the first kinds, one by one after that.
            if which > counted(3, broken.len()) && nth != which % SHOWING.len() {
                continue;
            }
            let ended = folder.ieap(verb);
            tried += 1;
            let said = format!("{which} {verb:?}: {ended:#?}");
            if *verb == ["status"] {
                assert_eq!(ended.status, 3, "{said}");
                assert!(ended.stdout.contains("2 fitted"), "{said}");
            } else {
                // A verb that could not do it before cannot now.
                let wanted = if shown[nth].status == 0 {
                    3
                } else {
                    shown[nth].status
                };
                assert_eq!(
                    (ended.status, &ended.stdout),
                    (wanted, &shown[nth].stdout),
                    "{said}"
                );
            }
            let first = ended.stderr.lines().next().unwrap_or_default();
            assert!(
                first.starts_with("error: ") && first.contains("campaign.toml"),
                "{said}"
            );
        }
        for verb in [
            &["run"][..],
            &["ingest"],
            &["fit"],
            &["tag", "runs/1.csv", "note=a"],
            &["rebuild"],
        ] {
            let refused = folder.ieap(verb);
            assert_eq!(refused.status, 2, "{which} {verb:?}: {refused:#?}");
        }
        folder.ieap(&["verify"]).expect(0);
    }
    assert!(
        shown.iter().filter(|ended| ended.status == 0).count() >= 9,
        "{shown:#?}"
    );
    eprintln!("{tried} of {} kinds", broken.len());
}

#[test]
fn a_campaign_whose_last_settings_are_not_known_is_shown_without_any() {
    let folder = campaign();
    fs::remove_file(folder.join("archive/campaign.toml")).unwrap();
    put(&folder, Some(&b"no".to_vec()));
    let table = folder.ieap(&["table", "fits-wide"]).expect(3);
    assert!(table.stderr.contains("stated nothing"), "{table:#?}");
    assert!(table.stdout.contains("runs/1.csv"), "{table:#?}");
    // Where nothing was ever stored there is no campaign to show.
    let none = CampaignFolder::new();
    put(&none, Some(&b"no".to_vec()));
    none.ieap(&["status"]).expect(2);
}

#[test]
fn a_backup_is_made_and_restored_and_verified_whatever_campaign_toml_says() {
    for text in [Some(&b"[campaign\n"[..]), None] {
        let folder = campaign();
        put(&folder, text.map(<[u8]>::to_vec).as_ref());
        let backup = tempfile::tempdir().unwrap();
        let (to, again) = (backup.path().join("b"), backup.path().join("again"));
        let [to, again] = [to.to_str().unwrap(), again.to_str().unwrap()];
        let status = if text.is_some() { 0 } else { 3 };
        let made = folder.ieap(&["backup", to]).expect(status);
        assert!(made.stderr.contains("campaign.toml"), "{made:#?}");
        folder.ieap(&["restore", to, again]).expect(status);
        let verified = folder.ieap(&["verify", again]);
        assert_eq!(verified.status, 0, "{verified:#?}");
        assert!(Path::new(again).join("runs/1.csv").exists());
        let table = folder.ieap(&["table", "fits-wide", again]).expect(3);
        assert!(table.stdout.contains("runs/1.csv"), "{table:#?}");
    }
}

const PROFILE: &str = "[profile]\nversion = 1\n[recognise]\nname = \"laser_*\"\n[layout]\nseparator = \"comma\"\ndecimal = \"point\"\nheader_contains = \"t,U\"\n[time]\nbase = \"elapsed\"\ncolumn = \"t\"\nunit = \"s\"\n[[column]]\ncolumn = \"U\"\nquantity = \"voltage\"\nunit = \"V\"\n[[column]]\ncolumn = \"I\"\nquantity = \"current\"\nunit = \"mA\"\n";

#[test]
fn a_profile_that_cannot_be_read_costs_the_files_that_it_may_be_for() {
    let laser = |seed| run_table(seed).replace("time_s,voltage_v,current_a,curvature_per_cm", "t,U,I,x");
    let folder = campaign();
    folder.write("profiles/laser.toml", PROFILE);
    folder.write("runs/laser_1.csv", laser(3));
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let content = || crate::rebuild::content(&folder);
    let before = content();
    // A sidecar in the wrong folder recognises nothing: it costs nothing but its line.
    folder.write("profiles/a.csv.toml", "sample = \"S1\"\n");
    let told = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(
        told.stdout.contains("profiles/a.csv.toml") || told.stderr.contains("profiles/a.csv.toml"),
        "{told:#?}"
    );
    crate::rebuild::same(&content(), &before);
    fs::remove_file(folder.join("profiles/a.csv.toml")).unwrap();
    folder.write("profiles/laser.toml", format!("{PROFILE}oh no\n"));
    folder.write("runs/3.csv", run_table(4));
    folder.write("runs/laser_2.csv", laser(5));
    let told = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    let said = format!("{}{}", told.stdout, told.stderr);
    for name in ["profiles/laser.toml", "runs/laser_2.csv"] {
        assert!(said.contains(name), "{name}: {told:#?}");
    }
    let status = folder.ieap(&["status"]).expect(0);
    assert!(
        status.stdout.contains("4 runs") && status.stdout.contains("profiles/laser.toml"),
        "{status:#?}"
    );
    let codes = folder.ieap(&["status", "--json"]).expect(0).stdout;
    let told = ["profile-refused", "profile-not-read"];
    assert!(told.iter().all(|code| codes.contains(code)), "{codes}");
    let runs = folder
        .ieap(&["table", "fits-wide", "--format", "csv"])
        .expect(0)
        .stdout;
    assert!(
        runs.contains("runs/3.csv") && runs.contains("runs/laser_1.csv") && !runs.contains("runs/laser_2"),
        "{runs}"
    );
    folder.ieap(&["verify"]).expect(0);
    folder.ieap(&["rebuild"]).expect(2);
    folder.write("profiles/laser.toml", PROFILE);
    let mended = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(!mended.stderr.contains("profiles/"), "{mended:#?}");
    let runs = folder
        .ieap(&["table", "fits-wide", "--format", "csv"])
        .expect(0)
        .stdout;
    assert!(runs.contains("runs/laser_2.csv"), "{runs}");
    folder.ieap(&["verify", "--deep"]).expect(0);
}

/// Where nothing may be written: in a user namespace without a mapping even root must ask for rights.
#[cfg(unix)]
#[test]
fn what_is_stored_is_shown_where_nothing_may_be_written() {
    let of_right = |folder: &CampaignFolder, mode: &str| {
        let mode = format!("a{mode}w,a+rX");
        let done = Command::new("chmod")
            .args(["-R", &mode])
            .arg(folder.path())
            .status();
        assert!(done.unwrap().success());
    };
    let as_nobody = |folder: &CampaignFolder, verb: &[&str]| {
        let program = command(folder.path(), &[]);
        let output = Command::new("unshare")
            .arg("-U")
            .arg(program.get_program())
            .args(verb)
            .current_dir(folder.path())
            .output();
        output.map(|output| Ended {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        })
    };
    let folder = campaign();
    folder.ieap(&["diagnose"]).expect(0);
    folder.ieap(&["report"]).expect(0);
    if !as_nobody(&folder, &["--version"]).is_ok_and(|ended| ended.status == 0) {
        eprintln!("skipped: no namespace can be made");
        return;
    }
    let more: [&[&str]; 4] = [&["fit"], &["fit", "--json"], &["report"], &["verify"]];
    let verbs: Vec<&[&str]> = SHOWING.into_iter().chain(more).collect();
    let shown: Vec<Ended> = verbs.iter().map(|verb| folder.ieap(verb)).collect();
    // All of it, the database and its folder alone, the archive alone.
    let parts: [&[&str]; 3] = [
        &["."],
        &[
            "campaign.db",
            "campaign.db-wal",
            "campaign.db-shm",
            "campaign.db.lock",
        ],
        &["archive"],
    ];
    let mut tried = 0;
    for part in parts {
        of_right(&folder, "+");
        for name in part.iter().filter(|name| folder.join(name).exists()) {
            let done = Command::new("chmod")
                .args(["-R", "a-w"])
                .arg(folder.join(name))
                .status();
            assert!(done.unwrap().success());
        }
        for (verb, shown) in verbs.iter().zip(&shown) {
            let ended = as_nobody(&folder, verb).unwrap();
            tried += 1;
            assert_eq!(ended.status, shown.status, "{part:?} {verb:?}: {ended:#?}");
            // Where a part may be written still, a report may be made anew.
            let is_the_same = ended.stdout == shown.stdout || verb == &["report"];
            assert!(is_the_same, "{part:?} {verb:?}: {ended:#?}");
        }
    }
    of_right(&folder, "+");
    folder.write("runs/3.csv", run_table(3));
    of_right(&folder, "-");
    let refused = as_nobody(&folder, &["fit", "--json"]).unwrap();
    assert!(
        refused.status == 4 && refused.stderr.contains("1 file to take in"),
        "{refused:#?}"
    );
    of_right(&folder, "+");
    eprintln!("{tried} shown");
}

#[test]
fn what_is_stored_is_shown_beside_a_watch_and_what_it_works_on_is_waited_for() {
    let folder = campaign();
    let more: [&[&str]; 5] = [
        &["fit"],
        &["fit", "--json"],
        &["report"],
        &["verify"],
        &["backup", "../backup-beside-watch"],
    ];
    let backup = folder.path().parent().unwrap().join("backup-beside-watch");
    let _watching = Watching::start(&folder, &[]);
    for round in 0..counted(2, 20) {
        // A file comes while the verbs look.
        folder.write(
            &format!("runs/new_{round}.csv"),
            run_table(100 + u32::try_from(round).unwrap()),
        );
        for verb in SHOWING.into_iter().chain(more) {
            let ended = folder.ieap(verb);
            assert!([0, 3].contains(&ended.status), "{verb:?}: {ended:#?}");
        }
        let fits = folder.ieap(&["fit", "--json"]);
        assert!(fits.stdout.contains(&format!("new_{round}.csv")), "{fits:#?}");
    }
    fs::remove_dir_all(backup).unwrap();
}

/// `verify` read journal and database at two moments: beside people who tag it said "NOT SOUND" in 27 of 62.
#[test]
fn a_campaign_is_sound_beside_people_who_tag() {
    let (looks, writers) = (counted(12, 1000), counted(4, 10));
    let folder = campaign();
    let (is_over, said, waits) = (AtomicBool::new(false), AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for writer in 0..writers {
            let (folder, is_over, said) = (&folder, &is_over, &said);
            scope.spawn(move || {
                while !is_over.load(Ordering::Relaxed) {
                    let note = format!("note={}", said.fetch_add(1, Ordering::Relaxed));
                    let run = format!("runs/{}.csv", 1 + writer % 2);
                    folder.ieap(&["tag", &run, &note]).expect(0);
                }
            });
        }
        let looking: Vec<_> = (0..2)
            .map(|_| {
                let (folder, is_over, waits) = (&folder, &is_over, &waits);
                scope.spawn(move || {
                    let mut unsound = Vec::new();
                    for _ in 0..looks / 2 {
                        let begun = std::time::Instant::now();
                        let ended = folder.ieap(&["verify"]);
                        if begun.elapsed().as_secs() >= 5 {
                            waits.fetch_add(1, Ordering::Relaxed);
                        }
                        if ended.status != 0 {
                            unsound.push(ended);
                        }
                    }
                    is_over.store(true, Ordering::Relaxed);
                    unsound
                })
            })
            .collect();
        let unsound: Vec<Ended> = looking
            .into_iter()
            .flat_map(|looking| looking.join().unwrap())
            .collect();
        assert!(
            unsound.is_empty(),
            "{} of {looks}: {:#?}",
            unsound.len(),
            unsound[0]
        );
    });
    eprintln!(
        "{looks} looks beside {writers} writers: 0 false, {} took 5 s or more; {} words",
        waits.load(Ordering::Relaxed),
        said.load(Ordering::Relaxed)
    );
    folder.ieap(&["verify", "--deep"]).expect(0);
}

#[test]
fn a_database_that_lags_behind_its_journal_is_shown_and_that_is_said() {
    let folder = campaign();
    let older = tempfile::tempdir().unwrap();
    let store = ieap::store::Store::open_read_only(folder.path())
        .unwrap()
        .unwrap();
    store.copy_in(older.path()).unwrap();
    drop(store);
    folder.ieap(&["tag", "runs/1.csv", "note=said"]).expect(0);
    for name in ["campaign.db", "campaign.db-wal", "campaign.db-shm"] {
        let _ = fs::remove_file(folder.join(name));
    }
    fs::copy(older.path().join("campaign.db"), folder.join("campaign.db")).unwrap();
    let journal = fs::read(folder.join("archive/journal.jsonl")).unwrap();
    for verb in SHOWING.into_iter().step_by(counted(4, 1)) {
        let shown = folder.ieap(verb);
        assert!(
            shown.stderr.contains("the database lacks what the journal says"),
            "{verb:?}: {shown:#?}"
        );
        assert_ne!(shown.status, 0, "{verb:?}");
    }
    folder.ieap(&["verify"]).expect(4);
    assert_eq!(fs::read(folder.join("archive/journal.jsonl")).unwrap(), journal);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    folder.ieap(&["status"]).expect(0);
}

/// The database as an earlier version left it.
fn made_older(folder: &CampaignFolder) {
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    database
        .execute_batch("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA user_version = 19")
        .unwrap();
}

/// A disk that was not mounted cost all runs whose files are gone, and `tag` ended with 0.
#[test]
fn an_older_database_is_made_anew_only_where_nothing_of_it_is_lost() {
    let whole = campaign();
    fs::remove_file(whole.join("runs/2.csv")).unwrap();
    made_older(&whole);
    let verbs: [&[&str]; 6] = [
        &["tag", "runs/1.csv", "note=a"],
        &["drop", "runs/1.csv", "--why", "a"],
        &["run"],
        &["ingest"],
        &["fit"],
        &["report"],
    ];
    let first = |folder: &CampaignFolder| {
        let inside = fs::read_dir(folder.join("archive"))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let blobs: Vec<_> = inside.filter(|path| path.is_dir()).collect();
        fs::read_dir(&blobs[0]).unwrap().next().unwrap().unwrap().path()
    };
    for missing in ["archive", "all but a folder", "journal", "one raw file"] {
        let folder = copied(&whole);
        match missing {
            "archive" => fs::rename(folder.join("archive"), folder.join("elsewhere")).unwrap(),
            "all but a folder" => {
                fs::rename(folder.join("archive"), folder.join("elsewhere")).unwrap();
                fs::create_dir(folder.join("archive")).unwrap();
            }
            "journal" => fs::remove_file(folder.join("archive/journal.jsonl")).unwrap(),
            _ => fs::remove_file(first(&folder)).unwrap(),
        }
        let before = fs::read(folder.join("campaign.db")).unwrap();
        for verb in verbs {
            let refused = folder.ieap(verb).expect(4);
            assert!(
                refused.stderr.contains("Nothing was changed. Mount the disk"),
                "{missing}: {refused:#?}"
            );
            assert_eq!(
                fs::read(folder.join("campaign.db")).unwrap(),
                before,
                "{missing} {verb:?}"
            );
            assert_eq!(folder.join("archive").exists(), missing != "archive", "{verb:?}");
        }
        if folder.join("elsewhere").exists() {
            let _ = fs::remove_dir(folder.join("archive"));
            fs::rename(folder.join("elsewhere"), folder.join("archive")).unwrap();
            let done = folder.ieap(&["tag", "runs/2.csv", "note=kept"]).expect(0);
            assert!(done.stderr.contains("made anew"), "{done:#?}");
            folder.ieap(&["verify", "--deep"]).expect(0);
        }
    }
    // Where it is lost for good, a person says so.
    let folder = copied(&whole);
    fs::remove_file(first(&folder)).unwrap();
    folder.ieap(&["rebuild"]).expect(3);
}

#[test]
fn an_archive_without_its_mark_is_taken_where_it_is_whole_and_refused_where_it_is_not() {
    let folder = campaign();
    fs::remove_file(folder.join("runs/2.csv")).unwrap();
    fs::remove_file(folder.join("archive/database-id")).unwrap();
    folder.ieap(&["tag", "runs/1.csv", "note=a"]).expect(0);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert!(folder.join("archive/database-id").exists());
    fs::rename(folder.join("archive"), folder.join("elsewhere")).unwrap();
    fs::create_dir(folder.join("archive")).unwrap();
    for verb in [
        &["tag", "runs/1.csv", "note=b"][..],
        &["run", "--no-diagnose"],
        &["fit"],
    ] {
        let refused = folder.ieap(verb).expect(4);
        assert!(refused.stderr.contains("Mount its disk"), "{refused:#?}");
    }
    assert_eq!(fs::read_dir(folder.join("archive")).unwrap().count(), 0);
}

#[test]
fn a_tag_of_any_length_is_answered_at_once() {
    let folder = campaign();
    let long = "k".repeat(100_000);
    for pair in [format!("{long}=1"), format!("note={long}")] {
        let begun = std::time::Instant::now();
        let refused = folder.ieap(&["tag", "runs/1.csv", &pair]).expect(2);
        assert!(
            refused.stderr.contains("may have") && refused.stderr.len() < 500,
            "{}",
            refused.stderr.len()
        );
        assert!(begun.elapsed().as_secs() < 10);
    }
    let begun = std::time::Instant::now();
    folder.write("runs/1.csv.toml", format!("{} = 1\n", "k".repeat(1_000_000)));
    let run = folder.ieap(&["run", "--no-diagnose"]);
    assert!(
        [0, 3].contains(&run.status) && begun.elapsed().as_secs() < 20,
        "{}",
        run.status
    );
}
