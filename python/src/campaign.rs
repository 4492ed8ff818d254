//! A campaign as it is now; every call opens it anew, to read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ieap::ingest::campaign_file;
use ieap::pipeline::documents::comparison::comparison_document;
use ieap::pipeline::documents::diagnosis::diagnosis_document;
use ieap::pipeline::documents::fits::fits_document;
use ieap::pipeline::findings::impedance::{SCHEMA, spectra};
use ieap::pipeline::show::partitioned::run_rows_parquet;
use ieap::pipeline::show::plain_tables::{listed, plain_table, stored_readings};
use ieap::pipeline::standalone::in_memory::{ReadTable, Stated};
use ieap::pipeline::{CompareModels, Context, DiagnoseChoice, PipelineError, Silent};
use ieap::show::Document;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::alone::circuits_of;
use crate::arrow::ArrowTable;
use crate::error::{bad_argument, failed, json};
use crate::forward::{self, Numbers};
use crate::readings::Readings;
use crate::results;
use crate::stated::drive_of;
use crate::work::interruptible;

/// Readings with what the campaign states of them.
type Stored = (ReadTable, Stated);

fn stored(run: &str, (read, stated): Stored) -> Readings {
    Readings {
        read: Arc::new(read),
        stated: Some(Arc::new(stated)),
        source: run.to_owned(),
    }
}

/// A campaign folder.
#[pyclass(frozen, module = "ieap._native")]
pub struct Campaign {
    folder: PathBuf,
}

#[pymethods]
impl Campaign {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Campaign> {
        match campaign_file::find(&folder) {
            Some(folder) => Ok(Campaign { folder }),
            None => {
                let place = folder.display().to_string();
                let remedy = "name a campaign folder, or make one with `ieap init`";
                Err(bad_argument(
                    py,
                    &place,
                    "there is no campaign.toml here or above",
                    remedy,
                ))
            }
        }
    }

    #[getter]
    fn folder(&self) -> &Path {
        &self.folder
    }

    /// A table that `ieap export` writes or `ieap table` lists.
    fn table(&self, py: Python<'_>, name: &str) -> PyResult<ArrowTable> {
        let columns = self.ask(py, |context| plain_table(context, name))?;
        results::table(py, columns)
    }

    /// Names of the tables that there are, and what each holds.
    #[staticmethod]
    fn tables() -> Vec<(&'static str, &'static str)> {
        listed().collect()
    }

    /// The readings of a run as a fit takes them.
    fn readings(&self, py: Python<'_>, run: &str) -> PyResult<Readings> {
        let found = self.ask(py, |context| stored_readings(context, run))?;
        Ok(stored(run, found))
    }

    /// The readings of several runs, with the campaign opened once.
    fn readings_many(&self, py: Python<'_>, runs: Vec<String>) -> PyResult<Vec<Readings>> {
        let found: Vec<Stored> = self.ask(py, |context| {
            runs.iter().map(|run| stored_readings(context, run)).collect()
        })?;
        Ok(runs
            .iter()
            .zip(found)
            .map(|(run, found)| stored(run, found))
            .collect())
    }

    /// Runs as rows that can be fitted elsewhere: the bytes of a Parquet file.
    fn fit_rows<'py>(&self, py: Python<'py>, runs: Option<Vec<String>>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.ask(py, |context| run_rows_parquet(context, runs.as_deref()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// What `ieap fit --json` prints of the current fits.
    fn fits_document(&self, py: Python<'_>) -> PyResult<String> {
        let document = self.ask(py, fits_document)?;
        json(py, &document)
    }

    /// What `ieap diagnose --json` prints of the current findings; of one group where it is named.
    fn diagnosis_document(&self, py: Python<'_>, group: Option<String>) -> PyResult<String> {
        let choice = DiagnoseChoice::default();
        let document = self.ask(py, |context| diagnosis_document(context, &choice, group.as_deref()))?;
        json(py, &document)
    }

    /// What `ieap impedance --json` prints of the spectra that are there, with these circuits as well.
    fn impedance_document(&self, py: Python<'_>, circuits: Vec<String>) -> PyResult<String> {
        let asked = circuits_of(py, &circuits)?;
        let value = self.ask(py, |context| spectra(context, &asked))?;
        let document = Document {
            schema: SCHEMA,
            value,
        };
        json(py, &document)
    }

    /// What `ieap compare --json` prints; what is missing or out of date is compared, and not stored.
    fn compare(&self, py: Python<'_>, models: Vec<String>) -> PyResult<String> {
        let compare = CompareModels { models, again: false };
        let found = interruptible(py, None, || {
            compare.look(&self.opened()?, &Silent)
        })?;
        json(
            py,
            &comparison_document(&found.map_err(|error| failed(py, &error))?),
        )
    }

    /// What `ieap predict --json` prints.
    fn predict(
        &self,
        py: Python<'_>,
        of: forward::Strip,
        numbers: Numbers,
        drive: (f64, Vec<(f64, Option<f64>)>),
        at_s: Vec<f64>,
    ) -> PyResult<String> {
        let Some(drive) = drive_of(drive.0, &drive.1) else {
            let remedy = "give a segment or more: [(0, 1.5), (300, 0.0)]";
            return Err(bad_argument(py, "drive", "found no segment", remedy));
        };
        let predict = forward::predict(of, &numbers, drive, at_s);
        let document = self.ask(py, |context| predict.run(context))?;
        json(py, &document)
    }

    /// What `ieap drive --json` prints.
    fn drive(
        &self,
        py: Python<'_>,
        of: forward::Strip,
        numbers: Numbers,
        course: Vec<(f64, f64)>,
    ) -> PyResult<String> {
        let drive = forward::drive(of, &numbers, course);
        let document = self.ask(py, |context| drive.run(context))?;
        json(py, &document)
    }

    fn __repr__(&self) -> String {
        format!("<ieap.Campaign {:?}>", self.folder.display().to_string())
    }
}

impl Campaign {
    /// The campaign to read from. Settings that cannot be read are an error: there is no line above the numbers to say so.
    fn opened(&self) -> Result<Context, PipelineError> {
        let context = Context::open_read_only(&self.folder)?;
        context.refuse_unread()?;
        Ok(context)
    }

    fn ask<R: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&Context) -> Result<R, PipelineError> + Send,
    ) -> PyResult<R> {
        let answer = py.detach(|| question(&self.opened()?));
        answer.map_err(|error| failed(py, &error))
    }
}
