//! Results that follow from readings, of all kinds: one table, each a document with its hash, which is checked whenever it is
//! read. What stood earlier stays.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Row, ToSql, params};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::blob::{packed_json, unpacked_json};
use super::columns::{from_json, text_in, to_json};
use super::new_run::RunRow;
use super::rows::{RESULT, RowHash, stated};
use super::{StepError, Store, StoreError, Transaction};
use ieap_domain::{Issue, MadeBy, string_enum};

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
        /// What the climate logs come to.
        Climate = "climate",
        /// A few readings of a run, by which others with the same ones are found.
        Marks = "marks",
        /// In which runs the readings of a run stand too.
        Same = "same",
    }
}

impl ResultKind {
    /// Whether each is of one run or log.
    pub fn is_of_run(self) -> bool {
        !matches!(self, ResultKind::Group | ResultKind::Alarms | ResultKind::Climate)
    }

    /// SQL that finds results by the name of what they are of.
    fn named(self, name: &str) -> String {
        if self.is_of_run() {
            format!("run_id IN (SELECT id FROM run WHERE path = {name})")
        } else {
            format!("name = {name}")
        }
    }

    /// SQL that finds the current result by kind and name.
    fn current(self) -> String {
        format!(
            "WHERE kind = ?1 AND {} AND superseded_at IS NULL",
            self.named("?2")
        )
    }

    /// In words of messages.
    fn words(self) -> &'static str {
        match self {
            ResultKind::Fit => "fit",
            ResultKind::Modulus => "analysis",
            ResultKind::Comparison => "comparison of models",
            ResultKind::Group | ResultKind::Run => "diagnosis",
            ResultKind::Alarms => "list of alarms",
            ResultKind::Climate => "assessment",
            ResultKind::Marks => "list of marks",
            ResultKind::Same => "list of copies",
        }
    }
}

/// What is found of a run, a log or a group, as it is stored.
pub trait ResultDocument: Serialize + DeserializeOwned {
    /// Fields that are only drawn: they are stored beside the document, so that who asks for numbers does not read them.
    /// Without them it can be read.
    const DRAWN: &'static [&'static str] = &[];
}

/// What a result is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject<'a> {
    /// A run or a modulus log, by its row id: its name may change.
    Run(i64),
    /// A group, or what there is one of.
    Named(&'a str),
}

/// A result on its way into the database.
#[derive(Debug, Clone, PartialEq)]
pub struct NewResult<'a, T> {
    /// What it is of.
    pub of: Subject<'a>,
    /// Row ids of the runs that it was made from: where one of them is no current one any more, the result is not stored.
    pub made_from: &'a [i64],
    /// Hash of everything that it depends on, and of nothing else; empty where it is to be made again whenever it is asked for.
    pub key: &'a str,
    /// The program.
    pub made_by: &'a MadeBy,
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

impl<T> StoredResult<T> {
    fn named_key(&self) -> (String, String) {
        (self.origin.name.clone(), self.origin.key.clone())
    }
}

