//! Ctrl-C, a lost terminal, or a request to end: heard at any time, and followed within two seconds.

use std::time::Duration;

use super::exit::CliError;
use super::output::to_stderr;
use crate::pipeline::Interrupt;

/// How long the work under way may take to end by itself. Long loops ask many times a second; what does not, the reading
/// of a huge file, a write to a slow disk, is cut off, which the database and the archive bear as they bear a lost power
/// supply. With it the program ends within 2 s of a signal.
const GRACE: Duration = Duration::from_millis(1500);

/// From here on a signal asks what is returned to end, and ends the program with `status` and `words` where that takes too
/// long. Commands of the outside end with the program.
///
/// # Errors
/// The system does not give signals.
pub fn listen(quiet: bool, status: u8, words: &'static str) -> Result<Interrupt, CliError> {
    let interrupt = Interrupt::default();
    let heard = interrupt.clone();
    ctrlc::set_handler(move || {
        heard.ask();
        std::thread::sleep(GRACE);
        if !quiet {
            // The terminal may be gone.
            to_stderr(words);
        }
        std::process::exit(i32::from(status));
    })
    .map_err(|error| CliError::internal(&format!("cannot listen for Ctrl-C: {error}")))?;
    Ok(interrupt)
}
