//! Rows that changed behind the back of the store are noticed when they are read.

use std::collections::BTreeSet;

use rusqlite::Connection;

use super::*;
use crate::{FileRow, HandTag, Store, StoreError};
use ieap_domain::FileState;

fn file(path: &str) -> FileRow {
    FileRow {
        path: path.to_owned(),
        size_bytes: 1,
        modified_ns: 1,
        inode: 0,
        changed_ns: 0,
        hash: None,
        state: FileState::Pending,
        reader: String::new(),
        issue: None,
        missing_since: None,
    }
}

fn hand_tag(value: &str) -> HandTag {
    HandTag {
        run_path: "runs/a.csv".to_owned(),
        key: "note".to_owned(),
        value: Some(value.to_owned()),
        set_by: "tester".to_owned(),
        set_at: "now".to_owned(),
    }
}

fn is_damaged<T>(outcome: Result<T, StoreError>) -> bool {
    matches!(outcome, Err(StoreError::Damaged { .. }))
}

#[test]
fn a_row_that_changed_or_vanished_is_noticed_and_never_sealed_again() {
    for tampering in [
        "UPDATE hand_tag SET value = 'other'",
        "UPDATE hand_tag SET run_path = 'runs/b.csv' WHERE value = 'second'",
        "DELETE FROM hand_tag WHERE value = 'first'",
        "DELETE FROM hand_tag",
        "DELETE FROM seal WHERE subject = 'hand tags'",
        "UPDATE seal SET sum = x'00' WHERE subject = 'hand tags'",
    ] {
        let mut store = Store::in_memory().unwrap();
        store
            .add_hand_tags("now", &[hand_tag("first"), hand_tag("second")])
            .unwrap();
        assert_eq!(store.hand_tags("runs/a.csv").unwrap().len(), 1);
        assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
        store.connection.execute_batch(tampering).unwrap();
        assert!(is_damaged(store.hand_tags("runs/a.csv")), "{tampering}");
        assert!(
            is_damaged(store.add_hand_tags("now", &[hand_tag("third")])),
            "{tampering}"
        );
        assert!(is_damaged(store.hand_tags("runs/a.csv")), "{tampering}");
    }
}

#[test]
fn what_a_batch_changed_is_read_in_it_and_sealed_at_its_end() {
    let mut store = Store::in_memory().unwrap();
    store.begin_batch().unwrap();
    store.record_files("now", &[file("a"), file("b")]).unwrap();
    store.mark_missing("now", &["a".to_owned()]).unwrap();
    assert_eq!(store.files().unwrap().len(), 2);
    let failed = store.write("trying", "now", |transaction| {
        transaction.changes(Subject::File("b".to_owned()))?;
        transaction.execute("DELETE FROM source_file", [])?;
        transaction.execute("INSERT INTO no_such_table VALUES (1)", [])?;
        Ok(())
    });
    assert!(failed.is_err());
    store.commit_batch().unwrap();
    assert_eq!(store.files().unwrap().len(), 2);
    assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
    store
        .connection
        .execute_batch("UPDATE source_file SET size_bytes = 2 WHERE path = 'b'")
        .unwrap();
    assert!(is_damaged(store.files()));
    assert_eq!(store.check_all().unwrap().len(), 1);
}

/// Without its seals whatever changed would pass, and the next opening would seal it.
#[test]
fn a_database_that_lost_its_seals_is_damaged_and_never_sealed_again() {
    for lost in [
        "DELETE FROM seal",
        "DELETE FROM seal WHERE subject = 'schema'",
        "UPDATE seal SET id = 17 WHERE subject = 'schema'",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        store.record_files("now", &[file("a")]).unwrap();
        store.connection.execute_batch(lost).unwrap();
        drop(store);
        for _ in 0..2 {
            assert!(is_damaged(Store::open_read_only(folder.path())), "{lost}");
            assert!(is_damaged(Store::open(folder.path())), "{lost}");
        }
    }
}

#[test]
fn values_of_other_types_and_places_have_other_seals() {
    let connection = Connection::open_in_memory().unwrap();
    let seal_of = |sql: &str| {
        let mut hasher = blake3::Hasher::new();
        let mut statement = connection.prepare(sql).unwrap();
        let columns = statement.column_count();
        let mut rows = statement.query([]).unwrap();
        while let Some(row) = rows.next().unwrap() {
            add_row(&mut hasher, row, columns).unwrap();
        }
        finished(&hasher)
    };
    let of = [
        "SELECT 1, 2",
        "SELECT 2, 1",
        "SELECT 1.0, 2",
        "SELECT '1', 2",
        "SELECT x'31', 2",
        "SELECT NULL, 2",
        "SELECT '1' || '2', ''",
        "SELECT '', '12'",
        "SELECT 1 UNION ALL SELECT 2",
    ];
    let seals: BTreeSet<Seal> = of.iter().map(|sql| seal_of(sql)).collect();
    assert_eq!(seals.len(), of.len());
}

#[test]
fn connections_that_write_by_turns_find_what_the_others_sealed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut one, mut two) = (
        Store::open(folder.path()).unwrap(),
        Store::open(folder.path()).unwrap(),
    );
    for turn in 1..4 {
        one.add_hand_tags("now", &[hand_tag("one")]).unwrap();
        one.record_files("now", &[file("a")]).unwrap();
        two.begin_batch().unwrap();
        two.add_hand_tags("now", &[hand_tag("two")]).unwrap();
        two.note_change_times("now", &[("a", turn)]).unwrap();
        two.commit_batch().unwrap();
        assert_eq!(one.files().unwrap()[0].changed_ns, turn);
    }
    // What a batch had open that the database gave up is looked at again.
    one.begin_batch().unwrap();
    one.note_change_times("now", &[("a", 7)]).unwrap();
    one.connection.execute_batch("ROLLBACK").unwrap();
    let tampering = "UPDATE source_file SET size_bytes = 9";
    two.connection.execute_batch(tampering).unwrap();
    assert!(is_damaged(one.note_change_times("now", &[("a", 8)])));
    assert!(is_damaged(one.files()));
}

#[test]
fn threads_that_write_and_read_at_once_raise_no_false_alarm() {
    let folder = tempfile::tempdir().unwrap();
    drop(Store::open(folder.path()).unwrap());
    let open = || Store::open(folder.path()).unwrap();
    std::thread::scope(|threads| {
        for name in ["one", "two"] {
            threads.spawn(move || {
                let mut store = open();
                for turn in 0..10 {
                    store.add_hand_tags("now", &[hand_tag(name)]).unwrap();
                    store.record_files("now", &[file("a")]).unwrap();
                    store.note_change_times("now", &[("a", turn)]).unwrap();
                }
            });
        }
        let store = open();
        for _ in 0..20 {
            assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
            store.files().unwrap();
            store.changes().unwrap();
        }
    });
}
