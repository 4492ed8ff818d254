//! Runs: which there are, and what is known of each but its readings.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rusqlite::{OptionalExtension, Row};

use super::fits::fill_in_fit;
use super::new_run::RunRow;
use super::readings::density_as_current;
use super::rows::RUN;
use super::{ResultKind, Store, StoreError};
use ieap_domain::{ChannelSummary, Issue, Quantity, RunKind, RunRecord, RunState, Standing};

/// The measurements of runs.
pub(super) fn measurements(rows: &[Arc<RunRow>]) -> BTreeSet<&str> {
    rows.iter().map(|run| run.measurement.as_str()).collect()
}

impl Store {
    /// Every current actuation run with tags, issues, channels (without readings) and its current fit, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        let mut records = self.current(RunKind::Actuation)?;
        self.fill_in_fits(&mut records)?;
        Ok(records)
    }

    /// Every current modulus log with tags, issues and channels (without readings), by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn dma_logs(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.current(RunKind::Dma)
    }

    /// Every current impedance spectrum with tags, issues and channels (without readings), by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn spectra(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.current(RunKind::Impedance)
    }

    /// The current actuation run of that name, looked up by itself; other names of its files are left out. What asking for it
    /// costs does not grow with the campaign.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_named(&self, path: &str) -> Result<Option<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        let row = self
            .current_run(path)?
            .filter(|row| row.kind == RunKind::Actuation);
        let Some(row) = row else { return Ok(None) };
        let mut record = self.records([&row], &BTreeMap::new())?.remove(0);
        fill_in_fit(&mut record, self.result(ResultKind::Fit, path)?);
        Ok(Some(record))
    }

    fn current(&self, kind: RunKind) -> Result<Vec<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        let rows = self.current_rows(kind)?;
        let aliases = if rows.is_empty() {
            BTreeMap::new()
        } else {
            self.aliases()?
        };
        self.records(rows.iter().map(Arc::as_ref), &aliases)
    }

    /// Every current run of a kind as it is stored, by path.
    pub(super) fn current_rows(&self, kind: RunKind) -> Result<Arc<Vec<Arc<RunRow>>>, StoreError> {
        let name = match kind {
            RunKind::Actuation => "run actuation",
            RunKind::Dma => "run dma",
            RunKind::Impedance => "run impedance",
        };
        self.whole(name, |store| {
            let read = |row: &Row<'_>| RunRow::read(row).map(Arc::new);
            let mut rows = store.listed("reading runs", RUN, name, read)?;
            rows.sort_by(|a, b| a.path.cmp(&b.path));
            Ok(rows)
        })
    }

    /// Every current run of all kinds, by path.
    pub(super) fn all_current_rows(&self) -> Result<Vec<Arc<RunRow>>, StoreError> {
        let _moment = self.snapshot()?;
        let mut rows = Vec::new();
        for kind in RunKind::ALL {
            rows.extend(self.current_rows(kind)?.iter().cloned());
        }
        rows.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(rows)
    }

    /// Hash of the readings of every current run as results are made of them ([`FitTask::data_hash`]), by row id.
    ///
    /// # Errors
    /// See [`StoreError`].
    ///
    /// [`FitTask::data_hash`]: super::FitTask::data_hash
    pub fn readings_hashes(&self) -> Result<BTreeMap<i64, String>, StoreError> {
        let rows = self.all_current_rows()?.into_iter();
        Ok(rows.map(|run| (run.id, run.readings_hash())).collect())
    }

    /// The current run of a name.
    fn current_run(&self, path: &str) -> Result<Option<RunRow>, StoreError> {
        let rest = ("", "WHERE path = ?1 AND superseded_at IS NULL");
        let found = self.kept("looking for a run", RUN, rest, [path], RunRow::read)?;
        Ok(found.into_iter().next())
    }

    /// A revision of a run by its row id.
    pub(super) fn run_of(&self, run_id: i64) -> Result<RunRow, StoreError> {
        let found = self.kept(
            "reading a run",
            RUN,
            ("", "WHERE id = ?1"),
            [run_id],
            RunRow::read,
        )?;
        found.into_iter().next().ok_or_else(|| StoreError::Damaged {
            what: format!("run {run_id}"),
        })
    }

    /// Names of current runs and their files' paths that hold the bytes of `hash`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_with_content(&self, hash: &str) -> Result<Vec<(String, String)>, StoreError> {
        let rest = "WHERE superseded_at IS NULL AND id IN (SELECT run_id FROM run_file WHERE hash = ?1) ORDER BY path";
        let runs = self.kept("looking for known bytes", RUN, ("", rest), [hash], RunRow::read)?;
        let of = |run: RunRow| {
            let files = run.reading.files.into_iter().filter(|file| file.hash == hash);
            let named: Vec<_> = files.map(|file| (run.path.clone(), file.path)).collect();
            named
        };
        Ok(runs.into_iter().flat_map(of).collect())
    }

    /// Paths and hashes of the files of the current run of that name, in order.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn contents_of(&self, path: &str) -> Result<Vec<(String, String)>, StoreError> {
        let files = self
            .current_run(path)?
            .map_or_else(Vec::new, |run| run.reading.files);
        Ok(files.into_iter().map(|file| (file.path, file.hash)).collect())
    }

    /// What the current run of a name is known by; of one that is not there the name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn measurement_of(&self, path: &str) -> Result<String, StoreError> {
        let run = self.current_run(path)?;
        Ok(run.map_or_else(|| path.to_owned(), |run| run.measurement))
    }

    /// The name that a measurement has now: of the current run that it is, or that follows it.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn name_of(&self, measurement: &str) -> Result<Option<String>, StoreError> {
        let rest = "WHERE measurement = ?1 AND superseded_at IS NULL ORDER BY path LIMIT 1";
        let path = |row: &Row<'_>| Ok(row.get("path")?);
        // What a current run is hangs on no other.
        let is_it = self.kept("looking for a measurement", RUN, ("", rest), [measurement], path)?;
        if let Some(name) = is_it.into_iter().next() {
            return Ok(Some(name));
        }
        let said_of = self.said_of_all()?.into_iter();
        let mut named = said_of.filter(|(_, of)| of.iter().any(|of| of == measurement));
        Ok(named.next().map(|(name, _)| name))
    }

    /// Row id of the current run of that name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn id_of_run(&self, path: &str) -> Result<Option<i64>, StoreError> {
        Ok(self.current_run(path)?.map(|run| run.id))
    }

    /// Whether a run of that name was stored, now or earlier.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn has_run(&self, path: &str) -> Result<bool, StoreError> {
        self.connection
            .prepare_cached("SELECT 1 FROM run WHERE path = ?1 LIMIT 1")
            .and_then(|mut statement| statement.query_row([path], |_| Ok(())).optional())
            .map(|found| found.is_some())
            .map_err(|e| self.failed("looking for a run", e))
    }

    /// Format id and reader version of the current run of that name, as `id/version`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn reader_of(&self, path: &str) -> Result<Option<String>, StoreError> {
        let run = self.current_run(path)?;
        Ok(run.map(|run| format!("{}/{}", run.reading.format, run.reading.reader_version)))
    }

    /// Names of current runs of all kinds, in order.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_names(&self) -> Result<Vec<String>, StoreError> {
        let _moment = self.snapshot()?;
        let mut names = Vec::new();
        for kind in RunKind::ALL {
            let list = format!("run {}", kind.key());
            names.extend(self.listed("reading names of runs", RUN, &list, |row| Ok(row.get("path")?))?);
        }
        names.sort();
        Ok(names)
    }

    /// What words of people hang on that hold of each current run, by its name.
    pub(super) fn said_of_all(&self) -> Result<BTreeMap<String, Vec<String>>, StoreError> {
        let rows = self.all_current_rows()?;
        let current = measurements(&rows);
        Ok(rows
            .iter()
            .map(|run| (run.path.clone(), run.said_of(&current)))
            .collect())
    }

    /// The same of the current run of a name; of one that is not there the name alone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn said_of(&self, path: &str) -> Result<Vec<String>, StoreError> {
        let rows = self.all_current_rows()?;
        let found = rows.binary_search_by(|run| run.path.as_str().cmp(path));
        Ok(found.map_or_else(
            |_| vec![path.to_owned()],
            |at| rows[at].said_of(&measurements(&rows)),
        ))
    }

    /// Whether the run's clock starts at the voltage step, and whether its technique is a step response.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn reading_facts(&self, run_id: i64) -> Result<(bool, bool), StoreError> {
        let reading = self.run_of(run_id)?.reading;
        Ok((reading.time_zero_is_step, reading.is_step_response))
    }

    /// Names of current runs and modulus logs that lack tags.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn untagged_runs(&self) -> Result<Vec<String>, StoreError> {
        self.runs_in_state(RunState::Untagged)
    }

    /// Names of current runs whose voltage does not go in steps.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_without_steps(&self) -> Result<Vec<String>, StoreError> {
        self.runs_in_state(RunState::NoSteps)
    }

    fn runs_in_state(&self, state: RunState) -> Result<Vec<String>, StoreError> {
        let rows = self.all_current_rows()?.into_iter();
        Ok(rows
            .filter(|row| row.state == state)
            .map(|row| row.path.clone())
            .collect())
    }

    /// Issues with that code of current runs and modulus logs, with the name of the run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn issues_of_code(&self, code: &str) -> Result<Vec<(String, Issue)>, StoreError> {
        let mut found = Vec::new();
        for row in self.all_current_rows()? {
            let of_code = row.issues().filter(|issue| issue.code == code);
            found.extend(of_code.map(|issue| (row.path.clone(), issue.clone())));
        }
        Ok(found)
    }

    /// What cannot be read of the tag files of current runs, and for how many runs each speaks, by place. Run sheets are
    /// files of their own ([`Store::unsettled_files`]).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn unreadable_tag_files(&self) -> Result<Vec<(Issue, usize)>, StoreError> {
        const CODES: [&str; 3] = ["tag-file-unreadable", "tag-file-not-toml", "tag-not-flat"];
        let mut found: BTreeMap<(String, String), (Issue, usize)> = BTreeMap::new();
        for row in self.all_current_rows()? {
            let mut of_run: Vec<&Issue> = Vec::new();
            for issue in row
                .tagging
                .issues
                .iter()
                .filter(|issue| CODES.contains(&&*issue.code))
            {
                let is_same = |other: &&Issue| (&other.place, &other.code) == (&issue.place, &issue.code);
                if !of_run.iter().any(is_same) {
                    of_run.push(issue);
                }
            }
            for issue in of_run {
                let key = (issue.place.to_string(), issue.code.to_string());
                found.entry(key).or_insert_with(|| (issue.clone(), 0)).1 += 1;
            }
        }
        Ok(found.into_values().collect())
    }

    /// Rows as records, in their order; a run's files have the other names that `aliases` gives by hash.
    pub(super) fn records<'r>(
        &self,
        rows: impl IntoIterator<Item = &'r RunRow>,
        aliases: &BTreeMap<String, Vec<String>>,
    ) -> Result<Vec<RunRecord>, StoreError> {
        let mut records = Vec::new();
        for row in rows {
            let mut record = record(row);
            for file in &mut record.files {
                file.aliases = aliases.get(&file.hash).cloned().unwrap_or_default();
            }
            self.fill_in_profiles(&mut record.origin)?;
            records.push(record);
        }
        Ok(records)
    }
}

