//! What lies on the disk only as long as the program works: a signal that ends the program ends it, too.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

/// All of it, by path.
static ALL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// How long is waited for a file that is just being made: a disk that does not answer must not keep the program.
const PATIENCE: Duration = Duration::from_millis(500);
/// How often a folder is removed into which others still write.
const TRIES: usize = 5;

/// A file or folder that is to go with the program, as long as this value lives.
#[derive(Debug)]
pub struct Passing(PathBuf);

impl Passing {
    /// Makes a file or folder, and says where it is: never is it there without being known here.
    ///
    /// # Errors
    /// What `make` says.
    pub fn made<T>(
        make: impl FnOnce() -> io::Result<T>,
        place: impl FnOnce(&T) -> PathBuf,
    ) -> io::Result<(T, Passing)> {
        let mut all = all();
        let made = make()?;
        let path = place(&made);
        all.insert(path.clone());
        Ok((made, Passing(path)))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Passing {
    fn drop(&mut self) {
        all().remove(&self.0);
    }
}

fn all() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all of it, just before the program ends: nothing can be made so any more.
pub fn end() {
    let begun = Instant::now();
    let all = loop {
        match ALL.try_lock() {
            Ok(all) => break all,
            Err(TryLockError::Poisoned(all)) => break all.into_inner(),
            Err(TryLockError::WouldBlock) if begun.elapsed() > PATIENCE => return,
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    for path in all.iter() {
        for _ in 0..TRIES {
            let removed = match std::fs::symlink_metadata(path) {
                Ok(found) if found.is_dir() => std::fs::remove_dir_all(path),
                Ok(_) => std::fs::remove_file(path),
                Err(_) => break,
            };
            if removed.is_ok() {
                break;
            }
        }
    }
    // Other threads work on until the program is no more.
    std::mem::forget(all);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_given_up_is_not_known_any_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let make = || std::fs::write(&path, "");
        let ((), passing) = Passing::made(make, |()| path.clone()).unwrap();
        assert!(all().contains(passing.path()));
        drop(passing);
        assert!(!all().contains(&path));
        let failed = Passing::made(
            || Err::<(), _>(io::Error::from_raw_os_error(28)),
            |()| path.clone(),
        );
        assert!(failed.is_err() && !all().contains(&path));
    }
}
