//! The folder in which a campaign is restored, before it gets its name. What a killed `restore` left of one is removed by the
//! next one in that place: whoever works in such a folder holds a lock on a file in it.

use std::io;
use std::path::{Path, PathBuf};

use crate::system::fs;
use crate::system::passing::Passing;

/// How the name of such a folder begins.
const PREFIX: &str = ".ieap-restoring-";
/// The file that is locked.
const LOCK: &str = ".restoring";

/// A folder in the making; it goes when it is dropped before it has its name.
#[derive(Debug)]
pub struct Making {
    /// None once it has its name.
    folder: Option<tempfile::TempDir>,
    path: PathBuf,
    _lock: fs::File,
    passing: Passing,
}

impl Making {
    /// Makes one in `parent`, and removes those that nobody works in any more.
    ///
    /// # Errors
    /// What the system says.
    pub fn begin(parent: &Path) -> io::Result<Making> {
        remove_leftovers(parent);
        let make = || tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent);
        let (folder, passing) = Passing::made(make, |folder| folder.path().to_owned())?;
        let mut options = fs::OpenOptions::own();
        let lock = options
            .write(true)
            .create_new(true)
            .open(folder.path().join(LOCK))?;
        lock.try_lock().map_err(io::Error::from)?;
        Ok(Making {
            path: folder.path().to_owned(),
            folder: Some(folder),
            _lock: lock,
            passing,
        })
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name, which nothing or an empty folder has.
    ///
    /// # Errors
    /// What the system says.
    pub fn put(mut self, target: &Path) -> io::Result<()> {
        readable(&self.path)?;
        fs::remove_file(self.path.join(LOCK))?;
        if fs::exists(target)? {
            fs::remove_dir(target)?;
        }
        drop(self.passing);
        fs::rename(&self.path, target)?;
        // It has another name now, under which nothing removes it.
        self.folder.take().map(tempfile::TempDir::keep);
        fs::sync_names(self.path.parent().unwrap_or(Path::new(".")))
    }
}

/// Removes folders that a killed program left. One whose lock cannot be had is worked in; one without it is none of ours, or
/// was killed before it held anything.
fn remove_leftovers(parent: &Path) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let path = entry.path();
        let is_ours = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if !is_ours || !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            continue;
        }
        let _ = match fs::File::open_own(path.join(LOCK)) {
            Ok(lock) if lock.try_lock().is_ok() => fs::remove_dir_all(&path),
            _ => fs::remove_dir(&path),
        };
    }
}

/// Gives a temporary folder, which is its owner's alone, the rights of any other.
#[cfg(unix)]
fn readable(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(folder, fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn readable(_folder: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_program_left_goes_and_what_another_works_in_stays() {
        let parent = tempfile::tempdir().unwrap();
        let working = Making::begin(parent.path()).unwrap();
        fs::write(working.path().join("a"), "a").unwrap();
        let left = parent.path().join(format!("{PREFIX}left"));
        let theirs = parent.path().join(format!("{PREFIX}notes"));
        for (folder, file) in [(&left, LOCK), (&theirs, "thesis.tex")] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join(file), "").unwrap();
        }
        fs::write(left.join("campaign.toml"), "").unwrap();
        drop(Making::begin(parent.path()).unwrap());
        assert!(!left.exists() && theirs.join("thesis.tex").exists());
        working.put(&parent.path().join("new")).unwrap();
        let names: Vec<_> = fs::read_dir(parent.path().join("new"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(names, ["a"]);
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 2);
    }
}
