//! The open database: how it is opened, and how rows are read from it.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, OpenFlags};

use super::error::named;
use super::journal::Journal;
use super::place::{FILE_NAME, Place, refuse_other_than_files};
use super::rows::CHANGE_COUNT;
use super::whole_lists::WholeLists;
use super::words::Remembered;
use super::{StepError, StoreError, migration, schema, views};
use ieap_system::fs;

/// First SQLite without the WAL-reset corruption bug.
const OLDEST_SQLITE: i32 = 3_051_003;

/// Prepared statements that a connection keeps: more than there are queries.
const STATEMENTS: usize = 256;

/// How long a connection waits for another one's lock: several times what the largest batch of files takes to store on a
/// slow disk.
const BUSY_TIMEOUT: Duration = Duration::from_secs(30);

/// A campaign's database.
#[derive(Debug)]
pub struct Store {
    pub(super) connection: Connection,
    pub(super) path: PathBuf,
    pub(super) place: Place,
    pub(super) journal: Journal,
    pub(super) remembered: RefCell<Remembered>,
    pub(super) whole_lists: WholeLists,
}

impl Store {
    /// Opens the database of the campaign in `folder` for writing; makes it where there is none.
    ///
    /// # Errors
    /// See [`StoreError`]; a newer schema is refused, and an older one: such a database is made anew.
    pub fn open(folder: &Path) -> Result<Store, StoreError> {
        check_sqlite()?;
        let path = folder.join(FILE_NAME);
        refuse_other_than_files(&path)?;
        let mut connection = Connection::open_with_flags(
            &path,
            OpenFlags::SQLITE_OPEN_READ_WRITE
                | OpenFlags::SQLITE_OPEN_CREATE
                | OpenFlags::SQLITE_OPEN_NO_MUTEX,
        )
        .map_err(|e| StoreError::from_sql(&path, "opening", e))?;
        configure(&connection).map_err(|e| StoreError::from_sql(&path, "opening", e))?;
        migration::make(&mut connection, &path)?;
        schema::refuse_changed(&connection, &path)?;
        views::put(&mut connection).map_err(|e| StoreError::from_sql(&path, "making the views", e))?;
        Ok(Store {
            connection,
            place: Place::of(&path)?,
            path,
            journal: Journal::of(folder),
            remembered: RefCell::default(),
            whole_lists: WholeLists::default(),
        })
    }

    /// Opens the database for reading beside a working instance. `None` where there is none yet.
    ///
    /// # Errors
    /// See [`StoreError`]; a schema that this program does not write is refused, and never changed: whoever reads holds
    /// no lock.
    pub fn open_read_only(folder: &Path) -> Result<Option<Store>, StoreError> {
        check_sqlite()?;
        let path = folder.join(FILE_NAME);
        refuse_other_than_files(&path)?;
        let there = fs::exists(&path).map_err(|source| StoreError::File {
            path: path.clone(),
            doing: "looking for the database",
            source,
        })?;
        if !there {
            return Ok(None);
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let opened = open_to_read(&path, &path.to_string_lossy(), flags).or_else(|refused| {
            // A write-ahead log needs a folder that can be written. Without a log waiting to be merged, a
            // database on a read-only disk can be read as it stands.
            let log = folder.join(format!("{FILE_NAME}-wal"));
            let settled = fs::metadata(log).map_or(true, |log| log.len() == 0);
            match (refused, as_uri(&path, "immutable=1")) {
                (StoreError::CannotOpen { .. } | StoreError::ReadOnly { .. }, Some(uri)) if settled => {
                    open_to_read(&path, &uri, flags | OpenFlags::SQLITE_OPEN_URI)
                }
                (refused, _) => Err(refused),
            }
        });
        let (connection, found) = opened?;
        migration::refuse(found, &path)?;
        migration::refuse_unversioned(&connection, &path, found)?;
        if found == ieap_migrations::NEWEST {
            schema::refuse_changed(&connection, &path)?;
        }
        if found == 0 {
            return Ok(None);
        }
        Ok(Some(Store {
            connection,
            path,
            place: Place::default(),
            journal: Journal::default(),
            remembered: RefCell::default(),
            whole_lists: WholeLists::default(),
        }))
    }

    /// A database in memory, for tests.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn in_memory() -> Result<Store, StoreError> {
        let path = PathBuf::from(":memory:");
        let mut connection =
            Connection::open_in_memory().map_err(|e| StoreError::from_sql(&path, "opening", e))?;
        configure(&connection).map_err(|e| StoreError::from_sql(&path, "opening", e))?;
        migration::make(&mut connection, &path)?;
        views::put(&mut connection).map_err(|e| StoreError::from_sql(&path, "making the views", e))?;
        Ok(Store {
            connection,
            path,
            place: Place::default(),
            journal: Journal::default(),
            remembered: RefCell::default(),
            whole_lists: WholeLists::default(),
        })
    }

