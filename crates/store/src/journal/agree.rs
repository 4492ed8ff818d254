//! Makes the journal and the database of a campaign say the same, as far as that needs no person.

use std::path::Path;
use std::time::{Duration, Instant};

use super::bring_up::{brought_up, parted};
use super::entry::{End, Entry, Line};
use super::file::{Found, HeldJournal, failed, locked, path_in, read};
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
    /// Whether the last line of the database is the last one of the journal of the campaign in `folder`: where not, somebody
    /// may be between the two writings.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn is_level(&self, folder: &Path) -> Result<bool, StoreError> {
        let path = path_in(folder);
        let in_file = match File::open_own(&path) {
            Ok(mut file) => {
                let size = file.metadata().map_err(|source| failed(&path, source))?.len();
                tail::last(&mut file, size).map_err(|source| failed(&path, source))?
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => tail::Last::default(),
            Err(source) => return Err(failed(&path, source)),
        };
        Ok(in_file.end() == self.last_said()?)
    }

    /// The same for who is to write: waits until nobody is between the two writings, who holds the journal for as long.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn is_agreed(&self, folder: &Path) -> Result<bool, StoreError> {
        if self.is_level(folder)? {
            return Ok(true);
        }
        let _held = HeldJournal::wait_to_read(folder)?;
        self.is_level(folder)
    }

    /// Holds the lines of the database against those of the journal of the campaign in `folder`, without a lock and while
    /// others write; gives the lines of the journal, too.
    ///
    /// The database is read first: whatever it says, the journal said before. A line of the journal that it lacks may be one
    /// of which the transaction commits just now, so that it is looked for again for as long as that may take.
    ///
    /// # Errors
    /// See [`StoreError`]; [`StoreError::Parted`] where they are of two courses.
    pub fn compared(&self, folder: &Path) -> Result<(Option<Found>, Compared), StoreError> {
        let begun = Instant::now();
        let look = || -> Result<_, StoreError> {
            let (lines, found) = (self.course()?, read(folder)?);
            let compared = Compared::of(&lines, found.as_ref().unwrap_or(&NOTHING));
            Ok((found, compared.map_err(|detail| parted(folder, detail))))
        };
        let (mut found, mut compared) = look()?;
        let is_whole = |found: &Option<Found>| found.as_ref().is_none_or(Found::is_whole);
        // What was read in pieces while a line was taken back and another took its place is neither.
        if compared.is_err() || !is_whole(&found) {
            std::thread::sleep(GLANCE);
            (found, compared) = look()?;
        }
        let mut compared = compared?;
        while !compared.of_journal.is_empty() && begun.elapsed() < COMMIT {
            std::thread::sleep(GLANCE);
            let stands = read(folder)?.unwrap_or_default().lines;
            let mut waits = Vec::new();
            for line in std::mem::take(&mut compared.of_journal) {
                if stands.contains(&line) && !self.has_line(line.n, line.sum())? {
                    waits.push(line);
                }
            }
            compared.of_journal = waits;
        }
        Ok((found, compared))
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

/// Longest time from a line in the journal to the end of its transaction, which has nothing left but to commit. Chosen: many
/// times what a slow disk takes.
const COMMIT: Duration = Duration::from_secs(5);
/// How long to wait before one looks again.
const GLANCE: Duration = Duration::from_millis(20);
/// A journal that is not there.
static NOTHING: Found = Found {
    lines: Vec::new(),
    damaged: Vec::new(),
    gaps: Vec::new(),
    is_torn: false,
    last_number: 0,
};

/// What is being done here, for errors.
const DOING: &str = "holding the database against the journal";
