//! The computer of a room: it disturbs one call of the system, and writes down all.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use ieap::system::{Call, FaultInjector, Kind, with_fs};
use tempfile::TempDir;

use super::meets::Meets;
use super::room::copied;
use super::verbs::Ended;
use crate::world::computer::{Computer, PowerLost, Weather};
use crate::world::sqlite;

/// What happens in place of a call, or right before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Act {
    /// It is refused once: EIO.
    Fails,
    /// The same of a listing.
    ListFails,
    /// From here on every opening and reading of the path is refused: EMFILE.
    StaysUnreadable,
    /// The disk is full, once: ENOSPC.
    DiskFull,
    /// A wait for the disk is refused, and the power goes when the verb has ended.
    SyncFails,
    /// The program is killed.
    Killed,
    /// The power goes.
    PowerLost,
    /// The clock is set back by a year.
    ClockBack,
    /// Somebody else does something.
    Meets(Meets),
}

/// How long somebody else is waited for who seems to wait for the program.
const PATIENCE: Duration = Duration::from_millis(250);
/// A year.
const BACK_S: i64 = -31_536_000;
/// Seed of what a loss of power leaves.
const SEED: u64 = 20_261_127;

impl Act {
    /// Whether it may happen at such a call.
    fn is_for(self, kind: Kind) -> bool {
        match self {
            Act::Fails => !matches!(kind, Kind::List | Kind::Sync | Kind::SyncAll),
            Act::ListFails => kind == Kind::List,
            Act::StaysUnreadable => matches!(kind, Kind::Open | Kind::Read | Kind::List),
            Act::DiskFull => matches!(
                kind,
                Kind::Create | Kind::Write | Kind::MakeFolder | Kind::Truncate
            ),
            Act::SyncFails => matches!(kind, Kind::Sync | Kind::SyncAll),
            Act::Killed | Act::PowerLost | Act::ClockBack | Act::Meets(_) => true,
        }
    }
}

/// A computer on which one verb is asked for.
pub struct Disturber {
    room: PathBuf,
    computer: Computer,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// Every call, in words with its number among those alike.
    calls: Vec<(Kind, String)>,
    /// How often each came.
    counts: BTreeMap<String, usize>,
    /// The last call was SQLite's, and this one.
    read: Option<String>,
    plan: Option<(Act, String)>,
    spoilt: Option<PathBuf>,
    /// The room as it was when the program was killed.
    left: Option<TempDir>,
    is_dead: bool,
    sync_failed: bool,
    met: Option<JoinHandle<Ended>>,
}

impl Disturber {
    /// One that disturbs that call of `room`, or none.
    pub fn new(room: &Path, plan: Option<(Act, String)>) -> Disturber {
        let computer = Computer::new(room, SEED);
        computer.knows_what_is_there();
        Disturber {
            room: room.to_owned(),
            computer,
            state: Mutex::new(State {
                plan,
                ..State::default()
            }),
        }
    }

    /// All calls that such a disturbance may happen at.
    pub fn places(&self, act: Act) -> Vec<String> {
        let state = self.state();
        let fitting = state.calls.iter().filter(|(kind, _)| act.is_for(*kind));
        fitting.map(|(_, place)| place.clone()).collect()
    }

    /// Whether the program was ended by force.
    pub fn is_dead(&self) -> bool {
        self.state().is_dead || self.computer.is_dead()
    }

