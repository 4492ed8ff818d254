//! Checksums of what is stored: written with every change, looked at whenever rows are read.
//!
//! SQLite notices a damaged page only where its structure breaks; a flipped bit in a number reads as another number. So
//! every set of rows that is read together (a [`Subject`]) has a seal: a checksum over all of its values as SQLite gives
//! them, in order, so that a row that is missing, moved or changed is noticed. A change opens the seal (after a look at
//! it) and closes it again in the same transaction. Seals are of a schema: a migration seals everything anew.

mod subject;
#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::collections::BTreeSet;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OptionalExtension, Row, TransactionBehavior, params, params_from_iter};

use super::migration::NEWEST;
use super::transaction::Snapshot;
use super::{StepError, Store, StoreError};

pub(super) use subject::Subject;

/// Bytes of BLAKE3 that are kept.
const SEAL_BYTES: usize = 16;
/// Subject of the row that says for which schema the seals are.
const OF_SCHEMA: &str = "schema";

/// A checksum over values in order.
pub(super) type Seal = [u8; SEAL_BYTES];

/// The seals of an open database.
#[derive(Debug, Default)]
pub(super) struct Seals {
    /// Whether there are seals: a database that an older program made has none until it is opened for writing.
    are_there: bool,
    /// What changed in the transaction of this connection that is under way: its seals are open. Empty outside of one, as
    /// other connections write then; they wait while it is under way.
    open: RefCell<BTreeSet<Subject>>,
}

impl Seals {
    /// Of a database that is opened for reading.
    pub fn of(connection: &Connection) -> rusqlite::Result<Seals> {
        Ok(Seals {
            are_there: are_of_this_schema(connection)?,
            open: RefCell::default(),
        })
    }

    /// Of a database that is opened for writing: everything is sealed where that was not done in this schema.
    pub fn made(connection: &mut Connection) -> rusqlite::Result<Seals> {
        if !are_of_this_schema(connection)? {
            let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
            // Another connection may have done it meanwhile, and changed rows since.
            if !are_of_this_schema(&transaction)? {
                transaction.execute("DELETE FROM seal", [])?;
                for subject in Subject::all(&transaction)? {
                    close(&transaction, &subject)?;
                }
                let sql = "INSERT INTO seal VALUES (?1, ?2, x'')";
                transaction.execute(sql, params![OF_SCHEMA, NEWEST])?;
            }
            transaction.commit()?;
        }
        Seals::of(connection)
    }

    /// Holds rows against their seal; those that the transaction under way changed are not sealed yet.
    pub fn check(&self, connection: &Connection, subject: &Subject) -> Result<(), StepError> {
        if !self.are_there || self.open.borrow().contains(subject) {
            return Ok(());
        }
        let _moment = Snapshot::of(connection)?;
        let computed = computed(connection, subject)?;
        match stored(connection, subject)? == computed.map(|seal| seal.to_vec()) {
            true => Ok(()),
            false => Err(damaged(subject).into()),
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

impl Store {
    /// Holds rows against their seal before they are read.
    pub(super) fn check_seal(&self, subject: &Subject) -> Result<(), StoreError> {
        let checked = self.seals.check(&self.connection, subject);
        checked.map_err(self.named("checking what is stored"))
    }

    /// Whether a row is as it was sealed; its last column is the seal.
    pub(super) fn check_sealed_row(&self, subject: &Subject, row: &Row<'_>) -> Result<(), StepError> {
        let last = row.as_ref().column_count() - 1;
        if !self.seals.are_there || self.seals.open.borrow().contains(subject) {
            return Ok(());
        }
        let mut hasher = blake3::Hasher::new();
        add_row(&mut hasher, row, last)?;
        match row.get::<_, Option<Vec<u8>>>(last)? == Some(finished(&hasher).to_vec()) {
            true => Ok(()),
            false => Err(damaged(subject).into()),
        }
    }

    /// Looks at everything: the structure of the database, references between rows, every seal, and every run's readings
    /// against their hash. Gives what is wrong, in words.
    ///
    /// # Errors
    /// See [`StoreError`]; where the database cannot be read at all.
    pub fn check_all(&self) -> Result<Vec<String>, StoreError> {
        let mut wrong = self.structure_faults("PRAGMA integrity_check")?;
        wrong.extend(self.structure_faults("SELECT 'a row of ' || \"table\" || ' names a row of ' || parent || ' that is not there' FROM pragma_foreign_key_check")?);
        let subjects =
            Subject::all(&self.connection).map_err(|e| self.failed("listing what is stored", e))?;
        for subject in subjects {
            wrong.extend(self.check_seal(&subject).err().map(in_words));
            if let Subject::Readings(run_id) = subject {
                wrong.extend(self.channels_as_read(run_id).err().map(in_words));
            }
        }
        wrong.extend(self.course().err().map(in_words));
        wrong.dedup();
        Ok(wrong)
    }

    /// Looks at the structure of the database, which takes as long as reading all of it once.
    ///
    /// # Errors
    /// [`StoreError::NotADatabase`] with what is wrong.
    pub fn check_structure(&self) -> Result<(), StoreError> {
        match self.structure_faults("PRAGMA quick_check(1)")?.into_iter().next() {
            None => Ok(()),
            Some(detail) => Err(StoreError::NotADatabase {
                path: self.path.clone(),
                detail,
            }),
        }
    }

    fn structure_faults(&self, sql: &str) -> Result<Vec<String>, StoreError> {
        let mut faults = self.rows("checking the database", sql, [], |row| {
            Ok(row.get::<_, String>(0)?)
        })?;
        faults.retain(|fault| fault != "ok");
        Ok(faults)
    }
}

/// What is wrong, without the way to mend it.
fn in_words(error: StoreError) -> String {
    match error {
        StoreError::Damaged { what } => {
            format!("{what} is not as it was stored (its checksum does not match)")
        }
        other => other.to_string(),
    }
}

fn damaged(subject: &Subject) -> StoreError {
    StoreError::Damaged {
        what: subject.to_string(),
    }
}

fn are_of_this_schema(connection: &Connection) -> rusqlite::Result<bool> {
    let sql = "SELECT EXISTS (SELECT 1 FROM seal WHERE subject = ?1 AND id = ?2)";
    connection.query_row(sql, params![OF_SCHEMA, NEWEST], |row| row.get(0))
}

fn stored(connection: &Connection, subject: &Subject) -> rusqlite::Result<Option<Vec<u8>>> {
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

pub(super) fn close(connection: &Connection, subject: &Subject) -> rusqlite::Result<()> {
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

pub(super) fn finished(hasher: &blake3::Hasher) -> Seal {
    let mut seal = [0; SEAL_BYTES];
    seal.copy_from_slice(&hasher.finalize().as_bytes()[..SEAL_BYTES]);
    seal
}

/// Adds the values of a row, each with its type and length.
pub(super) fn add_row(hasher: &mut blake3::Hasher, row: &Row<'_>, columns: usize) -> rusqlite::Result<()> {
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
