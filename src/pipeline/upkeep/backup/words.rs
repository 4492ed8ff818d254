//! The words that go into a backup. They are appended to meanwhile, and read after the database was copied, so that they hold
//! whatever it does: their ends are compared, once. Words that are damaged or cut take the place of no good copy.

use std::io;
use std::path::Path;

use super::manifest::{JOURNAL, StoredFile};
use crate::domain::Severity;
use crate::ingest::archive;
use crate::pipeline::infra::error::BackupError;
use crate::pipeline::upkeep::rebuild::what_is_wrong;
use crate::pipeline::{Context, PipelineError, failed};
use crate::store::{Store, journal};
use crate::system::fs;

/// The words of a campaign as far as their lines are whole: none where nothing was said.
///
/// # Errors
/// They cannot be read, or do not hold what the copied database or the earlier copy of them holds.
pub fn read(
    context: &Context,
    copy: &Store,
    earlier: Option<&StoredFile>,
) -> Result<Option<Vec<u8>>, PipelineError> {
    let bytes = of(&context.folder)?;
    let refused = |detail: String| BackupError::Words {
        path: JOURNAL.to_owned(),
        detail,
    };
    if let Some(detail) = what_they_lack(&bytes, copy)? {
        return Err(refused(detail).into());
    }
    if let Some(earlier) = earlier.filter(|earlier| !begin_as(&bytes, earlier)) {
        return Err(refused(format!(
            "the {} bytes of it in the backup are not how it begins: it was cut, or the campaign is an older one",
            earlier.size_bytes
        ))
        .into());
    }
    Ok((!bytes.is_empty()).then_some(bytes))
}

/// The words in a folder, without a line that is cut off: nobody was told of what it says.
///
/// # Errors
/// They cannot be read.
pub fn of(folder: &Path) -> Result<Vec<u8>, PipelineError> {
    let path = journal::path_in(folder);
    match fs::read_own(&path) {
        Ok(bytes) => Ok(journal::without_torn_end(&bytes).to_vec()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(source) => Err(failed(&path, "reading")(source)),
    }
}

/// Why words are not all that a database holds; none where they are.
///
/// # Errors
/// The database cannot be read.
pub fn what_they_lack(bytes: &[u8], database: &Store) -> Result<Option<String>, PipelineError> {
    let found = journal::found(bytes);
    let mut wrong = what_is_wrong(Some(&found)).into_iter();
    if let Some(issue) = wrong.find(|issue| issue.severity == Severity::Error) {
        return Ok(Some(format!("{}: {}", issue.place, issue.message)));
    }
    let end = database.last_said()?;
    let mut ends = found.lines.iter().map(journal::End::after);
    let holds = end == journal::End::default() || ends.any(|own| own == end);
    Ok((!holds).then(|| format!("it lacks line {} of the database", end.n)))
}

fn begin_as(bytes: &[u8], earlier: &StoredFile) -> bool {
    let size = usize::try_from(earlier.size_bytes).ok();
    let begins = size.and_then(|size| bytes.get(..size));
    begins.is_some_and(|begins| archive::hash(begins) == earlier.blake3)
}
