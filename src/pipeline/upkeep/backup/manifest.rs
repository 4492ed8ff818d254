//! What a backup holds: its list, written last. A folder without one is no backup, or one that was never finished.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::pipeline::infra::error::BackupError;
use crate::pipeline::infra::whole_file::put_own;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// What no file holds, one JSON document a line, inside the archive: it is only ever appended to.
pub const JOURNAL: &str = "archive/journal.jsonl";
/// Name of the list that is a backup.
pub use crate::pipeline::infra::error::BACKUP_LIST as FILE_NAME;
/// Schema of the document.
const SCHEMA: &str = "ieap/backup-contents/1";

/// What a backup holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Schema of this document.
    schema: String,
    /// Campaign id.
    pub campaign: String,
    /// Id of the database.
    pub database_id: String,
    /// When it was made, RFC 3339 UTC.
    pub made_at: String,
    /// Program that made it.
    pub program: String,
    /// Number of changes of the database until then.
    pub changes: u64,
    /// The copy of the database; its path is that inside the backup.
    pub database: StoredFile,
    /// The other files of the campaign, by their paths in it; their bytes lie in `archive/` of the backup under their hashes.
    pub files: Vec<StoredFile>,
    /// What is not in the backup, with the reason.
    pub left_out: Vec<LeftOut>,
}

/// A file of a backup.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoredFile {
    /// Path as the scan displays it: with `/`, escaped without loss.
    pub path: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// BLAKE3 of its bytes, hexadecimal.
    pub blake3: String,
    /// Modification time, ns since 1970; 0 where it is of no use.
    pub modified_ns: i64,
}

/// What is not in a backup.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub struct LeftOut {
    /// Path relative to the campaign.
    pub path: String,
    /// Why, and how to mend it.
    pub reason: String,
}

/// What was found out of a campaign beside its files.
pub struct Head {
    /// Campaign id.
    pub campaign: String,
    /// Id of the database.
    pub database_id: String,
    /// When the backup is made, RFC 3339 UTC.
    pub made_at: String,
    /// Number of changes of the database.
    pub changes: u64,
}

impl Manifest {
    /// Of these files.
    pub fn of(head: Head, database: StoredFile, files: Vec<StoredFile>, left_out: Vec<LeftOut>) -> Manifest {
        Manifest {
            schema: SCHEMA.to_owned(),
            campaign: head.campaign,
            database_id: head.database_id,
            made_at: head.made_at,
            program: format!("ieap {}", crate::pipeline::CODE_VERSION),
            changes: head.changes,
            database,
            files,
            left_out,
        }
    }

    /// Reads that of the backup in `folder`; none where there is none.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn read(folder: &Path) -> Result<Option<Manifest>, PipelineError> {
        let path = folder.join(FILE_NAME);
        let text = match fs::read_own(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(failed(&path, "reading what the backup holds")(source)),
        };
        parsed(&text)
            .map(Some)
            .map_err(|detail| BackupError::DamagedManifest { path, detail }.into())
    }

    /// Puts it in place, safe on the disk and read back. Until this step the one before it is the backup.
    ///
    /// # Errors
    /// The disk refuses, or does not give back what was written.
    pub fn put(&self, folder: &Path) -> Result<(), PipelineError> {
        put_own(&folder.join(FILE_NAME), self.text()?.as_bytes())?;
        fs::sync_names(folder).map_err(failed(folder, "bringing it to the disk"))?;
        if Manifest::read(folder)?.as_ref() != Some(self) {
            let (folder, path) = (folder.to_owned(), FILE_NAME.to_owned());
            return Err(BackupError::NotAsWritten { folder, path }.into());
        }
        Ok(())
    }

    /// The file of that path in the campaign.
    pub fn file(&self, path: &str) -> Option<&StoredFile> {
        self.files.iter().find(|file| file.path == path)
    }

    /// Hashes of the files that it names.
    pub fn hashes(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.blake3.as_str())
    }

    /// Those of files that go with a list that no longer is the backup. Raw files of the archive stay: nothing removes one, and one
    /// that the campaign lost is here.
    pub fn hashes_to_forget(&self) -> impl Iterator<Item = &str> {
        let is_raw = |file: &&StoredFile| file.path.starts_with("archive/") && file.path != JOURNAL;
        let raw: BTreeSet<&str> = (self.files.iter().filter(is_raw))
            .map(|file| file.blake3.as_str())
            .collect();
        self.hashes().filter(move |hash| !raw.contains(hash))
    }

    fn text(&self) -> Result<String, PipelineError> {
        let internal = |error: serde_json::Error| PipelineError::Fault {
            step: "writing what the backup holds".to_owned(),
            reason: error.to_string(),
        };
        let backup = serde_json::to_value(self).map_err(internal)?;
        let document = serde_json::json!({ "checksum": checksum(&backup), "backup": backup });
        let text = serde_json::to_string_pretty(&document).map_err(internal)?;
        Ok(format!("{text}\n"))
    }
}

fn parsed(text: &[u8]) -> Result<Manifest, String> {
    let mut document: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
    let backup = document["backup"].take();
    if document["checksum"] != checksum(&backup) {
        return Err("its checksum does not match".to_owned());
    }
    match backup["schema"].as_str() {
        Some(SCHEMA) => serde_json::from_value(backup).map_err(|error| error.to_string()),
        found => Err(format!(
            "schema {}, this program knows {SCHEMA}",
            found.unwrap_or("none")
        )),
    }
}

/// BLAKE3 of a document without its blanks.
fn checksum(backup: &Value) -> String {
    blake3::hash(backup.to_string().as_bytes()).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest() -> Manifest {
        let file = |path: &str| StoredFile {
            path: path.to_owned(),
            size_bytes: 7,
            blake3: "ab".repeat(32),
            modified_ns: -1,
        };
        let head = Head {
            campaign: "c".to_owned(),
            database_id: "d".to_owned(),
            made_at: "2026-01-01T00:00:00Z".to_owned(),
            changes: u64::MAX,
        };
        Manifest::of(
            head,
            file("campaign.db"),
            vec![file("runs/µ \"a\".csv")],
            Vec::new(),
        )
    }

    #[test]
    fn what_was_written_is_read_and_any_flipped_byte_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE_NAME);
        assert_eq!(Manifest::read(folder.path()).unwrap(), None);
        fs::write(&path, manifest().text().unwrap()).unwrap();
        assert_eq!(Manifest::read(folder.path()).unwrap(), Some(manifest()));
        let sound = fs::read_own(&path).unwrap();
        for at in 0..sound.len() {
            let mut flipped = sound.clone();
            flipped[at] ^= 1;
            fs::write(&path, &flipped).unwrap();
            let read = Manifest::read(folder.path());
            // A blank between two words of JSON may become another one.
            assert!(read.is_err() || read.unwrap() == Some(manifest()), "byte {at}");
        }
    }
}
