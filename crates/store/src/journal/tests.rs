//! Tests of the journal.

use std::fs;
use std::path::Path;

use super::*;
use crate::HandTag;

fn tag(value: &str) -> HandTag {
    HandTag {
        run_path: "runs/a.csv".to_owned(),
        key: "note".to_owned(),
        value: Some(value.to_owned()),
        set_by: "tester".to_owned(),
        set_at: "2026-01-01T00:00:00Z".to_owned(),
    }
}

fn say(store: &mut Store, value: &str) {
    store
        .add_hand_tags("2026-01-01T00:00:00Z", &[tag(value)])
        .unwrap();
}

fn values(folder: &Path) -> Vec<String> {
    let lines = read(folder).unwrap().unwrap().lines.into_iter();
    lines
        .filter_map(|line| match line.entry {
            Entry::Tag(tag) => tag.value,
            _ => None,
        })
        .collect()
}

#[test]
fn what_is_said_is_in_the_journal_and_what_is_taken_back_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    assert_eq!(read(folder.path()).unwrap(), None);
    say(&mut store, "one");
    store.begin_batch().unwrap();
    say(&mut store, "two");
    let refused: Result<(), StoreError> = store.write("trying", "now", |transaction| {
        transaction.says("now", Entry::Tag(tag("never")));
        transaction.execute("INSERT INTO no_such_table VALUES (1)", [])?;
        Ok(())
    });
    assert!(refused.is_err());
    say(&mut store, "three");
    assert_eq!(values(folder.path()), ["one"]);
    store.commit_batch().unwrap();
    assert_eq!(values(folder.path()), ["one", "two", "three"]);
    let found = read(folder.path()).unwrap().unwrap();
    let numbers: Vec<u64> = found.lines.iter().map(|line| line.n).collect();
    assert_eq!(numbers, [1, 2, 3]);
    assert!(found.damaged.is_empty() && found.gaps.is_empty() && !found.is_torn);
}

#[test]
fn half_a_line_is_noticed_and_cut_off_by_the_next_to_write() {
    for left in [&b"{\"n\":2,\"at\":\"20"[..], &[0; 700]] {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        say(&mut store, "one");
        let path = path_in(folder.path());
        let mut bytes = fs::read(&path).unwrap();
        bytes.extend(left);
        fs::write(&path, &bytes).unwrap();
        assert!(read(folder.path()).unwrap().unwrap().is_torn);
        say(&mut store, "two");
        let found = read(folder.path()).unwrap().unwrap();
        assert!(!found.is_torn && found.damaged.is_empty() && found.gaps.is_empty());
        assert_eq!(values(folder.path()), ["one", "two"]);
    }
}

#[test]
fn a_flipped_byte_costs_one_line_and_a_lost_line_is_missed() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    // Longer than the first look at the end of the file.
    let long = "x".repeat(40_000);
    for value in ["one", "two", &long, "four"] {
        say(&mut store, value);
    }
    let path = path_in(folder.path());
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    fs::write(&path, whole.replacen("two", "tWo", 1)).unwrap();
    let found = read(folder.path()).unwrap().unwrap();
    assert_eq!(
        (found.damaged.len(), found.damaged[0].0, found.lines.len()),
        (1, 2, 3)
    );
    assert!(found.gaps.is_empty());
    fs::write(&path, [lines[0], lines[2], lines[3]].concat()).unwrap();
    assert_eq!(read(folder.path()).unwrap().unwrap().gaps, [2]);
    // The last line is damaged: the next to write takes it from the database, and keeps what was there.
    let damaged = whole.replacen("four", "fouR", 1);
    fs::write(&path, &damaged).unwrap();
    say(&mut store, "five");
    assert!(fs::read_to_string(&path).unwrap().starts_with(&whole));
    let found = read(folder.path()).unwrap().unwrap();
    assert_eq!((found.damaged.len(), found.last_number), (0, 5));
    assert!(beside(folder.path(), "set-aside").iter().any(|text| *text == damaged));
}

/// What the files beside the journal hold whose names say that.
fn beside(folder: &Path, name: &str) -> Vec<String> {
    let entries = fs::read_dir(folder.join(FOLDER)).unwrap();
    let named = entries.map(|entry| entry.unwrap().path());
    named
        .filter(|path| path.to_string_lossy().contains(name))
        .map(|path| fs::read_to_string(path).unwrap())
        .collect()
}

#[test]
fn a_journal_that_is_not_there_is_written_from_the_database() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    for value in ["one", "two"] {
        say(&mut store, value);
    }
    fs::remove_file(path_in(folder.path())).unwrap();
    say(&mut store, "three");
    assert_eq!(values(folder.path()), ["one", "two", "three"]);
    fs::remove_file(path_in(folder.path())).unwrap();
    assert_eq!(store.agree().unwrap().written.len(), 3);
    assert_eq!(store.agree().unwrap(), Agreed::default());
    assert_eq!(values(folder.path()), ["one", "two", "three"]);
}

#[test]
fn nothing_is_stored_that_the_journal_cannot_keep() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    fs::create_dir_all(path_in(folder.path())).unwrap();
    let refused = store.add_hand_tags("2026-01-01T00:00:00Z", &[tag("one")]);
    assert!(refused.is_err());
    assert!(store.hand_tags("runs/a.csv").unwrap().is_empty());
}
