//! The campaign folder on a real disk: watching, scanning, archiving, and what goes wrong there.

use crate::needs_shared::skip;
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ieap::domain::{RunKind, Severity, tag::keys};
use ieap::ingest::archive::{Archive, ArchiveError, Outcome};
use ieap::ingest::campaign_file;
use ieap::ingest::scan::{
    DEFAULT_LIMIT_BYTES, Known, ReadFileError, Readiness, Scan, ScanLimits, Sighting, diff, read_stable,
    readiness, scan,
};
use ieap::ingest::tags::{TagFiles, TagRequest, resolve, stem};
use ieap::ingest::watch::{Wake, WatchMode, WatchOptions, Watcher};

static GO: AtomicBool = AtomicBool::new(false);

fn campaign() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    fs::create_dir(&runs).unwrap();
    (folder, runs)
}

fn watch(campaign: &Path) -> Watcher {
    let options = WatchOptions {
        quiet: Duration::from_millis(300),
        ..WatchOptions::default()
    };
    let (watcher, issues) = Watcher::start(campaign, "runs", &[], options).unwrap();
    assert_eq!((watcher.mode(), issues.len()), (WatchMode::Events, 0));
    watcher
}

fn look(campaign: &Path) -> Scan {
    scan(campaign, "runs", &[], ScanLimits::default()).unwrap()
}

/// Scans whenever the watcher says so, as the program does, until `count` files are seen.
fn follow_until(watcher: &Watcher, campaign: &Path, count: usize) -> Scan {
    let started = Instant::now();
    loop {
        let wake = watcher.wait(Duration::from_secs(10), &GO);
        assert_eq!(
            wake,
            Wake::Hint,
            "after {:?}, {} files",
            started.elapsed(),
            look(campaign).files.len()
        );
        let found = look(campaign);
        if found.files.len() >= count {
            assert_eq!(found.files.len(), count);
            return found;
        }
    }
}

#[test]
fn renames_into_place_are_all_seen_and_no_half_file_ever_is() {
    let (folder, runs) = campaign();
    let watcher = watch(folder.path());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for k in 0..1000 {
                let part = runs.join(format!("{k}.csv.part"));
                fs::write(&part, "whole").unwrap();
                fs::rename(&part, runs.join(format!("{k}.csv"))).unwrap();
            }
        });
        let found = follow_until(&watcher, folder.path(), 1000);
        assert!(
            found
                .files
                .iter()
                .all(|file| file.size_bytes == 5 && file.display.ends_with(".csv"))
        );
    });
}

#[test]
fn a_new_folder_with_files_at_once_is_seen_whole_without_a_full_scan() {
    let (folder, runs) = campaign();
    let watcher = watch(folder.path());
    for round in 0..10 {
        let deep = runs.join(format!("{round}/b/c"));
        fs::create_dir_all(&deep).unwrap();
        for k in 0..200 {
            fs::write(deep.join(format!("{k}.csv")), "1").unwrap();
        }
        follow_until(&watcher, folder.path(), 200 * (round + 1));
    }
}

#[test]
fn a_folder_moved_in_is_seen_and_watched() {
    let (folder, runs) = campaign();
    let aside = folder.path().join("aside");
    fs::create_dir_all(aside.join("deep")).unwrap();
    fs::write(aside.join("deep/a.csv"), "1").unwrap();
    let watcher = watch(folder.path());
    fs::rename(&aside, runs.join("set")).unwrap();
    follow_until(&watcher, folder.path(), 1);
    while watcher.wait(Duration::from_secs(1), &GO) == Wake::Hint {}
    fs::write(runs.join("set/deep/b.csv"), "1").unwrap();
    follow_until(&watcher, folder.path(), 2);
}

#[test]
fn what_the_program_reads_and_writes_itself_wakes_nobody() {
    let (folder, runs) = campaign();
    for k in 0..100 {
        fs::write(runs.join(format!("{k}.csv")), "1").unwrap();
    }
    let watcher = watch(folder.path());
    // A process that another test begins holds our files open until it runs its own program: their closing
    // can be told after the watch began, and is a hint rightly.
    while watcher.wait(Duration::from_millis(600), &GO) == Wake::Hint {}
    let archive = Archive::new(folder.path());
    for file in look(folder.path()).files {
        let bytes = read_stable(&file.location(folder.path()), DEFAULT_LIMIT_BYTES).unwrap();
        archive.store(&bytes, &file.relative).unwrap();
    }
    fs::write(folder.path().join("campaign.db-wal"), "1").unwrap();
    fs::create_dir(folder.path().join("report")).unwrap();
    fs::write(folder.path().join("report/index.html"), "1").unwrap();
    for k in 0..1000 {
        fs::write(runs.join(format!(".{k}.csv.swp")), "1").unwrap();
    }
    assert_eq!(watcher.wait(Duration::from_millis(600), &GO), Wake::Timeout);
    fs::write(folder.path().join("campaign.toml"), "1").unwrap();
    assert_eq!(watcher.wait(Duration::from_secs(10), &GO), Wake::Hint);
    while watcher.wait(Duration::from_millis(600), &GO) == Wake::Hint {}
    fs::write(runs.join("1.csv.toml"), "sample = \"C1\"").unwrap();
    assert_eq!(watcher.wait(Duration::from_secs(10), &GO), Wake::Hint);
}

