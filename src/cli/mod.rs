//! The command line: one file per verb.

use std::process::ExitCode;

/// Parses the command line, runs the verb and gives its exit status.
pub fn main() -> ExitCode {
    ExitCode::SUCCESS
}
