//! On how many threads the work is done: as many as are asked for, are of use, and can be had.

use crate::domain::words::counted;
use std::sync::mpsc::{Sender, channel};
use std::thread::{Builder, JoinHandle};

use super::exit::CliError;
use super::output::Output;

/// Most threads taken: more than the machines that this is meant for have cores. Work here only waits for the processor, so
/// that further ones bring nothing but their memory.
const MOST_THREADS: usize = 256;

/// Starts the threads that all work is shared among.
///
/// # Errors
/// Wrong usage: no thread is asked for.
pub fn set(asked: Option<usize>, output: &Output) -> Result<(), CliError> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = MOST_THREADS.max(cores);
    let wanted = match asked {
        Some(0) => return Err(CliError::usage("--threads: found 0, needed 1 or more")),
        Some(count) if count > most => {
            output.message(&format!(
                "--threads {count}: more than {most} are of no use here; {most} are taken"
            ));
            most
        }
        Some(count) => count,
        // What rayon itself would take.
        None => std::env::var("RAYON_NUM_THREADS")
            .ok()
            .and_then(|text| text.parse().ok())
            .filter(|&count| count > 0)
            .map_or(cores, |count: usize| count.min(most)),
    };
    let had = to_be_had(wanted);
    if had < wanted {
        output.message(&format!(
            "{wanted} threads were wanted and the system gives {had}; working on {}",
            counted(had.max(1), "thread")
        ));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(had.max(1));
    // Where no thread can be had beside this one, this one does the work.
    let pool = if had == 0 { pool.use_current_thread() } else { pool };
    pool.build_global()
        .map_err(|error| CliError::internal(&format!("no thread can be had: {error}")))
}

/// How many of that many threads the system gives. The pool can be started once only, so that it is tried before; where
/// they run short, half of those there are is left for whatever else the program starts.
fn to_be_had(wanted: usize) -> usize {
    let mut started: Vec<(Sender<()>, JoinHandle<()>)> = Vec::new();
    while started.len() < wanted {
        let (until, ended) = channel();
        // Each waits until its sender is dropped.
        match Builder::new().spawn(move || ended.recv().unwrap_or(())) {
            Ok(thread) => started.push((until, thread)),
            Err(_) => break,
        }
    }
    let count = started.len();
    let (senders, threads): (Vec<_>, Vec<_>) = started.into_iter().unzip();
    drop(senders);
    threads.into_iter().for_each(|thread| drop(thread.join()));
    if count < wanted { count / 2 } else { count }
}
