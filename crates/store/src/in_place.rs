//! Whether there is a database, which one it is, and how one takes the place of another.

use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags};

use super::place::has_no_tables;
use super::{FILE_NAME, Store, StoreError, journal};
use ieap_system::fs;

/// Smallest page of SQLite, bytes: no database is smaller.
const SMALLEST_BYTES: u64 = 512;

/// What lies in the place of a campaign's database.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// No file.
    Nothing,
    /// A file in which nothing was ever stored.
    Empty {
        /// Its size.
        bytes: u64,
    },
    /// Something else: a database, or what is refused when it is opened.
    Something,
}

/// Looks for the database of the campaign in `folder`; nothing is made or changed.
pub fn found(folder: &Path) -> Found {
    let path = folder.join(FILE_NAME);
    match fs::symlink_metadata(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Found::Nothing,
        // Whoever opens it refuses it, with the reason.
        Ok(file) if !file.is_file() => Found::Something,
        Ok(file) if file.len() < SMALLEST_BYTES || is_blank(&path) => Found::Empty { bytes: file.len() },
        _ => Found::Something,
    }
}

fn is_blank(path: &Path) -> bool {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let opened = Connection::open_with_flags(path, flags);
    opened.is_ok_and(|connection| has_no_tables(&connection).unwrap_or(false))
}

/// A mark for what is moved aside at `now`, under which nothing was before: two may be moved in one second. Whoever asks holds
/// the lock of the campaign.
///
/// # Errors
/// The system cannot tell what is there.
pub fn free_mark(folder: &Path, now: &str) -> Result<String, StoreError> {
    let first = now.replace([':', '-'], "");
    let (mut mark, mut more) = (first.clone(), 1);
    while is_taken(&folder.join(format!("{FILE_NAME}.set-aside-{mark}")))?
        || is_taken(&journal::aside_in(folder, &mark))?
    {
        more += 1;
        mark = format!("{first}-{more}");
    }
    Ok(mark)
}

fn is_taken(path: &Path) -> Result<bool, StoreError> {
    match fs::symlink_metadata(path) {
        Ok(_) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(StoreError::File {
            path: path.to_owned(),
            doing: "looking for a free name",
            source,
        }),
    }
}

/// Moves what lies in the place of the database aside, with its companions; gives the new name. `mark` tells it from
/// others that were moved aside.
///
/// # Errors
/// A file cannot be renamed.
pub fn set_aside(folder: &Path, mark: &str) -> Result<Option<PathBuf>, StoreError> {
    let (from, to) = (
        folder.join(FILE_NAME),
        folder.join(format!("{FILE_NAME}.set-aside-{mark}")),
    );
    let mut moved = None;
    for companion in ["", "-wal", "-shm"] {
        let with = |path: &Path| PathBuf::from(format!("{}{companion}", path.display()));
        match fs::rename(with(&from), with(&to)) {
            Ok(()) => moved = Some(to.clone()),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(source) => {
                return Err(StoreError::File {
                    path: with(&from),
                    doing: "moving the database aside",
                    source,
                });
            }
        }
    }
    Ok(moved)
}

/// Puts the database that was made in the folder `made` in the place of that of the campaign in `folder`. What lies there is
/// moved aside; gives its new name.
///
/// # Errors
/// A file cannot be brought to the disk or renamed. Where that is the last step the campaign has no database for the
/// moment, and the one that was made stays in `made`.
pub fn put_in_place(made: &Path, folder: &Path, mark: &str) -> Result<Option<PathBuf>, StoreError> {
    let (from, to) = (made.join(FILE_NAME), folder.join(FILE_NAME));
    let failed = |path: &Path, source| StoreError::File {
        path: path.to_owned(),
        doing: "putting the new database in place",
        source,
    };
    let synced = fs::File::open_own(&from).and_then(|file| file.sync_all());
    synced.map_err(|source| failed(&from, source))?;
    let aside = set_aside(folder, mark)?;
    fs::rename(&from, &to).map_err(|source| failed(&to, source))?;
    fs::sync_names(folder).map_err(|source| failed(folder, source))?;
    Ok(aside)
}

impl Store {
    /// Refuses to go on where the database file, or its write-ahead log, was deleted or replaced since it was opened:
    /// what is written into an unlinked file is lost.
    ///
    /// # Errors
    /// [`StoreError::Replaced`].
    pub fn check_in_place(&self) -> Result<(), StoreError> {
        self.place.check(&self.path)
    }

    /// What tells this database from every other.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn identity(&self) -> Result<String, StoreError> {
        self.connection
            .query_row("SELECT id FROM identity", [], |row| row.get(0))
            .map_err(|e| self.failed("reading the database's id", e))
    }
}

