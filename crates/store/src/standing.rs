//! Readings that stand in two runs, and other names of runs.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::new_run::RunRow;
use super::results::{self, NewResult, ResultDocument, ResultKind, Subject};
use super::{StepError, Store, StoreError, Transaction};
use ieap_domain::{MadeBy, RunKind, SameReadings};

/// A few readings of a run as hashes, the smallest ones: runs that hold the same readings share some.
#[derive(Serialize, Deserialize)]
struct Marks {
    marks: Vec<u64>,
}

impl ResultDocument for Marks {}

/// Runs in which the readings of a run stand too.
#[derive(Serialize, Deserialize)]
struct Same {
    standing_in: Vec<StandingIn>,
}

/// One of them, by what tells its readings: a name may change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct StandingIn {
    data_hash: String,
    /// Whether the other holds nothing more.
    whole: bool,
}

impl ResultDocument for Same {}

impl Store {
    /// Row ids of current actuation runs without marks of that version. No marks are read for it: what is damaged in a key only
    /// makes them again.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn unmarked(&self, version: u32) -> Result<Vec<i64>, StoreError> {
        let _moment = self.snapshot()?;
        let sql =
            "SELECT run_id, key FROM result WHERE kind = ?1 AND superseded_at IS NULL AND run_id IS NOT NULL";
        let read = |row: &rusqlite::Row<'_>| Ok((row.get::<_, i64>("run_id")?, row.get::<_, String>("key")?));
        let doing = "looking which runs have marks";
        let known = self.rows(doing, sql, [ResultKind::Marks.key()], read)?;
        let known: BTreeMap<i64, String> = known.into_iter().collect();
        let runs = self.current_rows(RunKind::Actuation)?;
        let is_marked = |run: &&Arc<RunRow>| {
            known
                .get(&run.id)
                .is_some_and(|own| *own == key(version, &run.data_hash))
        };
        let unmarked = runs.iter().filter(|run| !is_marked(run)).map(|run| run.id);
        let mut unmarked: Vec<i64> = unmarked.collect();
        unmarked.sort_unstable();
        Ok(unmarked)
    }

    /// Current actuation runs by row id, each with its marks; empty where it has none of that version.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn marks(&self, version: u32) -> Result<BTreeMap<i64, Option<Vec<u64>>>, StoreError> {
        let _moment = self.snapshot()?;
        let stored = self.results::<Marks>(ResultKind::Marks)?.into_iter();
        let mut stored: BTreeMap<String, _> = stored
            .map(|stored| (stored.origin.name.clone(), stored))
            .collect();
        let of = |run: &Arc<RunRow>| {
            let marks = stored.remove(&run.path);
            let marks = marks.filter(|stored| stored.origin.key == key(version, &run.data_hash));
            (run.id, marks.and_then(|stored| Some(stored.found.ok()?.marks)))
        };
        let runs = self.current_rows(RunKind::Actuation)?;
        Ok(runs.iter().map(of).collect())
    }

    /// Stores the marks of runs that had none, and in which runs their readings stand too.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_marks(
        &mut self,
        now: &str,
        version: u32,
        marks: &[(i64, Vec<u64>)],
        same: &[SameReadings],
    ) -> Result<(), StoreError> {
        let rows = self.current_rows(RunKind::Actuation)?;
        let runs: BTreeMap<i64, &RunRow> = rows.iter().map(|run| (run.id, &**run)).collect();
        let mut known = self.standing_in()?;
        let mut changed = BTreeSet::new();
        for pair in same {
            let (Some(run), Some(other)) = (runs.get(&pair.run_id), runs.get(&pair.in_run_id)) else {
                continue;
            };
            let all = known.entry(run.path.clone()).or_default();
            all.retain(|known| known.data_hash != other.data_hash);
            let (data_hash, whole) = (other.data_hash.clone(), pair.whole);
            all.push(StandingIn { data_hash, whole });
            changed.insert(pair.run_id);
        }
        let marked = marks.iter().filter_map(|(run_id, marks)| {
            let run = *runs.get(run_id)?;
            let marks = marks.clone();
            Some((run, key(version, &run.data_hash), Marks { marks }))
        });
        let marked: Vec<(&RunRow, String, Marks)> = marked.collect();
        let standing = changed.iter().map(|run_id| {
            let run = runs[run_id];
            let standing_in = known.get(&run.path).cloned().unwrap_or_default();
            (run, run.data_hash.clone(), Same { standing_in })
        });
        let standing: Vec<(&RunRow, String, Same)> = standing.collect();
        // Of a run that is another one by now they are made at the next look.
        self.write("storing marks of readings", now, |transaction| {
            keep_of_runs(transaction, now, ResultKind::Marks, &marked)?;
            keep_of_runs(transaction, now, ResultKind::Same, &standing)
        })
    }

    /// Where the readings of runs stand too, by the runs' names.
    fn standing_in(&self) -> Result<BTreeMap<String, Vec<StandingIn>>, StoreError> {
        let stored = self.all_results::<Same>("copies", ResultKind::Same)?;
        let of = |stored: &super::StoredResult<Same>| {
            let same = stored.found.as_ref().ok()?;
            Some((stored.origin.name.clone(), same.standing_in.clone()))
        };
        Ok(stored.iter().filter_map(of).collect())
    }

    /// Current runs whose readings stand in another current run, in the order of their names.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn same_readings(&self) -> Result<Vec<SameReadings>, StoreError> {
        let _moment = self.snapshot()?;
        let standing_in = self.standing_in()?;
        if standing_in.is_empty() {
            return Ok(Vec::new());
        }
        let runs = self.current_rows(RunKind::Actuation)?;
        let mut found = Vec::new();
        for run in runs.iter().filter(|run| standing_in.contains_key(&run.path)) {
            for other in runs.iter().filter(|other| other.id != run.id) {
                let mut pairs = standing_in[&run.path].iter();
                let pair = pairs.find(|pair| pair.data_hash == other.data_hash);
                found.extend(pair.map(|pair| SameReadings {
                    run_id: run.id,
                    in_run_id: other.id,
                    whole: pair.whole,
                }));
            }
        }
        Ok(found)
    }

    /// Other names under which the readings of current runs lie, by the run's row id, each list by name: files with the same
    /// bytes, and runs with the same readings. A file that is a part of its run only is not among them.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn other_names(&self) -> Result<BTreeMap<i64, Vec<String>>, StoreError> {
        let _moment = self.snapshot()?;
        let aliases = self.aliases()?;
        let same = self.same_readings()?;
        let mut names: BTreeMap<i64, BTreeSet<String>> = BTreeMap::new();
        if aliases.is_empty() && same.is_empty() {
            return Ok(BTreeMap::new());
        }
        let runs = self.all_current_rows()?;
        for run in &runs {
            if let [file] = &run.reading.files[..]
                && let Some(paths) = aliases.get(&file.hash)
            {
                names.entry(run.id).or_default().extend(paths.iter().cloned());
            }
        }
        let by_id: BTreeMap<i64, &RunRow> = runs.iter().map(|run| (run.id, &**run)).collect();
        for pair in same.iter().filter(|pair| pair.whole) {
            let other = by_id.get(&pair.in_run_id).map(|run| run.path.clone());
            names.entry(pair.run_id).or_default().extend(other);
        }
        let listed = |(run_id, paths): (i64, BTreeSet<String>)| (run_id, paths.into_iter().collect());
        Ok(names.into_iter().map(listed).collect())
    }
}

/// Stores what was found of runs, each with its key.
fn keep_of_runs<T: ResultDocument>(
    transaction: &Transaction<'_>,
    now: &str,
    kind: ResultKind,
    found: &[(&RunRow, String, T)],
) -> Result<(), StepError> {
    for (run, key, found) in found {
        let result = NewResult {
            of: Subject::Run(run.id),
            made_from: &[run.id],
            key,
            made_by: &MadeBy::default(),
            found: Ok(found),
        };
        results::keep(transaction, now, kind, &[result])?;
    }
    Ok(())
}

fn key(version: u32, data_hash: &str) -> String {
    format!("{version} {data_hash}")
}
