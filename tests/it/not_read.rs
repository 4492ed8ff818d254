//! What the system cannot give is no property of a file: it is told, tried again, and nothing is decided about it.

use std::fs;
use std::io;
use std::path::Path;
use std::time::SystemTime;

use ieap::ingest::scan::{ReadFileError, read_stable};
use ieap::pipeline::{Context, Ingest, IngestSummary, Silent};

use crate::campaign::{CampaignFolder, forge, run_table};

/// Beside a file: number of the error that the system gives for it.
fn errno_of(path: &Path) -> std::path::PathBuf {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    path.with_file_name(format!(".{name}.errno"))
}

/// A disk that gives the error that stands beside a file.
fn disk(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ReadFileError> {
    match fs::read_to_string(errno_of(path)) {
        Ok(errno) => Err(ReadFileError::Failed {
            path: path.into(),
            source: io::Error::from_raw_os_error(errno.parse().unwrap()),
        }),
        Err(_) => read_stable(path, limit_bytes),
    }
}

fn ingest(folder: &CampaignFolder) -> IngestSummary {
    let mut context = Context::open(folder.path(), false).unwrap();
    context.read_file = disk;
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap()
}

fn fail(folder: &CampaignFolder, file: &str, errno: i32) {
    fs::write(errno_of(&folder.join(file)), errno.to_string()).unwrap();
}

fn mend(folder: &CampaignFolder, file: &str) {
    fs::remove_file(errno_of(&folder.join(file))).unwrap();
}

fn unread(summary: &IngestSummary) -> Vec<&str> {
    summary.unread.iter().map(|(path, _)| path.as_str()).collect()
}

/// EIO, ENFILE, EMFILE, ENOMEM, ESTALE, EACCES of Linux.
const PASSING: [i32; 6] = [5, 23, 24, 12, 116, 13];

#[test]
fn a_passing_error_is_told_at_every_look_and_the_file_is_read_when_it_has_passed() {
    let folder = CampaignFolder::new();
    for errno in PASSING {
        let file = format!("runs/{errno}.csv");
        folder.write(&file, run_table(errno.unsigned_abs()));
        fail(&folder, &file, errno);
        for _ in 0..2 {
            let summary = ingest(&folder);
            assert_eq!(unread(&summary), [file.as_str()]);
            assert_eq!((summary.refused.len(), summary.new.len()), (0, 0));
            assert!(summary.left_out_inputs());
        }
        let status = folder.ieap(&["status"]).expect(0).stdout;
        assert!(
            status.contains(&file) && status.contains("tried again"),
            "{status}"
        );
        mend(&folder, &file);
        let summary = ingest(&folder);
        assert_eq!(summary.new, std::slice::from_ref(&file));
        assert_eq!(summary.unread, []);
        assert!(!folder.ieap(&["status"]).expect(0).stdout.contains("tried again"));
    }
}

#[test]
fn a_known_run_stays_as_it_is_until_its_new_content_can_be_read() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    assert_eq!(ingest(&folder).new, ["runs/a.csv"]);
    folder.write("runs/a.csv", run_table(2));
    fail(&folder, "runs/a.csv", 5);
    assert_eq!(unread(&ingest(&folder)), ["runs/a.csv"]);
    let document = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(document["status"]["runs"], 1);
    mend(&folder, "runs/a.csv");
    assert_eq!(ingest(&folder).replaced, ["runs/a.csv"]);
}

#[test]
fn half_a_run_is_not_stored() {
    let folder = CampaignFolder::new();
    let whole = run_table(3);
    let columns = |keep: &[usize]| -> String {
        let line = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            keep.iter().map(|&at| cells[at]).collect::<Vec<_>>().join(",")
        };
        whole.lines().map(|text| line(text) + "\n").collect()
    };
    folder.write("runs/a.current.csv", columns(&[0, 1, 2]));
    folder.write("runs/a.curvature.csv", columns(&[0, 3]));
    fail(&folder, "runs/a.curvature.csv", 5);
    let summary = ingest(&folder);
    assert_eq!(unread(&summary), ["runs/a.curvature.csv"]);
    assert!(summary.new.is_empty(), "{summary:?}");
    mend(&folder, "runs/a.curvature.csv");
    assert_eq!(ingest(&folder).new.len(), 1);
}

