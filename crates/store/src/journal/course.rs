//! The course of a campaign: the lines of its journal, in order.
//!
//! It is stored twice. A line is on the disk in `archive/journal.jsonl` first: it says what is intended. The transaction
//! that does what it says writes the line into the database too (`journal_line`), and with that the intention has its end.
//! Each line holds the checksum of the one before it, so that the last line of each, by number and checksum, tells whether
//! the two are of one course and equally far. Every opening looks at that, and every change before it writes. Where they
//! differ all lines are compared, and what one of them lacks it takes from the other:
//!
//! - The database lacks lines at its end: it is older, its write-ahead log was lost, or a program was ended between the two
//!   writings. They are said again.
//! - The journal lacks lines, is damaged or gone: they are written from the database.
//! - Both go on differently after some line, or neither has a line that a later one follows: a person has to know.
//!
//! A change that is refused after its line was written takes the line back.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::{Connection, params};

use super::entry::{Entry, Line};
use super::{Found, line};
use crate::seal::{self, Subject};
use crate::{StepError, StoreError};

/// Lines that a message names of each side.
const NAMED: usize = 5;

/// Every line that a database has.
pub(super) const ALL: &str = "SELECT n, line FROM journal_line ORDER BY n";
/// Those of them that say that words may be lost, or answer that.
pub(super) const LOST: &str = "SELECT n, line FROM journal_line WHERE is_lost = 1 ORDER BY n";

/// Lines of a database, in order; one that is not as it was written is damage.
pub(super) fn stored(connection: &Connection, sql: &str) -> Result<Vec<Line>, StepError> {
    let mut statement = connection.prepare_cached(sql)?;
    let mut rows = statement.query([])?;
    let mut lines = Vec::new();
    while let Some(row) = rows.next()? {
        let n: i64 = row.get("n")?;
        let text = row.get_ref("line")?.as_bytes().unwrap_or_default();
        let read = line::read(text).ok().filter(|line| line.n == n.unsigned_abs());
        lines.push(read.ok_or_else(|| StoreError::Damaged {
            what: format!("line {n} of the journal in it"),
        })?);
    }
    Ok(lines)
}

/// Number and checksum of the last line that a database has. That there is none after it says its seal.
pub(super) fn last(connection: &Connection) -> Result<(u64, Option<String>), StepError> {
    let last = stored(
        connection,
        "SELECT n, line FROM journal_line ORDER BY n DESC LIMIT 1",
    )?;
    let end = last.first().map(|line| (line.n, Some(line.sum().to_owned())));
    Ok(end.unwrap_or_default())
}

/// Writes lines into a database, which says from then on that it has what they say.
pub(super) fn store(connection: &Connection, lines: &[Line]) -> Result<(), StepError> {
    let mut statement = connection.prepare_cached("INSERT INTO journal_line VALUES (?1, ?2, ?3)")?;
    for line in lines {
        let is_lost = matches!(line.entry, Entry::Missed { .. } | Entry::Answered { .. });
        statement.execute(params![line.n.cast_signed(), line.text, is_lost])?;
    }
    Ok(seal::close(connection, &Subject::JournalEnd)?)
}

/// The lines of the database and of the journal, held against each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Compared {
    /// What the database has and the journal lacks.
    pub of_database: Vec<Line>,
    /// What the journal has and the database lacks.
    pub of_journal: Vec<Line>,
    /// Numbers of lines that neither has, though it has later ones or something damaged stands in their place.
    pub missing: BTreeSet<u64>,
    /// Number of the last line of the database; 0 where it has none.
    pub stored: u64,
}

impl Compared {
    /// Holds the lines of a database against those of a journal. On an error they are of two courses, which is told in
    /// words.
    ///
    /// # Errors
    /// They are of two courses.
    pub fn of(stored: &[Line], journal: &Found) -> Result<Compared, String> {
        let by_number = |lines: &[Line]| -> BTreeMap<u64, Line> {
            lines.iter().map(|line| (line.n, line.clone())).collect()
        };
        let (database, file) = (by_number(stored), by_number(&journal.lines));
        if let Some(at) = parting(&database, &file) {
            return Err(parted(at, &database, &file));
        }
        let beyond = |own: &BTreeMap<u64, Line>, other: &BTreeMap<u64, Line>| -> Vec<Line> {
            let own = own.iter().filter(|(n, _)| !other.contains_key(n));
            own.map(|(_, line)| line.clone()).collect()
        };
        let last = |lines: &BTreeMap<u64, Line>| lines.keys().next_back().copied().unwrap_or(0);
        let end = last(&database).max(journal.last_number);
        // What a rebuilding found missing it wrote down, and a person is asked.
        let known = [&database, &file].into_iter().flat_map(|lines| lines.values());
        let known = known.filter(|line| matches!(line.entry, Entry::Missed { .. }));
        let told = known.map(|line| line.n).max().unwrap_or(0);
        let has = |n: &u64| database.contains_key(n) || file.contains_key(n) || *n < told;
        Ok(Compared {
            of_database: beyond(&database, &file),
            of_journal: beyond(&file, &database),
            missing: (1..=end).filter(|n| !has(n)).collect(),
            stored: last(&database),
        })
    }

    /// Whether the database has all that is there.
    pub fn is_database_whole(&self) -> bool {
        self.of_journal.is_empty()
    }

    /// Whether what the database lacks can be said to it again: lines that follow its own, none of which is missing.
    pub fn can_be_said_again(&self) -> bool {
        let follow = self.of_journal.iter().all(|line| line.n > self.stored);
        follow && self.missing.range(self.stored + 1..).next().is_none()
    }

    /// What the database lacks, in words.
    pub fn lacks(&self) -> String {
        in_words(&self.of_journal)
    }
}

/// The first number under which two courses say different things, or do not follow each other.
fn parting(one: &BTreeMap<u64, Line>, other: &BTreeMap<u64, Line>) -> Option<u64> {
    let differs = |(n, line): (&u64, &Line)| {
        let same = other.get(n).is_none_or(|there| there.text == line.text);
        (!same).then_some(*n)
    };
    let follows = |own: &BTreeMap<u64, Line>, other: &BTreeMap<u64, Line>| {
        let breaks = |(n, line): (&u64, &Line)| {
            let before = other.get(&n.checked_sub(1)?)?;
            let is_wrong = line.after.as_ref().is_some_and(|after| after != before.sum());
            is_wrong.then_some(*n)
        };
        own.iter().find_map(breaks)
    };
    let found = [
        one.iter().find_map(differs),
        follows(one, other),
        follows(other, one),
        follows(one, one),
        follows(other, other),
    ];
    found.into_iter().flatten().min()
}

fn parted(at: u64, database: &BTreeMap<u64, Line>, journal: &BTreeMap<u64, Line>) -> String {
    let from = |lines: &BTreeMap<u64, Line>| {
        let after: Vec<Line> = lines.range(at..).map(|(_, line)| line.clone()).collect();
        if after.is_empty() {
            "nothing".to_owned()
        } else {
            in_words(&after)
        }
    };
    format!(
        "they are of two courses, and part before line {at}; from there the database says: {}; the journal says: {}",
        from(database),
        from(journal)
    )
}

/// Some lines in words, and how many more there are.
pub fn in_words(lines: &[Line]) -> String {
    let named = lines.iter().take(NAMED);
    let mut words: Vec<String> = named
        .map(|line| format!("{} at {}", line.entry.in_words(), line.at))
        .collect();
    if lines.len() > NAMED {
        words.push(format!("and {} more", lines.len() - NAMED));
    }
    words.join(", ")
}