impl Store {
    /// Makes this the database of an archive: a database that is made anew from it takes the id of the old one.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn take_identity(&mut self, now: &str, id: &str) -> Result<(), StoreError> {
        self.write("taking the database's id", now, |transaction| {
            transaction.execute("UPDATE identity SET id = ?1", [id])?;
            Ok(())
        })
    }

    /// Closes a database that was made, with everything in its one file, opens that file once more and holds what it says
    /// against what was made.
    ///
    /// # Errors
    /// See [`StoreError`]; [`StoreError::NotAsMade`] where a part is not in the file.
    pub fn close_whole(self) -> Result<(), StoreError> {
        let (made, path) = (self.content()?, self.path.clone());
        let doing = "writing everything into the new database";
        // Whoever closes hears nothing of what fails here: it is done, and its result read, while one can.
        let (is_busy, left): (bool, i64) = self
            .connection
            .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| {
                Ok((row.get("busy")?, row.get("log")?))
            })
            .map_err(|e| self.failed(doing, e))?;
        let not_as_made = |detail: &str| StoreError::NotAsMade {
            path: path.clone(),
            detail: detail.to_owned(),
        };
        if is_busy || left > 0 {
            return Err(not_as_made("its write-ahead log is still in use"));
        }
        let closed = self.connection.close();
        closed.map_err(|(_, e)| StoreError::from_sql(&path, doing, e))?;
        let written = Store::open_copy(&path)?;
        if let Some(fault) = written.check_all()?.into_iter().next() {
            return Err(not_as_made(&fault));
        }
        match written.content()?.differences(&made).first() {
            None => Ok(()),
            Some((kind, name)) => Err(not_as_made(&format!("{kind} {name} is another one"))),
        }
    }

    /// Copies the database, as it is at one moment, into `folder` and opens the copy. What is said to it goes to no journal.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn copy_in(&self, folder: &Path) -> Result<Store, StoreError> {
        let copied = self.connection.backup("main", folder.join(FILE_NAME), None);
        copied.map_err(|e| self.failed("copying the database", e))?;
        let mut copy = Store::open(folder)?;
        copy.keep_journal_in(None);
        Ok(copy)
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_lies_in_the_place_of_a_database_is_told() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(found(folder.path()), Found::Nothing);
        let path = folder.path().join(FILE_NAME);
        for bytes in [0, 1, 100] {
            std::fs::write(&path, vec![0; bytes]).unwrap();
            assert_eq!(found(folder.path()), Found::Empty { bytes: bytes as u64 });
        }
        std::fs::remove_file(&path).unwrap();
        Connection::open(&path)
            .unwrap()
            .pragma_update(None, "journal_mode", "WAL")
            .unwrap();
        assert!(matches!(found(folder.path()), Found::Empty { bytes } if bytes > 100));
        std::fs::write(&path, vec![7; 5000]).unwrap();
        assert_eq!(found(folder.path()), Found::Something);
        std::fs::remove_file(&path).unwrap();
        drop(Store::open(folder.path()).unwrap());
        assert_eq!(found(folder.path()), Found::Something);
    }

    #[test]
    fn what_is_set_aside_in_one_second_has_names_of_its_own_and_what_cannot_be_asked_ends() {
        let folder = tempfile::tempdir().unwrap();
        let mark = || free_mark(folder.path(), "2026-01-01T00:00:00Z");
        assert_eq!(mark().unwrap(), "20260101T000000Z");
        for expected in ["20260101T000000Z-2", "20260101T000000Z-3"] {
            let taken = format!("{FILE_NAME}.set-aside-{}", mark().unwrap());
            std::fs::write(folder.path().join(taken), "").unwrap();
            assert_eq!(mark().unwrap(), expected);
        }
        let file = folder.path().join("no folder");
        std::fs::write(&file, "").unwrap();
        assert!(matches!(free_mark(&file, "now"), Err(StoreError::File { .. })));
    }

    #[test]
    fn nothing_is_written_into_a_file_that_lost_its_name() {
        for lost in ["", "-wal"] {
            let folder = tempfile::tempdir().unwrap();
            let mut store = Store::open(folder.path()).unwrap();
            store.record_files("now", &[]).unwrap();
            store.mark_missing("now", &["a".to_owned()]).unwrap();
            store.check_in_place().unwrap();
            let path = folder.path().join(format!("{FILE_NAME}{lost}"));
            let away = folder.path().join("away");
            std::fs::rename(&path, &away).unwrap();
            let refused = store.mark_missing("now", &["a".to_owned()]).unwrap_err();
            assert!(matches!(refused, StoreError::Replaced { .. }), "{refused}");
            assert!(store.begin_batch().is_err());
            std::fs::copy(&away, &path).unwrap();
            assert!(store.check_in_place().is_err(), "a copy is another file");
        }
    }

    #[test]
    fn a_database_that_does_not_read_back_as_it_was_made_is_refused() {
        let (folder, older) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let store = Store::open(folder.path()).unwrap();
        drop(store.copy_in(older.path()).unwrap());
        store.close_whole().unwrap();
        let log = folder.path().join(format!("{FILE_NAME}-wal"));
        assert!(!log.exists());
        let mut store = Store::open(folder.path()).unwrap();
        let file = crate::FileRow::unseen(
            "runs/a.csv".to_owned(),
            ieap_domain::FileState::Pending,
            String::new(),
        );
        store.record_files("now", &[file]).unwrap();
        // The file under its name is not the one that was written to.
        let path = folder.path().join(FILE_NAME);
        std::fs::rename(&path, folder.path().join("away")).unwrap();
        std::fs::copy(older.path().join(FILE_NAME), &path).unwrap();
        let refused = store.close_whole().unwrap_err();
        assert!(
            matches!(refused, StoreError::NotAsMade { .. }) && refused.to_string().contains("runs/a.csv"),
            "{refused}"
        );
    }

    #[test]
    fn each_database_has_an_id_of_its_own_and_keeps_it() {
        let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let id = |folder: &Path| Store::open(folder).unwrap().identity().unwrap();
        assert_eq!(id(one.path()), id(one.path()));
        assert_ne!(id(one.path()), id(two.path()));
    }
}
