//! Exit status, and errors that end a verb.

use std::fmt;

use crate::pipeline::PipelineError;

/// Done.
pub const DONE: u8 = 0;
/// A fault of the program ended the verb.
pub const INTERNAL: u8 = 1;
/// Wrong usage: an option, an argument, campaign.toml.
pub const USAGE: u8 = 2;
/// Done, but some inputs were refused, or a fault of the program left out a part.
pub const SOME_REFUSED: u8 = 3;
/// The database or the disk refused.
pub const STORAGE: u8 = 4;
/// Done, and an alarm stands (`ieap status --alarms`).
pub const ALARM: u8 = 5;

/// The status of work that was done: whether a fault of the program left out part of it, and whether every input was taken.
pub fn after(has_fault: bool, all_taken: bool) -> u8 {
    if all_taken && !has_fault {
        DONE
    } else {
        SOME_REFUSED
    }
}

/// An error that ends a verb.
#[derive(Debug)]
pub struct CliError {
    status: u8,
    message: String,
    cannot_write: bool,
    is_of_another: bool,
}

impl CliError {
    /// A mistake in what the user gave.
    pub fn usage(message: &str) -> CliError {
        CliError {
            status: USAGE,
            message: message.to_owned(),
            cannot_write: false,
            is_of_another: false,
        }
    }

    /// A refusal of the disk.
    pub fn storage(message: &str) -> CliError {
        CliError {
            status: STORAGE,
            message: message.to_owned(),
            cannot_write: false,
            is_of_another: false,
        }
    }

    /// A fault of the program.
    pub fn internal(message: &str) -> CliError {
        CliError {
            status: INTERNAL,
            message: message.to_owned(),
            cannot_write: false,
            is_of_another: false,
        }
    }

    /// Whether nothing can be written now: another program works on the campaign, or the disk gives no right to.
    pub fn cannot_write(&self) -> bool {
        self.cannot_write
    }

    /// Whether another program works on the campaign.
    pub fn is_of_another(&self) -> bool {
        self.is_of_another
    }

    /// The same with a sentence more.
    pub fn with(mut self, sentence: &str) -> CliError {
        self.message.push_str(sentence);
        self
    }

    /// The exit status it ends with.
    pub fn status(&self) -> u8 {
        self.status
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<PipelineError> for CliError {
    fn from(error: PipelineError) -> CliError {
        let status = match () {
            () if error.is_storage() => STORAGE,
            () if error.is_fault() => INTERNAL,
            () => USAGE,
        };
        CliError {
            status,
            message: error.to_string(),
            cannot_write: error.cannot_write(),
            is_of_another: error.is_second_instance(),
        }
    }
}
