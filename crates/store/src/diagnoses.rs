//! Diagnoses: what is current, what is new. Old ones stay.

use ieap_domain::string_enum;

use rusqlite::{OptionalExtension, params};

use super::columns::{count_in, json_in, key_in, to_json};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::GroupDiagnosis;

string_enum! {
    /// What a diagnosis is about.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum DiagnosisKind {
        /// Runs that one parameter set describes.
        Group = "group",
        /// One run alone.
        Run = "run",
    }
}

/// What a diagnosis was made from and by.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosisStamp {
    /// What it is about.
    pub kind: DiagnosisKind,
    /// Name of the group or the run.
    pub name: String,
    /// Row ids of its runs.
    pub run_ids: Vec<i64>,
    /// Hash of everything that the finding depends on.
    pub input_hash: String,
    /// Hash of the library of effects.
    pub library: String,
    /// Seed of the draws.
    pub seed: u64,
    /// Number of draws.
    pub draws: usize,
    /// Version of the program.
    pub code_version: String,
}

/// A current diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredDiagnosis {
    /// What it is about.
    pub kind: DiagnosisKind,
    /// Name of the group or the run.
    pub name: String,
    /// Hash of everything that the finding depends on.
    pub input_hash: String,
    /// Hash of the library of effects.
    pub library: String,
    /// Seed of the draws.
    pub seed: u64,
    /// Number of draws.
    pub draws: usize,
    /// Version of the program.
    pub code_version: String,
    /// When it was made, RFC 3339 UTC.
    pub made_at: String,
    /// What was found.
    pub found: GroupDiagnosis,
}

impl Store {
    /// Current diagnoses by kind and name; those of a run that has a newer revision are left out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn diagnoses(&self) -> Result<Vec<StoredDiagnosis>, StoreError> {
        let doing = "reading diagnoses";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Diagnoses)?;
        let current = "SELECT id FROM diagnosis WHERE superseded_at IS NULL ORDER BY kind, name";
        let ids: Vec<i64> = self.rows(doing, current, [], |row| Ok(row.get(0)?))?;
        let sql = "SELECT kind, name, input_hash, library, seed, draws, code_version, made_at, document
                   FROM diagnosis WHERE id = ?1 AND NOT EXISTS (
                       SELECT 1 FROM diagnosis_run JOIN run ON run.id = diagnosis_run.run_id
                       WHERE diagnosis_run.diagnosis_id = diagnosis.id AND run.superseded_at IS NOT NULL)";
        let mut found = Vec::new();
        for id in ids {
            self.check_seal(&Subject::Diagnosis(id))?;
            found.extend(self.rows(doing, sql, [id], read)?);
        }
        Ok(found)
    }

    /// Stores diagnoses, each as the current one of its kind and name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_diagnoses(
        &mut self,
        now: &str,
        diagnoses: &[(DiagnosisStamp, GroupDiagnosis)],
    ) -> Result<(), StoreError> {
        if diagnoses.is_empty() {
            return Ok(());
        }
        self.write("storing diagnoses", now, |transaction| {
            diagnoses
                .iter()
                .try_for_each(|(stamp, found)| insert(transaction, now, stamp, found))
        })
    }

    /// Retires current diagnoses of groups and runs that are no more. Nothing is written where there is none.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn retire_diagnoses(
        &mut self,
        now: &str,
        gone: &[(DiagnosisKind, String)],
    ) -> Result<(), StoreError> {
        if gone.is_empty() {
            return Ok(());
        }
        self.write("retiring diagnoses", now, |transaction| {
            gone.iter()
                .try_for_each(|(kind, name)| retire(transaction, now, *kind, name))
        })
    }
}

fn read(row: &rusqlite::Row<'_>) -> Result<StoredDiagnosis, StepError> {
    let draws = count_in(row, "draws")?;
    let found: GroupDiagnosis = json_in(row, "document", "a diagnosis")?;
    Ok(StoredDiagnosis {
        kind: key_in(row, "kind", "a diagnosis's kind", DiagnosisKind::from_key)?,
        name: row.get("name")?,
        input_hash: row.get("input_hash")?,
        library: row.get("library")?,
        seed: row.get::<_, i64>("seed")?.cast_unsigned(),
        draws,
        code_version: row.get("code_version")?,
        made_at: row.get("made_at")?,
        found: GroupDiagnosis { draws, ..found },
    })
}

fn retire(
    transaction: &Transaction<'_>,
    now: &str,
    kind: DiagnosisKind,
    name: &str,
) -> Result<(), StepError> {
    transaction.changes(Subject::Diagnoses)?;
    let current: Option<i64> = transaction
        .prepare_cached("SELECT id FROM diagnosis WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL")?
        .query_row(params![kind.key(), name], |row| row.get(0))
        .optional()?;
    if let Some(id) = current {
        transaction.changes(Subject::Diagnosis(id))?;
    }
    let sql =
        "UPDATE diagnosis SET superseded_at = ?3 WHERE kind = ?1 AND name = ?2 AND superseded_at IS NULL";
    transaction
        .prepare_cached(sql)?
        .execute(params![kind.key(), name, now])?;
    Ok(())
}

fn insert(
    transaction: &Transaction<'_>,
    now: &str,
    stamp: &DiagnosisStamp,
    found: &GroupDiagnosis,
) -> Result<(), StepError> {
    retire(transaction, now, stamp.kind, &stamp.name)?;
    let sql = "INSERT INTO diagnosis (kind, name, input_hash, library, seed, draws, code_version, document, made_at)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
    transaction.prepare_cached(sql)?.execute(params![
        stamp.kind.key(),
        stamp.name,
        stamp.input_hash,
        stamp.library,
        stamp.seed.cast_signed(),
        stamp.draws as i64,
        stamp.code_version,
        to_json("a diagnosis", found)?,
        now,
    ])?;
    let id = transaction.last_insert_rowid();
    transaction.made(Subject::Diagnosis(id));
    for (ordinal, run_id) in stamp.run_ids.iter().enumerate() {
        transaction
            .prepare_cached("INSERT INTO diagnosis_run VALUES (?1, ?2, ?3)")?
            .execute(params![id, ordinal as i64, run_id])?;
    }
    if !found.condemned.is_empty() {
        transaction.changes(Subject::Condemned)?;
    }
    for condemned in &found.condemned {
        let sql = "INSERT INTO diagnosis_condemned
                   SELECT ?1, run.id, ?3 FROM run JOIN diagnosis_run ON diagnosis_run.run_id = run.id
                   WHERE diagnosis_run.diagnosis_id = ?1 AND +run.path = ?2";
        transaction
            .prepare_cached(sql)?
            .execute(params![id, condemned.run, condemned.reason])?;
    }
    Ok(())
}
