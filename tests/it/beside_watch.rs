//! Beside `watch`, which is killed again and again, people rename, drop, tag and replace runs: what stands at the end is what
//! archive and journal give, table by table.

use std::collections::BTreeSet;
use std::fs;
use std::process::{Child, Stdio};
use std::time::Duration;

use ieap::store::{ResultKind, Store};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::between::strays;
use crate::campaign::{CampaignFolder, Ended, command, run_table};
use crate::rebuild::{content, same, without_database};
use crate::watch::until;

/// Seed of the short form; `IEAP_BESIDE_SEED` draws another course.
const SEED: u64 = 20_261_128;
/// Names that files have and take: few, so that most were another run's before.
const NAMES: [&str; 9] = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
/// Files at the start.
const FILES: usize = 6;
/// Longest time between two changes, and between a change and a kill, ms.
const LONGEST_MS: u64 = 400;

/// What somebody does beside the watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Change {
    Renames,
    Swaps,
    Replaces,
    Deletes,
    TagsByHand,
    TagsInAFile,
    UntagsInAFile,
    Drops,
    PutsBack,
}

impl Change {
    const ALL: [Change; 9] = [
        Change::Renames,
        Change::Swaps,
        Change::Replaces,
        Change::Deletes,
        Change::TagsByHand,
        Change::TagsInAFile,
        Change::UntagsInAFile,
        Change::Drops,
        Change::PutsBack,
    ];
}

/// Readings of a quick fit that no other file has.
fn readings(seed: u32) -> String {
    run_table(seed).lines().take(120).collect::<Vec<_>>().join("\n") + "\n"
}

/// A campaign and what was done to it.
struct Course {
    folder: CampaignFolder,
    rng: ChaCha8Rng,
    watch: Option<Child>,
    /// Files written so far, each with readings of its own.
    written: u32,
    /// Words that a verb took, each with a number of its own.
    said: Vec<String>,
    /// Words that were refused, for the run was not known by that name at that moment.
    refused: usize,
    /// Kinds of changes that were done.
    done: BTreeSet<Change>,
}

impl Course {
    fn new(seed: u64) -> Course {
        let mut course = Course {
            folder: CampaignFolder::new(),
            rng: ChaCha8Rng::seed_from_u64(seed),
            watch: None,
            written: 0,
            said: Vec::new(),
            refused: 0,
            done: BTreeSet::new(),
        };
        for name in &NAMES[..FILES] {
            course.writes(name);
        }
        course
    }

    fn writes(&mut self, name: &str) {
        self.written += 1;
        self.folder.write(&file(name), readings(self.written));
    }

    /// Starts the watch where none works, and waits until the database is there.
    fn watches(&mut self) {
        if self.watch.is_some() {
            return;
        }
        let arguments = ["watch", "--quiet-s", "0.1", "--no-diagnose"];
        let child = command(self.folder.path(), &arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        self.watch = Some(child);
        until("a database", || self.folder.join("report/index.html").exists());
    }

    /// Kills the watch at some moment after the last change.
    fn kills(&mut self) {
        self.waits();
        let mut watch = self.watch.take().unwrap();
        assert!(watch.try_wait().unwrap().is_none(), "the watch ended by itself");
        watch.kill().unwrap();
        watch.wait().unwrap();
        assert_eq!(strays(self.folder.path()), 0);
    }

    fn waits(&mut self) {
        std::thread::sleep(Duration::from_millis(self.rng.random_range(0..LONGEST_MS)));
    }

    /// Names of which there is a file, or of which there is none.
    fn names(&self, is_there: bool) -> Vec<&'static str> {
        let of = |name: &&str| self.folder.join(&file(name)).exists() == is_there;
        NAMES.into_iter().filter(of).collect()
    }

