//! One working instance a campaign.

use std::io::{Read, Seek, Write};
use std::path::Path;

use super::{StoreError, locks};
use ieap_system::fs::{self, File, OpenOptions, TryLockError};

/// What the file says after an orderly end.
const ENDED: &str = "ended\n";

/// Held while this program ingests, fits or renders. The system frees it when the program ends, however it
/// ends; the file stays and tells who holds it, or that the last one ended in order.
#[derive(Debug)]
pub struct InstanceLock {
    file: File,
    was_ended: bool,
    is_sound: bool,
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
        let is_link = || fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink());
        let mut file = match options().open(&path) {
            Ok(file) => file,
            Err(_) if is_link() => {
                let found = "a link to another file";
                return Err(StoreError::NotALock { path, found });
            }
            Err(source) => return Err(failed("opening the lock file")(source)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                let _ = file.read_to_string(&mut holder);
                return Err(StoreError::SecondInstance {
                    path,
                    holder: holder.trim().to_owned(),
                });
            }
            Err(TryLockError::Error(source)) => return Err(locks::refused(&path, "locking", source)),
        }
        let was_ended = ended_in_order(&mut file, &path)?;
        let holder = format!("{MARK}{} on {}\n", std::process::id(), host_name());
        file.set_len(0)
            .and_then(|()| file.rewind())
            .map_err(failed("writing the lock file"))?;
        // On the disk before anything else is: a loss of power is noticed by it.
        file.write_all(holder.as_bytes())
            .and_then(|()| file.sync_all())
            .map_err(failed("writing the lock file"))?;
        Ok(InstanceLock {
            file,
            was_ended,
            is_sound: was_ended,
        })
    }

    /// Whether the instance before this one ended in order, by what is known: of the first nothing is. One that was killed, or lost its power, may
    /// have left the disk with less than it believed.
    pub fn last_ended_in_order(&self) -> bool {
        self.was_ended
    }

    /// To be said when the database was found sound after a disorderly end; the trace of that end stays until then.
    pub fn found_sound(&mut self) {
        self.is_sound = true;
    }
}

impl Drop for InstanceLock {
    fn drop(&mut self) {
        // Where any of this fails the next instance looks at the database once more than it must.
        if self.is_sound {
            // Only into an empty file: over the rest of another word it would be none that a lock writes.
            let emptied = self.file.set_len(0).and_then(|()| self.file.rewind());
            let _ = emptied.and_then(|()| self.file.write_all(ENDED.as_bytes()));
        }
        // Closing frees the lock only when the last copy of the handle is closed, and a child that is just being started has
        // one until it has become its own program.
        let _ = self.file.unlock();
    }
}

/// What a lock file that was held begins with.
const MARK: &str = "process ";

/// What a lock writes is shorter, bytes.
const LONGEST: u64 = 512;

/// Without following a link, and without a change before the lock is had.
fn options() -> OpenOptions {
    let mut options = OpenOptions::own();
    options.read(true).write(true).create(true).truncate(false);
    options
}

/// Whether the file says that the last instance ended in order. An empty one says nothing: it is new, or what was in it is
/// lost. A file that no lock wrote, one that was copied or linked there, is refused.
fn ended_in_order(file: &mut File, path: &Path) -> Result<bool, StoreError> {
    let mut head = Vec::new();
    let read = file.take(LONGEST).read_to_end(&mut head);
    read.map_err(|source| StoreError::File {
        path: path.to_owned(),
        doing: "reading the lock file",
        source,
    })?;
    if is_ours(&head) {
        Ok(head == ENDED.as_bytes())
    } else {
        Err(StoreError::NotALock {
            path: path.to_owned(),
            found: "it holds something else",
        })
    }
}

/// Whether a lock wrote this. A disk that lost its power may keep the length of a file and any part of its content, of the
/// word before as well: so each byte is that of one of the two words, or zero.
fn is_ours(head: &[u8]) -> bool {
    let of_a_word = |(at, byte): (usize, &u8)| {
        *byte == 0
            || [ENDED, MARK]
                .iter()
                .any(|word| word.as_bytes().get(at) == Some(byte))
    };
    (head.len() as u64) < LONGEST && head.iter().enumerate().take(MARK.len()).all(of_a_word)
}

