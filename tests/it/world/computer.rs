//! The computer of a world: it refuses calls, loses its power in any of them, and shows a time of its own.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use ieap::system::{Call, FaultInjector, Kind};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::disk::{Disk, Image};
use super::sqlite;

/// What ends a program whose computer has no power.
#[derive(Debug)]
pub struct PowerLost;

/// Files of the database, which SQLite writes and waits for by itself: they are there as they were written.
const OF_SQLITE: [&str; 2] = ["campaign.db", "campaign.db-wal"];

/// What goes wrong in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Weather {
    /// Part of all calls that the system refuses.
    pub refusals: f64,
    /// The call that is refused, from 1, and with which of the errors that such a call may have.
    pub refused: Option<(u64, usize)>,
    /// The call before which the power goes, from 1.
    pub power_lost_at: Option<u64>,
    /// Part of the readings of a measured file during which somebody writes to it.
    pub meddling: f64,
}

/// A computer with one campaign.
pub struct Computer {
    root: PathBuf,
    state: Mutex<State>,
}

/// What a disk holds, and what is left of the files that SQLite writes by itself.
type Left = (Image, BTreeMap<&'static str, Option<Vec<u8>>>);

struct State {
    rng: ChaCha8Rng,
    disk: Disk,
    clock: SystemTime,
    weather: Weather,
    calls: u64,
    refused: u64,
    /// What is left, once the power went.
    left: Option<Left>,
    /// The reports that were ever put in place, by the hash of all that is in them.
    reports: Vec<String>,
}

impl Computer {
    /// With the campaign in `root`, all of which is safe.
    pub fn new(root: &Path, seed: u64) -> Computer {
        Computer {
            root: root.to_owned(),
            state: Mutex::new(State {
                rng: ChaCha8Rng::seed_from_u64(seed),
                disk: Disk::new(root),
                clock: SystemTime::now(),
                weather: Weather::default(),
                calls: 0,
                refused: 0,
                left: None,
                reports: Vec::new(),
            }),
        }
    }

    /// From here on this goes wrong; calls are counted anew.
    pub fn have(&self, weather: Weather) {
        let mut state = self.state();
        (state.weather, state.calls, state.refused) = (weather, 0, 0);
    }

    /// What lies in its folder now is safe, but for the files of databases: from here on a part of it that is changed and not
    /// waited for may be lost.
    pub fn knows_what_is_there(&self) {
        self.state().disk.know_all(&OF_SQLITE);
    }

    /// The power goes now.
    pub fn loses_power(&self) {
        self.state().lose_power(&self.root);
    }

    /// From here on all that is on the disk is safe: somebody else changed it.
    pub fn settle(&self) {
        self.state().disk.settle();
    }

    /// Sets the clock.
    pub fn set_clock(&self, time: SystemTime) {
        self.state().clock = time;
    }

    /// Sets the clock forward, or back.
    pub fn step_clock(&self, seconds: i64) {
        let mut state = self.state();
        let by = Duration::from_secs(seconds.unsigned_abs());
        state.clock = if seconds < 0 {
            state.clock - by
        } else {
            state.clock + by
        };
    }

    /// Calls since the weather changed, and how many of them were refused.
    pub fn calls(&self) -> (u64, u64) {
        let state = self.state();
        (state.calls, state.refused)
    }

    /// Whether it has no power.
    pub fn is_dead(&self) -> bool {
        self.state().left.is_some()
    }

    /// Gives it power again: on the disk is what is left.
    pub fn restart(&self) {
        let mut state = self.state();
        let Some((image, database)) = state.left.take() else {
            return;
        };
        for (name, bytes) in database {
            let path = self.root.join(name);
            let _ = fs::remove_file(&path);
            if let Some(bytes) = bytes {
                fs::write(path, bytes).unwrap();
            }
        }
        let _ = fs::remove_file(self.root.join("campaign.db-shm"));
        state.disk.put(&image);
    }

    /// Whether this is a report that was put in place at some time.
    pub fn was_made(&self, report: &str) -> bool {
        self.state().reports.iter().any(|made| made == report)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl FaultInjector for Computer {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        // These worlds leave to SQLite what it reads.
        if sqlite::is_read(call) {
            return Ok(());
        }
        let mut state = self.state();
        if state.left.is_none() && !std::thread::panicking() {
            state.calls += 1;
            if state.weather.power_lost_at == Some(state.calls) {
                state.lose_power(&self.root);
            }
        }
        if state.left.is_some() {
            drop(state);
            return if std::thread::panicking() {
                Err(error(5))
            } else {
                std::panic::resume_unwind(Box::new(PowerLost))
            };
        }
        if let Some(errno) = state.refuses(call) {
            state.refused += 1;
            if matches!(call.kind, Kind::Sync | Kind::SyncAll) {
                state.disk.not_synced(call);
            }
            return Err(error(errno));
        }
        state.meddle(call);
        state.disk.before(call);
        Ok(())
    }

    fn after(&self, call: &Call<'_>) {
        let mut state = self.state();
        if state.left.is_some() {
            return;
        }
        state.disk.after(call);
        let report = self.root.join("report");
        let to = call.to.is_some_and(|to| to == report);
        if to && matches!(call.kind, Kind::Rename | Kind::Exchange) {
            state.reports.extend(hash_of_report(&self.root));
        }
    }

    fn now(&self) -> SystemTime {
        self.state().clock
    }
}

impl State {
    fn lose_power(&mut self, root: &Path) {
        let database = OF_SQLITE.map(|name| (name, fs::read(root.join(name)).ok()));
        let image = self.disk.image(&mut self.rng);
        self.left = Some((image, database.into()));
    }

    fn refuses(&mut self, call: &Call<'_>) -> Option<i32> {
        let errors = errors_of(call.kind);
        if let Some((_, which)) = self.weather.refused.filter(|(nth, _)| *nth == self.calls) {
            return errors.get(which).copied();
        }
        let refuses = self.weather.refusals > 0.0 && self.rng.random_bool(self.weather.refusals);
        refuses.then(|| errors[self.rng.random_range(0..errors.len())])
    }

    /// Somebody writes to a measured file while it is read.
    fn meddle(&mut self, call: &Call<'_>) {
        let is_measured = call.path.extension().is_some_and(|end| end == "csv")
            && call.path.components().any(|part| part.as_os_str() == "runs");
        let reads = matches!(call.kind, Kind::Open | Kind::Read | Kind::Stat);
        if !is_measured || !reads || self.weather.meddling == 0.0 {
            return;
        }
        if self.rng.random_bool(self.weather.meddling) {
            let text = fs::read(call.path).unwrap_or_default();
            // Comments of different lengths: no clock is fine enough to tell two changes of one moment.
            let comment = format!("#{}\n", "m".repeat(self.rng.random_range(1..9)));
            let _ = fs::write(call.path, [text, comment.into_bytes()].concat());
        }
    }
}

/// What a system says that refuses such a call: numbers of Linux.
fn errors_of(kind: Kind) -> &'static [i32] {
    const EIO: i32 = 5;
    match kind {
        // EIO, ENOMEM, EACCES, ENFILE, EMFILE, ESTALE.
        Kind::Stat | Kind::List | Kind::Open | Kind::Read => &[EIO, 12, 13, 23, 24, 116],
        // EIO, ENOSPC, EROFS, EDQUOT.
        Kind::Create | Kind::Write | Kind::Truncate | Kind::MakeFolder => &[EIO, 28, 30, 122],
        Kind::Sync | Kind::SyncAll => &[EIO, 28],
        // ENOLCK.
        Kind::Lock => &[37],
        _ => &[EIO, 13, 28],
    }
}

fn error(errno: i32) -> io::Error {
    io::Error::from_raw_os_error(errno)
}

/// Hash of the names and bytes of a campaign's report; none where there is none.
pub fn hash_of_report(root: &Path) -> Option<String> {
    let report = root.join("report");
    let mut waiting = vec![report.clone()];
    let mut files = BTreeMap::new();
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(folder).ok()?.flatten() {
            let path = entry.path();
            match path.is_dir() {
                true => waiting.push(path),
                // The mark of a folder on its way.
                false if entry.file_name() == ".passing" => {}
                false => drop(files.insert(path.clone(), fs::read(path).ok()?)),
            }
        }
    }
    let mut hasher = blake3::Hasher::new();
    for (path, bytes) in files {
        hasher.update(path.strip_prefix(&report).ok()?.as_os_str().as_encoded_bytes());
        hasher.update(blake3::hash(&bytes).as_bytes());
    }
    Some(hasher.finalize().to_hex().to_string())
}
