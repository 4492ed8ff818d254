//! Tests of the journal.

use std::fs;
use std::path::Path;

use super::file::FOLDER;
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
        transaction.says("now", Entry::Tag(tag("never")))?;
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

#[cfg(unix)]
#[test]
fn a_file_of_somebody_else_in_the_place_of_the_journal_keeps_all_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    let (path, theirs) = (path_in(folder.path()), folder.path().join("thesis.tex"));
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let text = "\\begin{document}\nwithout an end";
    std::fs::write(&theirs, text).unwrap();
    let by: [fn(&Path, &Path) -> std::io::Result<()>; 2] = [
        |from, to| std::os::unix::fs::symlink(from, to),
        |from, to| std::fs::hard_link(from, to),
    ];
    for link in by {
        link(&theirs, &path).unwrap();
        assert!(
            store
                .add_hand_tags("2026-01-01T00:00:00Z", &[tag("one")])
                .is_err()
        );
        assert_eq!(std::fs::read_to_string(&theirs).unwrap(), text);
        std::fs::remove_file(&path).unwrap();
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
    assert!(beside(folder.path(), "set-aside").contains(&damaged));
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

/// A campaign in which that was said, and its store.
fn said(values: &[&str]) -> (tempfile::TempDir, Store) {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    values.iter().for_each(|value| say(&mut store, value));
    (folder, store)
}

fn lines(folder: &Path) -> Vec<Line> {
    read(folder).unwrap().unwrap().lines
}

/// The first lines of the journal alone.
fn cut_to(folder: &Path, kept: usize) {
    let text = fs::read_to_string(path_in(folder)).unwrap();
    let first: String = text.split_inclusive('\n').take(kept).collect();
    fs::write(path_in(folder), first).unwrap();
}

#[test]
fn each_line_holds_the_checksum_of_the_one_before_and_the_database_has_them_all() {
    let (folder, store) = said(&["one", "two", "three"]);
    let lines = lines(folder.path());
    assert_eq!(lines[0].after, None);
    for pair in lines.windows(2) {
        assert_eq!(pair[1].after.as_deref(), Some(pair[0].sum()));
    }
    assert_eq!(store.course().unwrap(), lines);
    assert!(store.is_agreed(folder.path()).unwrap());
}

#[test]
fn a_journal_that_went_back_in_time_gets_what_it_lacks_at_the_next_opening_or_change() {
    for kept in [0, 1, 2] {
        let (folder, mut store) = said(&["one", "two", "three"]);
        let whole = fs::read_to_string(path_in(folder.path())).unwrap();
        cut_to(folder.path(), kept);
        assert!(!store.is_agreed(folder.path()).unwrap());
        let (_, compared) = store.compared(folder.path()).unwrap();
        assert!(compared.is_database_whole() && compared.of_database.len() == 3 - kept);
        assert_eq!(store.agree().unwrap().written.len(), 3 - kept);
        assert_eq!(fs::read_to_string(path_in(folder.path())).unwrap(), whole);
        cut_to(folder.path(), kept);
        say(&mut store, "four");
        assert_eq!(values(folder.path()), ["one", "two", "three", "four"]);
        assert!(store.is_agreed(folder.path()).unwrap());
    }
}

#[test]
fn a_database_that_went_back_in_time_is_told_what_it_lacks_and_writes_nothing_before() {
    let (folder, mut store) = said(&["one"]);
    let older = tempfile::tempdir().unwrap();
    drop(store.copy_in(older.path()).unwrap());
    say(&mut store, "two");
    say(&mut store, "three");
    drop(store);
    for companion in ["-wal", "-shm"] {
        let _ = fs::remove_file(folder.path().join(format!("campaign.db{companion}")));
    }
    fs::copy(
        older.path().join("campaign.db"),
        folder.path().join("campaign.db"),
    )
    .unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    assert!(!store.is_agreed(folder.path()).unwrap());
    let refused = store
        .add_hand_tags("2026-01-01T00:00:00Z", &[tag("four")])
        .unwrap_err();
    assert!(matches!(refused, StoreError::Lags { .. }), "{refused}");
    assert!(refused.to_string().contains("note=two"), "{refused}");
    let to_say = store.agree().unwrap().to_say;
    assert_eq!(to_say, lines(folder.path())[1..]);
    store.hear("2026-01-01T00:00:00Z", &to_say).unwrap();
    say(&mut store, "four");
    assert_eq!(values(folder.path()), ["one", "two", "three", "four"]);
}

#[test]
fn two_courses_are_refused_and_both_are_named() {
    let (folder, mut store) = said(&["one", "two"]);
    let (other, mut elsewhere) = said(&["one", "two"]);
    say(&mut store, "mine");
    say(&mut elsewhere, "theirs");
    fs::copy(path_in(other.path()), path_in(folder.path())).unwrap();
    let before = fs::read(path_in(folder.path())).unwrap();
    let tried: [Result<(), StoreError>; 3] = [
        store.agree().map(drop),
        store.add_hand_tags("2026-01-01T00:00:00Z", &[tag("more")]),
        union(folder.path(), None).map(drop),
    ];
    for refused in tried {
        let told = refused.unwrap_err().to_string();
        assert!(
            told.contains("note=mine") && told.contains("note=theirs"),
            "{told}"
        );
    }
    assert_eq!(fs::read(path_in(folder.path())).unwrap(), before);
}

/// The line is in the journal when the database refuses to commit.
#[test]
fn what_is_refused_at_the_last_step_is_taken_back_from_the_journal() {
    for in_batch in [false, true] {
        let (folder, mut store) = said(&["one"]);
        let before = fs::read(path_in(folder.path())).unwrap();
        if in_batch {
            store.begin_batch().unwrap();
        }
        let work = store.write("trying", "now", |transaction| {
            transaction.says("now", Entry::Tag(tag("never")))?;
            transaction.execute_batch("PRAGMA defer_foreign_keys = ON")?;
            transaction.execute(
                "INSERT INTO run_file (run_id, ordinal, path, hash) VALUES (77, 0, 'a', 'b')",
                [],
            )?;
            Ok(())
        });
        let ended = if in_batch { store.commit_batch() } else { work };
        assert!(ended.unwrap_err().to_string().contains("FOREIGN KEY"));
        assert_eq!(fs::read(path_in(folder.path())).unwrap(), before);
        assert!(store.is_agreed(folder.path()).unwrap());
        say(&mut store, "two");
        assert_eq!(values(folder.path()), ["one", "two"]);
    }
}

#[test]
fn lines_that_neither_has_are_missed_until_a_rebuilding_told_of_them() {
    let (folder, store) = said(&["one", "two", "three", "four"]);
    let all = lines(folder.path());
    let found = |lines: &[Line]| {
        let lines = lines.to_vec();
        let last_number = lines.last().map_or(0, |line| line.n);
        Found {
            lines,
            last_number,
            ..Found::default()
        }
    };
    let (first, later) = (&all[..1], found(&[all[0].clone(), all[3].clone()]));
    let compared = Compared::of(first, &later).unwrap();
    assert_eq!(compared.missing.iter().copied().collect::<Vec<_>>(), [2, 3]);
    assert!(!compared.can_be_said_again());
    // What the database lacks among its own lines was in no result: it is not told it as if it came last.
    let compared = Compared::of(&[all[0].clone(), all[2].clone()], &found(&all)).unwrap();
    assert!(!compared.can_be_said_again());
    let lost = "two lines".to_owned();
    let told = Line::following(None, 5, ("now".to_owned(), Entry::Missed { lost }, None)).unwrap();
    let compared = Compared::of(&[first, &[told]].concat(), &Found::default()).unwrap();
    assert!(compared.missing.is_empty());
    drop(store);
}

#[test]
fn a_rebuilding_takes_what_can_be_read_of_a_broken_database_and_of_no_foreign_one() {
    let (folder, store) = said(&["one", "two", "three"]);
    let id = store.identity().unwrap();
    drop(store);
    // Its schema is no longer one that can be opened to be worked with.
    let broken = rusqlite::Connection::open(folder.path().join("campaign.db")).unwrap();
    broken
        .execute_batch("PRAGMA user_version = 0; DROP TABLE list_sum")
        .unwrap();
    drop(broken);
    assert!(Store::open(folder.path()).is_err());
    cut_to(folder.path(), 1);
    assert_eq!(union(folder.path(), Some("another")).unwrap().of_database, []);
    assert_eq!(values(folder.path()), ["one"]);
    let both = union(folder.path(), Some(&id)).unwrap();
    assert_eq!((both.of_database.len(), both.lacks_lines), (2, false));
    assert_eq!(values(folder.path()), ["one", "two", "three"]);
}

/// A line that is lost in the database is damage: taken for one that the database never had it would be said twice.
#[test]
fn a_line_that_changed_or_vanished_in_the_database_is_damage_and_not_said_again() {
    for tampering in [
        "DELETE FROM journal_line WHERE n = 2",
        "UPDATE journal_line SET line = replace(line, 'two', 'tWo')",
        "UPDATE journal_line SET n = 7 WHERE n = 2",
        "UPDATE journal_line SET line = 'x' WHERE n = 2",
    ] {
        let (folder, mut store) = said(&["one", "two"]);
        store.connection.execute_batch(tampering).unwrap();
        let is_damaged = |outcome: Result<(), StoreError>| {
            assert!(
                matches!(outcome, Err(StoreError::Damaged { .. })),
                "{tampering}: {outcome:?}"
            );
        };
        is_damaged(store.is_agreed(folder.path()).map(drop));
        is_damaged(store.agree().map(drop));
        is_damaged(store.add_hand_tags("now", &[tag("three")]));
        assert!(!store.check_all().unwrap().is_empty());
        assert_eq!(values(folder.path()), ["one", "two"]);
    }
    let (_folder, store) = said(&["one", "two"]);
    let middle = "UPDATE journal_line SET line = replace(line, 'one', 'oNe')";
    store.connection.execute_batch(middle).unwrap();
    assert!(store.course().is_err() && !store.check_all().unwrap().is_empty());
}
