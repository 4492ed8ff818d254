//! Tests of the scan.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;

use std::path::Path;
use std::time::{Duration, SystemTime};

use ieap_system::{Call, FaultInjector, Kind, fs, with_fs};

use super::*;

/// A campaign folder with these files in it, each holding its own path.
fn campaign(files: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("runs")).unwrap();
    for file in files {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, file).unwrap();
    }
    folder
}

fn look(folder: &tempfile::TempDir) -> Scan {
    scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap()
}

fn shown(scan: &Scan) -> Vec<&str> {
    scan.files.iter().map(|file| file.display.as_str()).collect()
}

fn codes(scan: &Scan) -> Vec<(&str, &str)> {
    scan.issues
        .iter()
        .map(|issue| (issue.place.as_str(), issue.code.as_str()))
        .collect()
}

#[test]
fn data_is_found_sorted_and_the_rest_is_left_out() {
    let folder = campaign(&[
        "runs/b.csv",
        "runs/a/z.dta",
        "runs/a.csv",
        "runs/a.csv.toml",
        "runs/tags.toml",
        "runs/.hidden/x.csv",
        "runs/x.csv.part",
        "runs/~$book.xlsx",
        "runs/Thumbs.db",
        "archive/ab/x.csv",
        "other/c.csv",
    ]);
    let found = look(&folder);
    assert_eq!(shown(&found), ["runs/a.csv", "runs/a/z.dta", "runs/b.csv"]);
    assert_eq!(found.folders, [Path::new("runs"), Path::new("runs/a")]);
    assert_eq!((found.issues.len(), found.unreadable.len()), (0, 0));
    let first = &found.files[0];
    assert_eq!(first.size_bytes, "runs/a.csv".len() as u64);
    assert!(first.inode > 0 && first.age.is_some_and(|age| age < Duration::from_secs(60)));
}

