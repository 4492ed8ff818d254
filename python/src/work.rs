//! Long work beside the interpreter: the GIL is released, and Ctrl-C ends it.

use std::sync::Mutex;
use std::sync::mpsc::channel;
use std::time::Duration;

use ieap::pipeline::Interrupt;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::error::fault;

/// How often Python is asked for signals while work goes on.
const ASKED_EVERY: Duration = Duration::from_millis(50);

/// Does `work` on `threads` threads (none: as many as there are cores).
///
/// # Errors
/// `KeyboardInterrupt`, or what another signal handler raises; `EngineFault` where the work panics.
pub fn interruptible<R: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    let interrupt = Interrupt::default();
    let own = interrupt.clone();
    std::thread::scope(|scope| {
        let (done, heard) = channel::<()>();
        let heard = Mutex::new(heard);
        let worker = scope.spawn(move || {
            let result = on_threads(threads, || own.run(work));
            let _ = done.send(());
            result
        });
        // A worker that panics hangs up, which is heard as well.
        while py.detach(|| is_waiting(&heard)) {
            if let Err(raised) = py.check_signals() {
                interrupt.ask();
                let _ = py.detach(|| worker.join());
                return Err(raised);
            }
        }
        match py.detach(|| worker.join()) {
            Ok(Some(result)) => Ok(result),
            Ok(None) => Err(PyKeyboardInterrupt::new_err("the work was given up")),
            Err(_) => Err(fault(py, "the work", "it stopped; the message above says where")),
        }
    })
}

fn is_waiting(heard: &Mutex<std::sync::mpsc::Receiver<()>>) -> bool {
    use std::sync::mpsc::RecvTimeoutError;
    let heard = heard.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    matches!(heard.recv_timeout(ASKED_EVERY), Err(RecvTimeoutError::Timeout))
}

/// The engine takes as many threads as the pool has that it is called from; more than there are cores only cost memory.
fn on_threads<R: Send>(threads: Option<usize>, work: impl FnOnce() -> R + Send) -> R {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = threads.map(|threads| {
        ThreadPoolBuilder::new()
            .num_threads(threads.clamp(1, cores))
            .build()
    });
    match pool {
        Some(Ok(pool)) => pool.install(work),
        _ => work(),
    }
}