/// What a result is of, and what it was made from and by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultOrigin {
    /// Row id.
    pub id: i64,
    /// Name of the group, or that which the run or the log has now.
    pub name: String,
    /// Hash of everything that it depends on.
    pub key: String,
    /// The program that made it.
    pub made_by: MadeBy,
    /// When, RFC 3339 UTC.
    pub made_at: String,
    /// Hash of its row, which states that of what is drawn.
    pub row_hash: RowHash,
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
impl Store {
    /// Stores results of a kind, each as the current one of what it is of, where the runs that it was made from still are
    /// current; tells of each whether it is stored.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn keep_results<T: ResultDocument>(
        &mut self,
        now: &str,
        kind: ResultKind,
        results: &[NewResult<'_, T>],
    ) -> Result<Vec<bool>, StoreError> {
        if results.is_empty() {
            return Ok(Vec::new());
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
            let condition = format!("kind = '{}' AND {}", kind.key(), kind.named("?1"));
            let mut names = names.iter();
            names.try_for_each(|name| retire(transaction, now, (&condition, name)))
        })
    }

    /// The current results of a kind, by name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn results<T: ResultDocument>(&self, kind: ResultKind) -> Result<Vec<StoredResult<T>>, StoreError> {
        let mut found = self.listed("reading results", RESULT, &list_of(kind), read)?;
        found.sort_by(|a: &StoredResult<T>, b| a.origin.name.cmp(&b.origin.name));
        Ok(found)
    }

    /// The same, read once for as long as nothing changes; `name` is of this kind understood as `T`, and of no other list.
    pub(super) fn all_results<T: ResultDocument + Send + Sync + 'static>(
        &self,
        name: &'static str,
        kind: ResultKind,
    ) -> Result<Arc<Vec<StoredResult<T>>>, StoreError> {
        self.whole(name, |store| store.results(kind))
    }

    /// What the current results of a kind depend on, by name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn result_keys(&self, kind: ResultKind) -> Result<BTreeMap<String, String>, StoreError> {
        let read = |row: &Row<'_>| Ok((row.get("of_name")?, row.get("key")?));
        let keys = match kind {
            // Who asks for the keys of fits asks for the fits, too.
            ResultKind::Fit => self.fits()?.iter().map(StoredResult::named_key).collect(),
            _ => self.listed("reading what results depend on", RESULT, &list_of(kind), read)?,
        };
        Ok(keys.into_iter().collect())
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
        let (key, of) = (kind.key(), kind.named("?2"));
        let (condition, values): (String, Vec<&dyn ToSql>) = match &when {
            When::Now => ("superseded_at IS NULL".to_owned(), vec![&key, &name]),
            When::Before => (
                format!(
                    "id < (SELECT id FROM result WHERE kind = ?1 AND {of} AND superseded_at IS NULL)
                     AND document NOT LIKE '{{\"issue\"%'"
                ),
                vec![&key, &name],
            ),
            When::At(moment) => (
                "made_at <= ?3 AND (superseded_at IS NULL OR superseded_at > ?3)".to_owned(),
                vec![&key, &name, moment],
            ),
        };
        let rest = format!("WHERE kind = ?1 AND {of} AND {condition} ORDER BY id DESC LIMIT 1");
        let found = self.kept("reading a result", RESULT, ("", &rest), values.as_slice(), read)?;
        Ok(found.into_iter().next())
    }

    /// What pages draw of the current result of a name: the fields that [`ResultDocument::DRAWN`] names. None where there is
    /// nothing.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn drawn<D: DeserializeOwned>(&self, kind: ResultKind, name: &str) -> Result<Option<D>, StoreError> {
        let rest = format!("{} AND drawn IS NOT NULL", kind.current());
        let found = self.kept(
            "reading curves",
            RESULT,
            (", drawn", &rest),
            [kind.key(), name],
            |row| {
                check_drawn(row)?;
                let drawn: Vec<u8> = row.get("drawn")?;
                Ok(unpacked_json("curves", &drawn)?)
            },
        )?;
        Ok(found.into_iter().next())
    }

    /// Current results, in words, of a run or log that is no current one.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn stray_results(&self) -> Result<Vec<String>, StoreError> {
        let rest = "WHERE superseded_at IS NULL AND run_id IS NOT NULL
                    AND run_id NOT IN (SELECT id FROM run WHERE superseded_at IS NULL) ORDER BY id";
        let told = |row: &Row<'_>| Ok(row.get::<_, String>("told_of_row")?);
        self.kept("looking for results of no run", RESULT, ("", rest), [], told)
    }

    /// What is wrong with what is drawn of results, current and earlier ones, in the order in which they were made.
    pub(super) fn check_all_drawn(&self) -> Result<Vec<StoreError>, StoreError> {
        let doing = "checking curves";
        // A document that is damaged is told with its row.
        let sql = RESULT.select(", drawn", "ORDER BY id");
        let found = self.rows(doing, &sql, [], |row| Ok(check_drawn(row).err()))?;
        Ok(found.into_iter().flatten().map(self.named(doing)).collect())
    }
}

fn list_of(kind: ResultKind) -> String {
    format!("result {}", kind.key())
}

