//! Results that follow from readings, of all kinds: one table, each a document with its hash, which is checked whenever it is
//! read. What stood earlier stays.

use std::collections::BTreeMap;

use rusqlite::{Connection, OptionalExtension, Row, ToSql, params};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::columns::{from_json, to_json};
use super::seal::{Seal, finished};
use super::{StepError, Store, StoreError, Transaction};
use ieap_domain::{Issue, string_enum};

string_enum! {
    /// What kind of result.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum ResultKind {
        /// The fit of a run.
        Fit = "fit",
        /// The analysis of a modulus log.
        Modulus = "modulus",
        /// Models held against each other on a run.
        Comparison = "comparison",
        /// The diagnosis of runs that one parameter set describes.
        Group = "group",
        /// The diagnosis of one run alone.
        Run = "run",
        /// The alarms of long-term monitoring.
        Alarms = "alarms",
    }
}

impl ResultKind {
    /// In words of messages.
    fn words(self) -> &'static str {
        match self {
            ResultKind::Fit => "fit",
            ResultKind::Modulus => "analysis",
            ResultKind::Comparison => "comparison of models",
            ResultKind::Group | ResultKind::Run => "diagnosis",
            ResultKind::Alarms => "list of alarms",
        }
    }
}

/// What is found of a run, a log or a group, as it is stored.
pub trait ResultDocument: Serialize + DeserializeOwned {
    /// Fields that are only drawn: they are stored beside the document, so that who asks for numbers does not read them.
    /// Without them it can be read.
    const DRAWN: &'static [&'static str] = &[];
}

/// A result on its way into the database.
#[derive(Debug, Clone, PartialEq)]
pub struct NewResult<'a, T> {
    /// Of the run, the log or the group.
    pub name: &'a str,
    /// Hash of everything that it depends on; empty where it is to be made again whenever it is asked for.
    pub key: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// What was found, or why nothing could be.
    pub found: Result<&'a T, &'a Issue>,
}

/// A stored result.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredResult<T> {
    /// What it is of and what it was made from.
    pub origin: ResultOrigin,
    /// What was found, or why nothing could be.
    pub found: Result<T, Issue>,
}

/// What a result is of, and what it was made from and by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultOrigin {
    /// Row id.
    pub id: i64,
    /// Name of the run, the log or the group.
    pub name: String,
    /// Hash of everything that it depends on.
    pub key: String,
    /// Version of the program that made it.
    pub version: String,
    /// When, RFC 3339 UTC.
    pub made_at: String,
}

/// Which of the results of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum When<'a> {
    /// The one that is current.
    Now,
    /// The last that found anything before the one that is current.
    Before,
    /// The one that was current at a moment, RFC 3339 UTC to the second.
    At(&'a str),
}

/// What stands in the column `document`.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Document<T> {
    Found(T),
    Issue(Issue),
}

/// Key of a document under which the hash of what is drawn stands.
const DRAWN_HASH: &str = "drawn_hash";
/// Level of compression of what is drawn.
const ZSTD_LEVEL: i32 = 3;
const COLUMNS: &str = "id, superseded_at, kind, name, key, version, document, made_at, hash";

impl Store {
    /// Stores results of a kind, each as the current one of its name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn keep_results<T: ResultDocument>(
        &mut self,
        now: &str,
        kind: ResultKind,
        results: &[NewResult<'_, T>],
    ) -> Result<(), StoreError> {
        if results.is_empty() {
            return Ok(());
        }
        self.write("storing results", now, |transaction| {
            keep(transaction, now, kind, results)
        })
    }

