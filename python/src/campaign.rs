//! A campaign as it is now; every call opens it anew, to read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray};
use ieap::analysis::plain_columns::{PlainCells, PlainColumn};
use ieap::domain::Issue;
use ieap::ingest::campaign_file;
use ieap::pipeline::documents::diagnosis::{GroupEntry, diagnosis_document};
use ieap::pipeline::documents::fits::fits_document;
use ieap::pipeline::show::plain_tables::{plain_table, stored_readings};
use ieap::pipeline::{Context, DiagnoseChoice, PipelineError};
use pyo3::prelude::*;

use crate::arrow::ArrowTable;
use crate::error::{bad_argument, failed, fault};
use crate::results;
use crate::table::Table;

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

    /// One of the tables that `ieap export` writes.
    fn table(&self, py: Python<'_>, name: &str) -> PyResult<ArrowTable> {
        let columns = self.ask(py, |context| plain_table(context, name))?;
        let batch = batch(columns).map_err(|error| fault(py, name, &error.to_string()))?;
        Ok(ArrowTable::new(batch))
    }

    /// The readings of a run as a fit takes them.
    fn readings(&self, py: Python<'_>, run: &str) -> PyResult<Table> {
        let (read, stated) = self.ask(py, |context| stored_readings(context, run))?;
        Ok(Table {
            read: Arc::new(read),
            stated: Some(Arc::new(stated)),
            source: run.to_owned(),
        })
    }

    /// The current findings of groups, one row a group.
    fn findings(&self, py: Python<'_>) -> PyResult<ArrowTable> {
        let choice = DiagnoseChoice::default();
        let document = self.ask(py, |context| diagnosis_document(context, &choice, None))?;
        let rows: Vec<(String, Result<GroupEntry, Issue>)> = document
            .groups
            .into_iter()
            .map(|group| (group.group.clone(), Ok(group)))
            .collect();
        results::findings(&rows)
            .map(ArrowTable::new)
            .map_err(|error| fault(py, "findings", &error.to_string()))
    }

    /// What `ieap fit --json` prints of the current fits.
    fn fits_document(&self, py: Python<'_>) -> PyResult<String> {
        let document = self.ask(py, fits_document)?;
        serde_json::to_string(&document).map_err(|error| fault(py, "a document", &error.to_string()))
    }

    /// What `ieap diagnose --json` prints of the current findings.
    fn diagnosis_document(&self, py: Python<'_>) -> PyResult<String> {
        let choice = DiagnoseChoice::default();
        let document = self.ask(py, |context| diagnosis_document(context, &choice, None))?;
        serde_json::to_string(&document).map_err(|error| fault(py, "a document", &error.to_string()))
    }

    fn __repr__(&self) -> String {
        format!("<ieap.Campaign {:?}>", self.folder.display().to_string())
    }
}

impl Campaign {
    fn ask<R: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&Context) -> Result<R, PipelineError> + Send,
    ) -> PyResult<R> {
        let answer = py.detach(|| question(&Context::open_read_only(&self.folder)?));
        answer.map_err(|error| failed(py, &error))
    }
}

fn batch(columns: Vec<PlainColumn>) -> Result<RecordBatch, arrow_schema::ArrowError> {
    let array = |cells: PlainCells| -> ArrayRef {
        match cells {
            PlainCells::Numbers(cells) => Arc::new(Float64Array::from(cells)),
            PlainCells::Counts(cells) => Arc::new(Int64Array::from(cells)),
            PlainCells::Flags(cells) => Arc::new(BooleanArray::from(cells)),
            PlainCells::Texts(cells) => Arc::new(StringArray::from(cells)),
        }
    };
    let columns = columns
        .into_iter()
        .map(|column| (column.name, array(column.cells), true));
    RecordBatch::try_from_iter_with_nullable(columns)
}
