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

use rusqlite::{Connection, OptionalExtension, Row, params};

use super::entry::{End, Entry, Line};
use super::{Found, line};
use crate::rows::{self, JOURNAL_LINE};
use crate::{StepError, StoreError};

/// Lines that a message names of each side.
const NAMED: usize = 5;

/// Lines of a database up to a number, in order; one that is not as it was written is damage.
pub(super) fn stored(connection: &Connection, up_to: u64) -> Result<Vec<Line>, StepError> {
    let sql = rows::JOURNAL_LINE.select("", "WHERE n <= ?1 ORDER BY n");
    let mut statement = connection.prepare_cached(&sql)?;
    let mut found = statement.query([up_to.cast_signed()])?;
    let mut lines = Vec::new();
    while let Some(row) = found.next()? {
        rows::check(JOURNAL_LINE, row)?;
        lines.push(read(row)?);
    }
    Ok(lines)
}

/// A line from a row that was held against its hash.
pub(crate) fn read(row: &Row<'_>) -> Result<Line, StepError> {
    let n: i64 = row.get("n")?;
    let text = row.get_ref("line")?.as_bytes().unwrap_or_default();
    let read = line::read(text).ok().filter(|line| line.n == n.unsigned_abs());
    Ok(read.ok_or_else(|| damaged(n))?)
}

/// The end of the course of a database. That there is no line after it says the hash of the last.
pub(super) fn last(connection: &Connection) -> Result<End, StepError> {
    let sql = rows::JOURNAL_LINE.select("", "ORDER BY n DESC LIMIT 1");
    let mut statement = connection.prepare_cached(&sql)?;
    let mut found = statement.query([])?;
    let line = match found.next()? {
        Some(row) => Some(read(row)?),
        None => None,
    };
    let sum = connection
        .prepare_cached("SELECT sum FROM list_sum WHERE list = ?1")?
        .query_row([rows::JOURNAL_END], |row| row.get::<_, Vec<u8>>(0))
        .optional()?;
    if sum != line.as_ref().map(end_hash) {
        let what = "the end of the journal in it".to_owned();
        return Err(StoreError::Damaged { what }.into());
    }
    Ok(line.as_ref().map_or_else(End::default, End::after))
}

/// Writes lines that follow the last.
pub(super) fn store(connection: &Connection, lines: &[Line]) -> Result<(), StepError> {
    for line in lines {
        let n = line.n.cast_signed();
        let name = match &line.of {
            Some(of) => Some(of.clone()),
            None => run_of(connection, &line.entry)?.or_else(|| line.entry.name().map(str::to_owned)),
        };
        rows::change(connection, JOURNAL_LINE, ("n = ?1", &n), || {
            connection
                .prepare_cached("INSERT INTO journal_line (n, line, what, name) VALUES (?1, ?2, ?3, ?4)")?
                .execute(params![n, line.text, line.entry.what(), name])?;
            Ok(())
        })?;
    }
    if let Some(last) = lines.last() {
        connection
            .prepare_cached("INSERT OR REPLACE INTO list_sum VALUES (?1, ?2)")?
            .execute(params![rows::JOURNAL_END, end_hash(last)])?;
    }
    Ok(())
}

/// The measurement that a word is about: the run that has the name now. None of what is about no run, and of one that is not
/// there.
pub(super) fn run_of(connection: &Connection, entry: &Entry) -> Result<Option<String>, StepError> {
    let Some(name) = entry.name().filter(|_| entry.is_of_run()) else {
        return Ok(None);
    };
    let sql = "SELECT measurement FROM run WHERE path = ?1 AND superseded_at IS NULL";
    let mut statement = connection.prepare_cached(sql)?;
    Ok(statement.query_row([name], |row| row.get(0)).optional()?)
}

fn end_hash(line: &Line) -> Vec<u8> {
    blake3::hash(line.text.as_bytes()).as_bytes()[..16].to_vec()
}

fn damaged(n: i64) -> StoreError {
    StoreError::Damaged {
        what: format!("line {n} of the journal in it"),
    }
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
