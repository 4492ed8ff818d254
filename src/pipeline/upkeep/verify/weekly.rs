//! When a campaign that is watched was looked at last: once a week is often enough for a disk that fails slowly.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::short::quick;
use crate::domain::Issue;
use crate::pipeline::infra::whole_file::put_own;
use crate::pipeline::{Context, PipelineError};
use crate::system::fs;

/// Time between two looks.
const WEEK: Duration = Duration::from_secs(7 * 24 * 3600);
/// Holds the time of the last look, RFC 3339 UTC.
const FILE: &str = "archive/last-look";

/// Says when the next look is due.
#[derive(Debug)]
pub struct Weekly {
    file: PathBuf,
}

impl Weekly {
    /// Of the campaign in that folder.
    pub fn of(folder: &Path) -> Weekly {
        Weekly {
            file: folder.join(FILE),
        }
    }

    /// Looks at the campaign where a week has passed; what was found, or none where it was not due. A campaign that was
    /// never looked at is due, and so is one whose last look lies in the future of the clock.
    ///
    /// # Errors
    /// The archive cannot be looked through, or the time cannot be written down.
    pub fn look(&self, context: &Context, now: jiff::Timestamp) -> Result<Option<Vec<Issue>>, PipelineError> {
        let text = fs::read_own_text(&self.file).unwrap_or_default();
        let last: Option<jiff::Timestamp> = text.trim().parse().ok();
        let since = last.and_then(|last| Duration::try_from(now.duration_since(last)).ok());
        if since.is_some_and(|since| since < WEEK) {
            return Ok(None);
        }
        let found = quick(context)?;
        put_own(&self.file, format!("{now}\n").as_bytes())?;
        Ok(Some(found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::infra::whole_file::put_bytes;

    #[test]
    fn a_week_passes_between_two_looks_and_what_is_lost_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let text = "[campaign]\nid = \"c\"\ntitle = \"C\"\n";
        put_bytes(&folder.path().join("campaign.toml"), false, text.as_bytes()).unwrap();
        let context = Context::open(folder.path(), false).unwrap();
        let weekly = Weekly::of(folder.path());
        let at = |days: i64| jiff::Timestamp::from_second(1_800_000_000 + days * 24 * 3600).unwrap();
        let looked = |days| weekly.look(&context, at(days)).unwrap().map(|found| found.len());
        assert_eq!((looked(0), looked(6)), (Some(0), None));
        // The clock was set back: rather one look more.
        assert_eq!((looked(8), looked(1), looked(2)), (Some(0), Some(0), None));
        let journal = crate::store::journal::path_in(folder.path());
        put_own(&journal, b"no line of a journal\n").unwrap();
        assert_eq!(looked(9), Some(1));
    }
}
