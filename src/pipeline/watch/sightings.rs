//! Which files may be read now: those that have been quiet, and those that the system could not give after a delay that
//! grows with each try.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::domain::Issue;
use crate::ingest::scan::{Readiness, SeenFile, Sighting, readiness};

/// Delay after the first failed try: a full table of open files, or a lock of another program, is often gone by then.
const FIRST_DELAY: Duration = Duration::from_secs(1);
/// Longest delay: a disk or share that is there again is noticed within a coffee break, and one that is not costs
/// twelve tries an hour.
const LONGEST_DELAY: Duration = Duration::from_secs(300);

/// What is known of files that were not read yet.
pub(super) struct Sightings {
    quiet: Duration,
    /// Since when each file has not changed.
    seen: BTreeMap<String, Sighting>,
    /// Files that the system could not give.
    failed: BTreeMap<String, Retry>,
    next: Option<Instant>,
}

/// A file that the system could not give.
#[derive(Clone, Copy)]
struct Retry {
    delay: Duration,
    at: Instant,
}

impl Sightings {
    pub fn new(quiet: Duration) -> Sightings {
        Sightings {
            quiet,
            seen: BTreeMap::new(),
            failed: BTreeMap::new(),
            next: None,
        }
    }

    /// Begins a look at all files.
    pub fn begin(&mut self) {
        self.next = None;
    }

    /// Whether a file may be read at `now`.
    pub fn is_ready(&mut self, file: &SeenFile, now: Instant) -> bool {
        let retry = self.failed.get(&file.display).map(|retry| retry.at);
        if let Some(at) = retry.filter(|at| *at > now) {
            self.look_at(at);
            return false;
        }
        let sighting = match self.seen.remove(&file.display) {
            Some(earlier) => earlier.next(file, now),
            None => Sighting::first(file, now),
        };
        match readiness(&sighting, now, self.quiet) {
            Readiness::Ready => true,
            Readiness::Wait { until } => {
                self.seen.insert(file.display.clone(), sighting);
                self.look_at(until);
                false
            }
        }
    }

    /// Takes note, at `now`, of all files that the system could not give; those tried in this look are tried again after
    /// twice the delay.
    pub fn note_unread(&mut self, unread: &[(String, Issue)], now: Instant) {
        let before = std::mem::take(&mut self.failed);
        for (path, _) in unread {
            let retry = match before.get(path) {
                Some(waiting) if waiting.at > now => *waiting,
                tried => {
                    let delay = tried.map_or(FIRST_DELAY, |tried| (2 * tried.delay).min(LONGEST_DELAY));
                    Retry {
                        delay,
                        at: now + delay,
                    }
                }
            };
            self.look_at(retry.at);
            self.failed.insert(path.clone(), retry);
        }
    }

    /// Time from `now` until the first file that waits may be ready.
    pub fn next_look(&self, now: Instant) -> Option<Duration> {
        self.next.map(|next| next.saturating_duration_since(now))
    }

    fn look_at(&mut self, at: Instant) {
        self.next = Some(self.next.map_or(at, |next| next.min(at)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> SeenFile {
        SeenFile {
            relative: "runs/a.csv".into(),
            display: "runs/a.csv".to_owned(),
            size_bytes: 1,
            modified_ns: 1,
            inode: 1,
            changed_ns: 1,
            age: Some(Duration::from_secs(3600)),
            link_target: None,
        }
    }

    #[test]
    fn what_the_system_cannot_give_is_tried_again_after_a_delay_that_grows_to_a_bound() {
        let mut sightings = Sightings::new(Duration::ZERO);
        let unread = [("runs/a.csv".to_owned(), Issue::error("not-read-now", "EIO"))];
        let start = Instant::now();
        let mut tries = Vec::new();
        for second in 0..3600u64 {
            let now = start + Duration::from_secs(second);
            sightings.begin();
            if sightings.is_ready(&file(), now) {
                tries.push(second);
            }
            // It stays unread whether it was tried in this look or not.
            sightings.note_unread(&unread, now);
        }
        let waits: Vec<u64> = tries.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!(waits[..10], [1, 2, 4, 8, 16, 32, 64, 128, 256, 300], "{waits:?}");
        assert!(waits[10..].iter().all(|wait| *wait == 300), "{waits:?}");
    }

    #[test]
    fn a_file_that_was_read_begins_anew() {
        let mut sightings = Sightings::new(Duration::ZERO);
        let unread = [("runs/a.csv".to_owned(), Issue::error("not-read-now", "EIO"))];
        let now = Instant::now();
        sightings.note_unread(&unread, now);
        assert!(!sightings.is_ready(&file(), now));
        sightings.note_unread(&[], now + FIRST_DELAY);
        assert!(sightings.is_ready(&file(), now + FIRST_DELAY));
        sightings.note_unread(&unread, now + FIRST_DELAY);
        assert!(sightings.is_ready(&file(), now + 2 * FIRST_DELAY));
    }
}