#[test]
fn of_twenty_thousand_names_those_of_runs_are_found() {
    // Making twenty thousand files takes half a minute on a busy disk; memory serves as well, where there is any.
    let folder = tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap();
    let runs = folder.path().join("runs");
    fs::create_dir(&runs).unwrap();
    for k in 0..100 {
        let set = runs.join(format!("set-{k}"));
        fs::create_dir(&set).unwrap();
        for j in 0..100 {
            fs::write(set.join(format!("{j}.csv")), "").unwrap();
            fs::write(set.join(format!("{j}.csv.tmp")), "").unwrap();
        }
    }
    let found = look(folder.path());
    assert_eq!(
        (found.files.len(), found.folders.len(), found.issues.len()),
        (10_000, 101, 0)
    );
}

#[test]
fn what_happened_while_nobody_watched_shows_in_the_next_scan() {
    let (folder, runs) = campaign();
    for name in ["same", "grown", "rewritten", "replaced", "renamed", "deleted"] {
        fs::write(runs.join(format!("{name}.csv")), "12345").unwrap();
    }
    let before = look(folder.path());
    let known: Vec<Known> = before
        .files
        .iter()
        .map(|file| Known {
            display: &file.display,
            size_bytes: file.size_bytes,
            modified_ns: file.modified_ns,
            inode: file.inode,
            changed_ns: file.changed_ns,
            missing: false,
        })
        .collect();
    let time_of = |name: &str| fs::metadata(runs.join(name)).unwrap().modified().unwrap();
    fs::OpenOptions::new()
        .append(true)
        .open(runs.join("grown.csv"))
        .unwrap()
        .write_all(b"6")
        .unwrap();
    // The same size and a time that is one nanosecond older: a clock set back, a copy that keeps times.
    let rewritten = fs::File::options()
        .write(true)
        .open(runs.join("rewritten.csv"))
        .unwrap();
    let older = time_of("rewritten.csv") - Duration::from_nanos(1);
    (&rewritten).write_all(b"54321").unwrap();
    rewritten.set_modified(older).unwrap();
    let before = time_of("replaced.csv");
    fs::write(runs.join("x.tmp"), "54321").unwrap();
    fs::File::options()
        .write(true)
        .open(runs.join("x.tmp"))
        .unwrap()
        .set_modified(before)
        .unwrap();
    fs::rename(runs.join("x.tmp"), runs.join("replaced.csv")).unwrap();
    fs::rename(runs.join("renamed.csv"), runs.join("new-name.csv")).unwrap();
    fs::remove_file(runs.join("deleted.csv")).unwrap();
    let changes = diff(&known, &look(folder.path()));
    let names = |files: &[std::sync::Arc<ieap::ingest::scan::SeenFile>]| -> Vec<String> {
        files.iter().map(|file| file.display.clone()).collect()
    };
    assert_eq!(names(&changes.new), ["runs/new-name.csv"]);
    assert_eq!(
        names(&changes.changed),
        ["runs/grown.csv", "runs/replaced.csv", "runs/rewritten.csv"]
    );
    assert_eq!(names(&changes.unchanged), ["runs/same.csv"]);
    assert_eq!(changes.gone, ["runs/deleted.csv", "runs/renamed.csv"]);
}

#[test]
fn a_growing_file_is_never_ready_and_never_read_in_part() {
    let (folder, runs) = campaign();
    let path = runs.join("slow.csv");
    let block = vec![b'x'; 1 << 20];
    let finished = AtomicBool::new(false);
    let quiet = Duration::from_millis(400);
    let mut sighting: Option<Sighting> = None;
    let mut seen_growing = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut file = fs::File::create(&path).unwrap();
            for _ in 0..8 {
                file.write_all(&block).unwrap();
            }
            for _ in 0..200 {
                file.write_all(b"0.1,2.5\n").unwrap();
                std::thread::sleep(Duration::from_millis(5));
            }
            finished.store(true, Ordering::SeqCst);
        });
        while !finished.load(Ordering::SeqCst) {
            if let Some(seen) = look(folder.path()).files.first() {
                let now = Instant::now();
                let next =
                    sighting.map_or_else(|| Sighting::first(seen, now), |sighting| sighting.next(seen, now));
                let ready = readiness(&next, now, quiet);
                assert!(
                    ready != Readiness::Ready || finished.load(Ordering::SeqCst),
                    "ready while growing"
                );
                sighting = Some(next);
                let growing = read_stable(&path, DEFAULT_LIMIT_BYTES);
                seen_growing += usize::from(matches!(growing, Err(ReadFileError::StillGrowing { .. })));
            }
        }
    });
    println!("read while it was written: {seen_growing} times");
    assert!(seen_growing > 0);
    assert_eq!(
        read_stable(&path, DEFAULT_LIMIT_BYTES).unwrap().len(),
        (8 << 20) + 200 * 8
    );
    let seen = &look(folder.path()).files[0];
    let Some(at_rest) = sighting.map(|sighting| sighting.next(seen, Instant::now())) else {
        panic!("the file was never seen");
    };
    assert_eq!(
        readiness(&at_rest, Instant::now() + quiet, quiet),
        Readiness::Ready
    );
}