    /// Takes results of these names out of those that are current. Nothing is written where there is none.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn retire_results(
        &mut self,
        now: &str,
        kind: ResultKind,
        names: &[String],
    ) -> Result<(), StoreError> {
        if names.is_empty() {
            return Ok(());
        }
        self.write("retiring results", now, |transaction| {
            names
                .iter()
                .try_for_each(|name| retire(transaction, now, kind, name))
        })
    }

    /// The current results of a kind, by name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn results<T: ResultDocument>(&self, kind: ResultKind) -> Result<Vec<StoredResult<T>>, StoreError> {
        let mut found = self.current_results(kind, read)?;
        found.sort_by(|a: &StoredResult<T>, b| a.origin.name.cmp(&b.origin.name));
        Ok(found)
    }

    /// What the current results of a kind depend on, by name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn result_keys(&self, kind: ResultKind) -> Result<BTreeMap<String, String>, StoreError> {
        let keys = self.current_results(kind, |row| {
            check(row)?;
            Ok((row.get("name")?, row.get("key")?))
        });
        Ok(keys?.into_iter().collect())
    }

    /// Every current result of a kind, read from the table itself and not by an index; that none is missing is held against the
    /// sum of their hashes.
    fn current_results<T>(
        &self,
        kind: ResultKind,
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let _moment = self.snapshot()?;
        let sql =
            format!("SELECT {COLUMNS} FROM result NOT INDEXED WHERE kind = ?1 AND superseded_at IS NULL");
        let found = self.rows("reading results", &sql, [kind.key()], |row| {
            Ok((read(row)?, seal_in(row)?))
        })?;
        let stated = sum_of(&self.connection, kind).map_err(|e| self.failed("reading results", e))?;
        let sum = found
            .iter()
            .fold(Seal::default(), |sum, (_, hash)| added(sum, *hash));
        if sum != stated {
            return Err(StoreError::Damaged { what: list_of(kind) });
        }
        Ok(found.into_iter().map(|(result, _)| result).collect())
    }

    /// The current result of a name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn result<T: ResultDocument>(
        &self,
        kind: ResultKind,
        name: &str,
    ) -> Result<Option<StoredResult<T>>, StoreError> {
        self.result_then(kind, name, When::Now)
    }

    /// One of the results of a name.
    pub(super) fn result_then<T: ResultDocument>(
        &self,
        kind: ResultKind,
        name: &str,
        when: When<'_>,
    ) -> Result<Option<StoredResult<T>>, StoreError> {
        let kind = kind.key();
        let (condition, values): (&str, Vec<&dyn ToSql>) = match &when {
            When::Now => ("superseded_at IS NULL", vec![&kind, &name]),
            When::Before => (
                "id < (SELECT id FROM result WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL)
                 AND document NOT LIKE '{\"issue\"%'",
                vec![&kind, &name],
            ),
            When::At(moment) => (
                "made_at <= ?3 AND (superseded_at IS NULL OR superseded_at > ?3)",
                vec![&kind, &name, moment],
            ),
        };
        let sql = format!(
            "SELECT {COLUMNS} FROM result WHERE kind = ?1 AND name = ?2 AND {condition} ORDER BY id DESC LIMIT 1"
        );
        let found = self.rows("reading a result", &sql, values.as_slice(), read)?;
        Ok(found.into_iter().next())
    }

    /// What pages draw of the current result of a name: the fields that [`ResultDocument::DRAWN`] names. None where there is
    /// nothing.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn drawn<D: DeserializeOwned>(&self, kind: ResultKind, name: &str) -> Result<Option<D>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS}, drawn FROM result
             WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL AND drawn IS NOT NULL"
        );
        let found = self.rows("reading curves", &sql, [kind.key(), name], |row| {
            check(row)?;
            check_drawn(row)?;
            let drawn: Vec<u8> = row.get("drawn")?;
            let text = zstd::decode_all(drawn.as_slice()).map_err(|_| damaged(row))?;
            Ok(serde_json::from_slice(&text).map_err(|error| bad_value(&error))?)
        })?;
        Ok(found.into_iter().next())
    }

    /// Hash of what pages draw of the current result of a name, by which anyone knows whether it changed.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn drawn_hash(&self, kind: ResultKind, name: &str) -> Result<Option<String>, StoreError> {
        let sql =
            format!("SELECT {COLUMNS} FROM result WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL");
        let found = self.rows("reading a hash of curves", &sql, [kind.key(), name], |row| {
            check(row)?;
            stated_drawn_hash(row)
        })?;
        Ok(found.into_iter().flatten().next())
    }

    /// What is wrong with results, current and earlier ones, in the order in which they were made.
    pub(super) fn check_results(&self) -> Result<Vec<StoreError>, StoreError> {
        let sql = format!("SELECT {COLUMNS}, drawn FROM result ORDER BY id");
        let mut sums: BTreeMap<String, Seal> = BTreeMap::new();
        let found = self.rows("checking results", &sql, [], |row| {
            let is_current = row.get::<_, Option<String>>("superseded_at")?.is_none();
            let current = if is_current {
                Some((row.get::<_, String>("kind")?, seal_in(row)?))
            } else {
                None
            };
            match check(row).and_then(|()| check_drawn(row)) {
                Ok(()) => Ok((current, None)),
                Err(StepError::Store(error)) => Ok((current, Some(error))),
                Err(other) => Err(other),
            }
        });
        let mut wrong = Vec::new();
        for (current, error) in found? {
            if let Some((kind, hash)) = current {
                let sum = sums.entry(kind).or_default();
                *sum = added(*sum, hash);
            }
            wrong.extend(error);
        }
        for kind in ResultKind::ALL {
            let stated = sum_of(&self.connection, kind).map_err(|e| self.failed("checking results", e))?;
            if sums.get(kind.key()).copied().unwrap_or_default() != stated {
                wrong.push(StoreError::Damaged { what: list_of(kind) });
            }
        }
        Ok(wrong)
    }
}

