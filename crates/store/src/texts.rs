//! What a column holds as text: JSON, and the keys of closed vocabularies.

use super::StoreError;

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

/// The closed vocabulary's member that is stored under `key`.
pub(super) fn from_key<T>(
    what: &'static str,
    key: &str,
    find: fn(&str) -> Option<T>,
) -> Result<T, StoreError> {
    find(key).ok_or_else(|| StoreError::BadValue {
        what,
        detail: key.to_owned(),
    })
}
