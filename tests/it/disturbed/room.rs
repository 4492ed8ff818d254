//! A small campaign, and rooms that each hold a copy of it and of its backup.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use ieap::pipeline::Context;
use ieap::pipeline::show::explain::explain;
use tempfile::TempDir;

use super::verbs::{DATABASE, LOG, WORDS, Word, backup, drop_run, settle, tag};
use crate::campaign::{CAMPAIGN_TOML, TAGS_TOML};

/// The campaign in a room.
pub const CAMPAIGN: &str = "c";
/// Its backup.
pub const BACKUP: &str = "b";
/// A backup that is made in a trial.
pub const AGAIN: &str = "n";
/// A campaign that is restored in a trial.
pub const RESTORED: &str = "r";

/// What was said of the campaign and acknowledged.
pub const SAID: [Word; 3] = [
    Word {
        key: "environment",
        text: "vacuum",
    },
    Word {
        key: "outcome",
        text: "slipped",
    },
    Word {
        key: "relative_humidity_percent",
        text: "35",
    },
];

/// The campaign as it is copied into every room, and files of it as they were.
pub struct Base {
    room: TempDir,
    /// The database before any word was said, and before the last one was.
    pub older: [Vec<u8>; 2],
    /// The words before the last one was said.
    pub older_words: Vec<u8>,
    /// The log of the last change.
    pub log: Vec<u8>,
    /// The database as it is.
    pub database: Vec<u8>,
    /// The words as they are.
    pub words: Vec<u8>,
    /// λ of a run, which is shown.
    pub lambda_per_s: f64,
}

impl Base {
    /// Where it lies.
    pub fn room(&self) -> &Path {
        self.room.path()
    }
}

/// The campaign, made once.
pub fn base() -> &'static Base {
    static BASE: LazyLock<Base> = LazyLock::new(made);
    &BASE
}

/// Three runs, of which one is tagged with a sidecar, two by hand, and one is dropped; a fourth, and another sidecar, wait in
/// the folder; and a backup.
fn made() -> Base {
    let room = empty();
    let campaign = room.path().join(CAMPAIGN);
    let (folder, at) = (campaign.as_path(), |name: &str| campaign.join(name));
    fs::create_dir_all(at("runs")).unwrap();
    fs::write(at("campaign.toml"), CAMPAIGN_TOML).unwrap();
    fs::write(at("runs/tags.toml"), TAGS_TOML).unwrap();
    for (name, seed) in [("a", 1), ("b", 2), ("c", 3)] {
        fs::write(at(&format!("runs/{name}.csv")), readings(seed)).unwrap();
    }
    fs::write(at("runs/a.csv.toml"), "temperature_c = 20.0\n").unwrap();
    let takes = || assert_eq!(settle(folder).unwrap(), 0);
    takes();
    let first = whole(folder);
    tag(folder, "runs/b.csv", "environment", "vacuum").unwrap();
    drop_run(folder, "runs/c.csv", "slipped").unwrap();
    takes();
    let (second, older_words) = (whole(folder), fs::read(at(WORDS)).unwrap());
    // As long as somebody reads the log stays.
    let reader = rusqlite::Connection::open(at(DATABASE)).unwrap();
    let _: i64 = reader
        .query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))
        .unwrap();
    tag(folder, "runs/a.csv", "relative_humidity_percent", "35").unwrap();
    takes();
    let log = fs::read(at(LOG)).unwrap();
    drop(reader);
    let database = whole(folder);
    fs::write(at("runs/d.csv"), readings(4)).unwrap();
    fs::write(at("runs/a.csv.toml"), "temperature_c = 22.0\n").unwrap();
    assert_eq!(backup(folder, &room.path().join(BACKUP)).unwrap(), 0);
    let context = Context::open_read_only(folder).unwrap();
    let lambda = explain(&context, "table5", "1", "lambda_per_s").unwrap();
    Base {
        lambda_per_s: lambda.value.unwrap(),
        older: [first, second],
        older_words,
        log,
        database,
        words: fs::read(at(WORDS)).unwrap(),
        room,
    }
}

/// A room with nothing in it.
fn empty() -> TempDir {
    let in_memory = tempfile::Builder::new()
        .prefix("ieap-room-")
        .tempdir_in("/dev/shm");
    in_memory.unwrap_or_else(|_| tempfile::tempdir().unwrap())
}

/// A room with the campaign and its backup.
pub fn room() -> TempDir {
    let room = empty();
    copied(base().room.path(), room.path());
    room
}

/// The database in one file.
fn whole(campaign: &Path) -> Vec<u8> {
    let connection = rusqlite::Connection::open(campaign.join(DATABASE)).unwrap();
    connection
        .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))
        .unwrap();
    drop(connection);
    fs::read(campaign.join(DATABASE)).unwrap()
}

/// Every file of a folder, copied into another.
pub fn copied(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            fs::create_dir_all(&to).unwrap();
            copied(&path, &to);
        } else {
            fs::copy(&path, &to).unwrap();
        }
    }
}

/// Every file of a folder and those below it, by path, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut waiting) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(below) = waiting.pop() {
        for entry in fs::read_dir(&below).unwrap().map(Result::unwrap) {
            match entry.path() {
                path if path.is_dir() => waiting.push(path),
                path => found.push(path),
            }
        }
    }
    found.sort();
    found
}

/// A simulated run, short, so that it is fitted at once.
pub fn readings(seed: u32) -> String {
    let mut text = String::from("time_s,voltage_v,current_a,curvature_per_cm\n");
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    for step in -5i32..60 {
        let (t, on) = (f64::from(step), f64::from(u8::from(step >= 0)));
        let current_a = on * (1e-3 * (-t / 5.0).exp() + 2e-5) + 4e-6 * noise();
        let relaxed = ((-t / 5.0).exp() - (-0.01 * t).exp()) / (5.0 * 0.01 - 1.0);
        let curvature = on * 0.4 * relaxed + 4e-3 * noise();
        text += &format!("{step},{},{current_a:.5e},{curvature:.5}\n", 2.0 * on);
    }
    text
}
