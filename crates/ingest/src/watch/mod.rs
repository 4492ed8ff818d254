//! Says when to scan the campaign folder again: after events, in turns where there are none, and from time
//! to time in any case. What lies in the folder is for the scan to say.

mod hint;
mod signals;
mod source;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::scan::identity;
use ieap_domain::Issue;
use ieap_system::fs;

use signals::Signals;
use source::{Source, arm, failed, poll_of, polling};

pub use hint::{Hint, Places, hint_of};

/// How a folder is watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WatchOptions {
    /// Scan in turns of this length and use no events; none: events where there are any.
    pub poll: Option<Duration>,
    /// Quiet period of files; a new folder is looked at once more after it.
    pub quiet: Duration,
    /// Longest time between two scans of everything, whatever the events say.
    pub full_scan_every: Duration,
}

impl Default for WatchOptions {
    fn default() -> WatchOptions {
        WatchOptions {
            poll: None,
            quiet: Duration::from_secs(5),
            full_scan_every: Duration::from_secs(3600),
        }
    }
}

/// Turns of polling where events cannot be had and none was asked for.
pub const FALLBACK_POLL: Duration = Duration::from_secs(10);

/// Why waiting ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wake {
    /// Something may have changed, or a turn of polling is over: scan.
    Hint,
    /// Events may have been lost, the folder is back, or a full scan is due: scan.
    Rescan,
    /// The time given is over.
    Timeout,
    /// `stop` was set.
    Stopped,
    /// The runs folder is not there any more: offline. Said once; `Rescan` follows when it is back.
    FolderGone,
}

/// Where hints come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WatchMode {
    /// Events of the operating system.
    Events,
    /// Turns of this length.
    Polling(Duration),
}

/// Why a folder cannot be watched at all.
#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    /// The campaign or its runs folder is not there.
    #[error("{}: cannot be watched: it is not there ({source}); connect the disk or share, or create the folder", path.display())]
    FolderMissing {
        /// The folder.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
}

/// A pause in a burst of events after which the burst is over, and the longest burst that is waited for.
const BURST_PAUSE: Duration = Duration::from_millis(50);
const BURST_END: Duration = Duration::from_millis(500);

/// After a new folder's event its watch begins within milliseconds; what came in between shows then.
const ECHO_AFTER: Duration = Duration::from_millis(250);

/// How often the stop flag, and how often the runs folder itself, is looked at.
const STOP_EVERY: Duration = Duration::from_millis(100);
const CHECK_EVERY: Duration = Duration::from_secs(1);

/// Watches the runs folder of a campaign. Start it before the first scan, so that no change falls between.
pub struct Watcher {
    places: Places,
    options: WatchOptions,
    state: Mutex<State>,
}

struct State {
    source: Source,
    signals: Arc<Signals>,
    /// Device and inode of the watched runs folder; none while it is gone.
    armed: Option<(u64, u64)>,
    /// The same of the optional folders.
    armed_optional: Vec<Option<(u64, u64)>>,
    next_check: Instant,
    next_full: Instant,
    next_poll: Instant,
    /// When to look again after new folders.
    echoes: Vec<Instant>,
    issues: Vec<Issue>,
}

impl Watcher {
    /// Starts to watch `runs_folder` and the `optional` folders (relative to `campaign`) and the campaign's
    /// statements. An optional folder is watched from when it is there.
    ///
    /// The issues say where polling stands in for events, and why.
    ///
    /// # Errors
    /// Where the campaign or its runs folder is not there.
    pub fn start(
        campaign: &Path,
        runs_folder: &str,
        optional: &[&str],
        options: WatchOptions,
    ) -> Result<(Watcher, Vec<Issue>), WatchError> {
        let real = |path: PathBuf| match path.canonicalize() {
            Ok(real) => Ok(real),
            Err(source) => Err(WatchError::FolderMissing { path, source }),
        };
        let root = real(campaign.to_path_buf())?;
        let places = Places {
            runs: real(campaign.join(runs_folder))?,
            optional: optional.iter().map(|folder| root.join(folder)).collect(),
            campaign: root,
        };
        let armed = folder_identity(&places.runs).map_err(|source| WatchError::FolderMissing {
            path: places.runs.clone(),
            source,
        })?;
        let (source, signals, issues) = arm(&places, &options);
        let now = Instant::now();
        let state = State {
            next_poll: now + poll_of(&source),
            source,
            signals,
            armed: Some(armed),
            armed_optional: optional_identities(&places),
            next_check: now + CHECK_EVERY,
            next_full: now + options.full_scan_every,
            echoes: Vec::new(),
            issues: Vec::new(),
        };
        let watcher = Watcher {
            places,
            options,
            state: Mutex::new(state),
        };
        Ok((watcher, issues))
    }

    /// Waits for a reason to scan, at the longest for `timeout`. One thread waits at a time.
    pub fn wait(&self, timeout: Duration, stop: &AtomicBool) -> Wake {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let deadline = Instant::now() + timeout;
        loop {
            if stop.load(Ordering::Relaxed) {
                return Wake::Stopped;
            }
            let now = Instant::now();
            if let Some(wake) = self
                .folder_changed(&mut state, now)
                .or_else(|| self.due(&mut state, now, stop))
            {
                return wake;
            }
            if now >= deadline {
                return Wake::Timeout;
            }
            let end = state.next_moment().min(deadline).min(now + STOP_EVERY);
            state.signals.wait_until(end);
        }
    }

    /// Where hints come from now.
    pub fn mode(&self) -> WatchMode {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match state.source {
            Source::Events { .. } => WatchMode::Events,
            Source::Polling(turn) => WatchMode::Polling(turn),
        }
    }

