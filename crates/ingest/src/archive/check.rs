//! Whether the archive holds what it should.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::error::ArchiveError;
use super::{Archive, Archived, hash};
use ieap_domain::Issue;
use ieap_system::fs;

/// What is wrong with a raw file of the archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BlobFault {
    /// It is not there.
    Missing,
    /// It has another size.
    Size {
        /// Size found, bytes.
        found_bytes: u64,
    },
    /// Its bytes have another hash.
    Damaged {
        /// Hash found.
        found: String,
    },
    /// The system does not give it.
    Unreadable {
        /// What the system says.
        reason: String,
    },
}

/// A raw file that is not as it should be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlobFinding {
    /// Which one.
    pub wanted: Archived,
    /// What is wrong.
    pub fault: BlobFault,
}

impl BlobFinding {
    /// The finding in words, with the way to mend it.
    pub fn issue(&self) -> Issue {
        let found = match &self.fault {
            BlobFault::Missing => "it is not in the archive".to_owned(),
            BlobFault::Size { found_bytes } => {
                format!(
                    "it has {found_bytes} bytes, {} were stored",
                    self.wanted.size_bytes
                )
            }
            BlobFault::Damaged { found } => format!("its bytes hash to {found}"),
            BlobFault::Unreadable { reason } => format!("it cannot be read: {reason}"),
        };
        let mend = "put the original file into the runs folder again (`touch` it where it lies there) and run `ieap run`, \
                    or bring the archive's file back from a backup";
        Issue::error("raw-file-lost", found)
            .at(&self.wanted.path)
            .mend(mend)
    }
}

impl Archive {
    /// Which of these raw files are missing or have another size: names and sizes are looked at, no bytes are read.
    ///
    /// # Errors
    /// Where a folder cannot be read.
    pub fn missing(&self, wanted: &[Archived]) -> Result<Vec<BlobFinding>, ArchiveError> {
        let sizes: BTreeMap<String, u64> = self
            .entries()?
            .into_iter()
            .map(|entry| (entry.hash, entry.size_bytes))
            .collect();
        let fault = |wanted: &Archived| match sizes.get(&wanted.hash) {
            None => Some(BlobFault::Missing),
            Some(&found_bytes) if found_bytes != wanted.size_bytes => Some(BlobFault::Size { found_bytes }),
            Some(_) => None,
        };
        Ok(findings(wanted.iter().map(|wanted| (wanted, fault(wanted)))))
    }

    /// Reads every one of these raw files and holds its bytes against its hash.
    ///
    /// # Errors
    /// Where a folder cannot be read.
    pub fn verify(&self, wanted: &[Archived]) -> Result<Vec<BlobFinding>, ArchiveError> {
        let found: Result<Vec<Option<BlobFault>>, ArchiveError> =
            wanted.par_iter().map(|wanted| self.fault_of(wanted)).collect();
        Ok(findings(wanted.iter().zip(found?)))
    }

    fn fault_of(&self, wanted: &Archived) -> Result<Option<BlobFault>, ArchiveError> {
        let Some(path) = self.locate(&wanted.hash)? else {
            return Ok(Some(BlobFault::Missing));
        };
        Ok(match fs::read_own(&path) {
            Err(error) => Some(BlobFault::Unreadable {
                reason: error.to_string(),
            }),
            Ok(bytes) => {
                let found = hash(&bytes);
                (found != wanted.hash).then_some(BlobFault::Damaged { found })
            }
        })
    }
}

fn findings<'a>(looked_at: impl Iterator<Item = (&'a Archived, Option<BlobFault>)>) -> Vec<BlobFinding> {
    let finding = |(wanted, fault): (&'a Archived, Option<BlobFault>)| {
        Some(BlobFinding {
            wanted: wanted.clone(),
            fault: fault?,
        })
    };
    looked_at.filter_map(finding).collect()
}
