//! Long work that can be given up: threads whose long loops ask whether to go on.
//!
//! Searches lie many calls deep, and most of what calls them can do nothing with an interruption but pass it on. So it
//! unwinds, as a fault would, to where the work was begun (`domain::fault::caught` lets it pass); nothing is printed, and no result is half-made.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::ThreadPoolBuilder;

use ieap_domain::fault::Interrupted;

thread_local! {
    /// What may interrupt the work of this thread.
    static OF_THREAD: RefCell<Option<Interrupt>> = const { RefCell::new(None) };
}

/// Says once and for all that work is to be given up. Copies are one and the same.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

/// Stack of each thread, bytes: that of a main thread on Linux, whose work is done here. It takes memory only as it is used.
const STACK_BYTES: usize = 8 << 20;

impl Interrupt {
    /// Asks the work to end.
    pub fn ask(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// Whether it is asked to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }

    /// The flag itself, for what waits on one.
    pub fn flag(&self) -> &AtomicBool {
        &self.0
    }

    /// Does `work` on threads of its own, as many as the caller has, whose long loops ask for this; none where the work
    /// was given up. Where the system gives no threads, it is done on this one.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Option<R> {
        let here = self.clone();
        let pool = ThreadPoolBuilder::new()
            .num_threads(rayon::current_num_threads())
            .stack_size(STACK_BYTES)
            .start_handler(move |_| here.hold())
            .build();
        match pool {
            Ok(pool) => attempt(|| pool.install(work)),
            Err(_) => {
                self.hold();
                attempt(work)
            }
        }
    }

    fn hold(&self) {
        OF_THREAD.with(|held| *held.borrow_mut() = Some(self.clone()));
    }
}

/// Whether the work of this thread is asked to end.
pub fn is_asked() -> bool {
    OF_THREAD.with(|held| held.borrow().as_ref().is_some_and(Interrupt::is_asked))
}

/// Gives the work of this thread up if it is asked to end. Takes some nanoseconds: for the inside of long loops.
pub fn check() {
    if is_asked() {
        resume_unwind(Box::new(Interrupted));
    }
}

/// What `work` gives; none where it was given up. A fault in it goes on.
pub fn attempt<R>(work: impl FnOnce() -> R) -> Option<R> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => Some(done),
        Err(payload) if payload.is::<Interrupted>() => None,
        Err(payload) => resume_unwind(payload),
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use rayon::prelude::*;

    use super::*;
    use ieap_domain::fault::caught;

    #[test]
    fn work_that_never_ends_is_given_up_on_every_thread() {
        let interrupt = Interrupt::default();
        let asker = interrupt.clone();
        let begun = Instant::now();
        let asking = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(50));
            asker.ask();
        });
        // A fault is caught on the way, an interruption is not.
        let forever = |_: &u32| -> u32 {
            assert!(caught(|| -> u32 { panic!("a fault") }).is_err());
            let never = caught(|| -> u32 {
                loop {
                    check();
                    std::thread::sleep(Duration::from_millis(1));
                }
            });
            never.unwrap_or(0)
        };
        let given_up = interrupt.run(|| [1, 2, 3, 4].par_iter().map(forever).sum::<u32>());
        assert_eq!(given_up, None);
        assert!(begun.elapsed() < Duration::from_secs(20));
        asking.join().unwrap();
    }

    #[test]
    fn work_that_nobody_interrupts_gives_what_it_gives() {
        let interrupt = Interrupt::default();
        let sum = interrupt.run(|| {
            check();
            (0..100u32)
                .into_par_iter()
                .map(|x| x + u32::from(is_asked()))
                .sum::<u32>()
        });
        assert_eq!(sum, Some(4950));
        // Outside of it nothing is interrupted.
        interrupt.ask();
        check();
    }

    #[test]
    fn a_fault_is_no_interruption() {
        let passed_on = catch_unwind(|| Interrupt::default().run(|| -> u32 { panic!("a fault") }));
        assert!(passed_on.is_err());
    }
}
