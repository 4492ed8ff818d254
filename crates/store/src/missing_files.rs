//! Files of current runs and logs that are gone: no file of the folder holds their bytes.
//!
//! Where files were swapped, or one was written in the place of another, a name says nothing of bytes. So a file is there
//! where it lies under its own name, or where another file is known to hold the same bytes. What lies under its name and was
//! refused, or waits, is listed as that.

use std::collections::{BTreeMap, BTreeSet};

use super::{Store, StoreError, Subject};

/// Rows of `of` whose file, named in the table `file`, is gone.
fn gone(of: &str, file: &str) -> String {
    format!(
        "SELECT {of}
         LEFT JOIN source_file AS own
             ON own.path = {file}.path AND own.missing_since IS NULL AND own.state <> 'alias'
         WHERE superseded_at IS NULL AND own.path IS NULL
             AND {file}.hash NOT IN (SELECT hash FROM source_file
                 WHERE state = 'alias' AND hash IS NOT NULL AND missing_since IS NULL)"
    )
}

impl Store {
    /// Paths of files of current runs, modulus logs and climate logs that are gone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn gone_files(&self) -> Result<BTreeSet<String>, StoreError> {
        let doing = "looking for files that are gone";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Logs)?;
        let sql = gone("id, climate_log.path FROM climate_log", "climate_log");
        let logs: Vec<(i64, String)> = self.rows(doing, &sql, [], |row| Ok((row.get(0)?, row.get(1)?)))?;
        for (log_id, _) in &logs {
            self.check_seal(&Subject::Log(*log_id))?;
        }
        let mut gone: BTreeSet<String> = self.gone_of_runs()?.into_values().flatten().collect();
        gone.extend(logs.into_iter().map(|(_, path)| path));
        for path in &gone {
            self.check_seal(&Subject::File(path.clone()))?;
        }
        Ok(gone)
    }

    /// Names of current runs and modulus logs of which every file is gone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn deleted_runs(&self) -> Result<BTreeSet<String>, StoreError> {
        let _moment = self.snapshot()?;
        let mut deleted = BTreeSet::new();
        for ((run_id, name), gone) in self.gone_of_runs()? {
            for path in &gone {
                self.check_seal(&Subject::File(path.clone()))?;
            }
            if self.file_paths(run_id)?.iter().all(|path| gone.contains(path)) {
                deleted.insert(name);
            }
        }
        Ok(deleted)
    }

    /// Row ids of current runs of which no file lies under its name any more, as the journal says of each. Another file may
    /// hold their bytes.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_without_files(&self) -> Result<BTreeSet<i64>, StoreError> {
        let doing = "looking for runs whose files are missing";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Runs)?;
        let sql = "SELECT run_id, run_file.path AS file FROM source_file
                   JOIN run_file ON run_file.path = source_file.path JOIN run ON run.id = run_id
                   WHERE missing_since IS NOT NULL AND superseded_at IS NULL";
        let found: Vec<(i64, String)> =
            self.rows(doing, sql, [], |row| Ok((row.get("run_id")?, row.get("file")?)))?;
        let mut missing: BTreeMap<i64, BTreeSet<String>> = BTreeMap::new();
        for (run_id, path) in found {
            self.check_seal(&Subject::File(path.clone()))?;
            missing.entry(run_id).or_default().insert(path);
        }
        let mut without = BTreeSet::new();
        for (run_id, missing) in missing {
            if self.file_paths(run_id)?.iter().all(|path| missing.contains(path)) {
                without.insert(run_id);
            }
        }
        Ok(without)
    }

    /// Files that are gone of current runs and modulus logs, by row id and name.
    fn gone_of_runs(&self) -> Result<BTreeMap<(i64, String), BTreeSet<String>>, StoreError> {
        let doing = "looking for runs whose files are gone";
        self.check_seal(&Subject::Runs)?;
        let of = "run.id, run.path AS name, run_file.path AS file
                  FROM run JOIN run_file ON run_file.run_id = run.id";
        let found = self.rows(doing, &gone(of, "run_file"), [], |row| {
            Ok(((row.get("id")?, row.get("name")?), row.get("file")?))
        })?;
        let mut gone: BTreeMap<(i64, String), BTreeSet<String>> = BTreeMap::new();
        for (run, path) in found {
            gone.entry(run).or_default().insert(path);
        }
        for (run_id, _) in gone.keys() {
            self.check_seal(&Subject::Run(*run_id))?;
        }
        Ok(gone)
    }
}
