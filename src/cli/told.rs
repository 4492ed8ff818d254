//! Progress where there is no terminal: a line now and then, so that nobody takes long work for a hang.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// When the first line is told; each later one after twice the time.
const FIRST: Duration = Duration::from_secs(10);

/// A step under way.
#[derive(Debug)]
pub struct Told {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    done: AtomicU64,
    over: Mutex<bool>,
    ended: Condvar,
}

impl Told {
    /// Tells of a step of `total` parts through `tell` until it is dropped. Where no thread is to be had nothing is told.
    pub fn begin(step: &str, total: u64, tell: impl Fn(&str) + Send + 'static) -> Told {
        Told::with_first(step, total, FIRST, tell)
    }

    fn with_first(step: &str, total: u64, first: Duration, tell: impl Fn(&str) + Send + 'static) -> Told {
        let shared = Arc::new(Shared::default());
        let (own, step) = (Arc::clone(&shared), step.to_owned());
        let watch = move || {
            let began = Instant::now();
            let mut wait = first;
            while !own.over_within(wait) {
                let done = own.done.load(Ordering::Relaxed);
                tell(&format!(
                    "{step}: {done} of {total} after {} s",
                    began.elapsed().as_secs()
                ));
                wait = began.elapsed();
            }
        };
        let _ = std::thread::Builder::new()
            .name("progress".to_owned())
            .spawn(watch);
        Told { shared }
    }

    /// One more part is done.
    pub fn advance(&self) {
        self.shared.done.fetch_add(1, Ordering::Relaxed);
    }

    /// That many parts are done.
    pub fn reach(&self, done: u64) {
        self.shared.done.store(done, Ordering::Relaxed);
    }
}

impl Drop for Told {
    fn drop(&mut self) {
        *self.shared.over.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.shared.ended.notify_all();
    }
}

impl Shared {
    /// Whether the step is over before that time has gone by.
    fn over_within(&self, wait: Duration) -> bool {
        let over = self.over.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.ended.wait_timeout_while(over, wait, |over| !*over);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn long_work_is_told_of_until_it_is_over() {
        let (told, heard) = channel();
        let step = Told::with_first("fitting", 8, Duration::from_millis(5), move |line| {
            let _ = told.send(line.to_owned());
        });
        step.advance();
        let first = heard.recv_timeout(Duration::from_secs(60)).expect("a line");
        assert!(
            first.starts_with("fitting: ") && first.contains(" of 8 after "),
            "{first}"
        );
        step.reach(7);
        let is_late = |line: &String| line.starts_with("fitting: 7 of 8");
        assert!(heard.iter().take(50).any(|line| is_late(&line)));
        drop(step);
        // The thread has gone once its end of the channel is closed.
        assert!(heard.iter().count() < 50);
    }

    #[test]
    fn short_work_is_not_told_of() {
        let (told, heard) = channel::<String>();
        drop(Told::begin("fitting", 1, move |line| {
            told.send(line.to_owned()).unwrap()
        }));
        assert_eq!(heard.iter().count(), 0);
    }
}
