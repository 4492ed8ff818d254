//! Files of the campaign folder and the bytes that were archived from them.

use std::collections::BTreeMap;

use rusqlite::{Row, params};

use super::columns::{from_json, json_in, key_in, to_json};
use super::journal::{Entry, NamedBytes};
use super::rows::{CONTENT, RUN_FILE, SOURCE_FILE};
use super::run_changes::stated_beside;
use super::{RunContent, StepError, Store, StoreError, Transaction};
use ieap_domain::{FileState, Issue, SourceFile};

/// A file as the last scan saw it and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FileRow {
    /// Path relative to the campaign as the scan displays it: with `/`, escaped without loss.
    pub path: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Modification time, ns since 1970.
    pub modified_ns: i64,
    /// Inode, or 0 where the system has none.
    pub inode: u64,
    /// Time of the last change of anything of the file, ns since 1970; 0 where it is not known.
    pub changed_ns: i64,
    /// BLAKE3 of the bytes, hexadecimal; none where they were not read.
    pub hash: Option<String>,
    /// What became of it.
    pub state: FileState,
    /// Format id and version that decided, as `id/version`; empty where none did.
    pub reader: String,
    /// Why it was refused or waits.
    pub issue: Option<Issue>,
    /// Since when it has been gone, RFC 3339 UTC.
    pub missing_since: Option<String>,
}

impl FileRow {
    /// A file of which no fingerprint is known, so that the next scan looks at it.
    pub fn unseen(path: String, state: FileState, reader: String) -> FileRow {
        FileRow {
            path,
            size_bytes: 0,
            modified_ns: 0,
            inode: 0,
            changed_ns: 0,
            hash: None,
            state,
            reader,
            issue: None,
            missing_since: None,
        }
    }

    /// What pages and `status` show of it.
    pub fn source_file(&self) -> SourceFile {
        SourceFile {
            path: self.path.clone(),
            size_bytes: self.size_bytes,
            modified_ns: self.modified_ns,
            state: self.state,
            issue: self.issue.clone(),
            missing: self.missing_since.is_some(),
        }
    }
}

