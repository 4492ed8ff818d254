//! Rows that carry a hash of themselves, and lists that carry the sum of their rows' hashes.
//!
//! SQLite notices a damaged page only where its structure breaks; a flipped bit in a number reads as another number. So every
//! row that says something carries a hash over its other columns, which is checked whenever the row is read. Rows that are read
//! together stand in a list (the current runs of a kind, the known files, ...), and the sum of a list's hashes tells that one of
//! them is gone. A change takes the rows out of their lists (after a look at them), and puts them in again as they are then.

use std::collections::BTreeMap;

use rusqlite::{Connection, OptionalExtension, Row, ToSql, params};

use super::{StepError, StoreError};

/// Bytes of BLAKE3 that are kept.
const HASH_BYTES: usize = 16;

/// A hash over values in order.
pub type RowHash = [u8; HASH_BYTES];

/// A table whose rows carry hashes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table {
    /// Its name.
    pub name: &'static str,
    /// What of a row is hashed. Blobs that are not read with it have a hash of their own in a document of the row.
    columns: &'static str,
    /// SQL that tells a row from others, in words of messages.
    told: &'static str,
    /// SQL of the list that a row stands in; NULL where it stands in none.
    pub(super) list: &'static str,
    /// SQL of what stands in rows of other tables and is read with it; it is not hashed here.
    beside: &'static str,
}

/// Revisions of runs.
pub(super) const RUN: Table = Table {
    name: "run",
    columns: "id, path, revision, superseded_at, kind, state, data_hash, measurement, continues, tag_digest, ingested_at, row_hash, reading, tagging",
    told: "'run ' || id || ' (' || path || ')'",
    list: "CASE WHEN superseded_at IS NULL THEN 'run ' || kind END",
    beside: "",
};
/// Files of runs.
pub(super) const RUN_FILE: Table = Table {
    name: "run_file",
    columns: "id, run_id, ordinal, path, hash, row_hash",
    told: "'the file ' || path || ' of run ' || run_id",
    list: "'run_file'",
    beside: "",
};
/// Raw bytes that are archived.
pub(super) const CONTENT: Table = Table {
    name: "content",
    columns: "id, hash, size_bytes, archive_path, ingested_at, row_hash",
    told: "'what is known of the raw file ' || archive_path",
    list: "'content'",
    beside: "",
};
/// Files of the folder.
pub(super) const SOURCE_FILE: Table = Table {
    name: "source_file",
    columns: "id, path, size_bytes, modified_ns, inode, changed_ns, hash, state, reader, issue, missing_since, row_hash",
    told: "'what is known of the file ' || path",
    list: "'source_file'",
    beside: "",
};
/// Revisions of climate logs.
pub(super) const CLIMATE_LOG: Table = Table {
    name: "climate_log",
    columns: "id, path, revision, superseded_at, hash, ingested_at, row_hash, reading",
    told: "'climate log ' || path",
    list: "CASE WHEN superseded_at IS NULL THEN 'climate_log' END",
    beside: "",
};
/// Lines of the journal.
pub(super) const JOURNAL_LINE: Table = Table {
    name: "journal_line",
    columns: "n, line, what, name, row_hash",
    told: "'line ' || n || ' of the journal in it'",
    list: "'journal_line ' || what",
    beside: "",
};
/// Results of all kinds.
pub(super) const RESULT: Table = Table {
    name: "result",
    columns: "id, kind, run_id, name, key, version, built_from, made_at, superseded_at, row_hash, document",
    told: "'the ' || CASE kind WHEN 'group' THEN 'diagnosis' WHEN 'run' THEN 'diagnosis' WHEN 'modulus' THEN 'analysis' \
           WHEN 'comparison' THEN 'comparison of models' ELSE kind END || ' of ' || \
           coalesce(name, (SELECT path FROM run WHERE run.id = run_id), 'no run')",
    list: "CASE WHEN superseded_at IS NULL THEN 'result ' || kind END",
    beside: ", coalesce(name, (SELECT path FROM run WHERE run.id = run_id), '') AS of_name",
};
/// The count of changes.
pub(super) const CHANGE_COUNT: Table = Table {
    name: "change_count",
    columns: "only_row, changes, changed_at, row_hash",
    told: "'the count of changes'",
    list: "'change_count'",
    beside: "",
};
/// Name of the sum that is the hash of the last line of the journal in the database.
pub(super) const JOURNAL_END: &str = "journal_end";