    /// After the verb: what is left is on the disk, and whoever else came has ended; gives how, and whether it came to the
    /// disturbance.
    pub fn finish(&self) -> (Option<Ended>, bool) {
        let (left, met, sync_failed, happened) = {
            let mut state = self.state();
            (
                state.left.take(),
                state.met.take(),
                state.sync_failed,
                state.plan.is_none(),
            )
        };
        let met = met.map(|thread| thread.join().unwrap());
        if sync_failed && !self.computer.is_dead() {
            self.computer.loses_power();
        }
        self.computer.restart();
        if let Some(left) = left {
            for entry in std::fs::read_dir(&self.room).unwrap().map(Result::unwrap) {
                std::fs::remove_dir_all(entry.path()).unwrap();
            }
            copied(left.path(), &self.room);
        }
        (met, happened)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn disturbs(&self, act: Act, call: &Call<'_>) -> io::Result<()> {
        match act {
            Act::Fails | Act::ListFails => return Err(io::Error::from_raw_os_error(5)),
            Act::DiskFull => return Err(io::Error::from_raw_os_error(28)),
            Act::StaysUnreadable => {
                self.state().spoilt = Some(call.path.to_owned());
                return Err(io::Error::from_raw_os_error(24));
            }
            Act::SyncFails => {
                self.state().sync_failed = true;
                self.computer.have(Weather {
                    refused: Some((1, 0)),
                    ..Weather::default()
                });
                let refused = self.computer.before(call);
                self.computer.have(Weather::default());
                return refused;
            }
            Act::Killed => {
                let left = tempfile::tempdir_in(self.room.parent().unwrap()).unwrap();
                copied(&self.room, left.path());
                let mut state = self.state();
                (state.left, state.is_dead) = (Some(left), true);
            }
            Act::PowerLost => self.computer.loses_power(),
            Act::ClockBack => self.computer.step_clock(BACK_S),
            Act::Meets(other) => self.meets(other),
        }
        Ok(())
    }

    /// Somebody else comes, and is waited for unless that is the other way round.
    fn meets(&self, other: Meets) {
        let (room, (tell, hear)) = (self.room.clone(), channel());
        let thread = std::thread::spawn(move || {
            let world = Arc::new(Waiting(tell.clone(), Mutex::default()));
            let ended = with_fs(world, || other.does(&room));
            let _ = tell.send(());
            ended
        });
        let _ = hear.recv_timeout(PATIENCE);
        self.state().met = Some(thread);
    }
}

impl FaultInjector for Disturber {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        if self.is_dead() {
            return if std::thread::panicking() {
                Err(io::Error::from_raw_os_error(5))
            } else {
                std::panic::resume_unwind(Box::new(PowerLost))
            };
        }
        let planned = {
            let mut state = self.state();
            let reads = matches!(call.kind, Kind::Open | Kind::Read | Kind::List);
            if reads && state.spoilt.as_deref() == Some(call.path) {
                return Err(io::Error::from_raw_os_error(24));
            }
            state.comes(call, &self.room)
        };
        if let Some(act) = planned.filter(|_| !std::thread::panicking()) {
            self.disturbs(act, call)?;
            if self.is_dead() {
                std::panic::resume_unwind(Box::new(PowerLost));
            }
        }
        self.computer.before(call)
    }

    fn after(&self, call: &Call<'_>) {
        if !self.is_dead() {
            self.computer.after(call);
        }
    }

    fn now(&self) -> SystemTime {
        self.computer.now()
    }
}

impl State {
    /// Writes a call down; gives what is to happen at it. What SQLite reads in a row is one call.
    fn comes(&mut self, call: &Call<'_>, room: &Path) -> Option<Act> {
        let words = in_words(call, room);
        let read = sqlite::is_read(call).then(|| words.clone());
        if std::mem::replace(&mut self.read, read.clone()).is_some_and(|last| Some(last) == read) {
            return None;
        }
        let count = self.counts.entry(words.clone()).or_default();
        *count += 1;
        let place = format!("{words} #{count}");
        self.calls.push((call.kind, place.clone()));
        let is_it = self
            .plan
            .as_ref()
            .is_some_and(|(act, at)| *at == place && act.is_for(call.kind));
        if is_it {
            self.plan.take().map(|(act, _)| act)
        } else {
            None
        }
    }
}

/// A call, without what is new in every trial.
fn in_words(call: &Call<'_>, room: &Path) -> String {
    let inside = |path: &Path| {
        let inside = path
            .strip_prefix(room)
            .unwrap_or(path)
            .to_string_lossy()
            .into_owned();
        let parts: Vec<String> = inside.split('/').map(lasting).collect();
        parts.join("/")
    };
    let to = call.to.map(|to| format!(" to {}", inside(to)));
    format!("{:?} {}{}", call.kind, inside(call.path), to.unwrap_or_default())
}

/// A name without the random part of a passing one, hashes and times.
fn lasting(name: &str) -> String {
    if let Some(end) = name.rfind('-').filter(|_| name.starts_with('.')) {
        return format!("{}*", &name[..=end]);
    }
    let mut lasting = String::new();
    for part in name.split_inclusive(|c: char| !c.is_ascii_hexdigit()) {
        let bare = part.trim_end_matches(|c: char| !c.is_ascii_hexdigit());
        let is_new = bare.len() >= 6 && bare.contains(|c: char| c.is_ascii_digit());
        if is_new {
            lasting.push('*');
            lasting.push_str(&part[bare.len()..]);
        } else {
            lasting.push_str(part);
        }
    }
    lasting
}

/// The computer of somebody else, which tells when they wait for a lock.
struct Waiting(Sender<()>, Mutex<Option<PathBuf>>);

impl FaultInjector for Waiting {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        let mut last = self.1.lock().unwrap_or_else(PoisonError::into_inner);
        let locks = (call.kind == Kind::Lock).then(|| call.path.to_owned());
        if locks.is_some() && *last == locks {
            let _ = self.0.send(());
        }
        *last = locks;
        Ok(())
    }

    fn after(&self, _call: &Call<'_>) {}

    fn now(&self) -> SystemTime {
        SystemTime::now()
    }
}
