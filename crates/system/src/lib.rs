//! What the program asks of the operating system: files, folders and the time.
//!
//! [`fs`] has the names of `std::fs` and does what that does. A test puts a [`FaultInjector`] behind it for the thread that works
//! ([`with_fs`]): the world is asked before each call and may refuse it, as a disk does, or end the program there, as a loss
//! of power does. What SQLite does with its own files does not pass here.

pub mod fs;
pub mod passing;
mod regular;
mod temporary;

use std::cell::RefCell;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::SystemTime;

pub use temporary::Temporary;

/// Length and time of the file of the program that runs, which another build of the same version does not share; empty where the
/// system does not tell. Asked of the system itself, for it is no part of a campaign.
pub fn program_mark() -> String {
    let file = std::env::current_exe().and_then(std::fs::metadata);
    let mark = |file: std::fs::Metadata| Some((file.len(), file.modified().ok()?));
    let since = |time: SystemTime| Some(time.duration_since(SystemTime::UNIX_EPOCH).ok()?.as_nanos());
    let text = file
        .ok()
        .and_then(mark)
        .and_then(|(bytes, time)| Some(format!("{bytes} {}", since(time)?)));
    text.unwrap_or_default()
}

/// Stands in for the computer that the program runs on.
pub trait FaultInjector: Send + Sync {
    /// Asked before a call; nothing is done where it refuses.
    ///
    /// # Errors
    /// What the system says instead of doing it.
    fn before(&self, call: &Call<'_>) -> io::Result<()>;

    /// Told of a call that was done.
    fn after(&self, call: &Call<'_>);

    /// What its clock shows.
    fn now(&self) -> SystemTime;
}

/// A call of the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Call<'a> {
    /// What is asked for.
    pub kind: Kind,
    /// The file or folder; of an open file, the path that it was opened by.
    pub path: &'a Path,
    /// The other one, of a renaming, an exchange or a further name.
    pub to: Option<&'a Path>,
}

/// Kinds of calls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Asking what is there: size, times, kind, real path.
    Stat,
    /// Listing a folder.
    List,
    /// Opening a file or folder that is there.
    Open,
    /// Reading from an open file.
    Read,
    /// Opening a file that is made where it is not there, or emptied.
    Create,
    /// Writing to an open file.
    Write,
    /// Changing the length of an open file.
    Truncate,
    /// Waiting until an open file, or the names in an open folder, are on the disk.
    Sync,
    /// Waiting until a whole file system is on the disk.
    SyncAll,
    /// Making a folder, or a folder and those above it.
    MakeFolder,
    /// Giving a file or folder another name, at the cost of what has that name.
    Rename,
    /// The same where nothing may have that name.
    RenameToFree,
    /// Exchanging two names in one step.
    Exchange,
    /// Giving a file another name beside the one that it has.
    Link,
    /// Removing a file.
    Remove,
    /// Removing a folder that is empty.
    RemoveFolder,
    /// Removing a folder with all that is in it.
    RemoveTree,
    /// Changing who may read and write.
    Rights,
    /// Taking the lock on an open file.
    Lock,
}

impl Kind {
    /// Whether such a call changes what is on the disk, or says when it is there.
    pub fn changes(self) -> bool {
        !matches!(
            self,
            Kind::Stat | Kind::List | Kind::Open | Kind::Read | Kind::Lock
        )
    }
}

thread_local! {
    static WORLD: RefCell<Option<Arc<dyn FaultInjector>>> = const { RefCell::new(None) };
}

/// Does `work` in that world, as far as this thread does it.
pub fn with_fs<T>(world: Arc<dyn FaultInjector>, work: impl FnOnce() -> T) -> T {
    struct Back(Option<Arc<dyn FaultInjector>>);
    impl Drop for Back {
        fn drop(&mut self) {
            WORLD.set(self.0.take());
        }
    }
    let _back = Back(WORLD.replace(Some(world)));
    work()
}

/// What the clock shows.
pub fn now() -> SystemTime {
    world().map_or_else(SystemTime::now, |world| world.now())
}

/// The world of this thread; none where that is the real one.
fn world() -> Option<Arc<dyn FaultInjector>> {
    WORLD.try_with(|world| world.borrow().clone()).ok().flatten()
}

