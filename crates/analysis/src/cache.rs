//! Values that take long to make, kept from one report to the next, each under a hash over all that it is made from.
//!
//! They stand in one file beside the pages of a report, as these are kept, and not in the database: nothing is lost with
//! them, so that they need no table, no seal, no word in the journal and no place in a backup, and what they are made from
//! may change its form with every version of the program. What belongs to the state of the campaign belongs into the
//! database.

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::sync::{Mutex, PoisonError};

use ciborium::Value;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Values by the hash of what they were made from, as CBOR, which gives every number back as it was, infinite ones too.
#[derive(Debug, Default)]
pub struct Cache {
    program: String,
    earlier: HashMap<String, Vec<u8>>,
    /// Those that were asked for: what nobody asks for any more is not kept on.
    asked: Mutex<BTreeMap<String, Vec<u8>>>,
}

impl Cache {
    /// None yet, to be made by that program.
    pub fn by(program: &str) -> Cache {
        Cache {
            program: program.to_owned(),
            ..Cache::default()
        }
    }

    /// Those that a file holds; none where it is not what [`Cache::bytes`] gave, or another program made them.
    pub fn read(bytes: &[u8], program: &str) -> Option<Cache> {
        let entry = |(hash, value): (Value, Value)| Some((hash.into_text().ok()?, value.into_bytes().ok()?));
        let (by, map) = ciborium::from_reader::<(String, Value), _>(bytes).ok()?;
        let entries = map.into_map().ok().filter(|_| by == program)?;
        Some(Cache {
            earlier: entries.into_iter().filter_map(entry).collect(),
            ..Cache::by(program)
        })
    }

    /// The value that was made from what has that hash; none where it was not kept.
    pub fn earlier<T: DeserializeOwned>(&self, hash: &str) -> Option<T> {
        let bytes = self.earlier.get(hash)?;
        let value = ciborium::from_reader(bytes.as_slice()).ok()?;
        self.note(hash, bytes.clone());
        Some(value)
    }

    /// Keeps what was made from what has that hash.
    pub fn put<T: Serialize>(&self, hash: &str, value: &T) {
        let mut bytes = Vec::new();
        // What cannot be written is made anew the next time.
        if ciborium::into_writer(value, &mut bytes).is_ok() {
            self.note(hash, bytes);
        }
    }

    fn note(&self, hash: &str, bytes: Vec<u8>) {
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        asked.insert(hash.to_owned(), bytes);
    }

    /// The hashes of the values that were asked for.
    #[cfg(test)]
    pub(crate) fn hashes(&self) -> std::collections::BTreeSet<String> {
        let asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        asked.keys().cloned().collect()
    }

    /// The values that were asked for, as a file holds them: the same bytes whether they were kept or made.
    pub fn bytes(&self) -> Vec<u8> {
        let asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let entry =
            |(hash, bytes): (&String, &Vec<u8>)| (Value::Text(hash.clone()), Value::Bytes(bytes.clone()));
        let mut bytes = Vec::new();
        // Writing into memory cannot fail.
        let map = Value::Map(asked.iter().map(entry).collect());
        let _ = ciborium::into_writer(&(&self.program, map), &mut bytes);
        bytes
    }
}

/// A hash over values as they print for debugging, which tells any two apart that differ.
#[derive(Default)]
pub struct Hash(blake3::Hasher);

impl Hash {
    /// The same with another value.
    pub fn with(mut self, value: &dyn fmt::Debug) -> Hash {
        // Values print in many small parts: hashed one by one these take longer than all of the text.
        self.0.update(format!("{value:?}\n").as_bytes());
        self
    }

    /// Hexadecimal.
    pub fn text(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_back_as_it_was_and_only_under_its_hash() {
        let made = Cache::by("a program");
        let value = (
            Some(f64::INFINITY),
            [0.1, -0.0, f64::MIN_POSITIVE],
            "x".to_owned(),
        );
        made.put("a", &value);
        made.put("b", &f64::NAN);
        assert!(Cache::read(&made.bytes(), "another").is_none());
        let read = Cache::read(&made.bytes(), "a program").unwrap();
        assert_eq!(read.earlier("a"), Some(value));
        assert!(read.earlier::<f64>("b").unwrap().is_nan());
        assert_eq!(read.earlier::<f64>("c"), None);
        assert_eq!(read.bytes(), made.bytes());
    }

    #[test]
    fn what_is_not_asked_for_is_not_kept_on_and_what_is_torn_not_read() {
        let made = Cache::by("p");
        made.put("a", &1.0);
        made.put("b", &2.0);
        let bytes = made.bytes();
        let read = Cache::read(&bytes, "p").unwrap();
        assert_eq!(read.earlier("b"), Some(2.0));
        assert_eq!(Cache::read(&read.bytes(), "p").unwrap().earlier::<f64>("a"), None);
        assert!(Cache::read(&bytes[..bytes.len() - 1], "p").is_none());
        // Of another form than is asked for.
        assert_eq!(Cache::read(&bytes, "p").unwrap().earlier::<String>("b"), None);
    }

    #[test]
    fn values_that_differ_have_other_hashes() {
        let of = |a: f64, b: &str| Hash::default().with(&a).with(&b).text();
        assert_eq!(of(0.1, "x"), of(0.1, "x"));
        assert_ne!(of(0.1, "x"), of(0.1f64.next_up(), "x"));
        assert_ne!(of(0.1, "x\"\n\"y"), of(0.1, "x"));
    }
}