impl Store {
    /// Every file known, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn files(&self) -> Result<Vec<FileRow>, StoreError> {
        let files = self.whole("source_file", |store| {
            // Whoever asks what the folder held asks next which run a file is of.
            store.check_list(RUN_FILE, "run_file")?;
            let mut files = store.listed("listing files", SOURCE_FILE, "source_file", read_file)?;
            files.sort_by(|a, b| a.path.cmp(&b.path));
            Ok(files)
        })?;
        Ok(files.to_vec())
    }

    /// Those of these paths that are known, each looked up by itself.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn files_of(&self, paths: &[String]) -> Result<Vec<FileRow>, StoreError> {
        let mut files = Vec::with_capacity(paths.len());
        for path in paths {
            let rest = ("", "WHERE path = ?1");
            files.extend(self.kept("looking for a file", SOURCE_FILE, rest, [path], read_file)?);
        }
        Ok(files)
    }

    /// The files that are there and were refused or wait, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn unsettled_files(&self) -> Result<Vec<FileRow>, StoreError> {
        let mut files = self.files()?;
        files.retain(|file| {
            matches!(file.state, FileState::Refused | FileState::Pending) && file.missing_since.is_none()
        });
        Ok(files)
    }

    /// Records what became of files that hold no new run: refused, pending, aliases.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn record_files(&mut self, now: &str, files: &[FileRow]) -> Result<(), StoreError> {
        if files.is_empty() {
            return Ok(());
        }
        self.write("recording files", now, |transaction| {
            files.iter().try_for_each(|file| {
                say_alias(transaction, now, file)?;
                upsert_file(transaction, file)
            })
        })
    }

    /// Notes when files that are otherwise as they are stored changed last, ns since 1970: they were stored before such
    /// times were.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn note_change_times(&mut self, now: &str, files: &[(&str, i64)]) -> Result<(), StoreError> {
        if files.is_empty() {
            return Ok(());
        }
        self.write("noting change times", now, |transaction| {
            let sql = "UPDATE source_file SET changed_ns = ?2 WHERE path = ?1";
            files.iter().try_for_each(|(path, changed_ns)| {
                transaction.change(SOURCE_FILE, ("path = ?1", path), || {
                    transaction
                        .prepare_cached(sql)?
                        .execute(params![path, changed_ns])?;
                    Ok(())
                })
            })
        })
    }

    /// Files that the system could not give when they were to be read, with what it said, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn unread_files(&self) -> Result<Vec<(String, Issue)>, StoreError> {
        let sql = "SELECT path, issue FROM unread_file ORDER BY path";
        self.rows("listing files that were not read", sql, [], |row| {
            Ok((
                row.get("path")?,
                json_in(row, "issue", "why a file was not read")?,
            ))
        })
    }

    /// Records these as all files that the system could not give; no change where they are known as such. They carry no
    /// hash: no result is made from them, and the next scan writes them anew.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_unread_files(&mut self, now: &str, files: &[(String, Issue)]) -> Result<(), StoreError> {
        if self.unread_files()? == files {
            return Ok(());
        }
        self.write("recording files that were not read", now, |transaction| {
            transaction.execute("DELETE FROM unread_file", [])?;
            for (path, issue) in files {
                let issue = to_json("why a file was not read", issue)?;
                transaction
                    .prepare_cached("INSERT INTO unread_file VALUES (?1, ?2)")?
                    .execute([path, &issue])?;
            }
            Ok(())
        })
    }

    /// Marks files as gone since `now`. Their runs stay.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn mark_missing(&mut self, now: &str, paths: &[String]) -> Result<(), StoreError> {
        if paths.is_empty() {
            return Ok(());
        }
        self.write("marking missing files", now, |transaction| {
            let sql = "UPDATE source_file SET missing_since = ?2 WHERE path = ?1 AND missing_since IS NULL";
            for path in paths {
                let is_new = transaction.change(SOURCE_FILE, ("path = ?1", path), || {
                    Ok(transaction.prepare_cached(sql)?.execute(params![path, now])? > 0)
                })?;
                if is_new {
                    let tags = stated_beside(transaction, path)?;
                    let path = path.clone();
                    transaction.says(now, Entry::Gone { path, tags })?;
                }
            }
            Ok(())
        })
    }

    /// Forgets refused and pending files that are gone: nothing of them was kept.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn forget_files(&mut self, now: &str, paths: &[String]) -> Result<(), StoreError> {
        if paths.is_empty() {
            return Ok(());
        }
        self.write("forgetting files", now, |transaction| {
            paths.iter().try_for_each(|path| forget(transaction, path))
        })
    }

    /// Raw bytes that the database names: hash, size in bytes, path in the archive, and a file of a run or log that held
    /// them, in the order of the hashes.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn contents(&self) -> Result<Vec<RunContent>, StoreError> {
        let path = ", coalesce((SELECT min(path) FROM run_file WHERE hash = content.hash),
                       (SELECT min(path) FROM climate_log WHERE hash = content.hash), archive_path) AS path";
        let _moment = self.snapshot()?;
        self.check_list(CONTENT, "content")?;
        self.kept("listing raw files", CONTENT, (path, "ORDER BY hash"), [], |row| {
            Ok(RunContent {
                path: row.get("path")?,
                hash: row.get("hash")?,
                size_bytes: row.get::<_, i64>("size_bytes")?.unsigned_abs(),
                archive_path: row.get("archive_path")?,
            })
        })
    }

    /// Whether the database names raw bytes, or these bytes where a hash is given.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn names_content(&self, hash: Option<&str>) -> Result<bool, StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM content WHERE ?1 IS NULL)
                       OR EXISTS (SELECT 1 FROM content WHERE hash = ?1)";
        self.connection
            .prepare_cached(sql)
            .and_then(|mut statement| statement.query_row([hash], |row| row.get(0)))
            .map_err(|e| self.failed("looking for raw files", e))
    }

    /// Files that were another name of a run or log whose content is another one now: no current one holds their bytes.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn orphaned_aliases(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT path FROM source_file WHERE state = 'alias' AND hash IS NOT NULL AND missing_since IS NULL
                   AND NOT EXISTS (SELECT 1 FROM run_file JOIN run ON run.id = run_file.run_id
                                   WHERE run_file.hash = source_file.hash AND run.superseded_at IS NULL)
                   AND NOT EXISTS (SELECT 1 FROM climate_log
                                   WHERE climate_log.hash = source_file.hash AND climate_log.superseded_at IS NULL)
                   ORDER BY path";
        self.rows("looking for files of no run", sql, [], |row| Ok(row.get(0)?))
    }

    /// Has every file read again at the next scan, as if its reader had changed.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn read_again(&mut self, now: &str) -> Result<(), StoreError> {
        self.write("marking files to be read again", now, |transaction| {
            transaction.change(SOURCE_FILE, ("?1 IS NULL", &rusqlite::types::Null), || {
                transaction.execute("UPDATE source_file SET reader = ''", [])?;
                Ok(())
            })
        })
    }

    /// Other present paths of the same bytes, by hash.
    pub(super) fn aliases(&self) -> Result<BTreeMap<String, Vec<String>>, StoreError> {
        let mut aliases: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let is_alias = |file: &FileRow| file.state == FileState::Alias && file.missing_since.is_none();
        for file in self.files()?.into_iter().filter(is_alias) {
            if let Some(hash) = file.hash {
                aliases.entry(hash).or_default().push(file.path);
            }
        }
        Ok(aliases)
    }
}

