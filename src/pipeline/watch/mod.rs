//! The main job for every file that arrives, until stopped.
//!
//! Three threads with a connection and a pool of their own: one takes files in, one fits, raises alarms and renders, one
//! diagnoses. None waits for another; each rings the next one's bell. All writes are whole transactions, of which the
//! database lets one through at a time, and every step starts from what is stored: so the threads need not agree.

mod arrived;
mod bell;
mod intake;
mod refusals;
mod sightings;

use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::run::render;
use super::{
    Context, DiagnoseSummary, IngestSummary, Interrupt, Made, Observer, PipelineError, ReportSummary, Run,
};
use crate::domain::Issue;
use crate::ingest::watch::{Wake, WatchOptions, Watcher};
use crate::pipeline::campaign::context::moment;
use crate::pipeline::upkeep::verify::Weekly;
use arrived::Told;
use bell::Bell;
use refusals::{AFTER_REFUSAL, Refusals};

pub use intake::{Intake, Look};

/// A diagnosis is looked at anew after this long: the report shows what is known by then, and runs that came since count.
const TURN: Duration = Duration::from_secs(15);

/// How to watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WatchSettings {
    /// A file is taken when it has not changed for this long.
    pub quiet: Duration,
    /// Look in turns of this length instead of waiting for events.
    pub poll: Option<Duration>,
}

/// The verb `watch`.
#[derive(Debug, Clone)]
pub struct Watch {
    /// How to watch.
    pub settings: WatchSettings,
    /// The main job.
    pub job: Run,
}

/// Something that the watch did.
#[derive(Debug)]
pub enum Watched<'a> {
    /// Files were taken in.
    Taken(&'a IngestSummary),
    /// A run that came while the watch goes on was fitted: what it gives, in a line.
    Fitted(&'a str),
    /// Runs were fitted, or the report was rendered.
    Made(&'a Made, &'a ReportSummary),
    /// Groups were diagnosed.
    Diagnosed(&'a DiagnoseSummary),
}

/// What the threads share.
struct Shared<'a> {
    job: &'a Run,
    observer: &'a dyn Observer,
    stop: &'a Interrupt,
    hear: &'a (dyn Fn(&Watched) + Sync),
    work: Bell,
    diagnosis: Bell,
    /// Why the watch ended, where it was not told to.
    failure: Mutex<Option<PipelineError>>,
}

impl Watch {
    /// Subscribes, does the main job, then follows until `stop` is asked; `hear` hears of every step that did something,
    /// from several threads. A disk that is full or a share that went offline is waited for.
    ///
    /// # Errors
    /// The folder cannot be watched, campaign.toml is wrong at the start, the database or the archive is gone, replaced or
    /// damaged, or the disk or the database refused for an hour.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
        stop: &Interrupt,
        hear: &(dyn Fn(&Watched) + Sync),
    ) -> Result<(), PipelineError> {
        let options = WatchOptions {
            poll: self.settings.poll,
            quiet: self.settings.quiet,
            ..WatchOptions::default()
        };
        let mut optional = context.campaign.optional_folders().to_vec();
        optional.extend(crate::analysis::climate::sensors::FOLDERS);
        let (watcher, issues) =
            Watcher::start(&context.folder, &context.campaign.runs_folder, &optional, options)?;
        say(&issues, observer);
        let (mut worker, mut diagnoser) = (context.beside()?, context.beside()?);
        let shared = Shared {
            job: &self.job,
            observer,
            stop,
            hear,
            work: Bell::default(),
            diagnosis: Bell::default(),
            failure: Mutex::new(None),
        };
        std::thread::scope(|threads| {
            threads.spawn(|| shared.follow(|| shared.work(&mut worker)));
            if !self.job.skip_diagnosis {
                threads.spawn(|| shared.follow(|| shared.diagnose(&mut diagnoser)));
            }
            shared.follow(|| shared.take_in(context, &watcher, self.settings.quiet));
        });
        let failure = shared
            .failure
            .into_inner()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        failure.map_or(Ok(()), Err)
    }
}