/// A revision of a run without its fit.
fn record(row: &RunRow) -> RunRecord {
    let RunRow { reading, tagging, .. } = row;
    let channels = reading.channels.iter().map(|channel| channel.summary.clone());
    RunRecord {
        id: row.id,
        kind: row.kind,
        path: row.path.clone(),
        revision: row.revision,
        state: row.state,
        status: reading.status,
        status_evidence: reading.status_evidence.clone(),
        format: reading.format.clone(),
        reader_version: reading.reader_version,
        technique: reading.technique.clone(),
        files: reading.files.clone(),
        tags: tagging.tags.iter().map(|of| of.tag.clone()).collect(),
        channels: with_current(channels.collect(), tagging.area_cm2),
        origin: row.origin(),
        drive: tagging.drive.clone(),
        area_cm2: tagging.area_cm2,
        data_hash: row.data_hash.clone(),
        ingested_at: row.ingested_at.clone(),
        issues: row.issues().cloned().collect(),
        fit: None,
        fit_made_by: None,
        climate: tagging.climate.clone(),
        standing: Standing::default(),
    }
}

fn with_current(mut channels: Vec<ChannelSummary>, area_cm2: Option<f64>) -> Vec<ChannelSummary> {
    let quantities = channels.iter().map(|channel| channel.quantity);
    if let Some((index, area_cm2)) = density_as_current(area_cm2, quantities) {
        let channel = &mut channels[index];
        channel.quantity = Quantity::Current;
        let scaled = |density: Option<f64>| density.map(|density| density * area_cm2);
        (channel.first, channel.last) = (scaled(channel.first), scaled(channel.last));
    }
    channels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;

    #[test]
    fn a_run_by_itself_is_the_run_of_the_list() {
        let mut store = Store::in_memory().unwrap();
        let runs = ["runs/a.csv", "runs/b.csv"].map(|path| new_run(path, RunKind::Actuation, &[1e-3, 5e-4]));
        store.save_runs("2026-01-01T00:00:00Z", &[], &runs).unwrap();
        let listed = store.runs().unwrap();
        assert_eq!(store.run_named("runs/a.csv").unwrap().as_ref(), listed.first());
        assert_eq!(store.run_named("a.csv").unwrap(), None);
    }
}
