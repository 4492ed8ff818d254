//! The main job for every file that arrives, until stopped.

use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::{Context, Observer, PipelineError, Run, RunSummary, holdings};
use crate::ingest::scan::{Readiness, SeenFile, Sighting, readiness};
use crate::ingest::watch::{Wake, WatchOptions, Watcher};

/// Waits between two looks at files that are not quiet yet, at least.
const SHORTEST_WAIT: Duration = Duration::from_millis(100);
/// Longest wait without a hint: hand tags and tag files on a share are noticed by then.
const LONGEST_WAIT: Duration = Duration::from_secs(30);
/// Wait before another try where the disk or the database refused.
const AFTER_REFUSAL: Duration = Duration::from_secs(10);
/// A diagnosis is left for the next round after this long, so that runs that arrive meanwhile are taken in and the report
/// shows what is known by then.
const TURN: Duration = Duration::from_secs(15);
/// After this many refusals by the disk or the database in a row the watch ends.
const MOST_REFUSALS: u32 = 360;

/// How to watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WatchSettings {
    /// A file is taken when it has not changed for this long.
    pub quiet: Duration,
    /// Look in turns of this length instead of waiting for events.
    pub poll: Option<Duration>,
}

/// The verb `watch`.
#[derive(Debug, Clone)]
pub struct Watch {
    /// How to watch.
    pub settings: WatchSettings,
    /// The main job.
    pub job: Run,
}

impl Watch {
    /// Subscribes, does the main job, then follows until `stop` is set; `after` hears of every round that did
    /// something. A disk that is full or a share that went offline is waited for.
    ///
    /// # Errors
    /// The folder cannot be watched, campaign.toml is wrong at the start, the database or the archive is gone, replaced or
    /// damaged, or the disk or the database refused for an hour.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
        stop: &AtomicBool,
        after: &mut dyn FnMut(&RunSummary),
    ) -> Result<(), PipelineError> {
        let options = WatchOptions {
            poll: self.settings.poll,
            quiet: self.settings.quiet,
            ..WatchOptions::default()
        };
        let mut optional = context.campaign.optional_folders().to_vec();
        optional.push(crate::analysis::climate::sensors::FOLDER);
        let (watcher, issues) =
            Watcher::start(&context.folder, &context.campaign.runs_folder, &optional, options)?;
        issues
            .iter()
            .for_each(|issue| observer.warn(&format!("{} {}", issue.message, issue.mend)));
        let mut sightings = Sightings::new(self.settings.quiet);
        let (mut refusals, mut first) = (0, true);
        loop {
            let wait = match self.round(context, observer, &mut sightings, stop) {
                Ok(summary) => {
                    refusals = 0;
                    if first || summary.ingest.changed() || summary.fit.fitted > 0 || summary.report.rendered
                    {
                        after(&summary);
                    }
                    first = false;
                    match summary.diagnose.left {
                        0 => sightings
                            .next_look()
                            .map_or(LONGEST_WAIT, |wait| wait.clamp(SHORTEST_WAIT, LONGEST_WAIT)),
                        _ => SHORTEST_WAIT,
                    }
                }
                Err(error) if error.may_pass() && refusals < MOST_REFUSALS => {
                    refusals += 1;
                    observer.warn(&format!(
                        "{error}; the watch tries again in {} s",
                        AFTER_REFUSAL.as_secs()
                    ));
                    AFTER_REFUSAL
                }
                Err(error) => return Err(error),
            };
            if waited(&watcher, wait, stop, observer) {
                return Ok(());
            }
        }
    }

    fn round(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
        sightings: &mut Sightings,
        stop: &AtomicBool,
    ) -> Result<RunSummary, PipelineError> {
        if let Err(error) = context.reload() {
            observer.warn(&format!(
                "{error}; what campaign.toml and the profiles said before goes on to hold"
            ));
        }
        context.store.check_in_place()?;
        holdings::check(&context.folder, &context.store)?;
        sightings.begin();
        // The turn begins when the diagnosis first asks.
        let begun: OnceLock<Instant> = OnceLock::new();
        let may_go_on = || begun.get_or_init(Instant::now).elapsed() < TURN && !stop.load(Ordering::SeqCst);
        self.job.run_ready(
            context,
            observer,
            &mut |file| sightings.is_ready(file),
            &may_go_on,
        )
    }
}

/// Waits for a reason to look again; tells whether to stop.
fn waited(watcher: &Watcher, wait: Duration, stop: &AtomicBool, observer: &dyn Observer) -> bool {
    loop {
        match watcher.wait(wait, stop) {
            Wake::Stopped => return true,
            Wake::FolderGone => {
                observer.warn("the runs folder is not there; nothing is taken for removed. Waiting for it.")
            }
            Wake::Hint | Wake::Rescan | Wake::Timeout => return false,
        }
    }
}

/// Since when each file has not changed.
struct Sightings {
    quiet: Duration,
    seen: BTreeMap<String, Sighting>,
    next: Option<Instant>,
}

impl Sightings {
    fn new(quiet: Duration) -> Sightings {
        Sightings {
            quiet,
            seen: BTreeMap::new(),
            next: None,
        }
    }

    fn begin(&mut self) {
        self.next = None;
    }

    fn is_ready(&mut self, file: &SeenFile) -> bool {
        let now = Instant::now();
        let sighting = match self.seen.remove(&file.display) {
            Some(earlier) => earlier.next(file, now),
            None => Sighting::first(file, now),
        };
        match readiness(&sighting, now, self.quiet) {
            Readiness::Ready => true,
            Readiness::Wait { until } => {
                self.seen.insert(file.display.clone(), sighting);
                self.next = Some(self.next.map_or(until, |next| next.min(until)));
                false
            }
        }
    }

    /// Time until the first file that waits may be ready.
    fn next_look(&self) -> Option<Duration> {
        self.next
            .map(|next| next.saturating_duration_since(Instant::now()))
    }
}
