//! File systems that give no locks, as some network shares do: that is another thing than a lock that somebody holds.

use std::io;
use std::path::Path;

use super::StoreError;
#[cfg(unix)]
use ieap_system::Temporary;

/// What to say where a lock could not be had: that there are none, or what the system says.
pub(super) fn refused(path: &Path, doing: &'static str, source: io::Error) -> StoreError {
    let path = path.to_owned();
    if is_lacking(&source) {
        let detail = source.to_string();
        StoreError::NoLocks { path, detail }
    } else {
        StoreError::File { path, doing, source }
    }
}

/// Whether the system says that there are no locks.
fn is_lacking(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::Unsupported || is_without(error)
}

#[cfg(unix)]
fn is_without(error: &io::Error) -> bool {
    use rustix::io::Errno;
    let without = [Errno::NOLCK, Errno::NOSYS, Errno::OPNOTSUPP];
    without
        .iter()
        .any(|errno| error.raw_os_error() == Some(errno.raw_os_error()))
}

#[cfg(not(unix))]
fn is_without(_error: &io::Error) -> bool {
    false
}

/// What the system says where the folder of a file gives no locks, tried on a file that is nobody's; none where it does, or
/// where nothing can be tried.
#[cfg(unix)]
pub(super) fn lacking_beside(path: &Path) -> Option<String> {
    use rustix::fs::{FlockOperation, Mode, OFlags, fcntl_lock};
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let nobodys = Temporary::new_in(folder.unwrap_or(Path::new(".")), ".part-", "", 0o600).ok()?;
    let Ok(file) = rustix::fs::open(nobodys.path(), OFlags::WRONLY, Mode::empty()) else {
        return None;
    };
    let error = io::Error::from(fcntl_lock(&file, FlockOperation::NonBlockingLockExclusive).err()?);
    is_lacking(&error).then(|| error.to_string())
}

#[cfg(not(unix))]
pub(super) fn lacking_beside(_path: &Path) -> Option<String> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use rustix::io::Errno;

    #[test]
    fn no_locks_are_told_from_one_that_is_held_and_from_a_failure() {
        let told = |errno: Errno| refused(Path::new("a"), "locking", io::Error::from(errno));
        for errno in [Errno::NOLCK, Errno::NOSYS, Errno::OPNOTSUPP] {
            assert!(matches!(told(errno), StoreError::NoLocks { .. }), "{errno}");
        }
        for errno in [Errno::IO, Errno::INTR, Errno::ACCESS] {
            assert!(matches!(told(errno), StoreError::File { .. }), "{errno}");
        }
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(lacking_beside(&folder.path().join("campaign.db")), None);
    }
}
