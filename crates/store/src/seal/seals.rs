//! The seals of an open database, and how one is made.

use std::cell::RefCell;
use std::collections::BTreeSet;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OptionalExtension, Row, params, params_from_iter};

use super::subject::Subject;
use crate::snapshot::Snapshot;
use crate::{StepError, StoreError};

/// Bytes of BLAKE3 that are kept.
const SEAL_BYTES: usize = 16;
/// Subject of the row that says for which schema the seals are.
const OF_SCHEMA: &str = "schema";

/// A checksum over values in order.
pub(crate) type Seal = [u8; SEAL_BYTES];

/// The seals of an open database.
#[derive(Debug, Default)]
pub(crate) struct Seals {
    /// What changed in the transaction of this connection that is under way: its seals are open. Empty outside of one, as
    /// other connections write then; they wait while it is under way.
    pub(super) open: RefCell<BTreeSet<Subject>>,
}

/// Seals everything that a database holds, in the schema that it has now: the last step of a migration.
pub(crate) fn seal_all(connection: &Connection) -> rusqlite::Result<()> {
    connection.execute("DELETE FROM seal", [])?;
    for subject in Subject::all(connection)? {
        close(connection, &subject)?;
    }
    let sql = "INSERT INTO seal VALUES (?1, ?2, x'')";
    connection.execute(sql, params![OF_SCHEMA, schema(connection)?])?;
    Ok(())
}

/// The schema of a database.
fn schema(connection: &Connection) -> rusqlite::Result<i64> {
    connection.pragma_query_value(None, "user_version", |row| row.get(0))
}

impl Seals {
    /// Of a database of the newest schema. One whose seals say that they are of another one, or nothing, is damaged: they are
    /// made with the schema and never after it.
    pub fn of(connection: &Connection) -> Result<Seals, StepError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM seal WHERE subject = ?1 AND id = ?2)";
        let are_there: bool =
            connection.query_row(sql, params![OF_SCHEMA, schema(connection)?], |row| row.get(0))?;
        if are_there {
            Ok(Seals::default())
        } else {
            let what = "the list of its checksums".to_owned();
            Err(StoreError::Damaged { what }.into())
        }
    }

    /// Holds rows against their seal; those that the transaction under way changed are not sealed yet.
    pub fn check(&self, connection: &Connection, subject: &Subject) -> Result<(), StepError> {
        if self.open.borrow().contains(subject) {
            return Ok(());
        }
        let _moment = Snapshot::of(connection)?;
        let computed = computed(connection, subject)?;
        if stored(connection, subject)? == computed.map(|seal| seal.to_vec()) {
            Ok(())
        } else {
            Err(damaged(subject).into())
        }
    }

    /// Opens the seal of rows that are about to change.
    pub fn open(&self, connection: &Connection, subject: Subject) -> Result<(), StepError> {
        self.check(connection, &subject)?;
        self.open_new(subject);
        Ok(())
    }

    /// Opens the seal of rows that were just made.
    pub fn open_new(&self, subject: Subject) {
        self.open.borrow_mut().insert(subject);
    }

    /// Closes every open seal; the last step of a transaction.
    pub fn close(&self, connection: &Connection) -> rusqlite::Result<()> {
        self.open
            .take()
            .iter()
            .try_for_each(|subject| close(connection, subject))
    }

    /// Forgets what is open, after a transaction that was taken back.
    pub fn forget(&self) {
        self.open.take();
    }
}

pub(super) fn damaged(subject: &Subject) -> StoreError {
    StoreError::Damaged {
        what: subject.to_string(),
    }
}

pub(super) fn stored(connection: &Connection, subject: &Subject) -> rusqlite::Result<Option<Vec<u8>>> {
    connection
        .prepare_cached("SELECT sum FROM seal WHERE subject = ?1 AND id = ?2")?
        .query_row(params![subject.name(), subject.id()], |row| row.get(0))
        .optional()
}

/// The seal that the rows of a subject ask for; none where there is no row.
fn computed(connection: &Connection, subject: &Subject) -> rusqlite::Result<Option<Seal>> {
    let mut hasher = blake3::Hasher::new();
    let mut is_there = false;
    for (at, sql) in subject.queries().iter().enumerate() {
        // Rows of one table must not pass for rows of the next.
        if at > 0 {
            hasher.update(b"|");
        }
        let mut statement = connection.prepare_cached(sql)?;
        let columns = statement.column_count();
        let mut rows = statement.query(params_from_iter(subject.keys()))?;
        while let Some(row) = rows.next()? {
            add_row(&mut hasher, row, columns)?;
            is_there = true;
        }
    }
    Ok(is_there.then(|| finished(&hasher)))
}

pub(crate) fn close(connection: &Connection, subject: &Subject) -> rusqlite::Result<()> {
    let (name, id) = (subject.name(), subject.id());
    match computed(connection, subject)? {
        Some(seal) => connection
            .prepare_cached("INSERT OR REPLACE INTO seal VALUES (?1, ?2, ?3)")?
            .execute(params![name, id, seal]),
        None => connection
            .prepare_cached("DELETE FROM seal WHERE subject = ?1 AND id = ?2")?
            .execute(params![name, id]),
    }?;
    Ok(())
}

pub(crate) fn finished(hasher: &blake3::Hasher) -> Seal {
    let mut seal = [0; SEAL_BYTES];
    seal.copy_from_slice(&hasher.finalize().as_bytes()[..SEAL_BYTES]);
    seal
}

/// Adds the values of a row, each with its type and length.
pub(crate) fn add_row(hasher: &mut blake3::Hasher, row: &Row<'_>, columns: usize) -> rusqlite::Result<()> {
    hasher.update(b"r");
    for column in 0..columns {
        let number;
        let (kind, bytes): (u8, &[u8]) = match row.get_ref(column)? {
            ValueRef::Null => (b'n', &[]),
            ValueRef::Integer(value) => {
                number = value.to_le_bytes();
                (b'i', &number)
            }
            ValueRef::Real(value) => {
                number = value.to_le_bytes();
                (b'f', &number)
            }
            ValueRef::Text(bytes) => (b't', bytes),
            ValueRef::Blob(bytes) => (b'b', bytes),
        };
        hasher.update(&[kind]);
        hasher.update(&(bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    }
    Ok(())
}
