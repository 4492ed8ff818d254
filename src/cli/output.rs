//! Where everything printed goes through: results to stdout, messages and progress to stderr.

use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use jiff::Timestamp;
use jiff::tz::TimeZone;
use serde::Serialize;

use super::colour::{self, Ink};
use super::exit::{self, CliError};
use super::global::Global;
use super::log_file::LogFile;
use super::printable::printable;
use super::told::Told;
use crate::domain::Issue;
use crate::domain::safe_text::json_text;
use crate::pipeline::Observer;
use crate::pipeline::show::tables::write_within;
use crate::show::{Block, Document};

/// How the time of a line is written: RFC 3339 but for a space, with the offset from UTC.
const LOG_TIME: &str = "%Y-%m-%d %H:%M:%S%:z";

/// Prints; also hears the progress of long work.
#[derive(Debug)]
pub struct Output {
    /// Whether results are one JSON document.
    pub json: bool,
    quiet: bool,
    verbose: bool,
    progress: bool,
    /// Whether long work says a line now and then, in place of a bar.
    tells: bool,
    colours_stdout: bool,
    colours_stderr: bool,
    /// Where set, each line begins with the time by this clock.
    clock: OnceLock<TimeZone>,
    /// Where set, each line of results and messages stands in it too.
    log: OnceLock<Mutex<LogFile>>,
    bar: Mutex<Option<ProgressBar>>,
    told: Mutex<Option<Told>>,
    stdout: Mutex<Stdout>,
    /// Whether what was shown falls short of what there is.
    falls_short: AtomicBool,
}

/// What has become of stdout.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stdout {
    /// Everything was taken.
    Open,
    /// The reader has had enough (`| head`): what it asked for it has.
    Closed,
    /// Something was lost, and was said to be.
    Failed,
}

impl Output {
    /// As the global options ask.
    pub(super) fn new(global: &Global) -> Output {
        let wants_progress = !global.no_progress && !global.quiet;
        Output {
            json: global.json,
            quiet: global.quiet,
            verbose: global.verbose,
            progress: wants_progress && io::stderr().is_terminal(),
            tells: wants_progress && !io::stderr().is_terminal(),
            colours_stdout: colour::is_wanted(global.color, io::stdout().is_terminal()),
            colours_stderr: colour::is_wanted(global.color, io::stderr().is_terminal()),
            clock: OnceLock::new(),
            log: OnceLock::new(),
            bar: Mutex::new(None),
            told: Mutex::new(None),
            stdout: Mutex::new(Stdout::Open),
            falls_short: AtomicBool::new(false),
        }
    }

    /// A result for people; nothing where JSON is asked for.
    pub fn result(&self, text: &str) {
        if !self.json {
            let text = printable(text);
            let time = self.logged(&text);
            self.write(format!("{time}{text}\n").as_bytes());
        }
    }

    /// A result that heads those after it: bold where colours are wanted.
    pub fn heading(&self, text: &str) {
        if !self.json {
            let text = printable(text);
            let time = self.logged(&text);
            let text = colour::painted(&text, Ink::Heading, self.colours_stdout);
            self.write(format!("{time}{text}\n").as_bytes());
        }
    }

    /// From now on every line begins with the time by that clock: for what runs for days and is read as a log.
    pub fn time_lines(&self, clock: TimeZone) {
        let _ = self.clock.set(clock);
    }

    /// From now on every line stands in that file too, with its time where lines have one.
    pub fn log_into(&self, file: LogFile) {
        let _ = self.log.set(Mutex::new(file));
    }

    /// Writes a line into the log, where there is one; gives what stands before it there and wherever else it is shown:
    /// one line has one time.
    fn logged(&self, text: &str) -> String {
        let time = self.time_before(text);
        let log = self.log.get().map(Mutex::lock);
        if let Some(Ok(mut log)) = log
            && let Err(error) = log.line(&format!("{time}{text}"))
        {
            to_stderr(&format!("error: the log cannot be written: {error}"));
        }
        time
    }

    /// The time with a space behind it, where lines have one.
    fn time_before(&self, text: &str) -> String {
        let now = || Timestamp::try_from(crate::system::now()).ok();
        match (self.clock.get(), text) {
            (None, _) | (_, "") => String::new(),
            (Some(clock), _) => now().map_or_else(String::new, |now| {
                format!("{} ", now.to_zoned(clock.clone()).strftime(LOG_TIME))
            }),
        }
    }

    /// Writes to stdout; every verb's results pass here. A failure is said once and ends the program with
    /// [`exit::STORAGE`]; a reader that stops reading is none, and nothing more is written for it.
    pub fn write(&self, bytes: &[u8]) {
        let Ok(mut state) = self.stdout.lock() else {
            return;
        };
        if *state != Stdout::Open {
            return;
        }
        let mut stdout = io::stdout().lock();
        let Err(error) = stdout.write_all(bytes).and_then(|()| stdout.flush()) else {
            return;
        };
        *state = match error.kind() {
            ErrorKind::BrokenPipe => Stdout::Closed,
            _ => Stdout::Failed,
        };
        if *state == Stdout::Failed {
            self.error(&format!(
                "stdout: writing failed: {error}. The results are not complete."
            ));
        }
    }

