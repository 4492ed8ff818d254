//! Files of current runs and logs that are gone: no file of the folder holds their bytes.
//!
//! Where files were swapped, or one was written in the place of another, a name says nothing of bytes. So a file is there
//! where it lies under its own name, or where another file is known to hold the same bytes. What lies under its name and was
//! refused, or waits, is listed as that.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::new_run::RunRow;
use super::{FileRow, Store, StoreError};
use ieap_domain::{FileState, RunFile};

/// What the folder holds, as far as it is known.
struct Present {
    /// Paths under which a file lies that is no copy of another.
    paths: BTreeSet<String>,
    /// Bytes that a copy of another holds.
    copied: BTreeSet<String>,
}

impl Present {
    fn of(files: Vec<FileRow>) -> Present {
        let (mut paths, mut copied) = (BTreeSet::new(), BTreeSet::new());
        for file in files.into_iter().filter(|file| file.missing_since.is_none()) {
            match file.state {
                FileState::Alias => copied.extend(file.hash),
                _ => drop(paths.insert(file.path)),
            }
        }
        Present { paths, copied }
    }

    fn lacks(&self, path: &str, hash: &str) -> bool {
        !self.paths.contains(path) && !self.copied.contains(hash)
    }
}

impl Store {
    /// Paths of files of current runs, modulus logs and climate logs that are gone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn gone_files(&self) -> Result<BTreeSet<String>, StoreError> {
        let _moment = self.snapshot()?;
        let present = Present::of(self.files()?);
        let runs = self.all_current_rows()?;
        let of_runs = (runs.iter().flat_map(|run| &run.reading.files))
            .map(|file| (file.path.clone(), file.hash.clone()));
        let named = of_runs.chain(self.log_files()?);
        let gone = named.filter(|(path, hash)| present.lacks(path, hash));
        Ok(gone.map(|(path, _)| path).collect())
    }

    /// Names of current runs and modulus logs of which every file is gone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn deleted_runs(&self) -> Result<BTreeSet<String>, StoreError> {
        let _moment = self.snapshot()?;
        let present = Present::of(self.files()?);
        let runs = self.runs_of_which_every(|file| present.lacks(&file.path, &file.hash))?;
        Ok(runs.iter().map(|run| run.path.clone()).collect())
    }

    /// Paths of files that are missing.
    pub(super) fn missing_paths(&self) -> Result<BTreeSet<String>, StoreError> {
        let files = self.files()?.into_iter();
        let missing = files.filter(|file| file.missing_since.is_some());
        Ok(missing.map(|file| file.path).collect())
    }

    fn runs_of_which_every(&self, holds: impl Fn(&RunFile) -> bool) -> Result<Vec<Arc<RunRow>>, StoreError> {
        let mut runs = self.all_current_rows()?;
        runs.retain(|run| run.reading.files.iter().all(&holds));
        Ok(runs)
    }
}
