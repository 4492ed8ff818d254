//! The intake of a watch: looks at the folder again and again, and takes in what is ready.

use std::time::{Duration, Instant};

use super::refusals::{AFTER_REFUSAL, Refusals};
use super::sightings::Sightings;
use crate::ingest::scan::SeenFile;
use crate::pipeline::{Context, Ingest, IngestSummary, Observer, PipelineError};

/// Waits between two looks at files that are not quiet yet, at least.
const SHORTEST_WAIT: Duration = Duration::from_millis(100);
/// Longest wait without a hint: hand tags and tag files on a share are noticed by then.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// What is known from look to look.
pub struct Intake {
    sightings: Sightings,
    refusals: Refusals,
}

/// What a look came to.
#[derive(Debug)]
pub struct Look {
    /// What was taken in; none where the disk or the database refused, which was said.
    pub taken: Option<IngestSummary>,
    /// Time until the next look, where nothing calls for one before.
    pub wait: Duration,
}

impl Intake {
    /// Takes a file when it has not changed for as long as `quiet`.
    pub fn new(quiet: Duration) -> Intake {
        Intake {
            sightings: Sightings::new(quiet),
            refusals: Refusals::default(),
        }
    }

    /// Looks once; `now` is asked for the time.
    ///
    /// # Errors
    /// The database or the archive is gone, replaced or damaged, or the disk or the database refused for an hour.
    pub fn look(
        &mut self,
        context: &mut Context,
        now: &dyn Fn() -> Instant,
        observer: &dyn Observer,
    ) -> Result<Look, PipelineError> {
        let sightings = &mut self.sightings;
        sightings.begin();
        let ready = &mut |file: &SeenFile| sightings.is_ready(file, now());
        let in_place = context.check_in_place();
        let taken = in_place.and_then(|()| Ingest { ready }.run(context, observer));
        let taken = self.refusals.passed(taken, observer)?;
        let wait = match &taken {
            Some(summary) => {
                sightings.note_unread(&summary.unread, now());
                let next = sightings.next_look(now());
                next.map_or(LONGEST_WAIT, |wait| wait.clamp(SHORTEST_WAIT, LONGEST_WAIT))
            }
            None => AFTER_REFUSAL,
        };
        Ok(Look { taken, wait })
    }
}