/// A system that lists a name and knows nothing of it then: some shares do, of names that they cannot spell.
struct Unspelt(&'static str);

impl FaultInjector for Unspelt {
    fn before(&self, call: &Call<'_>) -> std::io::Result<()> {
        match call.kind {
            Kind::Stat if call.path.ends_with(self.0) => Err(std::io::ErrorKind::NotFound.into()),
            _ => Ok(()),
        }
    }

    fn after(&self, _call: &Call<'_>) {}

    fn now(&self) -> SystemTime {
        SystemTime::now()
    }
}

#[test]
fn what_is_listed_and_cannot_be_read_is_out_of_sight_and_not_gone() {
    let folder = campaign(&["runs/a.csv", "runs/b/c.csv", "runs/f/frames.toml", "runs/f/1.png"]);
    assert_eq!(shown(&look(&folder)), ["runs/a.csv", "runs/b/c.csv", "runs/f"]);
    for (name, out_of_sight, left) in [
        ("a.csv", "runs/a.csv", vec!["runs/b/c.csv", "runs/f"]),
        ("b", "runs/b", vec!["runs/a.csv", "runs/f"]),
        // One picture of a folder that is measured as a whole.
        ("1.png", "runs/f", vec!["runs/a.csv", "runs/b/c.csv"]),
    ] {
        let found = with_fs(std::sync::Arc::new(Unspelt(name)), || look(&folder));
        assert_eq!(shown(&found), left, "{name}");
        assert_eq!(found.unreadable, [out_of_sight]);
        assert_eq!(codes(&found), [(out_of_sight, "folder-unreadable")]);
    }
}

#[test]
fn the_campaign_itself_as_runs_folder_leaves_out_what_the_program_writes() {
    let folder = campaign(&[
        "a.csv",
        "campaign.toml",
        "campaign.db",
        "campaign.db-wal",
        "report/t.csv",
        "archive/ab/x.csv",
    ]);
    let found = scan(folder.path(), ".", &[], ScanLimits::default()).unwrap();
    assert_eq!(shown(&found), ["a.csv"]);
}

#[test]
fn a_missing_runs_folder_is_offline_and_not_empty() {
    let folder = tempfile::tempdir().unwrap();
    let error = scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap_err();
    assert!(matches!(error, ScanError::FolderMissing { .. }));
    assert!(error.to_string().contains("nothing known is taken for removed"));
    fs::write(folder.path().join("runs"), "a file").unwrap();
    let error = scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap_err();
    assert!(matches!(error, ScanError::FolderMissing { .. }), "{error}");
}

#[test]
fn links_are_followed_inside_only_and_loops_end() {
    let folder = campaign(&["runs/a/x.csv", "stock/y.csv", "archive/ab/z.csv"]);
    let outside = campaign(&["runs/secret.csv"]);
    let runs = folder.path().join("runs");
    symlink(outside.path().join("runs"), runs.join("out")).unwrap();
    symlink(outside.path().join("runs/secret.csv"), runs.join("out.csv")).unwrap();
    symlink("..", runs.join("a/loop")).unwrap();
    symlink("a", runs.join("again")).unwrap();
    symlink("../stock", runs.join("stock")).unwrap();
    symlink("../stock/y.csv", runs.join("y2.csv")).unwrap();
    symlink("../archive", runs.join("old")).unwrap();
    symlink("../..", runs.join("a/campaign-parent")).unwrap();
    symlink("nowhere", runs.join("broken")).unwrap();
    symlink("self", runs.join("self")).unwrap();
    let found = look(&folder);
    assert_eq!(shown(&found), ["runs/a/x.csv", "runs/stock/y.csv", "runs/y2.csv"]);
    assert_eq!(
        codes(&found),
        [
            ("runs/a/campaign-parent", "link-not-followed"),
            ("runs/broken", "link-broken"),
            ("runs/old", "link-not-followed"),
            ("runs/out", "link-outside"),
            ("runs/out.csv", "link-outside"),
            ("runs/self", "link-broken"),
        ]
    );
    let linked = &found.files[2];
    let target = folder.path().canonicalize().unwrap().join("stock/y.csv");
    assert_eq!(linked.location(folder.path()), target);
    assert_eq!(read_stable(&target, 99).unwrap(), b"stock/y.csv");
}

#[test]
fn one_bad_name_does_not_stop_the_scan() {
    let folder = campaign(&["runs/a.csv"]);
    let long = "x".repeat(251) + ".csv";
    let names: [&[u8]; 5] = [
        b"\xff\xfe.csv",
        b"new\nline.csv",
        "🙂.csv".as_bytes(),
        b"space .csv ",
        long.as_bytes(),
    ];
    for name in names {
        fs::write(folder.path().join("runs").join(OsStr::from_bytes(name)), "1").unwrap();
    }
    let found = look(&folder);
    assert_eq!(found.files.len(), 6);
    for file in &found.files {
        assert_eq!(parse_display_path(&file.display), file.relative);
        assert!(file.location(folder.path()).is_file());
    }
}

#[test]
fn limits_and_special_files_are_said() {
    let folder = campaign(&["runs/a/b/c/x.csv", "runs/y.csv", "runs/z.csv"]);
    rustix::fs::mkfifoat(
        rustix::fs::CWD,
        folder.path().join("runs/pipe"),
        rustix::fs::Mode::RWXU,
    )
    .unwrap();
    let found = scan(folder.path(), "runs", &[], ScanLimits { files: 9, depth: 2 }).unwrap();
    assert_eq!(shown(&found), ["runs/y.csv", "runs/z.csv"]);
    assert_eq!(
        codes(&found),
        [("runs/a/b/c", "folder-too-deep"), ("runs/pipe", "not-a-file")]
    );
    let error = scan(folder.path(), "runs", &[], ScanLimits { files: 1, depth: 9 }).unwrap_err();
    assert!(matches!(error, ScanError::TooManyFiles { limit: 1, .. }));
}

#[test]
fn times_in_the_future_have_no_age() {
    let folder = campaign(&["runs/a.csv"]);
    let file = std::fs::File::options()
        .write(true)
        .open(folder.path().join("runs/a.csv"))
        .unwrap();
    file.set_modified(SystemTime::now() + Duration::from_secs(3600))
        .unwrap();
    assert_eq!(look(&folder).files[0].age, None);
}