impl Shared<'_> {
    /// Does the work of a thread. When it ends, however it ends, the watch ends.
    fn follow(&self, work: impl FnOnce() -> Result<(), PipelineError> + Send) {
        struct Ends<'a>(&'a Interrupt);
        impl Drop for Ends<'_> {
            fn drop(&mut self) {
                self.0.ask();
            }
        }
        let _ends = Ends(self.stop);
        if let Some(Err(error)) = self.stop.run(work) {
            let mut failure = self
                .failure
                .lock()
                .unwrap_or_else(|poisoned| poisoned.into_inner());
            failure.get_or_insert(error);
        }
    }

    /// Takes in what is ready, and waits for a reason to look again.
    fn take_in(
        &self,
        context: &mut Context,
        watcher: &Watcher,
        quiet: Duration,
    ) -> Result<(), PipelineError> {
        let mut intake = Intake::new(quiet);
        let mut first = true;
        let unmeasured = Unmeasured(self.observer);
        loop {
            self.reload(context);
            let look = intake.look(context, &Instant::now, &unmeasured)?;
            if let Some(summary) = &look.taken {
                if std::mem::take(&mut first) || summary.changed() {
                    (self.hear)(&Watched::Taken(summary));
                }
                self.work.ring();
            }
            if waited(watcher, look.wait, self.stop, self.observer) {
                return Ok(());
            }
        }
    }

    /// Fits, raises alarms and renders whenever something came in or was found.
    fn work(&self, context: &mut Context) -> Result<(), PipelineError> {
        let mut refusals = Refusals::default();
        let mut first = true;
        let mut told = Told::default();
        let weekly = Weekly::of(&context.folder);
        while self.work.wait(self.stop) {
            self.reload(context);
            let made = context.check_in_place().and_then(|()| {
                let mut made = self.job.make(context, self.observer)?;
                for line in told.new_lines(context)? {
                    (self.hear)(&Watched::Fitted(&line));
                }
                let report = render(context, self.observer, None, &mut made.faults)?;
                Ok((made, report))
            });
            match refusals.passed(made, self.observer)? {
                Some((made, report)) => {
                    let new = made.fit.fitted + made.modulus.analysed + made.alarms.new.len();
                    if std::mem::take(&mut first) || new > 0 || report.rendered {
                        (self.hear)(&Watched::Made(&made, &report));
                    }
                    self.diagnosis.ring();
                    let looked = weekly.look(context, moment());
                    self.tell_damage(refusals.passed(looked, self.observer)?.flatten());
                }
                None => self.work.ring_after(AFTER_REFUSAL, self.stop),
            }
        }
        Ok(())
    }

    /// Says what the weekly look found.
    fn tell_damage(&self, found: Option<Vec<Issue>>) {
        match found.as_deref() {
            None => {}
            Some([]) => self
                .observer
                .say("weekly look: database, raw files and journal are there and sound"),
            Some(found) => {
                for issue in found {
                    let warning = format!("weekly look: {} {}. {}", issue.place, issue.message, issue.mend);
                    self.observer.warn(&warning);
                }
                self.observer.warn("`ieap verify` looks at everything");
            }
        }
    }

    /// Diagnoses turn by turn, as long as something is left.
    fn diagnose(&self, context: &mut Context) -> Result<(), PipelineError> {
        let mut refusals = Refusals::default();
        let unmeasured = Unmeasured(self.observer);
        while self.diagnosis.wait(self.stop) {
            self.reload(context);
            let begun = Instant::now();
            let may_go_on = || begun.elapsed() < TURN && !self.stop.is_asked();
            let diagnosis = self.job.diagnosis();
            let found = context.check_in_place().and_then(|()| {
                let before = context.store.changes()?;
                let summary = diagnosis.run_while(context, &unmeasured, &may_go_on, &mut |_| Ok(()))?;
                Ok((summary, context.store.changes()? != before))
            });
            match refusals.passed(found, self.observer)? {
                Some((summary, changed)) => {
                    if summary.diagnosed > 0 {
                        (self.hear)(&Watched::Diagnosed(&summary));
                    }
                    if changed {
                        self.work.ring();
                    }
                    if summary.left > 0 {
                        self.diagnosis.ring();
                    }
                }
                None => self.diagnosis.ring_after(AFTER_REFUSAL, self.stop),
            }
        }
        Ok(())
    }

    fn reload(&self, context: &mut Context) {
        if let Err(error) = context.reload() {
            self.observer.warn(&format!(
                "{error}; what campaign.toml and the profiles said before goes on to hold"
            ));
        }
    }
}

/// Says why polling stands in for events, or that it ends.
fn say(issues: &[Issue], observer: &dyn Observer) {
    for issue in issues {
        observer.warn(format!("{} {}", issue.message, issue.mend).trim_end());
    }
}

/// Waits for a reason to look again; tells whether to stop.
fn waited(watcher: &Watcher, wait: Duration, stop: &Interrupt, observer: &dyn Observer) -> bool {
    loop {
        let woken = watcher.wait(wait, stop.flag());
        say(&watcher.take_issues(), observer);
        match woken {
            Wake::Stopped => return true,
            Wake::FolderGone => {
                observer.warn("the runs folder is not there; nothing is taken for removed. Waiting for it.")
            }
            Wake::Hint | Wake::Rescan | Wake::Timeout => return false,
        }
    }
}

/// Shows no progress: one bar has room for the work of one thread.
struct Unmeasured<'a>(&'a dyn Observer);

impl Observer for Unmeasured<'_> {
    fn begin(&self, _step: &str, _total: u64) {}
    fn advance(&self) {}
    fn reach(&self, _done: u64) {}
    fn end(&self) {}

    fn say(&self, text: &str) {
        self.0.say(text);
    }

    fn warn(&self, text: &str) {
        self.0.warn(text);
    }
}
