//! Files and folders, under the names of `std::fs`.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub use std::fs::{DirEntry, Metadata, Permissions, ReadDir, TryLockError};

use crate::{Call, Kind, call, call_on};

/// An open file or folder.
#[derive(Debug)]
pub struct File {
    file: std::fs::File,
    path: PathBuf,
}

impl File {
    /// Opens what is there to read it.
    ///
    /// # Errors
    /// What the system says, as of all functions here.
    pub fn open(path: impl AsRef<Path>) -> io::Result<File> {
        OpenOptions::new().read(true).open(path)
    }

    /// Returns when its bytes, or a folder's names, are on the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn sync_all(&self) -> io::Result<()> {
        call(Kind::Sync, &self.path, || self.file.sync_all())
    }

    /// Returns when the whole file system that it lies in is on the disk.
    ///
    /// # Errors
    /// What the system says.
    #[cfg(target_os = "linux")]
    pub fn sync_file_system(&self) -> io::Result<()> {
        call(Kind::SyncAll, &self.path, || Ok(rustix::fs::syncfs(&self.file)?))
    }

    /// Size, times and kind.
    ///
    /// # Errors
    /// What the system says.
    pub fn metadata(&self) -> io::Result<Metadata> {
        call(Kind::Look, &self.path, || self.file.metadata())
    }

    /// Cuts it off, or fills it up with zeros.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_len(&self, bytes: u64) -> io::Result<()> {
        call(Kind::Cut, &self.path, || self.file.set_len(bytes))
    }

    /// Changes who may read and write.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        call(Kind::Rights, &self.path, || {
            self.file.set_permissions(permissions)
        })
    }

    /// Sets the time of its last change.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_modified(&self, time: std::time::SystemTime) -> io::Result<()> {
        call(Kind::Rights, &self.path, || self.file.set_modified(time))
    }

    /// Takes the lock on it, where nobody has it.
    ///
    /// # Errors
    /// Somebody has it, or what the system says.
    pub fn try_lock(&self) -> Result<(), TryLockError> {
        call(Kind::Lock, &self.path, || Ok(())).map_err(TryLockError::Error)?;
        self.file.try_lock()
    }

    /// Frees the lock.
    ///
    /// # Errors
    /// What the system says.
    pub fn unlock(&self) -> io::Result<()> {
        self.file.unlock()
    }

    /// The same open file once more.
    ///
    /// # Errors
    /// What the system says.
    pub fn try_clone(&self) -> io::Result<File> {
        Ok(File {
            file: self.file.try_clone()?,
            path: self.path.clone(),
        })
    }
}

impl Read for &File {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        call(Kind::Read, &self.path, || (&self.file).read(into))
    }
}

impl Read for File {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        (&*self).read(into)
    }
}

impl Write for &File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        call(Kind::Write, &self.path, || (&self.file).write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (&*self).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// How a file is opened.
#[derive(Debug, Clone)]
pub struct OpenOptions {
    options: std::fs::OpenOptions,
    makes: bool,
}

impl Default for OpenOptions {
    fn default() -> OpenOptions {
        OpenOptions::new()
    }
}

impl OpenOptions {
    /// For nothing yet.
    pub fn new() -> OpenOptions {
        OpenOptions {
            options: std::fs::OpenOptions::new(),
            makes: false,
        }
    }

    /// To read it.
    pub fn read(&mut self, yes: bool) -> &mut OpenOptions {
        self.options.read(yes);
        self
    }

    /// To write to it.
    pub fn write(&mut self, yes: bool) -> &mut OpenOptions {
        self.options.write(yes);
        self
    }

    /// Makes it where it is not there.
    pub fn create(&mut self, yes: bool) -> &mut OpenOptions {
        self.options.create(yes);
        self.makes |= yes;
        self
    }

    /// Makes it, and refuses where it is there.
    pub fn create_new(&mut self, yes: bool) -> &mut OpenOptions {
        self.options.create_new(yes);
        self.makes |= yes;
        self
    }

    /// Empties it.
    pub fn truncate(&mut self, yes: bool) -> &mut OpenOptions {
        self.options.truncate(yes);
        self.makes |= yes;
        self
    }

    /// With these flags of the system.
    #[cfg(unix)]
    pub fn custom_flags(&mut self, flags: i32) -> &mut OpenOptions {
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut self.options, flags);
        self
    }

    /// With these rights where it is made.
    #[cfg(unix)]
    pub fn mode(&mut self, rights: u32) -> &mut OpenOptions {
        std::os::unix::fs::OpenOptionsExt::mode(&mut self.options, rights);
        self
    }

    /// Opens it.
    ///
    /// # Errors
    /// What the system says.
    pub fn open(&self, path: impl AsRef<Path>) -> io::Result<File> {
        let path = path.as_ref();
        let kind = if self.makes { Kind::Make } else { Kind::Open };
        let file = call(kind, path, || self.options.open(path))?;
        let path = path.to_owned();
        Ok(File { file, path })
    }
}

