//! The journal that goes into a backup: one that is damaged, cut or missing never takes the place of a good copy.

use super::contents::{IN_ITS_PLACE, reason};
use super::manifest::{JOURNAL, LeftOut, Manifest, StoredFile};
use super::shelf::Shelf;
use crate::domain::Severity;
use crate::domain::words::counted;
use crate::ingest::archive;
use crate::pipeline::upkeep::rebuild::what_is_wrong;
use crate::pipeline::{Context, PipelineError};
use crate::store::{Store, journal};
use crate::system::fs;

/// Keeps the journal as far as its lines are whole: it is appended to meanwhile, and read after the database was copied, so
/// that it holds whatever the database does. Where it cannot be trusted the earlier copy is what goes into the backup.
///
/// # Errors
/// The backup cannot be read or written, or the copied database.
pub fn kept(
    context: &Context,
    copy: &Store,
    earlier: Option<&Manifest>,
    shelf: &mut Shelf,
    left_out: &mut Vec<LeftOut>,
) -> Result<Option<StoredFile>, PipelineError> {
    let path = journal::path_in(&context.folder);
    let earlier = earlier
        .and_then(|list| list.files.iter().find(|file| file.path == JOURNAL))
        .filter(|file| shelf.holds(&file.blake3, file.size_bytes));
    let read = fs::read_own(&path).map(|bytes| journal::without_torn_end(&bytes).to_vec());
    let doubt = match &read {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let nothing_was_said = earlier.is_none() && copy.last_said()? == journal::End::default();
            (!nothing_was_said)
                .then(|| "it is not there; the next `ieap run` writes it from the database".to_owned())
        }
        Err(error) => Some(format!("it cannot be read: {error}")),
        Ok(bytes) => doubt(bytes, copy, earlier, shelf)?,
    };
    let bytes = match (doubt, read) {
        (None, Ok(bytes)) => bytes,
        (None, Err(_)) => return Ok(None),
        (Some(doubt), _) if earlier.is_some() => {
            left_out.push(reason(JOURNAL, &format!("{doubt}; {IN_ITS_PLACE}")));
            return Ok(earlier.cloned());
        }
        (Some(doubt), Ok(bytes)) => {
            left_out.push(reason(
                JOURNAL,
                &format!("{doubt}; there is no earlier copy, and it is in the backup as it is"),
            ));
            bytes
        }
        (Some(doubt), Err(_)) => {
            left_out.push(reason(JOURNAL, &doubt));
            return Ok(None);
        }
    };
    let stored = StoredFile {
        path: JOURNAL.to_owned(),
        size_bytes: bytes.len() as u64,
        blake3: archive::hash(&bytes),
        modified_ns: 0,
    };
    shelf.keep(stored.blake3.clone(), bytes, &path)?;
    Ok(Some(stored))
}

/// Why a journal cannot be trusted: its lines are damaged; or it neither goes on where the earlier copy ends nor says what the
/// database says.
fn doubt(
    bytes: &[u8],
    copy: &Store,
    earlier: Option<&StoredFile>,
    shelf: &Shelf,
) -> Result<Option<String>, PipelineError> {
    let found = journal::found(bytes);
    let damage = what_is_wrong(Some(&found))
        .into_iter()
        .find(|issue| issue.severity == Severity::Error);
    if let Some(issue) = damage {
        return Ok(Some(format!(
            "{}: {}. {}",
            issue.place, issue.message, issue.mend
        )));
    }
    if let Some(earlier) = earlier {
        let begins = usize::try_from(earlier.size_bytes)
            .ok()
            .and_then(|size| bytes.get(..size));
        if begins.is_some_and(|begins| archive::hash(begins) == earlier.blake3) {
            return Ok(None);
        }
        let begins_the_copy = || {
            shelf
                .read(&earlier.blake3)
                .is_ok_and(|copy| copy.starts_with(bytes))
        };
        if begins.is_none() && begins_the_copy() {
            return Ok(Some(format!(
                "it was cut to {} of {} bytes",
                bytes.len(),
                earlier.size_bytes
            )));
        }
    }
    Ok(match journal::Compared::of(&copy.course()?, &found) {
        Err(parted) => Some(parted),
        Ok(compared) if !compared.of_database.is_empty() => Some(format!(
            "it lacks {} that the database has; the next `ieap run` writes them",
            counted(compared.of_database.len(), "line")
        )),
        Ok(_) => None,
    })
}
