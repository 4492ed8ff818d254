//! What tells one state of a file from another: number in its file system, times of its content and of its entry.

use std::time::UNIX_EPOCH;

use ieap_system::fs::Metadata;

/// Device and inode; zeros where the operating system gives none.
#[cfg(unix)]
pub(crate) fn identity(metadata: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino())
}

/// Device and inode; zeros where the operating system gives none.
#[cfg(not(unix))]
pub(crate) fn identity(_metadata: &Metadata) -> (u64, u64) {
    (0, 0)
}

/// Modification time, ns since 1970, negative before; 0 where the file system keeps none.
pub(crate) fn modified_ns(metadata: &Metadata) -> i64 {
    let Ok(modified) = metadata.modified() else {
        return 0;
    };
    let (nanoseconds, sign) = match modified.duration_since(UNIX_EPOCH) {
        Ok(after) => (after.as_nanos(), 1),
        Err(before) => (before.duration().as_nanos(), -1),
    };
    // The year 2262 is the end of such a count.
    sign * i64::try_from(nanoseconds).unwrap_or(i64::MAX)
}

/// Time of the last change of anything of the file, ns since 1970: no program can set it, so that it also tells a change
/// after which the modification time was put back. 0 where the operating system gives none.
#[cfg(unix)]
pub(crate) fn changed_ns(metadata: &Metadata) -> i64 {
    use std::os::unix::fs::MetadataExt;
    let seconds = metadata.ctime().saturating_mul(1_000_000_000);
    seconds.saturating_add(metadata.ctime_nsec())
}

/// Time of the last change of anything of the file; 0 where the operating system gives none.
#[cfg(not(unix))]
pub(crate) fn changed_ns(_metadata: &Metadata) -> i64 {
    0
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn times_before_and_after_1970_keep_their_nanoseconds() {
        let file = tempfile::tempfile().unwrap();
        for (time, expected) in [
            (
                UNIX_EPOCH + Duration::new(1_700_000_000, 123_456_789),
                1_700_000_000_123_456_789,
            ),
            (UNIX_EPOCH - Duration::new(1, 500_000_000), -1_500_000_000),
            (UNIX_EPOCH, 0),
        ] {
            file.set_modified(time).unwrap();
            assert_eq!(modified_ns(&file.metadata().unwrap()), expected);
        }
    }
}