/// Every one.
pub(super) const ALL: [Table; 8] = [
    RUN,
    RUN_FILE,
    CONTENT,
    SOURCE_FILE,
    CLIMATE_LOG,
    JOURNAL_LINE,
    RESULT,
    CHANGE_COUNT,
];

impl Table {
    /// The query of its rows that [`check`] holds against their hashes; `rest` is what follows `FROM`, and `more` are further
    /// columns, which are not hashed.
    pub fn select(self, more: &str, rest: &str) -> String {
        let Table {
            name,
            columns,
            told,
            list,
            beside,
        } = self;
        format!(
            "SELECT {columns}, {told} AS told_of_row, {list} AS list_of_row {beside} {more} FROM {name} {rest}"
        )
    }

    /// How many columns of [`Table::select`] are the row's own.
    fn width(self) -> usize {
        self.columns.split(',').count()
    }
}

/// Changes rows of a table: they are held against their hashes before, and hashed anew after. `condition` has one parameter, and
/// finds the rows before or after or both.
pub(super) fn change<T>(
    connection: &Connection,
    table: Table,
    (condition, key): (&str, &dyn ToSql),
    work: impl FnOnce() -> Result<T, StepError>,
) -> Result<T, StepError> {
    let mut sums = BTreeMap::new();
    let rest = format!("WHERE {condition}");
    let mut ids = Vec::new();
    {
        let mut statement = connection.prepare_cached(&table.select(", rowid AS own_rowid", &rest))?;
        let mut rows = statement.query([key])?;
        while let Some(row) = rows.next()? {
            check(table, row)?;
            ids.push(row.get::<_, i64>("own_rowid")?);
            note(&mut sums, row, stated(row)?)?;
        }
    }
    let outcome = work()?;
    let mut statement = connection.prepare_cached(&format!("SELECT rowid FROM {} {rest}", table.name))?;
    for id in statement.query_map([key], |row| row.get(0))? {
        ids.push(id?);
    }
    ids.sort_unstable();
    ids.dedup();
    hash_anew(connection, table, &ids, sums)?;
    Ok(outcome)
}

/// Hashes every row of a database as it is: after its tables are made, and for tests of what a right hash hides.
pub(super) fn hash_all(connection: &Connection) -> Result<(), StepError> {
    connection.execute("DELETE FROM list_sum WHERE list <> ?1", [JOURNAL_END])?;
    for table in ALL {
        let mut statement = connection.prepare(&format!("SELECT rowid FROM {}", table.name))?;
        let ids = statement.query_map([], |row| row.get(0))?;
        let ids = ids.collect::<rusqlite::Result<Vec<i64>>>()?;
        hash_anew(connection, table, &ids, BTreeMap::new())?;
    }
    Ok(())
}

/// Hashes the rows of these ids that are there, and adds to the sums of their lists.
fn hash_anew(
    connection: &Connection,
    table: Table,
    ids: &[i64],
    mut sums: BTreeMap<String, RowHash>,
) -> Result<(), StepError> {
    for id in ids {
        let mut statement = connection.prepare_cached(&table.select("", "WHERE rowid = ?1"))?;
        let mut rows = statement.query([id])?;
        let Some(row) = rows.next()? else { continue };
        let hash = computed(table, row)?;
        note(&mut sums, row, hash)?;
        connection
            .prepare_cached(&format!(
                "UPDATE {} SET row_hash = ?2 WHERE rowid = ?1",
                table.name
            ))?
            .execute(params![id, hash])?;
    }
    for (list, hash) in sums {
        let sum = added(sum_of(connection, &list)?, hash);
        connection
            .prepare_cached("INSERT OR REPLACE INTO list_sum VALUES (?1, ?2)")?
            .execute(params![list, sum])?;
    }
    Ok(())
}

