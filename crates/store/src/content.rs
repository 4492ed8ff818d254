//! What a database says, part by part, as hashes: the same for two databases that say the same of a campaign.
//!
//! Left out is what cannot be the same in a database that is made anew: row ids, when something was stored and by which
//! version of the program, fingerprints of files in the folder (size, time, inode), how often the database changed, the
//! readings of earlier revisions as an earlier reader had them, and results that are no longer current. A word of a person
//! is in it with who and when. The lines of the journal are left out, for they say what the rest says. Comparisons of models
//! are left out: they are made when they are asked for, and no other result is made from them. So are the rows shown in SQL,
//! which follow from everything else.

use std::collections::BTreeMap;

use rusqlite::Connection;

use super::seal::{Seal, add_row, finished};
use super::{StepError, Store, StoreError};

/// What a database says: a hash for each of its parts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Content {
    /// By the kind of part (`run`, `fit`, ...) and its name.
    parts: BTreeMap<(&'static str, String), Seal>,
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
        let differs = |(part, sum): &(&(&'static str, String), &Seal)| other.parts.get(part) != Some(sum);
        let own = self.parts.iter().filter(differs).map(|(part, _)| part.clone());
        let missing = other.parts.keys().filter(|part| !self.parts.contains_key(part));
        let mut all: Vec<_> = own.chain(missing.cloned()).collect();
        all.sort();
        all
    }
}

/// Kinds of parts with their queries; the first column of each is the part's name, the rows of a part follow each other.
const KINDS: [(&str, &[&str]); 13] = [
    ("run", &RUN),
    ("earlier revision", &["SELECT run.path || ' revision ' || run.revision, run_file.path, run_file.hash FROM run
        JOIN run_file ON run_file.run_id = run.id WHERE run.superseded_at IS NOT NULL
        ORDER BY run.path, run.revision, run_file.ordinal"]),
    ("tags set by hand", &["SELECT run_path, key, value, set_by, set_at FROM hand_tag NOT INDEXED ORDER BY run_path, id"]),
    ("how a run is fitted", &["SELECT run_path, asked FROM asked_fit ORDER BY run_path"]),
    ("words on a run", &["SELECT run_path, drops, why, said_by, said_at, data_hash FROM run_word NOT INDEXED ORDER BY run_path, id"]),
    ("fit", &[FIT]),
    ("modulus analysis", &[ANALYSIS]),
    ("diagnosis", &[DIAGNOSIS]),
    ("same readings", &["SELECT run.path, other.path, whole FROM same_readings
        JOIN run ON run.id = run_id AND run.superseded_at IS NULL
        JOIN run AS other ON other.id = in_run_id AND other.superseded_at IS NULL ORDER BY run.path, other.path"]),
    ("climate log", &[
        "SELECT path, revision, hash, format, reader_version, encoding, status, status_evidence, started_raw,
            clock_start_s, clock_offset, clock_set_back, original_metadata, issues, data_hash
         FROM climate_log WHERE superseded_at IS NULL ORDER BY path",
        "SELECT path, ordinal, sensor, quantity, raw_name, raw_unit, not_used, climate_series.readings, interval_s, first_s,
            length_s, time_of, time_blob, value_blob
         FROM climate_series JOIN climate_log ON id = log_id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    ]),
    ("climate", &["SELECT 'all sensors', document FROM climate_assessment"]),
    ("file", &["SELECT path, hash, state, issue, missing_since IS NOT NULL FROM source_file ORDER BY path"]),
    ("alarm", &["SELECT id, sample, parameter, chart, run_path, message, command_status FROM alarm ORDER BY id"]),
];

const RUN: [&str; 11] = [
    "SELECT path, kind, revision, state, no_steps, status, status_evidence, format, reader_version, technique,
        is_step_response, encoding, time_zero_is_step, original_metadata, drive, area_cm2, length_cm,
        electrode_resistance_ohm_per_sq, data_hash
     FROM run WHERE superseded_at IS NULL ORDER BY path",
    "SELECT run.path, ordinal, run_file.path, run_file.hash, size_bytes, archive_path FROM run
     JOIN run_file ON run_id = id JOIN content ON content.hash = run_file.hash
     WHERE superseded_at IS NULL ORDER BY run.path, ordinal",
    "SELECT path, ordinal, quantity, raw_name, raw_unit, position_mm, readings, excluded, first_time_s, last_time_s,
        first_value, last_value, time_of, time_blob, value_blob, excluded_blob
     FROM run JOIN channel ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, ordinal, key, value, source, detail, chosen
     FROM run JOIN tag ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, stage, severity, code, place, message, mend
     FROM run JOIN run_issue ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, ordinal, file, is_reference, first_channel, channels, time_column, time_unit, printed_column, stamp_raw,
        stamp_kind, stamp_local, stamp_offset, stamp_basis
     FROM run JOIN run_clock ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, clock, source, offset_s, standard_error_s, applied, detail
     FROM run JOIN clock_offset ON run_id = id WHERE superseded_at IS NULL ORDER BY path, clock, source",
    "SELECT path, ordinal, column_name, flag, from_s, to_s, readings, excludes
     FROM run JOIN sample_flag ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, ordinal, digest
     FROM run JOIN run_profile ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, ordinal, sensor, quantity, chosen, readings, mean, standard_deviation, drift_per_h, largest_deviation,
        largest_gap_s, accuracy
     FROM run JOIN run_climate ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
    "SELECT path, ordinal, sensor, quantity, time_blob, value_blob
     FROM run JOIN run_climate_curve ON run_id = id WHERE superseded_at IS NULL ORDER BY path, ordinal",
];

/// Current results, with what is drawn of them.
const FIT: &str = "SELECT name, key, document, drawn FROM result NOT INDEXED WHERE kind = 'fit' AND superseded_at IS NULL ORDER BY name";
const ANALYSIS: &str = "SELECT name, key, document, drawn FROM result NOT INDEXED WHERE kind = 'modulus' AND superseded_at IS NULL ORDER BY name";
const DIAGNOSIS: &str = "SELECT kind || ' ' || name, key, document FROM result NOT INDEXED
     WHERE kind IN ('group', 'run') AND superseded_at IS NULL ORDER BY kind, name";

impl Store {
    /// What the database says, whatever it says it with.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn content(&self) -> Result<Content, StoreError> {
        let _moment = self.snapshot()?;
        let mut content = Content::default();
        for (kind, queries) in KINDS {
            let found = parts(&self.connection, queries).map_err(self.named("hashing what is stored"))?;
            let named = found.into_iter().map(|(name, sum)| ((kind, name), sum));
            content.parts.extend(named);
        }
        Ok(content)
    }
}

/// The parts of a kind by name, each with the hash of all its rows.
fn parts(connection: &Connection, queries: &[&str]) -> Result<BTreeMap<String, Seal>, StepError> {
    let mut hashers: BTreeMap<String, blake3::Hasher> = BTreeMap::new();
    for (index, sql) in queries.iter().enumerate() {
        let mut statement = connection.prepare_cached(sql)?;
        let columns = statement.column_count();
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            // Every query names the part in its first column; the others, whatever they are called, are what is hashed.
            let hasher = hashers.entry(row.get(0)?).or_default();
            // Rows of one table must not pass for rows of another.
            hasher.update(&[index as u8]);
            add_row(hasher, row, columns)?;
        }
    }
    let sealed = hashers
        .into_iter()
        .map(|(name, hasher)| (name, finished(&hasher)));
    Ok(sealed.collect())
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
        assert_eq!(differs, [("tags set by hand", "runs/a.csv".to_owned())]);
    }
}
