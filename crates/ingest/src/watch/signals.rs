//! What the events so far ask for, in constant room however many there are.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::hint::Hint;

/// What is asked for since it was last taken.
#[derive(Debug, Default)]
pub(super) struct Asked {
    /// The strongest hint.
    pub hint: Option<Hint>,
    /// Why no further events are to be expected.
    pub failure: Option<notify::Error>,
}

/// Shared by the thread that hears events and the one that waits.
#[derive(Debug, Default)]
pub(super) struct Signals {
    asked: Mutex<Asked>,
    changed: Condvar,
}

impl Signals {
    /// Notes a hint, or a failure of the watch.
    pub fn note(&self, hint: Result<Hint, notify::Error>) {
        let mut asked = self.lock();
        match hint {
            Ok(hint) => asked.hint = asked.hint.max(Some(hint)),
            Err(failure) => asked.failure = Some(failure),
        }
        drop(asked);
        self.changed.notify_all();
    }

    /// Takes what is asked for.
    pub fn take(&self) -> Asked {
        std::mem::take(&mut self.lock())
    }

    /// Waits until something is asked for, at the longest until `end`.
    pub fn wait_until(&self, end: Instant) {
        let mut asked = self.lock();
        while asked.hint.is_none() && asked.failure.is_none() {
            let left = end.saturating_duration_since(Instant::now());
            if left == Duration::ZERO {
                return;
            }
            let waited = self.changed.wait_timeout(asked, left);
            asked = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// A thread that panicked while it noted a hint left nothing half-done.
    fn lock(&self) -> MutexGuard<'_, Asked> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strongest_hint_stays_until_it_is_taken() {
        let signals = Signals::default();
        signals.note(Ok(Hint::Rescan));
        signals.note(Ok(Hint::Look));
        assert_eq!(signals.take().hint, Some(Hint::Rescan));
        assert_eq!(signals.take().hint, None);
    }

    #[test]
    fn waiting_ends_in_time_with_and_without_a_hint() {
        let signals = Signals::default();
        let started = Instant::now();
        signals.wait_until(started + Duration::from_millis(30));
        assert!(started.elapsed() >= Duration::from_millis(30));
        signals.note(Ok(Hint::Look));
        let started = Instant::now();
        signals.wait_until(started + Duration::from_secs(60));
        assert!(started.elapsed() < Duration::from_secs(10));
    }
}