/// Stores results of a kind, each as the current one of its name.
pub(super) fn keep<T: ResultDocument>(
    transaction: &Transaction<'_>,
    now: &str,
    kind: ResultKind,
    results: &[NewResult<'_, T>],
) -> Result<(), StepError> {
    for result in results {
        retire(transaction, now, kind, result.name)?;
        let (document, drawn) = written(kind, result.found)?;
        let of = [
            kind.key(),
            result.name,
            result.key,
            result.version,
            &document,
            now,
        ];
        let sql = "INSERT INTO result (kind, name, key, version, document, made_at, hash, drawn)
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)";
        let [kind, name, key, version, document, made_at] = of;
        let values = params![kind, name, key, version, document, made_at, hash_of(of), drawn];
        transaction.prepare_cached(sql)?.execute(values)?;
        add(transaction, kind, hash_of(of))?;
    }
    Ok(())
}

/// Takes the result of a name out of those that are current.
pub(super) fn retire(
    transaction: &Transaction<'_>,
    now: &str,
    kind: ResultKind,
    name: &str,
) -> Result<(), StepError> {
    let sql = "UPDATE result SET superseded_at = ?3 WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL RETURNING hash";
    let mut statement = transaction.prepare_cached(sql)?;
    let mut rows = statement.query(params![kind.key(), name, now])?;
    while let Some(row) = rows.next()? {
        add(transaction, kind.key(), seal_in(row)?)?;
    }
    Ok(())
}

/// Adds a hash to the sum of a kind, or takes it out again: without carry that is the same.
fn add(transaction: &Transaction<'_>, kind: &str, hash: Seal) -> Result<(), StepError> {
    let sum = sum_in(transaction, kind)?;
    transaction
        .prepare_cached("INSERT OR REPLACE INTO result_sum VALUES (?1, ?2)")?
        .execute(params![kind, added(sum, hash)])?;
    Ok(())
}

fn added(sum: Seal, hash: Seal) -> Seal {
    std::array::from_fn(|k| sum[k] ^ hash[k])
}

fn sum_of(connection: &Connection, kind: ResultKind) -> rusqlite::Result<Seal> {
    sum_in(connection, kind.key())
}

fn sum_in(connection: &Connection, kind: &str) -> rusqlite::Result<Seal> {
    let sum = connection
        .prepare_cached("SELECT sum FROM result_sum WHERE kind = ?1")?
        .query_row([kind], |row| row.get(0))
        .optional()?;
    Ok(sum.unwrap_or_default())
}

/// The hash in a row; nothing of one that is none any more.
fn seal_in(row: &Row<'_>) -> Result<Seal, StepError> {
    let hash = row.get_ref("hash")?.as_blob().unwrap_or_default();
    Ok(hash.try_into().unwrap_or_default())
}

fn list_of(kind: ResultKind) -> String {
    format!("the list of results ({})", kind.words())
}

/// Takes what was found in the readings of a run, or a log, out of what is current.
pub(super) fn retire_of_run(transaction: &Transaction<'_>, now: &str, name: &str) -> Result<(), StepError> {
    let kinds = [ResultKind::Fit, ResultKind::Modulus];
    kinds
        .into_iter()
        .try_for_each(|kind| retire(transaction, now, kind, name))
}

/// Gives the results of a run, or a log, its new name.
pub(super) fn rename(transaction: &Transaction<'_>, old: &str, new: &str) -> Result<(), StepError> {
    let sql = format!("SELECT {COLUMNS} FROM result WHERE name = ?1 AND kind <> 'group'");
    let mut statement = transaction.prepare_cached(&sql)?;
    let mut rows = statement.query([old])?;
    let mut renamed = Vec::new();
    while let Some(row) = rows.next()? {
        check(row)?;
        let text = |column: &str| row.get::<_, String>(column);
        let (kind, key, version) = (text("kind")?, text("key")?, text("version")?);
        let hash = hash_of([&kind, new, &key, &version, &text("document")?, &text("made_at")?]);
        let is_current = row.get::<_, Option<String>>("superseded_at")?.is_none();
        renamed.push((row.get::<_, i64>("id")?, kind, seal_in(row)?, hash, is_current));
    }
    for (id, kind, before, hash, is_current) in renamed {
        if is_current {
            add(transaction, &kind, added(before, hash))?;
        }
        transaction
            .prepare_cached("UPDATE result SET name = ?2, hash = ?3 WHERE id = ?1")?
            .execute(params![id, new, hash])?;
    }
    Ok(())
}