/// All bytes of a file.
///
/// # Errors
/// What the system says.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    let path = path.as_ref();
    call(Kind::Open, path, || Ok(()))?;
    call(Kind::Read, path, || std::fs::read(path))
}

/// All text of a file.
///
/// # Errors
/// What the system says; it is no UTF-8.
pub fn read_to_string(path: impl AsRef<Path>) -> io::Result<String> {
    let path = path.as_ref();
    call(Kind::Open, path, || Ok(()))?;
    call(Kind::Read, path, || std::fs::read_to_string(path))
}

/// Writes a file anew.
///
/// # Errors
/// What the system says.
pub fn write(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut options = OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(true).open(path)?;
    file.write_all(bytes.as_ref())
}

/// Copies the bytes and rights of a file; gives the number of bytes.
///
/// # Errors
/// What the system says.
pub fn copy(from: impl AsRef<Path>, to: impl AsRef<Path>) -> io::Result<u64> {
    let (from, to) = (from.as_ref(), to.as_ref());
    call(Kind::Read, from, || Ok(()))?;
    call(Kind::Make, to, || std::fs::File::create(to).map(drop))?;
    call(Kind::Write, to, || std::fs::copy(from, to))
}

/// Gives a file or folder another name, at the cost of a file that has that name.
///
/// # Errors
/// What the system says.
pub fn rename(from: impl AsRef<Path>, to: impl AsRef<Path>) -> io::Result<()> {
    let (path, to) = (from.as_ref(), to.as_ref());
    let call = Call {
        kind: Kind::Rename,
        path,
        to: Some(to),
    };
    call_on(call, || std::fs::rename(path, to))
}

/// Exchanges two names in one step.
///
/// # Errors
/// What the system says; `Unsupported` where it cannot.
#[cfg(target_os = "linux")]
pub fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let call = Call {
        kind: Kind::Exchange,
        path: one,
        to: Some(other),
    };
    call_on(call, || {
        Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
    })
}

/// Exchanges two names in one step.
///
/// # Errors
/// `Unsupported`.
#[cfg(not(target_os = "linux"))]
pub fn exchange(_one: &Path, _other: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Removes a file.
///
/// # Errors
/// What the system says.
pub fn remove_file(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::Remove, path, || std::fs::remove_file(path))
}

/// Removes an empty folder.
///
/// # Errors
/// What the system says.
pub fn remove_dir(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::RemoveFolder, path, || std::fs::remove_dir(path))
}

/// Removes a folder with all that is in it.
///
/// # Errors
/// What the system says.
pub fn remove_dir_all(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::RemoveTree, path, || std::fs::remove_dir_all(path))
}

/// Makes a folder.
///
/// # Errors
/// What the system says.
pub fn create_dir(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::MakeFolder, path, || std::fs::create_dir(path))
}

/// Makes a folder and those above it, where they are not there.
///
/// # Errors
/// What the system says.
pub fn create_dir_all(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::MakeFolder, path, || std::fs::create_dir_all(path))
}

/// What lies in a folder.
///
/// # Errors
/// What the system says.
pub fn read_dir(path: impl AsRef<Path>) -> io::Result<ReadDir> {
    let path = path.as_ref();
    call(Kind::List, path, || std::fs::read_dir(path))
}

/// Size, times and kind; a link is followed.
///
/// # Errors
/// What the system says.
pub fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let path = path.as_ref();
    call(Kind::Look, path, || std::fs::metadata(path))
}

/// Size, times and kind of what has that name; a link is not followed.
///
/// # Errors
/// What the system says.
pub fn symlink_metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let path = path.as_ref();
    call(Kind::Look, path, || std::fs::symlink_metadata(path))
}

/// The path without links.
///
/// # Errors
/// What the system says.
pub fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    let path = path.as_ref();
    call(Kind::Look, path, || std::fs::canonicalize(path))
}

/// Whether something has that name, a link that leads nowhere left out.
///
/// # Errors
/// What the system says, where it cannot tell.
pub fn exists(path: impl AsRef<Path>) -> io::Result<bool> {
    let path = path.as_ref();
    call(Kind::Look, path, || path.try_exists())
}

/// Changes who may read and write.
///
/// # Errors
/// What the system says.
pub fn set_permissions(path: impl AsRef<Path>, permissions: Permissions) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::Rights, path, || std::fs::set_permissions(path, permissions))
}

/// Whether a folder has that name, or a link to one.
///
/// # Errors
/// What the system says, where it cannot tell.
pub fn is_dir(path: impl AsRef<Path>) -> io::Result<bool> {
    match metadata(path) {
        Ok(found) => Ok(found.is_dir()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
