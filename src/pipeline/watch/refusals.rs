//! What the disk or the database refused, which is tried again for a while.

use std::time::Duration;

use crate::pipeline::{Observer, PipelineError};

/// Wait before another try where the disk or the database refused.
pub(super) const AFTER_REFUSAL: Duration = Duration::from_secs(10);
/// After this many refusals by the disk or the database in a row the watch ends.
const MOST_REFUSALS: u32 = 360;

/// How often in a row the disk or the database refused.
#[derive(Debug, Default)]
pub(super) struct Refusals(u32);

impl Refusals {
    /// What was done; none where it was refused and is to be tried again.
    pub fn passed<T>(
        &mut self,
        outcome: Result<T, PipelineError>,
        observer: &dyn Observer,
    ) -> Result<Option<T>, PipelineError> {
        match outcome {
            Ok(done) => {
                self.0 = 0;
                Ok(Some(done))
            }
            Err(error) if error.may_pass() && self.0 < MOST_REFUSALS => {
                self.0 += 1;
                observer.warn(&format!(
                    "{error}; the watch tries again in {} s",
                    AFTER_REFUSAL.as_secs()
                ));
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}
