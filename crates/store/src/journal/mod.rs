//! The journal of a campaign, `archive/journal.jsonl`: what no file holds, on the disk before the database has it.
//!
//! A change says what of it no file holds ([`Entry`]); the transaction writes that to the journal, waits for the disk, and
//! writes it into the database with the change itself ([`Compared`] says how the two are held against each other). Only who
//! holds the database's write lock writes, so the order is that of the database. A crash while a line is written leaves half
//! a line, which has no line feed: the next one to write cuts it off.

mod agree;
mod bring_up;
mod course;
mod entry;
mod file;
mod line;
mod salvage;
mod tail;
#[cfg(test)]
mod tests;
mod write;

use std::path::Path;

use super::{Store, StoreError};

pub use agree::Agreed;
pub(crate) use course::read as read_line;
pub use course::{Compared, in_words};
pub use entry::{End, Entry, Line, MovedFile, NamedBytes, NamedRun, ToldAlarm};
pub(crate) use file::aside_in;
pub use file::{Found, HeldJournal, found, hold, path_in, read, set_aside};
pub use salvage::{Union, union};
pub use tail::without_torn_end;
pub(super) use write::{Intended, Journal};

impl Store {
    /// From here on, what is said goes to the journal of the campaign in `folder`; where there is none it stays in the database.
    pub fn keep_journal_in(&mut self, folder: Option<&Path>) {
        self.journal.keep_in(folder);
    }

    /// From here on, what is said is said again by whoever hears lines ([`Store::hear`]): nothing is kept of it.
    pub fn keep_journal_heard(&mut self) {
        self.journal.keep_heard();
    }

    /// From here on, what is said is kept, to be said at a time of its own.
    pub fn keep_journal_for_later(&mut self) {
        self.journal.keep_for_later();
    }

    /// What was kept for later; from here on nothing is kept of what is said.
    pub fn kept_for_later(&mut self) -> Vec<(String, Entry)> {
        self.journal.kept_for_later()
    }

    /// Says this in the journal of the campaign in `folder`, which this program holds, and whatever is said after it.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn say_held(
        &mut self,
        now: &str,
        (folder, held): (&Path, &HeldJournal),
        entries: Vec<(String, Entry)>,
    ) -> Result<(), StoreError> {
        self.journal.keep_in_held(folder, held)?;
        self.say(now, entries)
    }
}