/// The document of a result, and what is drawn of it.
fn written<T: ResultDocument>(
    kind: ResultKind,
    found: Result<&T, &Issue>,
) -> Result<(String, Option<Vec<u8>>), StoreError> {
    let found = match found {
        Ok(found) => found,
        Err(issue) => {
            return Ok((
                to_json("why there is no result", &Document::<()>::Issue(issue.clone()))?,
                None,
            ));
        }
    };
    if T::DRAWN.is_empty() {
        return Ok((to_json(kind.words(), &Document::Found(found))?, None));
    }
    let mut value = serde_json::to_value(found).map_err(|error| bad_value(&error))?;
    let mut drawn = Map::new();
    let mut packed = None;
    if let Value::Object(fields) = &mut value {
        drawn.extend(T::DRAWN.iter().filter_map(|key| fields.shift_remove_entry(*key)));
        let text = to_json("curves", &drawn)?;
        let bytes =
            zstd::bulk::compress(text.as_bytes(), ZSTD_LEVEL).map_err(|error| StoreError::BadValue {
                what: "curves",
                detail: error.to_string(),
            })?;
        let hash = blake3::hash(&bytes).to_hex().to_string();
        fields.insert(DRAWN_HASH.to_owned(), Value::String(hash));
        packed = Some(bytes);
    }
    Ok((to_json(kind.words(), &Document::Found(value))?, packed))
}

/// A result from a row of [`COLUMNS`], held against its hash.
fn read<T: ResultDocument>(row: &Row<'_>) -> Result<StoredResult<T>, StepError> {
    check(row)?;
    let found = match from_json("a result", &row.get::<_, String>("document")?)? {
        Document::Found(found) => Ok(found),
        Document::Issue(issue) => Err(issue),
    };
    let origin = read_origin(row)?;
    Ok(StoredResult { origin, found })
}

fn read_origin(row: &Row<'_>) -> Result<ResultOrigin, StepError> {
    Ok(ResultOrigin {
        id: row.get("id")?,
        name: row.get("name")?,
        key: row.get("key")?,
        version: row.get("version")?,
        made_at: row.get("made_at")?,
    })
}

/// Holds a row of [`COLUMNS`] against its hash. What is no text any more has none that matches.
fn check(row: &Row<'_>) -> Result<(), StepError> {
    let text = |column: &str| {
        row.get_ref(column)
            .map(|value| value.as_str().unwrap_or_default())
    };
    let of = [
        text("kind")?,
        text("name")?,
        text("key")?,
        text("version")?,
        text("document")?,
        text("made_at")?,
    ];
    let stored = row.get_ref("hash")?.as_blob().unwrap_or_default();
    if stored == hash_of(of) {
        Ok(())
    } else {
        Err(damaged(row).into())
    }
}

/// Holds what is drawn of a checked row against the hash in its document.
fn check_drawn(row: &Row<'_>) -> Result<(), StepError> {
    let drawn: Option<Vec<u8>> = row.get("drawn")?;
    let computed = drawn.map(|drawn| blake3::hash(&drawn).to_hex().to_string());
    if computed == stated_drawn_hash(row)? {
        Ok(())
    } else {
        Err(damaged(row).into())
    }
}

fn stated_drawn_hash(row: &Row<'_>) -> Result<Option<String>, StepError> {
    #[derive(Deserialize)]
    struct Hash {
        drawn_hash: Option<String>,
    }
    let document: Document<Hash> = from_json("a result", &row.get::<_, String>("document")?)?;
    Ok(match document {
        Document::Found(found) => found.drawn_hash,
        Document::Issue(_) => None,
    })
}

/// The hash of a result: over its kind, name, key, version, document and when it was made.
fn hash_of(texts: [&str; 6]) -> Seal {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    finished(&hasher)
}

fn damaged(row: &Row<'_>) -> StoreError {
    let text = |column: &str| {
        row.get_ref(column)
            .ok()
            .and_then(|value| value.as_str().ok())
            .unwrap_or("?")
    };
    let kind = ResultKind::from_key(text("kind")).map_or("result", ResultKind::words);
    StoreError::Damaged {
        what: format!("the {kind} of {}", text("name")),
    }
}

fn bad_value(error: &serde_json::Error) -> StoreError {
    StoreError::BadValue {
        what: "a result",
        detail: error.to_string(),
    }
}

#[cfg(test)]
mod tests;