fn note(sums: &mut BTreeMap<String, RowHash>, row: &Row<'_>, hash: RowHash) -> Result<(), StepError> {
    if let Some(list) = row.get::<_, Option<String>>("list_of_row")? {
        let sum = sums.entry(list).or_default();
        *sum = added(*sum, hash);
    }
    Ok(())
}

/// Adds a hash to a sum, or takes it out again: without carry that is the same.
pub(super) fn added(sum: RowHash, hash: RowHash) -> RowHash {
    std::array::from_fn(|k| sum[k] ^ hash[k])
}

pub(super) fn sum_of(connection: &Connection, list: &str) -> rusqlite::Result<RowHash> {
    let sum = connection
        .prepare_cached("SELECT sum FROM list_sum WHERE list = ?1")?
        .query_row([list], |row| row.get::<_, Vec<u8>>(0))
        .optional()?;
    // What is no sum any more is none that matches.
    Ok(sum.map_or_else(RowHash::default, |sum| {
        sum.try_into().unwrap_or([u8::MAX; HASH_BYTES])
    }))
}

/// The hash that a row states; nothing of one that is none any more.
pub(super) fn stated(row: &Row<'_>) -> Result<RowHash, StepError> {
    let hash = row.get_ref("row_hash")?.as_blob().unwrap_or_default();
    Ok(hash.try_into().unwrap_or_default())
}

/// Holds a row of [`Table::select`] against its hash.
pub(super) fn check(table: Table, row: &Row<'_>) -> Result<(), StepError> {
    if row.get_ref("row_hash")?.as_blob().ok() == Some(&computed(table, row)?[..]) {
        return Ok(());
    }
    let told = row.get_ref("told_of_row")?.as_str().unwrap_or(table.name);
    let what = told.to_owned();
    Err(StoreError::Damaged { what }.into())
}

/// The hash that a row of [`Table::select`] asks for.
fn computed(table: Table, row: &Row<'_>) -> Result<RowHash, StepError> {
    let own = row.as_ref().column_index("row_hash")?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(table.name.as_bytes());
    for column in (0..table.width()).filter(|column| *column != own) {
        add_value(&mut hasher, row.get_ref(column)?);
    }
    Ok(finished(&hasher))
}

pub(super) fn damaged_list(list: &str) -> StoreError {
    StoreError::Damaged {
        what: format!("the list \"{list}\""),
    }
}

/// A hash in the length that is kept.
pub(super) fn finished(hasher: &blake3::Hasher) -> RowHash {
    let mut hash = [0; HASH_BYTES];
    hash.copy_from_slice(&hasher.finalize().as_bytes()[..HASH_BYTES]);
    hash
}

/// Adds a value with its type and length.
pub(super) fn add_value(hasher: &mut blake3::Hasher, value: rusqlite::types::ValueRef<'_>) {
    use rusqlite::types::ValueRef as V;
    let number;
    let (kind, bytes): (u8, &[u8]) = match value {
        V::Null => (b'n', &[]),
        V::Integer(value) => {
            number = value.to_le_bytes();
            (b'i', &number)
        }
        V::Real(value) => {
            number = value.to_le_bytes();
            (b'f', &number)
        }
        V::Text(bytes) => (b't', bytes),
        V::Blob(bytes) => (b'b', bytes),
    };
    hasher.update(&[kind]);
    hasher.update(&(bytes.len() as u64).to_le_bytes());
    hasher.update(bytes);
}
