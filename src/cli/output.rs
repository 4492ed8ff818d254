//! Where everything printed goes through: results to stdout, messages and progress to stderr.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::Global;
use super::exit::CliError;
use super::printable::printable;
use crate::domain::Issue;
use crate::pipeline::Observer;

/// `count` things: `1 file`, `3 files`.
pub fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

/// Prints; also hears the progress of long work.
#[derive(Debug)]
pub struct Output {
    /// Whether results are one JSON document.
    pub json: bool,
    quiet: bool,
    verbose: bool,
    progress: bool,
    bar: Mutex<Option<ProgressBar>>,
}

impl Output {
    /// As the global options ask.
    pub(super) fn new(global: &Global) -> Output {
        Output {
            json: global.json,
            quiet: global.quiet,
            verbose: global.verbose,
            progress: !global.no_progress && !global.quiet && std::io::stderr().is_terminal(),
            bar: Mutex::new(None),
        }
    }

    /// A result for people; nothing where JSON is asked for.
    pub fn result(&self, text: &str) {
        if !self.json {
            let _ = writeln!(std::io::stdout(), "{}", printable(text));
        }
    }

    /// The result for machines: the one document on stdout. Nothing where JSON is not asked for.
    ///
    /// # Errors
    /// The value cannot be written as JSON.
    pub fn document<T: Serialize>(&self, value: &T) -> Result<(), CliError> {
        if self.json {
            let text = serde_json::to_string_pretty(value).map_err(|e| CliError::internal(&e.to_string()))?;
            let _ = writeln!(std::io::stdout(), "{text}");
        }
        Ok(())
    }

    /// A message, unless `--quiet`.
    pub fn message(&self, text: &str) {
        if !self.quiet {
            self.line(text);
        }
    }

    /// A message that only `--verbose` shows.
    pub fn detail(&self, text: &str) {
        if self.verbose {
            self.line(text);
        }
    }

    /// An error; always shown.
    pub fn error(&self, text: &str) {
        self.line(&format!("error: {text}"));
    }

    /// A file or run with an issue: where, what, and how to mend it.
    pub fn issue(&self, path: &str, issue: &Issue) {
        let place = if issue.place.is_empty() {
            String::new()
        } else {
            format!(", {}", issue.place)
        };
        let mend = if issue.mend.is_empty() {
            String::new()
        } else {
            format!("\n    {}", issue.mend)
        };
        self.message(&format!("  {path}{place}: {}{mend}", issue.message));
    }

    fn line(&self, text: &str) {
        let text = printable(text);
        let bar = self.bar.lock().ok().and_then(|bar| bar.clone());
        match bar {
            Some(bar) => bar.suspend(|| drop(writeln!(std::io::stderr(), "{text}"))),
            None => drop(writeln!(std::io::stderr(), "{text}")),
        }
    }
}

impl Observer for Output {
    fn begin(&self, step: &str, total: u64) {
        if !self.progress || total == 0 {
            return;
        }
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{msg:>10} [{bar:30}] {pos}/{len} {eta}") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(step.to_owned());
        if let Ok(mut slot) = self.bar.lock() {
            *slot = Some(bar);
        }
    }

    fn advance(&self) {
        if let Some(bar) = self.bar.lock().ok().and_then(|bar| bar.clone()) {
            bar.inc(1);
        }
    }

    fn reach(&self, done: u64) {
        if let Some(bar) = self.bar.lock().ok().and_then(|bar| bar.clone()) {
            bar.set_position(done);
        }
    }

    fn end(&self) {
        if let Some(bar) = self.bar.lock().ok().and_then(|mut bar| bar.take()) {
            bar.finish_and_clear();
        }
    }

    fn say(&self, text: &str) {
        self.detail(text);
    }

    fn warn(&self, text: &str) {
        self.message(&format!("warning: {text}"));
    }
}
