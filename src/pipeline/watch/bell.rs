//! A bell that one thread rings and another waits for; however often it was rung, it is answered once.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::pipeline::Interrupt;

/// How often a thread that waits looks whether it is to end.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// The bell.
#[derive(Debug, Default)]
pub(super) struct Bell {
    rung: Mutex<bool>,
    changed: Condvar,
}

impl Bell {
    /// Asks for an answer.
    pub fn ring(&self) {
        *self.lock() = true;
        self.changed.notify_all();
    }

    /// The same in a while, unless the watch is to end before.
    pub fn ring_after(&self, wait: Duration, stop: &Interrupt) {
        let end = Instant::now() + wait;
        while Instant::now() < end && !stop.is_asked() {
            std::thread::sleep(LOOK_EVERY);
        }
        self.ring();
    }

    /// Waits until it is rung, and takes the ring; false where the watch is to end.
    pub fn wait(&self, stop: &Interrupt) -> bool {
        let mut rung = self.lock();
        loop {
            if stop.is_asked() {
                return false;
            }
            if std::mem::take(&mut *rung) {
                return true;
            }
            let waited = self.changed.wait_timeout(rung, LOOK_EVERY);
            rung = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn lock(&self) -> MutexGuard<'_, bool> {
        self.rung.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_count_once_and_waiting_ends_with_the_watch() {
        let (bell, stop) = (Bell::default(), Interrupt::default());
        bell.ring();
        bell.ring();
        assert!(bell.wait(&stop));
        let (later, begun) = (stop.clone(), Instant::now());
        let asking = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(200));
            later.ask();
        });
        assert!(!bell.wait(&stop));
        assert!(begun.elapsed() >= Duration::from_millis(200));
        asking.join().unwrap();
    }
}
