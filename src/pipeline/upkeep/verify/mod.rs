//! Whether what a campaign rests on is as it was stored: the database with what results are of, the raw files, the journal, the
//! report; and, asked for deeply, whether every current number can be derived again from the raw bytes, to the same bits.

pub mod archive;
mod database;
mod deep;
mod differs_in;
mod journal;
mod part;
mod report;
mod short;
mod subjects;
mod weekly;

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::Issue;
use crate::pipeline::{Context, Observer, PipelineError};
pub use journal::{behind, cut, missed};
pub use part::Part;
pub(crate) use short::of_archive;
pub(crate) use weekly::Weekly;

/// The verb `verify`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Verify {
    /// Whether raw bytes are read and runs are fitted again.
    pub deep: bool,
    /// Whether groups are diagnosed again, too.
    pub diagnoses: bool,
}

/// What was looked at of a campaign, and what was found.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Verified {
    /// Part by part.
    pub parts: Vec<Part>,
    /// Hash of all that the database says, times and row ids left out; none where it cannot be read.
    pub content_hash: Option<String>,
}

impl Verified {
    /// Whether nothing is lost or damaged.
    pub fn is_sound(&self) -> bool {
        self.parts.iter().all(Part::is_sound)
    }
}

impl Verify {
    /// Looks at the campaign in `folder`; nothing in it is changed. Another instance may work on it meanwhile.
    ///
    /// # Errors
    /// campaign.toml is wrong, or there was never a database; the archive or the report cannot be looked through.
    pub fn run(&self, folder: &Path, observer: &dyn Observer) -> Result<Verified, PipelineError> {
        let context = match Context::open_as_it_is(folder) {
            Ok(context) => context,
            Err(error) if error.is_storage() => return without_database(folder, &error),
            Err(error) => return Err(error),
        };
        let database = database::part(&context, observer)?;
        let can_be_read = database.is_sound();
        let mut parts = vec![database, archive::part(&context, observer)?];
        if can_be_read {
            parts.push(subjects::part(&context)?);
            parts.push(journal::part(&context)?);
            parts.push(report::part(&context)?);
        } else {
            parts.push(journal::alone(folder)?);
        }
        if self.deep && can_be_read {
            parts.extend(deep::parts(&context, self.diagnoses, observer)?);
        }
        let content = can_be_read.then(|| context.store.content()).transpose()?;
        Ok(Verified {
            parts,
            content_hash: content.map(|content| content.hash()),
        })
    }
}

/// What can be said where the database cannot be opened.
fn without_database(folder: &Path, error: &PipelineError) -> Result<Verified, PipelineError> {
    let database = Part {
        part: database::NAME,
        looked_at: "it cannot be opened".to_owned(),
        // The error says how to mend it.
        findings: vec![Issue::error("database-not-opened", error.to_string())],
    };
    Ok(Verified {
        parts: vec![database, archive::alone(folder)?, journal::alone(folder)?],
        content_hash: None,
    })
}
