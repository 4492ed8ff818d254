//! SQLite's own files in a world: a file system of SQLite that asks the world before each of its openings, readings, writes,
//! cuts and waits.
//!
//! It is the system's own, but for these calls on databases and their write-ahead logs; what the world refuses, SQLite
//! is told as an error of the disk. It is the only unsafe code beside the Python package: SQLite has no other door to this.
#![allow(unsafe_code)]

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, OnceLock, PoisonError};

use ieap::system::{Call, Kind, asked};
use rusqlite::ffi;

/// The calls of the system's own file system, and these with the asking before.
struct Table {
    own: ffi::sqlite3_io_methods,
    asking: ffi::sqlite3_io_methods,
}

/// A pointer that SQLite gave for the whole life of the program.
struct Lasting<T>(*mut T);

// SAFETY: SQLite calls its file systems from any thread, and what they point to is never changed here.
unsafe impl<T> Send for Lasting<T> {}
// SAFETY: as above.
unsafe impl<T> Sync for Lasting<T> {}

static SYSTEM: OnceLock<Lasting<ffi::sqlite3_vfs>> = OnceLock::new();
static TABLE: OnceLock<(Lasting<ffi::sqlite3_io_methods>, Table)> = OnceLock::new();
/// Names of open files, by where SQLite has them.
static NAMES: Mutex<BTreeMap<usize, PathBuf>> = Mutex::new(BTreeMap::new());

/// From here on SQLite's writing in this program goes through the worlds.
pub fn through_worlds() {
    static ONCE: Once = Once::new();
    // SAFETY: the system's file system is there since SQLite was begun, the copy lasts as long as the program, and it is
    // changed before SQLite knows it.
    ONCE.call_once(|| unsafe {
        assert_eq!(ffi::sqlite3_initialize(), ffi::SQLITE_OK);
        let system = ffi::sqlite3_vfs_find(std::ptr::null());
        let mut own = *system;
        own.zName = c"worlds".as_ptr();
        own.pNext = std::ptr::null_mut();
        own.xOpen = Some(open);
        let _ = SYSTEM.set(Lasting(system));
        assert_eq!(
            ffi::sqlite3_vfs_register(Box::leak(Box::new(own)), 1),
            ffi::SQLITE_OK
        );
    });
}

unsafe extern "C" fn open(
    _own: *mut ffi::sqlite3_vfs,
    name: *const c_char,
    file: *mut ffi::sqlite3_file,
    flags: c_int,
    got: *mut c_int,
) -> c_int {
    let system = SYSTEM.get().unwrap().0;
    let is_ours = flags & (ffi::SQLITE_OPEN_MAIN_DB | ffi::SQLITE_OPEN_WAL) != 0;
    if is_ours && !name.is_null() {
        // SAFETY: a name that SQLite gives ends with a zero.
        let path = unsafe { CStr::from_ptr(name) }.to_string_lossy().into_owned();
        if let Some(refused) = refused_of(&PathBuf::from(path), Kind::Open, ffi::SQLITE_CANTOPEN) {
            // SAFETY: SQLite's own argument; a file without methods is not closed.
            unsafe { (*file).pMethods = std::ptr::null() };
            return refused;
        }
    }
    // SAFETY: these are SQLite's own arguments, for the file system that they are made for.
    let opened = unsafe { (*system).xOpen.unwrap()(system, name, file, flags, got) };
    if opened != ffi::SQLITE_OK || name.is_null() || !is_ours {
        return opened;
    }
    // SAFETY: the file is open, so it has methods and its name ends with a zero.
    unsafe {
        let (methods, name) = ((*file).pMethods, CStr::from_ptr(name));
        let (known, table) = TABLE.get_or_init(|| (Lasting(methods.cast_mut()), Table::asking(*methods)));
        if known.0.cast_const() == methods {
            let name = PathBuf::from(name.to_string_lossy().into_owned());
            names(|names| names.insert(file.addr(), name));
            (*file).pMethods = &raw const table.asking;
        }
    }
    opened
}

impl Table {
    fn asking(own: ffi::sqlite3_io_methods) -> Table {
        let mut asking = own;
        asking.xRead = Some(read);
        asking.xWrite = Some(write);
        asking.xTruncate = Some(cut);
        asking.xSync = Some(wait);
        asking.xClose = Some(close);
        Table { own, asking }
    }
}

fn own() -> &'static ffi::sqlite3_io_methods {
    &TABLE.get().unwrap().1.own
}

fn names<T>(work: impl FnOnce(&mut BTreeMap<usize, PathBuf>) -> T) -> T {
    work(&mut NAMES.lock().unwrap_or_else(PoisonError::into_inner))
}

/// What SQLite is told of a call: that of the world's error, or none. A loss of power must not unwind through SQLite; whoever
/// asked it hears of it at the next call.
fn refused(file: *mut ffi::sqlite3_file, kind: Kind, otherwise: c_int) -> Option<c_int> {
    let path = names(|names| names.get(&file.addr()).cloned())?;
    refused_of(&path, kind, otherwise)
}

fn refused_of(path: &Path, kind: Kind, otherwise: c_int) -> Option<c_int> {
    ASKS.set(true);
    let answer = std::panic::catch_unwind(|| asked(kind, path));
    ASKS.set(false);
    match answer {
        Ok(Ok(())) => None,
        Ok(Err(error)) if error.kind() == std::io::ErrorKind::StorageFull => Some(ffi::SQLITE_FULL),
        _ => Some(otherwise),
    }
}

thread_local! {
    static ASKS: Cell<bool> = const { Cell::new(false) };
}

/// Whether it is SQLite that opens or reads one of its files here.
pub fn is_read(call: &Call<'_>) -> bool {
    ASKS.get() && matches!(call.kind, Kind::Open | Kind::Read)
}

unsafe extern "C" fn read(
    file: *mut ffi::sqlite3_file,
    into: *mut c_void,
    count: c_int,
    at: ffi::sqlite3_int64,
) -> c_int {
    // SAFETY: SQLite's own arguments, for the call that they are made for.
    refused(file, Kind::Read, ffi::SQLITE_IOERR_READ)
        .unwrap_or_else(|| unsafe { own().xRead.unwrap()(file, into, count, at) })
}

unsafe extern "C" fn write(
    file: *mut ffi::sqlite3_file,
    bytes: *const c_void,
    count: c_int,
    at: ffi::sqlite3_int64,
) -> c_int {
    // SAFETY: SQLite's own arguments, for the call that they are made for.
    refused(file, Kind::Write, ffi::SQLITE_IOERR_WRITE)
        .unwrap_or_else(|| unsafe { own().xWrite.unwrap()(file, bytes, count, at) })
}

unsafe extern "C" fn cut(file: *mut ffi::sqlite3_file, size: ffi::sqlite3_int64) -> c_int {
    // SAFETY: as in `write`.
    refused(file, Kind::Truncate, ffi::SQLITE_IOERR_TRUNCATE)
        .unwrap_or_else(|| unsafe { own().xTruncate.unwrap()(file, size) })
}

unsafe extern "C" fn wait(file: *mut ffi::sqlite3_file, flags: c_int) -> c_int {
    // SAFETY: as in `write`.
    refused(file, Kind::Sync, ffi::SQLITE_IOERR_FSYNC)
        .unwrap_or_else(|| unsafe { own().xSync.unwrap()(file, flags) })
}

unsafe extern "C" fn close(file: *mut ffi::sqlite3_file) -> c_int {
    names(|names| names.remove(&file.addr()));
    // SAFETY: as in `write`.
    unsafe { own().xClose.unwrap()(file) }
}
