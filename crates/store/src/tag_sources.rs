//! What the tags of runs came from: by it anyone knows whether they hold.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::new_run::RunRow;
use super::rows::RUN;
use super::runs::measurements;
use super::{Store, StoreError};
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunKind, RunRecord};

/// What the tags of a run came from.
#[derive(Debug, Clone, PartialEq)]
pub struct TagSources {
    /// Row id of the run.
    pub run_id: i64,
    /// The run's name.
    pub path: String,
    /// BLAKE3 over everything that its tags came from.
    pub digest: String,
    /// Paths of its files, in order.
    pub files: Vec<String>,
    /// What words of people hang on that hold of it.
    pub said_of: Vec<String>,
    /// Its chosen `started_at`.
    pub started_at: Option<String>,
    /// First and last time of its readings, s.
    pub times: Option<(f64, f64)>,
    /// What was noticed of it.
    pub issues: Vec<Issue>,
    /// Whether no file lies under the names of its files any more, as the journal says of each. Another file may hold their
    /// bytes.
    pub is_gone: bool,
}

impl Store {
    /// What the tags of every current run came from, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn tag_sources(&self) -> Result<Vec<TagSources>, StoreError> {
        let _moment = self.snapshot()?;
        let rows = self.all_current_rows()?;
        let missing = self.missing_paths()?;
        let current = measurements(&rows);
        let of = |run: &Arc<RunRow>| TagSources::of(run, &current, &missing);
        Ok(rows.iter().map(of).collect())
    }

    /// The same of those of them that have these row ids, each looked up by itself: no other run is read.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn tag_sources_of(&self, ids: &BTreeSet<i64>) -> Result<Vec<TagSources>, StoreError> {
        let _moment = self.snapshot()?;
        let missing = self.missing_paths()?;
        let mut found = Vec::new();
        for run in self.current_rows_of(ids.iter().copied())? {
            let mut current = BTreeSet::new();
            for one in run.earlier_and_files() {
                if self.is_measurement_of_now(one)? {
                    current.insert(one);
                }
            }
            found.push(TagSources::of(&run, &current, &missing));
        }
        Ok(found)
    }

    /// Those current runs of all kinds that have these row ids, each looked up by itself, without fits and other names of their
    /// files: those of a kind by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_of(&self, ids: impl Iterator<Item = i64>) -> Result<Vec<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        let mut rows = self.current_rows_of(ids)?;
        rows.sort_by_key(|run| RunKind::ALL.iter().position(|kind| *kind == run.kind));
        self.records(&rows, &BTreeMap::new())
    }

    /// By path.
    fn current_rows_of(&self, ids: impl Iterator<Item = i64>) -> Result<Vec<RunRow>, StoreError> {
        let rest = ("", "WHERE id = ?1 AND superseded_at IS NULL");
        let mut rows = Vec::new();
        for id in ids {
            rows.extend(self.kept("reading a run", RUN, rest, [id], RunRow::read)?);
        }
        rows.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(rows)
    }

    /// Whether a current run is that measurement.
    fn is_measurement_of_now(&self, measurement: &str) -> Result<bool, StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM run WHERE measurement = ?1 AND superseded_at IS NULL)";
        let doing = "looking for a measurement";
        let found = self.rows(doing, sql, [measurement], |row| Ok(row.get::<_, bool>(0)?))?;
        Ok(found == [true])
    }
}

impl TagSources {
    fn of(run: &RunRow, current: &BTreeSet<&str>, missing: &BTreeSet<String>) -> TagSources {
        let channels = run.reading.channels.iter().map(|channel| &channel.summary);
        let firsts = channels.clone().filter_map(|channel| channel.first_time_s);
        let lasts = channels.filter_map(|channel| channel.last_time_s);
        let files: Vec<String> = run.reading.files.iter().map(|file| file.path.clone()).collect();
        TagSources {
            run_id: run.id,
            path: run.path.clone(),
            digest: run.tag_digest.clone(),
            said_of: run.said_of(current),
            started_at: run.tagging.chosen.get(keys::STARTED_AT).cloned(),
            times: firsts.reduce(f64::min).zip(lasts.reduce(f64::max)),
            issues: run.issues().cloned().collect(),
            is_gone: files.iter().all(|file| missing.contains(file)),
            files,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;

    /// Of runs that follow others, and of one whose earlier bytes lie in the folder again.
    #[test]
    fn a_run_by_itself_comes_from_what_it_comes_from_among_all() {
        let mut store = Store::in_memory().unwrap();
        let mut save = |path: &str, reading: f64| {
            let run = new_run(path, RunKind::Actuation, &[1e-3, reading]);
            store.save_runs("2026-01-01T00:00:00Z", &[], &[run]).unwrap();
        };
        save("runs/a.csv", 1.0);
        save("runs/a.csv", 2.0);
        save("runs/b.csv", 1.0);
        save("runs/c.csv", 3.0);
        save("runs/c.csv", 4.0);
        let all = store.tag_sources().unwrap();
        let followed: Vec<usize> = all.iter().map(|one| one.said_of.len()).collect();
        for one in &all {
            let alone = store.tag_sources_of(&[one.run_id].into()).unwrap();
            assert_eq!(alone, std::slice::from_ref(one));
        }
        assert_eq!(all.len(), 3);
        assert!(followed.windows(2).any(|two| two[0] != two[1]), "{followed:?}");
        // The first revision of a run, which is current no more.
        assert_eq!(store.tag_sources_of(&[1].into()).unwrap(), []);
        let ids = all.iter().rev().map(|one| one.run_id);
        let runs = store.runs_of(ids).unwrap();
        assert_eq!(runs, store.runs().unwrap());
    }
}
