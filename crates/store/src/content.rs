//! What a database says, part by part, as hashes: the same for two databases that say the same of a campaign.
//!
//! Left out is what cannot be the same in a database that is made anew: row ids, when something was stored and by which
//! version of the program, fingerprints of files in the folder (size, time, inode), how often the database changed, the
//! readings of earlier revisions as an earlier reader had them, and results that are no longer current. A word of a person
//! is in it with who and when; the other lines of the journal are not, for they say what the rest says. Comparisons of models
//! are left out: they are made when they are asked for, and no other result is made from them. So are the rows shown in SQL
//! and the curves of fits, which follow from everything else.

use std::collections::BTreeMap;

use rusqlite::Connection;

use super::rows::{RowHash, add_value, finished};
use super::{StepError, Store, StoreError};

/// What a database says: a hash for each of its parts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Content {
    /// By the kind of part (`run`, `fit`, ...) and its name.
    parts: BTreeMap<(&'static str, String), RowHash>,
}

impl Content {
    /// One hash over everything, hexadecimal.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for ((kind, name), sum) in &self.parts {
            for text in [kind.as_bytes(), name.as_bytes(), sum] {
                hasher.update(&(text.len() as u64).to_le_bytes());
                hasher.update(text);
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Parts of either that are not the same in the other: their kinds and names.
    pub fn differences(&self, other: &Content) -> Vec<(&'static str, String)> {
        let differs = |(part, sum): &(&(&'static str, String), &RowHash)| other.parts.get(part) != Some(sum);
        let own = self.parts.iter().filter(differs).map(|(part, _)| part.clone());
        let missing = other.parts.keys().filter(|part| !self.parts.contains_key(part));
        let mut all: Vec<_> = own.chain(missing.cloned()).collect();
        all.sort();
        all
    }
}

/// Kinds of parts with their queries; the first column of each is the part's name, the rows of a part follow each other.
const KINDS: [(&str, &str); 9] = [
    (
        "run",
        "SELECT path, kind, revision, state, data_hash, measurement, reading, tagging FROM run NOT INDEXED
        WHERE superseded_at IS NULL ORDER BY path",
    ),
    (
        "earlier revision",
        "SELECT run.path || ' revision ' || run.revision, run_file.path, run_file.hash FROM run
        JOIN run_file ON run_file.run_id = run.id WHERE run.superseded_at IS NOT NULL
        ORDER BY run.path, run.revision, run_file.ordinal",
    ),
    (
        "raw file",
        "SELECT hash, size_bytes, archive_path FROM content ORDER BY hash",
    ),
    (
        "word",
        "SELECT what || ' ' || name, line -> '$.entry' FROM journal_line NOT INDEXED WHERE name IS NOT NULL
        ORDER BY what, name, n",
    ),
    ("fit", FIT),
    ("modulus analysis", ANALYSIS),
    ("diagnosis", DIAGNOSIS),
    (
        "climate log",
        "SELECT path, revision, hash, reading FROM climate_log NOT INDEXED WHERE superseded_at IS NULL ORDER BY path",
    ),
    (
        "file",
        "SELECT path, hash, state, issue, missing_since IS NOT NULL FROM source_file ORDER BY path",
    ),
];

/// Current fits: of one that came from elsewhere nothing that is drawn is stored.
const FIT: &str = "SELECT path, key, CASE WHEN json_valid(document) THEN json_remove(document, '$.found.drawn_hash') ELSE document END
     FROM result NOT INDEXED JOIN run ON run.id = run_id
     WHERE result.kind = 'fit' AND result.superseded_at IS NULL ORDER BY path";
/// Current analyses of modulus logs, with what is drawn of them.
const ANALYSIS: &str = "SELECT path, key, document, drawn FROM result NOT INDEXED JOIN run ON run.id = run_id
     WHERE result.kind = 'modulus' AND result.superseded_at IS NULL ORDER BY path";
const DIAGNOSIS: &str = "SELECT result.kind || ' ' || coalesce(name, path) AS told, key, document
     FROM result NOT INDEXED LEFT JOIN run ON run.id = run_id
     WHERE result.kind IN ('group', 'run', 'climate') AND result.superseded_at IS NULL ORDER BY told";

impl Store {
    /// What the database says, whatever it says it with.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn content(&self) -> Result<Content, StoreError> {
        let _moment = self.snapshot()?;
        let mut content = Content::default();
        for (kind, sql) in KINDS {
            let found = parts(&self.connection, sql).map_err(self.named("hashing what is stored"))?;
            let named = found.into_iter().map(|(name, sum)| ((kind, name), sum));
            content.parts.extend(named);
        }
        // What a run stood in that is current no more is left out.
        let runs = self.all_current_rows()?;
        let name = |id: i64| runs.iter().find(|run| run.id == id).map_or("", |run| &run.path);
        for pair in self.same_readings()? {
            let part = (
                "same readings",
                format!("{} in {}", name(pair.run_id), name(pair.in_run_id)),
            );
            content
                .parts
                .insert(part, [u8::from(pair.whole); size_of::<RowHash>()]);
        }
        Ok(content)
    }
}

/// The parts of a kind by name, each with the hash of all its rows.
fn parts(connection: &Connection, sql: &str) -> Result<BTreeMap<String, RowHash>, StepError> {
    let mut hashers: BTreeMap<String, blake3::Hasher> = BTreeMap::new();
    let mut statement = connection.prepare_cached(sql)?;
    let columns = statement.column_count();
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let hasher = hashers.entry(row.get(0)?).or_default();
        for column in 1..columns {
            add_value(hasher, row.get_ref(column)?);
        }
    }
    let hashed = hashers
        .into_iter()
        .map(|(name, hasher)| (name, finished(&hasher)));
    Ok(hashed.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HandTag;

    #[test]
    fn the_queries_are_of_this_schema_and_what_a_person_said_counts() {
        let (mut one, mut other) = (Store::in_memory().unwrap(), Store::in_memory().unwrap());
        assert_eq!(one.content().unwrap(), other.content().unwrap());
        let tag = |value: &str| HandTag {
            run_path: "runs/a.csv".into(),
            key: "note".into(),
            value: Some(value.into()),
            set_by: "tester".into(),
            set_at: "2026-01-01T00:00:00Z".into(),
        };
        one.add_hand_tags("2026-01-01T00:00:00Z", &[tag("wet")]).unwrap();
        // When it was stored is no part of it.
        other
            .add_hand_tags("2026-02-02T00:00:00Z", &[tag("wet")])
            .unwrap();
        let (first, second) = (one.content().unwrap(), other.content().unwrap());
        assert_eq!(
            (first.hash(), first.differences(&second)),
            (second.hash(), Vec::new())
        );
        other
            .add_hand_tags("2026-02-02T00:00:00Z", &[tag("dry")])
            .unwrap();
        let differs = first.differences(&other.content().unwrap());
        assert_eq!(differs, [("word", "tag runs/a.csv".to_owned())]);
    }
}