/// Name of this machine.
#[cfg(unix)]
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Name of this machine.
#[cfg(not(unix))]
pub fn host_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this computer".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};
    use std::time::SystemTime;

    use ieap_system::{Call, FaultInjector, Kind, with_fs};

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
    fn a_copy_of_the_handle_in_a_child_that_is_being_started_keeps_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        let lock = InstanceLock::take(folder.path()).unwrap();
        let _copy = lock.file.try_clone().unwrap();
        drop(lock);
        InstanceLock::take(folder.path()).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_lock_file_is_refused_and_keeps_its_content() {
        let folder = tempfile::tempdir().unwrap();
        let (path, thesis) = (
            folder.path().join(InstanceLock::FILE_NAME),
            folder.path().join("thesis.tex"),
        );
        std::fs::write(&thesis, "mine").unwrap();
        std::os::unix::fs::symlink(&thesis, &path).unwrap();
        let by_link = InstanceLock::take(folder.path()).unwrap_err();
        assert!(
            by_link.to_string().contains("a link to another file"),
            "{by_link}"
        );
        std::fs::remove_file(&path).unwrap();
        std::fs::hard_link(&thesis, &path).unwrap();
        let by_name = InstanceLock::take(folder.path()).unwrap_err();
        assert!(matches!(by_name, StoreError::NotALock { .. }), "{by_name}");
        assert_eq!(std::fs::read_to_string(&thesis).unwrap(), "mine");
    }

    #[test]
    fn a_disorderly_end_is_noticed_until_the_database_was_found_sound() {
        let folder = tempfile::tempdir().unwrap();
        let in_order = || InstanceLock::take(folder.path()).unwrap().last_ended_in_order();
        // Of the first nothing is known.
        assert!(!in_order());
        InstanceLock::take(folder.path()).unwrap().found_sound();
        assert!(in_order() && in_order());
        for left in [
            "",
            "process 1 on a",
            "ended\ns 1 on a\n",
            "\0\0oc\0ss 1 on a\n",
            "\0\0\0\0",
            "p",
            "process\0\0\0\0",
            "end",
            "ended\n\0",
        ] {
            std::fs::write(folder.path().join(InstanceLock::FILE_NAME), left).unwrap();
            assert!(!in_order());
            assert!(!in_order());
            InstanceLock::take(folder.path()).unwrap().found_sound();
            assert!(in_order());
        }
    }

    /// Hears of all calls, and refuses those of one kind.
    #[derive(Default)]
    struct Heard(Option<Kind>, Mutex<Vec<Kind>>);

    impl FaultInjector for Heard {
        fn before(&self, call: &Call<'_>) -> std::io::Result<()> {
            if self.0 == Some(call.kind) {
                Err(std::io::Error::from_raw_os_error(5))
            } else {
                Ok(())
            }
        }

        fn after(&self, call: &Call<'_>) {
            self.1.lock().unwrap().push(call.kind);
        }

        fn now(&self) -> SystemTime {
            SystemTime::now()
        }
    }

    /// Else a loss of power leaves what an earlier instance wrote when it ended in order.
    #[test]
    fn who_holds_it_is_on_the_disk_when_it_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let heard = Arc::new(Heard::default());
        let _lock = with_fs(heard.clone(), || InstanceLock::take(folder.path())).unwrap();
        let heard = heard.1.lock().unwrap();
        assert_eq!(heard[heard.len() - 2..], [Kind::Write, Kind::Sync]);
    }

    /// The word of an orderly end was written over the beginning of the longer one, and the next instance refused the file.
    #[test]
    fn a_file_that_cannot_be_emptied_keeps_its_word() {
        let folder = tempfile::tempdir().unwrap();
        let lock = InstanceLock::take(folder.path()).unwrap();
        with_fs(Arc::new(Heard(Some(Kind::Truncate), Mutex::default())), || {
            drop(lock)
        });
        assert!(!InstanceLock::take(folder.path()).unwrap().last_ended_in_order());
    }
}