    /// The exit status of a verb that ended with `status`: another where its results were lost, or fall short.
    pub fn ended(&self, status: u8) -> u8 {
        match self.stdout.lock().map(|state| *state) {
            Ok(Stdout::Failed) if status != exit::INTERNAL => exit::STORAGE,
            _ if status == exit::DONE && self.falls_short.load(Ordering::Relaxed) => exit::SOME_REFUSED,
            _ => status,
        }
    }

    /// Whether stdout is a terminal, for which bytes of a picture are no use.
    pub fn is_terminal(&self) -> bool {
        io::stdout().is_terminal()
    }

    /// Characters to a line of the terminal that stdout is; none where it is none.
    pub fn width(&self) -> Option<usize> {
        let (width, _) = terminal_size::terminal_size_of(io::stdout())?;
        Some(usize::from(width.0))
    }

    /// The result for machines: the one document on stdout. Nothing where JSON is not asked for.
    ///
    /// # Errors
    /// The value cannot be written as JSON.
    pub fn document<T: Serialize>(&self, value: &T) -> Result<(), CliError> {
        if self.json {
            let text = serde_json::to_string_pretty(value).map_err(|e| CliError::internal(&e.to_string()))?;
            // A program reads the same text; a terminal is not moved by it.
            self.write(format!("{}\n", json_text(&text)).as_bytes());
        }
        Ok(())
    }

    /// What a verb found: blocks for people, or the value for machines.
    ///
    /// # Errors
    /// The value cannot be written as JSON.
    pub fn show<T: Serialize>(
        &self,
        schema: &'static str,
        value: &T,
        blocks: &[Block],
    ) -> Result<(), CliError> {
        self.blocks("", blocks);
        self.document(&Document { schema, value })
    }

    /// Blocks under a title, each apart from that before it.
    fn blocks(&self, title: &str, blocks: &[Block]) {
        let printed = blocks.iter().filter(|block| !block.is_drawn());
        for (at, block) in printed.enumerate() {
            let is_large = matches!(block, Block::Part(..) | Block::Table(_));
            if is_large && (at > 0 || !title.is_empty()) {
                self.result("");
            }
            match block {
                Block::Say(sentence) => self.result(sentence),
                Block::Facts(facts) => facts
                    .iter()
                    .for_each(|(name, text)| self.result(&format!("  {name:<12} {text}"))),
                Block::Table(table) => {
                    let width = self.width().unwrap_or(usize::MAX);
                    self.result(write_within(table, width).trim_end());
                    self.result("");
                }
                Block::Issues(issues) => issues.iter().for_each(|issue| self.issue(title, issue)),
                Block::Runs(word, runs) => self.result(&format!("{word}: {}", runs.join(", "))),
                Block::Chart(_) => {}
                Block::Part(title, blocks) => {
                    self.heading(title);
                    self.blocks(title, blocks);
                }
            }
        }
    }

    /// Whether no messages are wanted.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// A message, unless `--quiet`.
    pub fn message(&self, text: &str) {
        if !self.quiet {
            self.line(text);
        }
    }

    /// Whether `--verbose` was given.
    pub fn is_verbose(&self) -> bool {
        self.verbose
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

    /// What cannot be read, so that what is shown falls short of it: always said, and seen in the exit status.
    pub fn falls_short(&self, issue: &Issue) {
        self.falls_short.store(true, Ordering::Relaxed);
        self.error(&format!("{}; {}", issue.message, issue.mend));
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
        let time = self.logged(&text);
        let text = format!("{time}{}", colour::first_word(&text, self.colours_stderr));
        let bar = self.bar.lock().ok().and_then(|bar| bar.clone());
        match bar {
            Some(bar) => bar.suspend(|| to_stderr(&text)),
            None => to_stderr(&text),
        }
    }
}

/// A line to stderr. Where that fails there is nobody left to say so to.
pub fn to_stderr(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

impl Observer for Output {
    fn begin(&self, step: &str, total: u64) {
        if self.tells && total > 0 {
            let told = Told::begin(step, total, to_stderr);
            if let Ok(mut slot) = self.told.lock() {
                *slot = Some(told);
            }
        }
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
        if let Ok(Some(told)) = self.told.lock().as_deref() {
            told.advance();
        }
        if let Some(bar) = self.bar.lock().ok().and_then(|bar| bar.clone()) {
            bar.inc(1);
        }
    }

    fn reach(&self, done: u64) {
        if let Ok(Some(told)) = self.told.lock().as_deref() {
            told.reach(done);
        }
        if let Some(bar) = self.bar.lock().ok().and_then(|bar| bar.clone()) {
            bar.set_position(done);
        }
    }

    fn end(&self) {
        drop(self.told.lock().ok().and_then(|mut told| told.take()));
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
