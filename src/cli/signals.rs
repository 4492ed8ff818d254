//! Ctrl-C, a lost terminal, or a request to end: heard at any time, and followed within two seconds. Nothing that was on its
//! way is left on the disk.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::exit::CliError;
use super::output::to_stderr;
use crate::pipeline::Interrupt;
use crate::system::passing;

/// How long the work under way may take to end by itself. Long loops ask many times a second; what does not, the reading
/// of a huge file, a write to a slow disk, is cut off, which the database and the archive bear as they bear a lost power
/// supply. With it the program ends within 2 s of a signal.
const GRACE: Duration = Duration::from_millis(1500);

/// What is added to the number of a signal to give the exit status, as shells count it.
const BY_SIGNAL: u8 = 128;

/// Work that is asked to end before the program does.
struct Work {
    interrupt: Interrupt,
    quiet: bool,
    status: Option<u8>,
    words: &'static str,
}

/// The work under way; a signal ends the program at once where there is none.
static WORK: Mutex<Option<Work>> = Mutex::new(None);
/// The signal that was heard.
static HEARD: AtomicU8 = AtomicU8::new(0);

/// From here on a signal ends the program as it would without this, but for what is on its way to the disk: that goes before.
/// A signal that whoever started the program has it not hear (`nohup`, `&` in a script) is none.
///
/// # Errors
/// The system does not give signals.
pub fn hear() -> Result<(), CliError> {
    system::hear(false, ended_by).map_err(unheard)
}

/// From here on a signal asks what is returned to end, and ends the program with `status` and `words` where that takes too
/// long; without one, with that of the signal. Commands of the outside end with the program.
///
/// # Errors
/// The system does not give signals.
pub fn listen(quiet: bool, status: Option<u8>, words: &'static str) -> Result<Interrupt, CliError> {
    let interrupt = Interrupt::default();
    let work = Work {
        interrupt: interrupt.clone(),
        quiet,
        status,
        words,
    };
    *WORK.lock().unwrap_or_else(PoisonError::into_inner) = Some(work);
    system::hear(true, ended_by).map_err(unheard)?;
    Ok(interrupt)
}

/// The exit status of a program that the signal which was heard ended.
pub fn status() -> u8 {
    BY_SIGNAL + HEARD.load(Ordering::SeqCst)
}

fn unheard(error: std::io::Error) -> CliError {
    CliError::internal(&format!("cannot listen for Ctrl-C: {error}"))
}

/// Ends the program because of a signal.
fn ended_by(signal: u8) {
    HEARD.store(signal, Ordering::SeqCst);
    let work = WORK.lock().unwrap_or_else(PoisonError::into_inner).take();
    let Some(work) = work else {
        passing::end();
        system::as_without_hearing(signal);
        std::process::exit(i32::from(status()));
    };
    work.interrupt.ask();
    std::thread::sleep(GRACE);
    if !work.quiet {
        // The terminal may be gone.
        to_stderr(work.words);
    }
    passing::end();
    std::process::exit(i32::from(work.status.unwrap_or_else(status)));
}

#[cfg(unix)]
mod system {
    use std::io;
    use std::sync::{Mutex, PoisonError};

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::{Handle, Signals};

    const ALL: [i32; 3] = [SIGHUP, SIGINT, SIGTERM];

    /// Tells who hears of further signals; none until somebody does.
    static HEARER: Mutex<Option<Handle>> = Mutex::new(None);

    /// Hears the signals, those that are ignored too where that is asked for; `ends` ends the program by one.
    pub fn hear(ignored_too: bool, ends: fn(u8)) -> io::Result<()> {
        let mut hearer = HEARER.lock().unwrap_or_else(PoisonError::into_inner);
        let handle = match hearer.take() {
            Some(handle) => handle,
            None => begin(ends)?,
        };
        let ignored = if ignored_too { 0 } else { ignored() };
        for signal in ALL.iter().filter(|&&signal| ignored >> (signal - 1) & 1 == 0) {
            handle.add_signal(*signal)?;
        }
        *hearer = Some(handle);
        Ok(())
    }

    fn begin(ends: fn(u8)) -> io::Result<Handle> {
        let mut signals = Signals::new([0_i32; 0])?;
        let handle = signals.handle();
        let named = std::thread::Builder::new().name("signals".to_owned());
        named.spawn(move || {
            for signal in signals.forever() {
                ends(u8::try_from(signal).unwrap_or_default());
            }
        })?;
        Ok(handle)
    }

    /// A bit for each signal that is ignored, as Linux tells it; elsewhere none is known to be.
    fn ignored() -> u64 {
        let told = crate::system::fs::read_text("/proc/self/status").unwrap_or_default();
        let line = told.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let bits = line.map(|bits| u64::from_str_radix(bits.trim(), 16));
        bits.and_then(Result::ok).unwrap_or_default()
    }

    /// Ends the program as a signal does that nobody hears: whoever waits for it learns which it was.
    pub fn as_without_hearing(signal: u8) {
        let _ = signal_hook::low_level::emulate_default_handler(i32::from(signal));
    }
}

#[cfg(not(unix))]
mod system {
    use std::io;
    use std::sync::OnceLock;

    static HEARD: OnceLock<Result<(), String>> = OnceLock::new();

    /// The signal of Ctrl-C.
    const INT: u8 = 2;

    pub fn hear(_ignored_too: bool, ends: fn(u8)) -> io::Result<()> {
        let begin = || ctrlc::set_handler(move || ends(INT)).map_err(|error| error.to_string());
        HEARD.get_or_init(begin).clone().map_err(io::Error::other)
    }

    pub fn as_without_hearing(_signal: u8) {}
}