#[test]
fn the_same_bytes_stored_by_many_at_once_are_one_file() {
    let (folder, _) = campaign();
    let archive = Archive::new(folder.path());
    let contents: Vec<Vec<u8>> = (0..20u8).map(|k| vec![k; 5000]).collect();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for bytes in &contents {
                    archive.store(bytes, Path::new("a.csv")).unwrap();
                }
            });
        }
    });
    let entries = archive.entries().unwrap();
    assert_eq!(entries.len(), contents.len());
    let read: BTreeSet<Vec<u8>> = entries
        .iter()
        .map(|entry| archive.read(&entry.hash).unwrap())
        .collect();
    assert_eq!(read, contents.into_iter().collect());
    assert_eq!(archive.remove_partial().unwrap(), 0);
}

/// Runs this test once more in a namespace of its own, where `script` has prepared the folder `$1`; gives
/// that folder to the inner run. Skips, saying so, where the system allows no namespaces.
fn in_namespace(test: &str, unshare: &str, script: &str) -> Option<PathBuf> {
    const FOLDER: &str = "IEAP_TEST_NAMESPACE_FOLDER";
    if let Some(folder) = std::env::var_os(FOLDER) {
        return Some(folder.into());
    }
    let folder = tempfile::tempdir().unwrap();
    let script = format!("{{ {script}; }} || exit 77; exec \"$2\" --exact folder::{test} --nocapture");
    let inner = Command::new("unshare")
        .args([unshare, "sh", "-c", &script, "sh"])
        .arg(folder.path())
        .arg(std::env::current_exe().unwrap())
        .env(FOLDER, folder.path())
        .output();
    match inner {
        Ok(output) if output.status.success() => {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(said.contains("1 passed"), "the inner run tested nothing: {said}");
        }
        Ok(output) if output.status.code() == Some(77) || !output.stdout.starts_with(b"\nrunning") => {
            skip(&format!(
                "no namespace: {}",
                String::from_utf8_lossy(&output.stderr)
            ));
        }
        Ok(output) => panic!(
            "{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        ),
        Err(error) => skip(&format!("no unshare: {error}")),
    }
    None
}

fn names_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(names_below(&path))
        } else {
            found.push(path)
        }
    }
    found
}