    fn one(&mut self, is_there: bool) -> &'static str {
        self.names(is_there).choose(&mut self.rng).copied().unwrap()
    }

    fn moves(&self, from: &str, to: &str) {
        fs::rename(self.folder.join(&file(from)), self.folder.join(&file(to))).unwrap();
    }

    /// One change; where files are few one more comes.
    fn changes(&mut self) {
        if self.names(true).len() < FILES {
            let name = self.one(false);
            self.writes(name);
        }
        let change = *Change::ALL.choose(&mut self.rng).unwrap();
        let of = self.one(true);
        let sidecar = format!("{}.toml", file(of));
        match change {
            Change::Renames => self.moves(of, self.names(false)[0]),
            Change::Swaps => {
                let (other, away) = (self.one(true), self.names(false)[0]);
                self.moves(of, away);
                if other != of {
                    self.moves(other, of);
                }
                self.moves(away, other);
            }
            Change::Replaces => self.writes(of),
            Change::Deletes => fs::remove_file(self.folder.join(&file(of))).unwrap(),
            Change::TagsByHand => self.says(of, |word| vec!["tag".into(), file(of), format!("note={word}")]),
            Change::TagsInAFile => {
                let cycle = self.rng.random_range(1..9);
                self.folder.write(&sidecar, format!("cycle = {cycle}\n"));
            }
            Change::UntagsInAFile => drop(fs::remove_file(self.folder.join(&sidecar))),
            Change::Drops => self.says(of, |word| vec!["drop".into(), file(of), "--why".into(), word]),
            Change::PutsBack => self.says(of, |word| {
                vec!["drop".into(), "--undo".into(), file(of), "--why".into(), word]
            }),
        }
        self.done.insert(change);
        self.waits();
    }

    /// Says a word; one that a verb takes must not be lost.
    fn says(&mut self, of: &str, arguments: impl FnOnce(String) -> Vec<String>) {
        let word = format!("word {}", self.said.len() + self.refused);
        let arguments = arguments(word.clone());
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let ended = self.folder.ieap(&arguments);
        match ended.status {
            0 | 3 => self.said.push(word),
            2 => self.refused += 1,
            _ => panic!("{of}: {ended:#?}"),
        }
    }
}

fn file(name: &str) -> String {
    format!("runs/{name}.csv")
}

fn settled(folder: &CampaignFolder) {
    let ended = folder.ieap(&["run", "--no-diagnose"]);
    assert!([0, 3].contains(&ended.status), "{ended:#?}");
}

/// So many changes beside a watch that is killed so often; then everything is held against a rebuilt copy.
fn come_to_the_same(seed: u64, changes: usize, kills: usize) {
    let mut course = Course::new(seed);
    for change in 0..changes {
        course.watches();
        course.changes();
        if (change + 1) * kills / changes > change * kills / changes {
            course.kills();
        }
    }
    drop(course.watch.take().map(|mut watch| (watch.kill(), watch.wait())));
    let folder = &course.folder;
    settled(folder);
    assert_eq!(strays(folder.path()), 0);
    let journal = fs::read_to_string(folder.join("archive/journal.jsonl")).unwrap();
    for word in &course.said {
        assert!(journal.contains(&format!("\"{word}\"")), "{word}");
    }
    let sound = |ended: Ended| assert!(ended.status == 0, "seed {seed}: {ended:#?}");
    sound(folder.ieap(&["verify"]));
    sound(folder.ieap(&["verify", "--deep"]));
    // The same without `verify`: the database beside the one that is made anew.
    let before = content(folder);
    let old = tempfile::tempdir().unwrap();
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    store.copy_in(old.path()).unwrap();
    drop(store);
    without_database(folder.path());
    let rebuilt = folder.ieap(&["rebuild"]);
    assert!([0, 3].contains(&rebuilt.status), "{rebuilt:#?}");
    settled(folder);
    same(&content(folder), &before);
    let [old, new] = [old.path(), folder.path()].map(|at| Store::open_read_only(at).unwrap().unwrap());
    let (differing, tables) = old.table_by_table(&new, &[ResultKind::Fit]).unwrap();
    let now = fs::read_to_string(folder.join("archive/journal.jsonl")).unwrap();
    let since = now.strip_prefix(&journal).unwrap_or(&now);
    assert_eq!(differing, [], "seed {seed}: said since: {since}");
    assert_eq!(strays(folder.path()), 0);
    eprintln!(
        "seed {seed}: {changes} changes of {} kinds, {kills} kills, {} words kept, {} refused; {} tables the same, 0 stray",
        course.done.len(),
        course.said.len(),
        course.refused,
        tables.len()
    );
}

fn seed() -> u64 {
    let seed = std::env::var("IEAP_BESIDE_SEED").ok();
    seed.map_or(SEED, |seed| seed.parse().unwrap())
}

#[test]
fn changes_beside_a_watch_that_is_killed_come_to_what_a_rebuilt_copy_has() {
    come_to_the_same(seed(), 20, 2);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn hundreds_of_changes_beside_a_watch_that_is_killed_come_to_what_a_rebuilt_copy_has() {
    come_to_the_same(seed(), 300, 20);
}