#[test]
fn climate_logs_and_frames_that_cannot_be_read_now_are_no_refusals() {
    let folder = CampaignFolder::new();
    folder.write(
        "ambient/box.csv",
        "time,relative_humidity_percent\n2026-03-02T10:00:00Z,40\n2026-03-02T10:01:00Z,41\n",
    );
    fail(&folder, "ambient/box.csv", 5);
    assert_eq!(unread(&ingest(&folder)), ["ambient/box.csv"]);
    mend(&folder, "ambient/box.csv");
    let summary = ingest(&folder);
    assert_eq!(
        (unread(&summary).len(), summary.logs.new.len()),
        (0, 1),
        "{summary:?}"
    );
}

/// A link that leads to itself is an error of the system for root as well.
#[cfg(unix)]
#[test]
fn the_command_says_so_with_status_3_while_it_lasts() {
    let folder = CampaignFolder::new();
    folder.write(
        "runs/f.frames/frames.toml",
        "px_per_mm = 10.0\nframes_per_second = 1.0\n",
    );
    let frame = folder.join("runs/f.frames/f1.png");
    std::os::unix::fs::symlink("f1.png", &frame).unwrap();
    for _ in 0..2 {
        let told = folder.ieap(&["run", "--no-diagnose"]).expect(3);
        assert!(
            told.stderr.contains("could not be read now") && told.stderr.contains("f.frames"),
            "{told:#?}"
        );
    }
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(status["status"]["unread"][0]["path"], "runs/f.frames");
    assert_eq!(status["status"]["refused"], serde_json::json!([]));
    fs::remove_file(&frame).unwrap();
    // Now it is the folder that is at fault.
    let refused = folder.ieap(&["run", "--no-diagnose", "--json"]).expect(3).json();
    assert_eq!(refused["run"]["ingest"]["unread"], serde_json::json!([]));
    assert_eq!(refused["run"]["ingest"]["refused"][0][0], "runs/f.frames");
}

#[cfg(unix)]
#[test]
fn runs_keep_their_tags_while_a_file_of_tags_cannot_be_read() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    assert_eq!(folder.run_json()["fit"]["fitted"], 1);
    let tags = folder.join("runs/tags.toml");
    let text = fs::read_to_string(&tags).unwrap();
    fs::remove_file(&tags).unwrap();
    std::os::unix::fs::symlink("tags.toml", &tags).unwrap();
    let told = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(told.stderr.contains("runs/tags.toml"), "{told:#?}");
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(status["status"]["runs_by_state"]["fitted"], 1, "{status:#}");
    assert_eq!(status["status"]["unreadable_tags"][0]["runs"], 1, "{status:#}");
    fs::remove_file(&tags).unwrap();
    fs::write(&tags, text).unwrap();
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(status["status"]["unreadable_tags"], serde_json::json!([]));
}

fn change_time(folder: &CampaignFolder) -> i64 {
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT changed_ns FROM source_file WHERE path = 'runs/a.csv'";
    database.query_row(sql, [], |row| row.get(0)).unwrap()
}

/// A database from before change times were stored does not read its files again: it notes the times that it finds.
#[cfg(unix)]
#[test]
fn change_times_are_noted_without_reading_the_files() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    ingest(&folder);
    let noted = change_time(&folder);
    assert_ne!(noted, 0);
    forge(folder.path(), "UPDATE source_file SET changed_ns = 0");
    fail(&folder, "runs/a.csv", 5);
    assert_eq!(ingest(&folder).unread, []);
    assert_eq!(change_time(&folder), noted);
}

/// As `cp -p` and programs that put the time back leave a file.
#[cfg(unix)]
#[test]
fn content_that_changed_at_the_same_size_and_time_is_read_again() {
    let folder = CampaignFolder::new();
    let table = run_table(1);
    folder.write("runs/a.csv", &table);
    let file = fs::OpenOptions::new()
        .write(true)
        .open(folder.join("runs/a.csv"))
        .unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    ingest(&folder);
    let other = table
        .replacen("\n0,2,9.", "\n0,2,8.", 1)
        .replacen("\n0,2,1.", "\n0,2,2.", 1);
    assert!(other.len() == table.len() && other != table);
    io::Write::write_all(&mut &file, other.as_bytes()).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    assert_eq!(ingest(&folder).revised, ["runs/a.csv"]);
}
