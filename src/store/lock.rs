//! One working instance a campaign.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::Path;

use super::StoreError;

/// What the file says after an orderly end.
const ENDED: &str = "ended\n";

/// Held while this program ingests, fits or renders. The system frees it when the program ends, however it
/// ends; the file stays and tells who holds it, or that the last one ended in order.
#[derive(Debug)]
pub struct InstanceLock {
    file: File,
    was_ended: bool,
}

impl InstanceLock {
    /// Name of the lock file inside the campaign.
    pub const FILE_NAME: &'static str = "campaign.db.lock";

    /// Takes the lock of the campaign in `folder`.
    ///
    /// # Errors
    /// [`StoreError::SecondInstance`] where another program holds it; [`StoreError::File`] where the lock file
    /// cannot be made.
    pub fn take(folder: &Path) -> Result<InstanceLock, StoreError> {
        let path = folder.join(InstanceLock::FILE_NAME);
        let failed = |doing: &'static str| {
            let path = path.clone();
            move |source| StoreError::File { path, doing, source }
        };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(failed("opening the lock file"))?;
        let mut holder = String::new();
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let _ = file.read_to_string(&mut holder);
                return Err(StoreError::SecondInstance {
                    path,
                    holder: holder.trim().to_owned(),
                });
            }
            Err(TryLockError::Error(source)) => return Err(failed("locking")(source)),
        }
        // What cannot be read is taken for the trace of a disorderly end.
        let was_ended = file.read_to_string(&mut holder).is_ok() && ["", ENDED].contains(&holder.as_str());
        let holder = format!("process {} on {}\n", std::process::id(), host_name());
        file.set_len(0)
            .and_then(|()| file.rewind())
            .map_err(failed("writing the lock file"))?;
        file.write_all(holder.as_bytes())
            .map_err(failed("writing the lock file"))?;
        Ok(InstanceLock { file, was_ended })
    }

    /// Whether the instance before this one ended in order, or there was none. One that was killed, or lost its power, may
    /// have left the disk with less than it believed.
    pub fn last_ended_in_order(&self) -> bool {
        self.was_ended
    }
}

impl Drop for InstanceLock {
    fn drop(&mut self) {
        // Where this fails the next instance looks at the database once more than it must.
        let _ = self.file.set_len(0);
        let _ = self.file.rewind();
        let _ = self.file.write_all(ENDED.as_bytes());
    }
}

#[cfg(unix)]
fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(not(unix))]
fn host_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this computer".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_refused_and_told_who_holds_it() {
        let folder = tempfile::tempdir().unwrap();
        let first = InstanceLock::take(folder.path()).unwrap();
        let refused = InstanceLock::take(folder.path()).unwrap_err();
        let StoreError::SecondInstance { holder, .. } = refused else {
            panic!("{refused}")
        };
        assert!(holder.contains(&std::process::id().to_string()));
        drop(first);
        InstanceLock::take(folder.path()).unwrap();
    }

    #[test]
    fn a_disorderly_end_is_noticed_once() {
        let folder = tempfile::tempdir().unwrap();
        let in_order = || InstanceLock::take(folder.path()).unwrap().last_ended_in_order();
        assert!(in_order() && in_order());
        std::fs::write(folder.path().join(InstanceLock::FILE_NAME), "process 1 on a").unwrap();
        assert!(!in_order());
        assert!(in_order());
    }
}
