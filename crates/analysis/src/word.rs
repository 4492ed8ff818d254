//! Words of closed lists, such as keys of parameters, that are read back from what was kept.

use std::collections::BTreeSet;
use std::sync::{Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Deserializer};

/// A word that is there for as long as the program runs.
pub type Word = &'static str;

/// The word of that text: it is kept for as long as the program runs, once, for such words are few.
pub(crate) fn word(text: &str) -> Word {
    static KNOWN: OnceLock<Mutex<BTreeSet<Word>>> = OnceLock::new();
    let known = KNOWN.get_or_init(Mutex::default);
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    match known.get(text) {
        Some(kept) => kept,
        None => {
            let kept: Word = Box::leak(text.into());
            known.insert(kept);
            kept
        }
    }
}

/// Reads a word.
pub(crate) fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Word, D::Error> {
    String::deserialize(from).map(|text| word(&text))
}

/// Reads a word that may not be there.
pub(crate) fn read_or_none<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Word>, D::Error> {
    Ok(Option::<String>::deserialize(from)?.map(|text| word(&text)))
}