/// Does a call where the world does not refuse it.
fn call<T>(kind: Kind, path: &Path, work: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    call_on(Call { kind, path, to: None }, work)
}

/// The same with two names. One that a signal interrupted is done again: it says nothing of the disk.
fn call_on<T>(call: Call<'_>, mut work: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    loop {
        match once(&call, &mut work) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            done => return done,
        }
    }
}

fn once<T>(call: &Call<'_>, work: &mut impl FnMut() -> io::Result<T>) -> io::Result<T> {
    let Some(world) = world() else { return work() };
    world.before(call)?;
    let done = work()?;
    world.after(call);
    Ok(done)
}

/// Asks the world, where there is one, before a call that something else than this crate does, such as SQLite's writing to
/// its files in tests.
///
/// # Errors
/// What the world says.
pub fn asked(kind: Kind, path: &Path) -> io::Result<()> {
    call(kind, path, || Ok(()))
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Refuses one kind of call, and writes all down.
    struct Refuses(Kind, Mutex<Vec<Kind>>);

    impl FaultInjector for Refuses {
        fn before(&self, call: &Call<'_>) -> io::Result<()> {
            if call.kind == self.0 {
                Err(io::Error::from_raw_os_error(5))
            } else {
                Ok(())
            }
        }

        fn after(&self, call: &Call<'_>) {
            self.1.lock().unwrap().push(call.kind);
        }

        fn now(&self) -> SystemTime {
            SystemTime::UNIX_EPOCH
        }
    }

    #[test]
    fn a_world_is_asked_first_and_holds_for_its_thread_and_its_time() {
        let folder = tempfile::tempdir().unwrap();
        let (one, two) = (folder.path().join("one"), folder.path().join("two"));
        let world = Arc::new(Refuses(Kind::Rename, Mutex::default()));
        with_fs(world.clone(), || {
            fs::write(&one, "1").unwrap();
            assert_eq!(fs::rename(&one, &two).unwrap_err().raw_os_error(), Some(5));
            assert_eq!(now(), SystemTime::UNIX_EPOCH);
        });
        assert!(one.exists() && !two.exists());
        fs::rename(&one, &two).unwrap();
        assert_ne!(now(), SystemTime::UNIX_EPOCH);
        assert_eq!(*world.1.lock().unwrap(), [Kind::Create, Kind::Write]);
    }

    /// Interrupts every call of the system twice.
    struct Interrupts(Mutex<Vec<Kind>>);

    impl FaultInjector for Interrupts {
        fn before(&self, call: &Call<'_>) -> io::Result<()> {
            let mut asked = self.0.lock().unwrap();
            asked.push(call.kind);
            let times = asked.iter().rev().take_while(|kind| **kind == call.kind).count();
            match times % 3 {
                0 => Ok(()),
                _ => Err(io::Error::from_raw_os_error(4)),
            }
        }

        fn after(&self, _call: &Call<'_>) {}

        fn now(&self) -> SystemTime {
            SystemTime::now()
        }
    }

    #[test]
    fn a_call_that_was_interrupted_is_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let (one, two) = (folder.path().join("one"), folder.path().join("two"));
        let world = Arc::new(Interrupts(Mutex::default()));
        with_fs(world.clone(), || {
            let mut made = Temporary::new_in(folder.path(), ".part-", "", 0o644).unwrap();
            std::io::Write::write_all(&mut made, b"kept").unwrap();
            made.sync_all().unwrap();
            made.persist(&one).unwrap();
            fs::rename(&one, &two).unwrap();
            assert_eq!(fs::read_own(&two).unwrap(), b"kept");
            fs::sync_names(folder.path()).unwrap();
        });
        let asked = world.0.lock().unwrap();
        assert_eq!(asked.len() % 3, 0, "{asked:?}");
    }

    #[test]
    fn a_temporary_goes_unless_it_is_given_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let make = || Temporary::new_in(folder.path(), ".part-", "", 0o444).unwrap();
        let gone = make().path().to_owned();
        assert!(!gone.exists());
        make().persist(&path).unwrap();
        assert!(path.exists());
        assert!(make().persist_to_free(&path).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
