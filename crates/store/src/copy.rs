//! Copies of a database that is in use.

use std::cell::RefCell;
use std::path::Path;

use rusqlite::backup::{Backup, StepResult};
use rusqlite::{Connection, OpenFlags};

use super::journal::Journal;
use super::place::Place;
use super::store::{as_uri, check_sqlite, open_to_read};
use super::whole_lists::WholeLists;
use super::{Store, StoreError, migration};

/// Pages that are copied between two words of progress: 4 MB.
const PAGES: std::ffi::c_int = 1024;

impl Store {
    /// Copies the database as it is at this moment into a new file at `path`; others go on writing meanwhile. Nothing lies
    /// beside the copy. `progress` hears how many pages are copied, and of how many.
    ///
    /// # Errors
    /// See [`StoreError`]; a half copy is left then.
    pub fn copy_to(&self, path: &Path, progress: &dyn Fn(u64, u64)) -> Result<(), StoreError> {
        // The copy would begin anew with every change of others; of one moment there are none.
        let _moment = self.snapshot()?;
        self.changes()?;
        let failed = |e| StoreError::from_sql(path, "copying the database", e);
        // Nobody else knows the copy, and file locks do not work on every share that a backup lies on.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
            | OpenFlags::SQLITE_OPEN_CREATE
            | OpenFlags::SQLITE_OPEN_URI
            | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let uri = as_uri(path, "nolock=1").ok_or_else(|| StoreError::CannotOpen {
            path: path.to_owned(),
            detail: "its path is not UTF-8".to_owned(),
        })?;
        let mut copy = Connection::open_with_flags(uri, flags).map_err(failed)?;
        copy.pragma_update(None, "journal_mode", "OFF").map_err(failed)?;
        let backup = Backup::new(&self.connection, &mut copy).map_err(failed)?;
        loop {
            let step = backup.step(PAGES).map_err(failed)?;
            let at = backup.progress();
            let total = u64::from(at.pagecount.unsigned_abs());
            progress(total - u64::from(at.remaining.unsigned_abs()), total);
            match step {
                StepResult::Done => return Ok(()),
                StepResult::More => {}
                // Another program makes the log anew, or ends it: that takes moments.
                _ => std::thread::sleep(std::time::Duration::from_millis(20)),
            }
        }
    }

    /// Opens a copy that nobody changes, to read; nothing is made beside it.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn open_copy(path: &Path) -> Result<Store, StoreError> {
        check_sqlite()?;
        let flags =
            OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let uri = as_uri(path, "immutable=1").ok_or_else(|| StoreError::CannotOpen {
            path: path.to_owned(),
            detail: "its path is not UTF-8".to_owned(),
        })?;
        let (connection, found) = open_to_read(path, &uri, flags)?;
        migration::refuse_unversioned(&connection, path, found)?;
        migration::refuse(found, path)?;
        Ok(Store {
            connection,
            path: path.to_owned(),
            place: Place::default(),
            journal: Journal::default(),
            remembered: RefCell::default(),
            whole_lists: WholeLists::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_holds_one_moment_while_others_write() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = Store::open(folder.path()).unwrap();
        let mark = |store: &mut Store, path: &str| store.mark_missing("now", &[path.to_owned()]).unwrap();
        mark(&mut writer, "runs/a.csv");
        let before = writer.changes().unwrap();
        let reader = Store::open_read_only(folder.path()).unwrap().unwrap();
        let path = folder.path().join("copy");
        let writer = std::cell::RefCell::new(writer);
        reader
            .copy_to(&path, &|_, _| mark(&mut writer.borrow_mut(), "runs/b.csv"))
            .unwrap();
        let copy = Store::open_copy(&path).unwrap();
        assert_eq!(copy.changes().unwrap(), before);
        assert_ne!(writer.borrow().changes().unwrap(), before);
        assert_eq!(copy.identity().unwrap(), reader.identity().unwrap());
        assert_eq!(copy.check_all().unwrap(), Vec::<String>::new());
        drop(copy);
        let beside: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.starts_with("copy"))
            .collect();
        assert_eq!(beside, ["copy"]);
    }
}
