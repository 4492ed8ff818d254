//! What columns hold, by their names: numbers of things, JSON, and the keys of closed vocabularies.

use rusqlite::Row;

use super::{StepError, StoreError};

/// A column's number of things.
pub(super) fn count_in(row: &Row<'_>, column: &str) -> rusqlite::Result<usize> {
    Ok(row.get::<_, i64>(column)?.unsigned_abs() as usize)
}

/// The closed vocabulary's member that is stored under a column's key.
pub(super) fn key_in<T>(
    row: &Row<'_>,
    column: &str,
    what: &'static str,
    find: fn(&str) -> Option<T>,
) -> Result<T, StepError> {
    let key: String = row.get(column)?;
    let found = find(&key).ok_or(StoreError::BadValue { what, detail: key })?;
    Ok(found)
}

/// A column's text as JSON of `T`.
pub(super) fn json_in<T: serde::de::DeserializeOwned>(
    row: &Row<'_>,
    column: &str,
    what: &'static str,
) -> Result<T, StepError> {
    Ok(from_json(what, text_in(row, column)?)?)
}

/// A column's text where it lies: documents are long, and read at every look.
pub(super) fn text_in<'r>(row: &'r Row<'_>, column: &str) -> rusqlite::Result<&'r str> {
    let at = row.as_ref().column_index(column)?;
    let value = row.get_ref(at)?;
    let wrong = |error| rusqlite::Error::FromSqlConversionFailure(at, value.data_type(), Box::new(error));
    value.as_str().map_err(wrong)
}

/// A stored text as JSON of `T`.
pub(super) fn from_json<T: serde::de::DeserializeOwned>(
    what: &'static str,
    text: &str,
) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(|e| StoreError::BadValue {
        what,
        detail: e.to_string(),
    })
}

/// `value` as JSON text for a column.
pub(super) fn to_json<T: serde::Serialize>(what: &'static str, value: &T) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|e| StoreError::BadValue {
        what,
        detail: e.to_string(),
    })
}
