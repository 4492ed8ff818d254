//! Files and folders, under the names of `std::fs`.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub use std::fs::{FileType, Metadata, Permissions, TryLockError};

use crate::regular::{self, Links};
use crate::{Call, Kind, call, call_on};

/// An open file or folder.
#[derive(Debug)]
pub struct File {
    file: std::fs::File,
    path: PathBuf,
}

impl File {
    /// Opens what is there to read it, a folder or a file that a user names.
    ///
    /// # Errors
    /// What the system says, as of all functions here.
    pub fn open(path: impl AsRef<Path>) -> io::Result<File> {
        OpenOptions::new().read(true).open(path)
    }

    /// Opens a file that the program itself keeps: see [`OpenOptions::own`].
    ///
    /// # Errors
    /// As there.
    pub fn open_own(path: impl AsRef<Path>) -> io::Result<File> {
        OpenOptions::own().read(true).open(path)
    }

    /// Opens a file that people put into a campaign: see [`OpenOptions::stated`].
    ///
    /// # Errors
    /// As there.
    pub fn open_stated(folder: impl AsRef<Path>, path: impl AsRef<Path>) -> io::Result<File> {
        OpenOptions::stated(folder).read(true).open(path)
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
        call(Kind::Stat, &self.path, || self.file.metadata())
    }

    /// Cuts it off, or fills it up with zeros.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_len(&self, bytes: u64) -> io::Result<()> {
        call(Kind::Truncate, &self.path, || self.file.set_len(bytes))
    }

    /// Changes who may read and write.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        call(Kind::Rights, &self.path, || {
            self.file.set_permissions(permissions.clone())
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
    /// Only a regular file is opened, and whether behind a link, too; none for whatever has the name.
    regular: Option<Links>,
}

impl Default for OpenOptions {
    fn default() -> OpenOptions {
        OpenOptions::new()
    }
}

impl OpenOptions {
    /// For nothing yet, of whatever has the name: what a user names may be a pipe or a device.
    pub fn new() -> OpenOptions {
        OpenOptions {
            options: std::fs::OpenOptions::new(),
            makes: false,
            regular: None,
        }
    }

    /// The same for a file that the program itself keeps. A link is not followed, and only a regular file is opened: else the
    /// program changes a file of somebody else, or waits for a pipe for ever.
    pub fn own() -> OpenOptions {
        OpenOptions {
            regular: Some(Links::Refused),
            ..OpenOptions::new()
        }
    }

    /// The same for a file that people put into a campaign, whose folder that is: a regular one, or a link to one that lies in
    /// the folder, too. What a campaign of somebody else links to outside of it is none of its business.
    pub fn stated(folder: impl AsRef<Path>) -> OpenOptions {
        OpenOptions {
            regular: Some(Links::Within(folder.as_ref().to_owned())),
            ..OpenOptions::new()
        }
    }

    /// The same for a file that a user names: a regular one, or a link to one.
    pub fn named() -> OpenOptions {
        OpenOptions {
            regular: Some(Links::Followed),
            ..OpenOptions::new()
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
        let kind = if self.makes { Kind::Create } else { Kind::Open };
        let file = call(kind, path, || match &self.regular {
            Some(links) => regular::open(&self.options, links, path),
            None => self.options.open(path),
        })?;
        let path = path.to_owned();
        Ok(File { file, path })
    }
}

/// All bytes of a file that a user names, which may be a pipe.
///
/// # Errors
/// What the system says.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    read_all(&OpenOptions::new(), path.as_ref())
}

/// The same as text.
///
/// # Errors
/// What the system says; it is no UTF-8.
pub fn read_text(path: impl AsRef<Path>) -> io::Result<String> {
    read(path).and_then(text)
}

/// All bytes of a file that the program itself keeps: see [`OpenOptions::own`].
///
/// # Errors
/// As there.
pub fn read_own(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    read_all(&OpenOptions::own(), path.as_ref())
}

/// The same as text.
///
/// # Errors
/// As there; it is no UTF-8.
pub fn read_own_text(path: impl AsRef<Path>) -> io::Result<String> {
    read_own(path).and_then(text)
}

/// All bytes of a file that people put into a campaign: see [`OpenOptions::stated`].
///
/// # Errors
/// As there.
pub fn read_stated(folder: impl AsRef<Path>, path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    read_all(&OpenOptions::stated(folder), path.as_ref())
}

/// The same as text.
///
/// # Errors
/// As there; it is no UTF-8.
pub fn read_stated_text(folder: impl AsRef<Path>, path: impl AsRef<Path>) -> io::Result<String> {
    read_stated(folder, path).and_then(text)
}

/// All bytes of a regular file that a user names: see [`OpenOptions::named`].
///
/// # Errors
/// As there.
pub fn read_named(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    read_all(&OpenOptions::named(), path.as_ref())
}

fn read_all(options: &OpenOptions, path: &Path) -> io::Result<Vec<u8>> {
    let file = options.clone().read(true).open(path)?;
    call(Kind::Read, path, || {
        let size_bytes = file.file.metadata().map_or(0, |found| found.len());
        let mut bytes = Vec::with_capacity(usize::try_from(size_bytes).unwrap_or(0));
        (&file.file).read_to_end(&mut bytes)?;
        Ok(bytes)
    })
}