    /// The database file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of committed changes so far, and when the last one was made (RFC 3339 UTC).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn changes(&self) -> Result<(u64, String), StoreError> {
        let read = |row: &rusqlite::Row<'_>| {
            Ok((
                row.get::<_, i64>("changes")?.unsigned_abs(),
                row.get("changed_at")?,
            ))
        };
        let found = self.listed("counting changes", CHANGE_COUNT, "change_count", read)?;
        found.into_iter().next().ok_or_else(|| StoreError::Damaged {
            what: "the count of changes".to_owned(),
        })
    }

    /// Rows of `sql`, read one by one.
    pub(super) fn rows<T>(
        &self,
        doing: &'static str,
        sql: &str,
        parameters: impl rusqlite::Params,
        read: impl Fn(&rusqlite::Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let mut statement = self
            .connection
            .prepare_cached(sql)
            .map_err(|e| self.failed(doing, e))?;
        let mut rows = statement.query(parameters).map_err(|e| self.failed(doing, e))?;
        let mut found = Vec::new();
        while let Some(row) = rows.next().map_err(|e| self.failed(doing, e))? {
            found.push(read(row).map_err(self.named(doing))?);
        }
        Ok(found)
    }

    pub(super) fn failed(&self, doing: &'static str, error: rusqlite::Error) -> StoreError {
        StoreError::from_sql(&self.path, doing, error)
    }

    pub(super) fn named(&self, doing: &'static str) -> impl Fn(StepError) -> StoreError + '_ {
        named(&self.path, doing)
    }
}

/// Opens a database to read, and reads its schema version.
pub(super) fn open_to_read(
    path: &Path,
    name: &str,
    flags: OpenFlags,
) -> Result<(Connection, i64), StoreError> {
    let failed = |e| StoreError::from_sql(path, "opening to read", e);
    let connection = Connection::open_with_flags(name, flags).map_err(failed)?;
    distrust(&connection).map_err(failed)?;
    connection.busy_timeout(BUSY_TIMEOUT).map_err(failed)?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    let version = migration::version(&connection).map_err(failed)?;
    Ok((connection, version))
}

/// The database as an address with a setting, such as `immutable=1` for a file that nothing changes; none where the path is
/// no UTF-8.
pub(super) fn as_uri(path: &Path, setting: &str) -> Option<String> {
    let path = std::path::absolute(path).ok()?;
    let escaped: String = path
        .to_str()?
        .chars()
        .map(|c| match c {
            '%' | '?' | '#' | '\\' => format!("%{:02X}", u32::from(c)),
            c => c.to_string(),
        })
        .collect();
    Some(format!("file:{escaped}?{setting}"))
}

/// Refuses to work with an SQLite that can corrupt a database.
pub(super) fn check_sqlite() -> Result<(), StoreError> {
    if rusqlite::version_number() < OLDEST_SQLITE {
        return Err(StoreError::SqliteTooOld {
            found: rusqlite::version(),
        });
    }
    Ok(())
}

/// A file may come from anywhere: what its schema says calls no function with an effect, and pages that cannot be are damage.
fn distrust(connection: &Connection) -> rusqlite::Result<()> {
    connection.pragma_update(None, "trusted_schema", "OFF")?;
    connection.pragma_update(None, "cell_size_check", "ON")
}

/// Settings of a writing connection: write-ahead log, an fsync at every commit (a lab computer loses power),
/// foreign keys enforced.
fn configure(connection: &Connection) -> rusqlite::Result<()> {
    connection.busy_timeout(BUSY_TIMEOUT)?;
    distrust(connection)?;
    connection.pragma_update(None, "journal_mode", "WAL")?;
    connection.pragma_update(None, "synchronous", "FULL")?;
    connection.pragma_update(None, "foreign_keys", "ON")?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linked_sqlite_is_new_enough() {
        assert!(
            rusqlite::version_number() >= OLDEST_SQLITE,
            "{}",
            rusqlite::version()
        );
    }

    #[test]
    fn a_text_file_in_place_of_the_database_is_named_as_such() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(
            folder.path().join(FILE_NAME),
            "this is no database, whatever its name says",
        )
        .unwrap();
        let refused = Store::open(folder.path()).unwrap_err();
        assert!(matches!(refused, StoreError::NotADatabase { .. }), "{refused}");
    }

    #[test]
    fn a_missing_folder_is_named_and_no_database_reads_as_none() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Store::open_read_only(folder.path()).unwrap().is_none());
        let refused = Store::open(&folder.path().join("gone")).unwrap_err();
        assert!(matches!(refused, StoreError::CannotOpen { .. }), "{refused}");
    }

    #[test]
    fn the_writer_uses_wal_full_and_foreign_keys() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let read = |name: &str| -> String {
            store
                .connection
                .pragma_query_value(None, name, |row| row.get::<_, rusqlite::types::Value>(0))
                .map(|value| format!("{value:?}"))
                .unwrap()
        };
        assert_eq!(read("journal_mode"), "Text(\"wal\")");
        assert_eq!(read("synchronous"), "Integer(2)");
        assert_eq!(read("foreign_keys"), "Integer(1)");
    }
}