/// Writes what is known of a file over what was known before.
pub(super) fn upsert_file(transaction: &Transaction<'_>, file: &FileRow) -> Result<(), StepError> {
    let issue = file
        .issue
        .as_ref()
        .map(|issue| to_json("a file's issue", issue))
        .transpose()?;
    let sql = "INSERT INTO source_file
            (path, size_bytes, modified_ns, inode, hash, state, reader, issue, missing_since, changed_ns)
        VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)
        ON CONFLICT (path) DO UPDATE SET size_bytes = ?2, modified_ns = ?3, inode = ?4, hash = ?5, state = ?6, reader = ?7,
            issue = ?8, missing_since = ?9, changed_ns = ?10";
    transaction.change(SOURCE_FILE, ("path = ?1", &file.path), || {
        transaction.prepare_cached(sql)?.execute(params![
            file.path,
            file.size_bytes.cast_signed(),
            file.modified_ns,
            file.inode.cast_signed(),
            file.hash,
            file.state.key(),
            file.reader,
            issue,
            file.missing_since,
            file.changed_ns,
        ])?;
        Ok(())
    })
}

/// Forgets a file.
pub(super) fn forget(transaction: &Transaction<'_>, path: &str) -> Result<(), StepError> {
    transaction.change(SOURCE_FILE, ("path = ?1", &path), || {
        transaction
            .prepare_cached("DELETE FROM source_file WHERE path = ?1")?
            .execute([path])?;
        Ok(())
    })
}

/// Says that a file holds the bytes of another, where that is news.
fn say_alias(transaction: &Transaction<'_>, now: &str, file: &FileRow) -> Result<(), StepError> {
    let Some(hash) = file.hash.as_ref().filter(|_| file.state == FileState::Alias) else {
        return Ok(());
    };
    let sql = "SELECT EXISTS (SELECT 1 FROM source_file WHERE path = ?1 AND hash = ?2 AND state = 'alias'
                   AND missing_since IS NULL)";
    let is_known: bool = transaction
        .prepare_cached(sql)?
        .query_row([&file.path, hash], |row| row.get(0))?;
    if !is_known {
        let (path, hash) = (file.path.clone(), hash.clone());
        let file = NamedBytes { path, hash };
        transaction.says(now, Entry::Alias { file })?;
    }
    Ok(())
}

fn read_file(row: &Row<'_>) -> Result<FileRow, StepError> {
    let issue: Option<String> = row.get("issue")?;
    Ok(FileRow {
        path: row.get("path")?,
        size_bytes: row.get::<_, i64>("size_bytes")?.cast_unsigned(),
        modified_ns: row.get("modified_ns")?,
        inode: row.get::<_, i64>("inode")?.cast_unsigned(),
        changed_ns: row.get("changed_ns")?,
        hash: row.get("hash")?,
        state: key_in(row, "state", "a file's state", FileState::from_key)?,
        reader: row.get("reader")?,
        issue: issue.map(|text| from_json("a file's issue", &text)).transpose()?,
        missing_since: row.get("missing_since")?,
    })
}
