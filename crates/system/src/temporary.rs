//! A file on its way: it has a passing name until it is whole, and goes where it does not come so far.

use std::io::{self, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::passing::Passing;
use crate::{Call, Kind, call, call_on};

/// A file under a passing name; it goes when it is dropped, or when a signal ends the program.
#[derive(Debug)]
pub struct Temporary {
    /// None once it was given its name.
    file: Option<NamedTempFile>,
    _passing: Passing,
}

impl Temporary {
    /// Makes an empty one in `folder`, with these rights where the system knows such (before the user's mask).
    ///
    /// # Errors
    /// What the system says.
    pub fn new_in(folder: &Path, prefix: &str, suffix: &str, rights: u32) -> io::Result<Temporary> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(prefix).suffix(suffix);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(rights));
        #[cfg(not(unix))]
        let _ = rights;
        let place = |file: &NamedTempFile| file.path().to_owned();
        let (file, passing) = Passing::made(|| builder.tempfile_in(folder), place)?;
        let file = Temporary {
            file: Some(file),
            _passing: passing,
        };
        call(Kind::Create, file.path(), || Ok(()))?;
        Ok(file)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.file.as_ref().map_or(Path::new(""), NamedTempFile::path)
    }

    /// Returns when its bytes are on the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn sync_all(&self) -> io::Result<()> {
        let synced = |file: &NamedTempFile| call(Kind::Sync, file.path(), || file.as_file().sync_all());
        self.file.as_ref().map_or(Ok(()), synced)
    }

    /// Gives it its name, at the cost of what has that name.
    ///
    /// # Errors
    /// What the system says; the file goes then.
    pub fn persist(self, path: &Path) -> io::Result<()> {
        self.named(Kind::Rename, path, |file| file.persist(path))
    }

    /// Gives it its name where nothing has it.
    ///
    /// # Errors
    /// What the system says; the file goes then.
    pub fn persist_to_free(self, path: &Path) -> io::Result<()> {
        self.named(Kind::RenameToFree, path, |file| file.persist_noclobber(path))
    }

    fn named(
        mut self,
        kind: Kind,
        to: &Path,
        name: impl Fn(NamedTempFile) -> Result<std::fs::File, tempfile::PersistError>,
    ) -> io::Result<()> {
        let from = self.path().to_owned();
        let (path, to) = (from.as_path(), Some(to));
        call_on(Call { kind, path, to }, || {
            let Some(file) = self.file.take() else {
                return Ok(());
            };
            name(file).map(drop).map_err(|kept| {
                self.file = Some(kept.file);
                kept.error
            })
        })
    }
}

impl Write for Temporary {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(file) = &mut self.file else { return Ok(0) };
        let path = file.path().to_owned();
        call(Kind::Write, &path, || file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let Some(mut file) = self.file.take() else { return };
        let path = file.path().to_owned();
        // The system removes it, or refuses to: then it stays for the next one who cleans up.
        file.disable_cleanup(true);
        let _ = call(Kind::Remove, &path, || std::fs::remove_file(&path));
    }
}