/// Stores results of a kind, each as the current one of what it is of; tells of each whether it is stored: what was made from a
/// revision that is no current one is not.
pub(super) fn keep<T: ResultDocument>(
    transaction: &Transaction<'_>,
    now: &str,
    kind: ResultKind,
    results: &[NewResult<'_, T>],
) -> Result<Vec<bool>, StepError> {
    let mut known = BTreeMap::new();
    let mut kept = Vec::with_capacity(results.len());
    for result in results {
        let mut is_so = true;
        for &run_id in result.made_from {
            is_so &= is_current(transaction, &mut known, run_id)?;
        }
        if is_so {
            insert(transaction, now, kind, result)?;
        }
        kept.push(is_so);
    }
    Ok(kept)
}

/// Whether a revision is a current one; `known` are those that were looked at.
fn is_current(
    transaction: &Transaction<'_>,
    known: &mut BTreeMap<i64, bool>,
    run_id: i64,
) -> Result<bool, StepError> {
    if let Some(is_so) = known.get(&run_id) {
        return Ok(*is_so);
    }
    let is_so = RunRow::current(transaction, run_id)?.is_some();
    known.insert(run_id, is_so);
    Ok(is_so)
}

fn insert<T: ResultDocument>(
    transaction: &Transaction<'_>,
    now: &str,
    kind: ResultKind,
    result: &NewResult<'_, T>,
) -> Result<(), StepError> {
    let (column, of): (_, &dyn ToSql) = match &result.of {
        Subject::Run(id) => ("run_id", id),
        Subject::Named(name) => ("name", name),
    };
    let condition = format!("kind = '{}' AND {column} = ?1", kind.key());
    retire(transaction, now, (&condition, of))?;
    let (document, drawn) = written(kind, result.found)?;
    let condition = format!("{condition} AND superseded_at IS NULL");
    transaction.change(RESULT, (&condition, of), || {
        let sql = format!(
            "INSERT INTO result (kind, {column}, key, version, built_from, document, made_at, drawn)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"
        );
        transaction.prepare_cached(&sql)?.execute(params![
            kind.key(),
            of,
            result.key,
            result.made_by.version,
            result.made_by.built_from,
            document,
            now,
            drawn
        ])?;
        Ok(())
    })
}

/// Takes results out of those that are current: those that the condition finds, which has one parameter.
fn retire(transaction: &Transaction<'_>, now: &str, of: (&str, &dyn ToSql)) -> Result<(), StepError> {
    let sql = format!("SELECT id FROM result WHERE superseded_at IS NULL AND {}", of.0);
    let mut statement = transaction.prepare_cached(&sql)?;
    let ids = statement.query_map([of.1], |row| row.get::<_, i64>(0))?;
    for id in ids.collect::<rusqlite::Result<Vec<_>>>()? {
        transaction.change(RESULT, ("id = ?1", &id), || {
            transaction
                .prepare_cached("UPDATE result SET superseded_at = ?2 WHERE id = ?1")?
                .execute(params![id, now])?;
            Ok(())
        })?;
    }
    Ok(())
}

/// Takes all that was found of a run, or a log, out of what is current.
pub(super) fn retire_of_run(transaction: &Transaction<'_>, now: &str, run_id: i64) -> Result<(), StepError> {
    retire(transaction, now, ("run_id = ?1", &run_id))
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
        let bytes = packed_json("curves", &drawn)?;
        let hash = blake3::hash(&bytes).to_hex().to_string();
        fields.insert(DRAWN_HASH.to_owned(), Value::String(hash));
        packed = Some(bytes);
    }
    Ok((to_json(kind.words(), &Document::Found(value))?, packed))
}

/// A result from a row of [`RESULT`].
fn read<T: ResultDocument>(row: &Row<'_>) -> Result<StoredResult<T>, StepError> {
    let found = match from_json("a result", text_in(row, "document")?)? {
        Document::Found(found) => Ok(found),
        Document::Issue(issue) => Err(issue),
    };
    let origin = read_origin(row)?;
    Ok(StoredResult { origin, found })
}

fn read_origin(row: &Row<'_>) -> Result<ResultOrigin, StepError> {
    Ok(ResultOrigin {
        id: row.get("id")?,
        name: row.get("of_name")?,
        key: row.get("key")?,
        made_by: MadeBy::new(
            row.get::<_, String>("version")?,
            row.get::<_, String>("built_from")?,
        ),
        made_at: row.get("made_at")?,
        row_hash: stated(row)?,
    })
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
    let document: Document<Hash> = from_json("a result", text_in(row, "document")?)?;
    Ok(match document {
        Document::Found(found) => found.drawn_hash,
        Document::Issue(_) => None,
    })
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
        what: format!("the {kind} of {}", text("of_name")),
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
