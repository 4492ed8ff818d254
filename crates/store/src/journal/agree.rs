//! Makes the journal and the database of a campaign say the same, as far as that needs no person.

use std::path::Path;

use super::bring_up::{brought_up, parted};
use super::entry::{End, Entry, Line};
use super::file::{HeldJournal, failed, locked, path_in, read};
use super::{Compared, course, tail};
use crate::rows::JOURNAL_LINE;
use crate::{FILE_NAME as DATABASE, Store, StoreError};
use ieap_system::fs::File;

/// What it came to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Agreed {
    /// What the journal lacked and has now.
    pub written: Vec<Line>,
    /// What the database lacks: it is to be said again.
    pub to_say: Vec<Line>,
}

impl Store {
    /// Whether the last line of the database is the last one of the journal of the campaign in `folder`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn is_agreed(&self, folder: &Path) -> Result<bool, StoreError> {
        let path = path_in(folder);
        let same = |file: Option<&mut File>| -> Result<bool, StoreError> {
            let in_file = match file {
                None => tail::Last::default(),
                Some(file) => {
                    let size = file.metadata().map_err(|source| failed(&path, source))?.len();
                    tail::last(file, size).map_err(|source| failed(&path, source))?
                }
            };
            Ok(in_file.end() == self.last_said()?)
        };
        let opened = || match File::open_own(&path) {
            Ok(file) => Ok(Some(file)),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(failed(&path, source)),
        };
        if same(opened()?.as_mut())? {
            return Ok(true);
        }
        // Somebody may be between the two writings, and holds the journal for as long.
        let _held = HeldJournal::wait_to_read(folder)?;
        same(opened()?.as_mut())
    }

    /// Holds the lines of the database against those of the journal of the campaign in `folder`.
    ///
    /// # Errors
    /// See [`StoreError`]; [`StoreError::Parted`] where they are of two courses.
    pub fn compared(&self, folder: &Path) -> Result<Compared, StoreError> {
        let lines = self.course()?;
        let found = read(folder)?.unwrap_or_default();
        Compared::of(&lines, &found).map_err(|detail| parted(folder, detail))
    }

    /// Compares both line by line, and writes into the journal what it lacks.
    ///
    /// # Errors
    /// See [`StoreError`]; [`StoreError::Parted`] where they are of two courses, [`StoreError::Lags`] where the database
    /// lacks what it cannot be told by itself.
    pub fn agree(&mut self) -> Result<Agreed, StoreError> {
        let Some(campaign) = self.journal.campaign().map(Path::to_owned) else {
            return Ok(Agreed::default());
        };
        if !path_in(&campaign).exists() && self.last_said()? == End::default() {
            return Ok(Agreed::default());
        }
        self.begin_batch()?;
        let brought = course::last(&self.connection).and_then(|end| {
            let file = locked(&campaign)?;
            brought_up(&self.connection, &campaign, file, end.n)
        });
        let ended = self.commit_batch();
        let (compared, _file) = brought.map_err(self.named(DOING))?;
        ended?;
        if !compared.can_be_said_again() {
            return Err(StoreError::Lags {
                path: campaign.join(DATABASE),
                lacks: compared.lacks(),
                why: "`ieap rebuild` makes a database of all that either has".to_owned(),
            });
        }
        Ok(Agreed {
            written: compared.of_database,
            to_say: compared.of_journal,
        })
    }

    /// Writes lines of the journal into the database, which has what they say.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hear(&mut self, now: &str, lines: &[Line]) -> Result<(), StoreError> {
        self.write(DOING, now, |transaction| {
            transaction.journal.changed();
            course::store(transaction, lines)
        })
    }

    /// Says what nothing is stored of beside.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn say(&mut self, now: &str, entries: Vec<(String, Entry)>) -> Result<(), StoreError> {
        if entries.is_empty() {
            return Ok(());
        }
        self.write("writing the journal", now, |transaction| {
            let mut each = entries.into_iter();
            each.try_for_each(|(at, entry)| transaction.says(&at, entry))
        })
    }

    /// The lines of the journal that the database has, in order.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn course(&self) -> Result<Vec<Line>, StoreError> {
        let _moment = self.snapshot()?;
        let end = self.last_said()?;
        course::stored(&self.connection, end.n).map_err(self.named(DOING))
    }

    /// Where the lines of the journal end that it has.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn last_said(&self) -> Result<End, StoreError> {
        course::last(&self.connection).map_err(self.named(DOING))
    }

    /// Whether the database has the line of that number and checksum.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn has_line(&self, n: u64, sum: &str) -> Result<bool, StoreError> {
        let rest = ("", "WHERE n = ?1");
        let lines = self.kept(DOING, JOURNAL_LINE, rest, [n.cast_signed()], course::read)?;
        Ok(lines.first().is_some_and(|line| line.sum() == sum))
    }

    /// Whether somebody was ever told that words may be lost, in words that name this.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn was_missed(&self, named: &str) -> Result<bool, StoreError> {
        Ok(self.words()?.ever_missed.iter().any(|lost| lost.contains(named)))
    }

    /// What may be lost, in words, until a person answered.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn words_missed(&self) -> Result<Vec<String>, StoreError> {
        Ok(self.words()?.missed.clone())
    }
}

/// What is being done here, for errors.
const DOING: &str = "holding the database against the journal";