    /// Takes what is to be said since the start, such as that events ended and polling stands in.
    pub fn take_issues(&self) -> Vec<Issue> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut state.issues)
    }

    /// Whether the runs folder went, came back or was replaced; a new folder is watched anew.
    fn folder_changed(&self, state: &mut State, now: Instant) -> Option<Wake> {
        if now < state.next_check {
            return None;
        }
        state.next_check = now + CHECK_EVERY;
        let optional = optional_identities(&self.places);
        let same_optional = optional == state.armed_optional;
        match (folder_identity(&self.places.runs).ok(), state.armed) {
            (None, None) => None,
            (None, Some(_)) => {
                state.armed = None;
                Some(Wake::FolderGone)
            }
            (Some(there), Some(armed)) if there == armed && same_optional => None,
            (Some(there), _) => {
                let (source, signals, issues) = arm(&self.places, &self.options);
                state.replace_source(source);
                state.signals = signals;
                state.issues.extend(issues);
                state.armed = Some(there);
                state.armed_optional = optional;
                state.full_scan_follows(now, &self.options);
                Some(Wake::Rescan)
            }
        }
    }

    /// The wake that is due by signals or by the clock; none while the runs folder is gone.
    fn due(&self, state: &mut State, now: Instant, stop: &AtomicBool) -> Option<Wake> {
        let asked = state.signals.take();
        state.armed?;
        if asked.failure.is_some() || state.is_deaf() {
            self.poll_instead(state, asked.failure.as_ref(), now);
            return Some(Wake::Rescan);
        }
        let hint = asked.hint.map(|hint| self.rest_of_burst(state, hint, now, stop));
        if hint == Some(Hint::Rescan) || now >= state.next_full {
            self.try_events_again(state);
            state.full_scan_follows(now, &self.options);
            return Some(Wake::Rescan);
        }
        if hint == Some(Hint::LookAgain) {
            state.echoes = vec![now + ECHO_AFTER, now + ECHO_AFTER + self.options.quiet];
        }
        let echo = state.echoes.iter().any(|at| now >= *at);
        state.echoes.retain(|at| now < *at);
        let turn = matches!(state.source, Source::Polling(_)) && now >= state.next_poll;
        if turn {
            state.next_poll = now + poll_of(&state.source);
        }
        (hint.is_some() || echo || turn).then_some(Wake::Hint)
    }

    /// The strongest hint of a burst of events, so that a hundred files make a few scans and not a hundred.
    fn rest_of_burst(&self, state: &State, first: Hint, start: Instant, stop: &AtomicBool) -> Hint {
        let mut strongest = first;
        while start.elapsed() < BURST_END && !stop.load(Ordering::Relaxed) {
            state.signals.wait_until(Instant::now() + BURST_PAUSE);
            let asked = state.signals.take();
            if let Some(failure) = asked.failure {
                state.signals.note(Err(failure));
                break;
            }
            match asked.hint {
                Some(hint) => strongest = strongest.max(hint),
                None => break,
            }
            // Without this a stream of events would be a busy loop.
            std::thread::sleep(BURST_PAUSE / 5);
        }
        strongest
    }

    /// Takes up events again where polling only stands in for them: limits are raised, shares replaced.
    /// A full scan must follow.
    fn try_events_again(&self, state: &mut State) {
        if self.options.poll.is_some() || matches!(state.source, Source::Events { .. }) {
            return;
        }
        // Why events cannot be had was said when polling began.
        let (source, signals, _) = arm(&self.places, &self.options);
        if matches!(source, Source::Events { .. }) {
            state.replace_source(source);
            state.signals = signals;
            let message = "the system gives events again; polling ends";
            state.issues.push(Issue::note("watch-events", message));
        }
    }

    fn poll_instead(&self, state: &mut State, failure: Option<&notify::Error>, now: Instant) {
        let turn = self.options.poll.unwrap_or(FALLBACK_POLL);
        state.issues.push(match failure {
            Some(failure) => failed(failure, turn),
            None => polling("the events ended without a reason", "", turn),
        });
        state.replace_source(Source::Polling(turn));
        state.next_poll = now + turn;
    }
}

impl State {
    /// Whether the thread that hears events has ended: nobody else holds the signals any more.
    fn is_deaf(&self) -> bool {
        matches!(self.source, Source::Events { .. }) && Arc::strong_count(&self.signals) == 1
    }

    fn replace_source(&mut self, source: Source) {
        let deaf = self.is_deaf();
        let before = std::mem::replace(&mut self.source, source);
        // notify's clearing up panics where its thread has ended: then leave it alone.
        if deaf {
            std::mem::forget(before);
        }
    }

    fn full_scan_follows(&mut self, now: Instant, options: &WatchOptions) {
        self.next_full = now + options.full_scan_every;
        self.next_poll = now + poll_of(&self.source);
        self.echoes.clear();
    }

    /// When something is due by the clock; while the folder is gone, only the look whether it is back.
    fn next_moment(&self) -> Instant {
        if self.armed.is_none() {
            return self.next_check;
        }
        let echo = self.echoes.iter().min().copied();
        let moments = [
            Some(self.next_check),
            Some(self.next_full),
            Some(self.next_poll),
            echo,
        ];
        moments.into_iter().flatten().min().unwrap_or(self.next_check)
    }
}

fn optional_identities(places: &Places) -> Vec<Option<(u64, u64)>> {
    let optional = places.optional.iter();
    optional.map(|folder| folder_identity(folder).ok()).collect()
}

/// Device and inode of a folder; zeros where the operating system gives none.
fn folder_identity(folder: &Path) -> io::Result<(u64, u64)> {
    let found = fs::metadata(folder)?;
    if found.is_dir() {
        Ok(identity(&found))
    } else {
        Err(io::ErrorKind::NotADirectory.into())
    }
}

#[cfg(test)]
mod tests;