fn text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Writes a file of the program anew: see [`OpenOptions::own`].
///
/// # Errors
/// As there.
pub fn write(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut options = OpenOptions::own();
    let mut file = options.write(true).create(true).truncate(true).open(path)?;
    file.write_all(bytes.as_ref())
}

/// Refuses what is no regular file of the program itself, for files that a library opens: see [`OpenOptions::own`]. One that is
/// not there is no obstacle.
///
/// # Errors
/// As there.
pub fn check_own(path: impl AsRef<Path>) -> io::Result<()> {
    match symlink_metadata(path) {
        Ok(found) => regular::check(found.file_type()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Brings the names in a folder to the disk, where the system can; others do it by themselves.
///
/// # Errors
/// What the system says.
pub fn sync_names(folder: impl AsRef<Path>) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()
    } else {
        Ok(())
    }
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

/// Gives a file another name beside the one that it has.
///
/// # Errors
/// What the system says; some file systems cannot.
pub fn hard_link(from: impl AsRef<Path>, to: impl AsRef<Path>) -> io::Result<()> {
    let (path, to) = (from.as_ref(), to.as_ref());
    let call = Call {
        kind: Kind::Link,
        path,
        to: Some(to),
    };
    call_on(call, || std::fs::hard_link(path, to))
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

/// What lies in a folder, one by one. A system that opens a folder may fail to give its names: [`entries`] gives all of them
/// or the error.
///
/// # Errors
/// What the system says.
pub fn read_dir(path: impl AsRef<Path>) -> io::Result<ReadDir> {
    let path = path.as_ref();
    Ok(ReadDir {
        entries: call(Kind::List, path, || std::fs::read_dir(path))?,
        to_ask: Some(path.to_owned()),
    })
}

/// All that lies in a folder.
///
/// # Errors
/// What the system says: where it does not give all of it, nothing is given.
pub fn entries(path: impl AsRef<Path>) -> io::Result<Vec<DirEntry>> {
    read_dir(path)?.collect()
}

/// The names in a folder as the system gives them.
#[derive(Debug)]
pub struct ReadDir {
    entries: std::fs::ReadDir,
    /// The folder, until the system was asked for the first names.
    to_ask: Option<PathBuf>,
}

impl Iterator for ReadDir {
    type Item = io::Result<DirEntry>;

    fn next(&mut self) -> Option<io::Result<DirEntry>> {
        match self.to_ask.take().map(|path| crate::asked(Kind::List, &path)) {
            Some(Err(error)) => Some(Err(error)),
            _ => Some(self.entries.next()?.map(|entry| DirEntry { entry })),
        }
    }
}

/// A name in a folder.
#[derive(Debug)]
pub struct DirEntry {
    entry: std::fs::DirEntry,
}

impl DirEntry {
    /// The name.
    pub fn file_name(&self) -> std::ffi::OsString {
        self.entry.file_name()
    }

    /// The name behind the folder's path.
    pub fn path(&self) -> PathBuf {
        self.entry.path()
    }

    /// What has the name; a link is not followed.
    ///
    /// # Errors
    /// What the system says: that an entry is there, and what it is, are two things that it may know of.
    pub fn file_type(&self) -> io::Result<FileType> {
        call(Kind::Stat, &self.path(), || self.entry.file_type())
    }

    /// Size, times and kind of what has the name; a link is not followed.
    ///
    /// # Errors
    /// What the system says.
    pub fn metadata(&self) -> io::Result<Metadata> {
        call(Kind::Stat, &self.path(), || self.entry.metadata())
    }
}

/// Size, times and kind; a link is followed.
///
/// # Errors
/// What the system says.
pub fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let path = path.as_ref();
    call(Kind::Stat, path, || std::fs::metadata(path))
}

/// Size, times and kind of what has that name; a link is not followed.
///
/// # Errors
/// What the system says.
pub fn symlink_metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let path = path.as_ref();
    call(Kind::Stat, path, || std::fs::symlink_metadata(path))
}

/// The path without links.
///
/// # Errors
/// What the system says.
pub fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    let path = path.as_ref();
    call(Kind::Stat, path, || std::fs::canonicalize(path))
}

/// The same of what has to lie in that folder, as a file that people put into a campaign: see [`OpenOptions::stated`].
///
/// # Errors
/// It lies outside, or what the system says.
pub fn canonicalize_within(folder: impl AsRef<Path>, path: impl AsRef<Path>) -> io::Result<PathBuf> {
    let path = path.as_ref();
    call(Kind::Stat, path, || regular::within(folder.as_ref(), path))
}

/// Whether something has that name, a link that leads nowhere left out.
///
/// # Errors
/// What the system says, where it cannot tell.
pub fn exists(path: impl AsRef<Path>) -> io::Result<bool> {
    let path = path.as_ref();
    call(Kind::Stat, path, || path.try_exists())
}

/// Changes who may read and write.
///
/// # Errors
/// What the system says.
pub fn set_permissions(path: impl AsRef<Path>, permissions: Permissions) -> io::Result<()> {
    let path = path.as_ref();
    call(Kind::Rights, path, || {
        std::fs::set_permissions(path, permissions.clone())
    })
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
