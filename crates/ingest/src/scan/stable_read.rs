//! Reads a file whole, and only if nobody wrote to it meanwhile.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::{changed_ns, identity, modified_ns};
use ieap_system::fs::{self, File, Metadata};

/// Largest file that is read unless the caller says otherwise: 1 GiB.
pub const DEFAULT_LIMIT_BYTES: u64 = 1 << 30;

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadFileError {
    /// It has gone.
    #[error("{}: the file has gone", path.display())]
    Gone {
        /// The file.
        path: PathBuf,
    },
    /// The user has not the right to read it.
    #[error("{}: the file cannot be opened ({source}); give your user the right to read it", path.display())]
    Denied {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The name is a link, and links are followed by the scan only.
    #[error("{}: a link stands where a file was expected; put the file itself there", path.display())]
    IsLink {
        /// The link.
        path: PathBuf,
    },
    /// Neither file nor link.
    #[error("{}: not a file; take it out of the runs folder", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// Larger than the limit.
    #[error("{}: {size_bytes} bytes, more than the {limit_bytes} bytes that are read; export it with fewer readings a second or as Parquet, which is smaller", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        size_bytes: u64,
        /// The limit.
        limit_bytes: u64,
    },
    /// Somebody wrote to it while it was read.
    #[error("{}: still being written ({before_bytes} bytes when opened, {after_bytes} after reading); it is read when it rests", path.display())]
    StillGrowing {
        /// The file.
        path: PathBuf,
        /// Size when opened.
        before_bytes: u64,
        /// Size after reading, or bytes read where that differs.
        after_bytes: u64,
    },
    /// Opening or reading failed for a reason of the system: a disk, a share, too many open files.
    #[error("{}: reading failed ({source}); check the disk or share", path.display())]
    Failed {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
}

impl ReadFileError {
    /// Whether this is no property of the file: the system could not give it now, or another thing stands in its place
    /// since the folder was looked through. Another try may go well.
    pub fn may_pass(&self) -> bool {
        !matches!(
            self,
            ReadFileError::TooLarge { .. } | ReadFileError::StillGrowing { .. }
        )
    }
}

/// Reads the file at `path`, which must be no link, if it is not larger than `limit_bytes` and has the same
/// size, modification time and inode before and after.
///
/// # Errors
/// Each reason why there are no bytes that can be trusted, [`ReadFileError`].
pub fn read_stable(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ReadFileError> {
    let opened = open(path)?;
    let failed = |source| ReadFileError::Failed {
        path: path.into(),
        source,
    };
    let before = opened.metadata().map_err(failed)?;
    let size_bytes = before.len();
    if size_bytes > limit_bytes {
        return Err(ReadFileError::TooLarge {
            path: path.into(),
            size_bytes,
            limit_bytes,
        });
    }
    let mut bytes = Vec::with_capacity(usize::try_from(size_bytes).unwrap_or(0));
    // One byte more than expected is enough to know that it grew.
    (&opened)
        .take(size_bytes + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let same = |after: &Metadata| fingerprint(after) == fingerprint(&before);
    let still_growing = |after_bytes| ReadFileError::StillGrowing {
        path: path.into(),
        before_bytes: size_bytes,
        after_bytes,
    };
    // The name is asked as well as the open file: it may stand for another file by now.
    match (opened.metadata(), fs::symlink_metadata(path)) {
        (Ok(after), Ok(named)) if same(&after) && same(&named) && bytes.len() as u64 == size_bytes => {
            Ok(bytes)
        }
        (Ok(after), Ok(_)) => Err(still_growing(after.len().max(bytes.len() as u64))),
        (_, Err(error)) if error.kind() == io::ErrorKind::NotFound => {
            Err(ReadFileError::Gone { path: path.into() })
        }
        (Err(source), _) | (_, Err(source)) => Err(failed(source)),
    }
}

fn fingerprint(metadata: &Metadata) -> (u64, i64, i64, (u64, u64)) {
    let times = (modified_ns(metadata), changed_ns(metadata));
    (metadata.len(), times.0, times.1, identity(metadata))
}

fn open(path: &Path) -> Result<File, ReadFileError> {
    let is_link = || fs::symlink_metadata(path).is_ok_and(|named| named.is_symlink());
    File::open_own(path).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => ReadFileError::Gone { path: path.into() },
        _ if is_link() => ReadFileError::IsLink { path: path.into() },
        io::ErrorKind::InvalidInput => ReadFileError::NotAFile { path: path.into() },
        io::ErrorKind::PermissionDenied => ReadFileError::Denied {
            path: path.into(),
            source,
        },
        _ => ReadFileError::Failed {
            path: path.into(),
            source,
        },
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_file_at_rest_is_read_whole_and_an_empty_one_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        for text in [&b""[..], b"time_s,current_a\n0,1\n"] {
            fs::write(&path, text).unwrap();
            assert_eq!(read_stable(&path, DEFAULT_LIMIT_BYTES).unwrap(), text);
        }
    }

    #[test]
    fn what_is_no_file_is_refused_with_its_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        assert!(matches!(read_stable(&path, 10), Err(ReadFileError::Gone { .. })));
        fs::write(&path, [0; 11]).unwrap();
        let error = read_stable(&path, 10).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("11 bytes, more than the 10 bytes that are read"),
            "{error}"
        );
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        assert!(matches!(
            read_stable(&link, 99),
            Err(ReadFileError::IsLink { .. })
        ));
        assert!(matches!(
            read_stable(folder.path(), 99),
            Err(ReadFileError::NotAFile { .. })
        ));
    }

    #[test]
    fn a_pipe_without_a_writer_does_not_block() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        rustix::fs::mkfifoat(rustix::fs::CWD, &path, rustix::fs::Mode::RWXU).unwrap();
        assert!(matches!(
            read_stable(&path, 99),
            Err(ReadFileError::NotAFile { .. })
        ));
    }
}