#[test]
fn a_full_disk_is_said_leaves_no_half_file_and_heals() {
    let test = "a_full_disk_is_said_leaves_no_half_file_and_heals";
    let Some(folder) = in_namespace(test, "-Urm", "mount -t tmpfs -o size=512k none \"$1\"") else {
        return;
    };
    let archive = Archive::new(&folder);
    let (small, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    fs::write(folder.join("filler"), vec![1; 256 << 10]).unwrap();
    let large = vec![2; 300 << 10];
    let error = archive.store(&large, Path::new("b.csv")).unwrap_err();
    assert!(
        matches!(
            error,
            ArchiveError::DiskFull {
                needed_bytes: 307_200,
                ..
            }
        ),
        "{error}"
    );
    assert!(
        error.to_string().contains("the disk is full: 307200 bytes"),
        "{error}"
    );
    assert_eq!(names_below(&folder.join("archive")), [folder.join(&small.path)]);
    fs::remove_file(folder.join("filler")).unwrap();
    let (stored, outcome) = archive.store(&large, Path::new("b.csv")).unwrap();
    assert_eq!(outcome, Outcome::Written);
    assert_eq!(archive.read(&stored.hash).unwrap(), large);
    assert_eq!(archive.read(&small.hash).unwrap(), b"readings");
}

#[test]
fn a_read_only_disk_is_said_and_reading_goes_on() {
    let test = "a_read_only_disk_is_said_and_reading_goes_on";
    let Some(folder) = in_namespace(test, "-Urm", "mount -t tmpfs none \"$1\"") else {
        return;
    };
    let archive = Archive::new(&folder);
    let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    let remounted = Command::new("mount")
        .args(["-o", "remount,ro"])
        .arg(&folder)
        .status()
        .unwrap();
    assert!(remounted.success());
    let error = archive.store(b"other", Path::new("b.csv")).unwrap_err();
    assert!(matches!(error, ArchiveError::Denied { .. }), "{error}");
    assert_eq!(archive.read(&stored.hash).unwrap(), b"readings");
}

#[test]
fn folders_without_rights_are_issues_and_the_rest_goes_on() {
    // In a user namespace without a mapping even root must ask for rights.
    let test = "folders_without_rights_are_issues_and_the_rest_goes_on";
    let script = "mkdir -p \"$1/runs/open\" \"$1/runs/shut\" \"$1/archive\" \
                  && echo 1 > \"$1/runs/open/a.csv\" && echo 1 > \"$1/runs/shut/b.csv\" \
                  && chmod 000 \"$1/runs/shut\" && chmod 000 \"$1/runs/open/a.csv\" && chmod 555 \"$1/archive\"";
    let Some(folder) = in_namespace(test, "-U", script) else {
        return;
    };
    let found = look(&folder);
    assert_eq!(found.files.len(), 1);
    assert_eq!(found.unreadable, ["runs/shut"]);
    assert_eq!(
        (found.issues[0].code.as_str(), found.issues[0].severity),
        ("folder-unreadable", Severity::Warning)
    );
    let known = Known {
        display: "runs/shut/b.csv",
        size_bytes: 2,
        modified_ns: 1,
        inode: 1,
        changed_ns: 0,
        missing: false,
    };
    let changes = diff(&[known], &found);
    assert_eq!((changes.gone.len(), changes.out_of_sight.len()), (0, 1));
    let denied = read_stable(&found.files[0].location(&folder), 99).unwrap_err();
    assert!(matches!(denied, ReadFileError::Denied { .. }), "{denied}");
    let error = Archive::new(&folder).store(b"1", Path::new("a.csv")).unwrap_err();
    assert!(matches!(error, ArchiveError::Denied { .. }), "{error}");
    assert!(error.to_string().contains("give your user the right"), "{error}");
}

#[test]
fn the_limit_of_watches_makes_the_start_poll_and_say_so() {
    let test = "the_limit_of_watches_makes_the_start_poll_and_say_so";
    // A user namespace has limits of its own.
    let script = "mkdir -p \"$1/runs/a/b\" && echo 2 > /proc/sys/user/max_inotify_watches";
    let Some(folder) = in_namespace(test, "-Ur", script) else {
        return;
    };
    let (watcher, issues) = Watcher::start(&folder, "runs", &[], WatchOptions::default()).unwrap();
    assert!(matches!(watcher.mode(), WatchMode::Polling(_)));
    assert_eq!(issues.len(), 1);
    assert!(issues[0].message.contains("inotify limit"), "{issues:?}");
}

/// Against what lies beside the project.
mod needs_shared {
    use super::*;
    use crate::needs_shared::shared;

    #[test]
    fn the_campaigns_with_known_answers_are_tagged() {
        let Some(campaigns) = shared("campaigns") else {
            return;
        };
        let entries = fs::read_dir(&campaigns).unwrap();
        let mut tagged = 0;
        for folder in entries
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.is_dir())
        {
            let loaded = campaign_file::read(&folder).unwrap();
            // Tags of their own were not declared when these campaigns were made.
            let mut warnings = loaded.warnings.iter();
            assert!(
                warnings.all(|issue| issue.code == "tag-undeclared"),
                "{}: {:?}",
                folder.display(),
                loaded.warnings
            );
            let found = scan(&folder, &loaded.campaign.runs_folder, &[], ScanLimits::default()).unwrap();
            assert_eq!(found.issues, []);
            for file in &found.files {
                let resolved = resolve(&TagRequest {
                    campaign: &loaded.campaign,
                    tag_files: &TagFiles::of(&folder),
                    data_files: std::slice::from_ref(&file.relative),
                    stem: &stem(&file.relative),
                    name_pattern: loaded.campaign.name_pattern.as_deref(),
                    needed: RunKind::Actuation.needed_tags(),
                    hand: &[],
                    planned: &[],
                    kept: &[],
                    held: None,
                    header: &[],
                    channel_voltage_v: Some(5.0),
                    has_voltage: true,
                    other_names: &[],
                    ambient: &[],
                });
                let mut others = resolved.issues.clone();
                others.retain(|issue| issue.code != "tag-undeclared");
                assert_eq!((others, resolved.missing.len()), (vec![], 0), "{}", file.display);
                assert!(resolved.tags.iter().any(|tag| tag.key == keys::SAMPLE));
                tagged += 1;
            }
        }
        println!("{tagged} runs tagged");
        assert!(tagged >= 28);
    }
}
