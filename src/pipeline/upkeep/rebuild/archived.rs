//! Files as the archive holds them: read again as when they came in.

use std::path::PathBuf;

use crate::domain::{Issue, RunKind};
use crate::ingest::archive::{Archive, Archived};
use crate::ingest::scan::SeenFile;
use crate::pipeline::Context;
use crate::pipeline::intake::ingest::{Outcome, PreparedFile, With, frame_folder, prepare_bytes};
use crate::store::journal::NamedBytes;

/// What reads archived files, of several threads at once.
pub struct ArchivedFiles<'a> {
    archive: Archive,
    with: With<'a>,
}

impl<'a> ArchivedFiles<'a> {
    /// Those of a campaign.
    pub fn of(context: &'a Context) -> ArchivedFiles<'a> {
        ArchivedFiles {
            archive: Archive::new(&context.folder),
            with: With {
                folder: &context.folder,
                profiles: &context.profiles,
                campaign: &context.campaign,
                read_file: context.read_file,
            },
        }
    }

    /// Reads the bytes of a file of that name again; `reader` is the format that read it then.
    ///
    /// # Errors
    /// The bytes are gone or damaged, or no reader reads them now.
    pub fn read(&self, named: &NamedBytes, kind: RunKind, reader: &str) -> Result<PreparedFile, Issue> {
        let lost = |message: String| {
            Issue::error("raw-file-lost", message).at(&named.path).mend(
                "put the original file into its folder and run `ieap run`, or put the archive's file back from a backup and run `ieap rebuild`",
            )
        };
        let bytes = self.archive.read(&named.hash).map_err(|e| lost(e.to_string()))?;
        let place = self.archive.find(&named.hash).map_err(|e| lost(e.to_string()))?;
        let archived = Archived {
            hash: named.hash.clone(),
            path: self.archive.relative(&place),
            size_bytes: bytes.len() as u64,
        };
        let mut file = match reader {
            frame_folder::FORMAT => of_frames(named, &bytes)?,
            _ => prepare_bytes(self.with, kind, &as_seen(named), bytes),
        };
        file.bytes = Vec::new();
        file.archived = Some(archived);
        match &file.outcome {
            Outcome::Read(_) => Ok(file),
            Outcome::Refused(issue)
            | Outcome::Unread(issue)
            | Outcome::Pending(issue)
            | Outcome::Sidecar(issue) => Err(issue.clone().at(&named.path)),
        }
    }
}

/// The table that was traced from a folder of frames.
fn of_frames(named: &NamedBytes, bytes: &[u8]) -> Result<PreparedFile, Issue> {
    let reading = frame_folder::reading_of_table(bytes)?;
    Ok(PreparedFile {
        file: as_seen(named),
        hash: Some(named.hash.clone()),
        bytes: Vec::new(),
        archived: None,
        outcome: Outcome::Read(Box::new(reading)),
        profile: None,
    })
}

/// The file as if a scan had seen it; the fingerprint is no file's, so that the next scan looks at it.
fn as_seen(named: &NamedBytes) -> SeenFile {
    SeenFile {
        relative: PathBuf::from(&named.path),
        display: named.path.clone(),
        size_bytes: 0,
        modified_ns: 0,
        inode: 0,
        changed_ns: 0,
        age: None,
        link_target: None,
    }
}
