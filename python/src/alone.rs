//! Spectra and trains of cycles of single calls, and what documents say of themselves.

use ieap::analysis::impedance::SweepDocument;
use ieap::model::impedance::{SpectrumCircuit, circuit};
use ieap::pipeline::standalone::in_memory;
use pyo3::prelude::*;

use crate::arrow::ArrowTable;
use crate::error::{bad_argument, json, refused};
use crate::fit::run_of;
use crate::readings::Readings;
use crate::results;
use crate::stated::Stated;
use crate::work::interruptible;

/// The circuits that texts name.
pub fn circuits_of(py: Python<'_>, texts: &[String]) -> PyResult<Vec<SpectrumCircuit>> {
    let found: Result<Vec<_>, _> = texts.iter().map(|text| circuit(text)).collect();
    found.map_err(|error| {
        let remedy = "write it as impedance.py does: R0-p(R1,CPE1)-W1";
        bad_argument(py, "circuits", &error.to_string(), remedy)
    })
}

/// The one spectrum of a table, analysed: one of the `spectra` of `ieap impedance --json`.
#[pyfunction]
pub fn impedance(py: Python<'_>, table: &Readings, circuits: Vec<String>) -> PyResult<String> {
    let asked = circuits_of(py, &circuits)?;
    let found = interruptible(py, Some(1), || in_memory::impedance(&table.read, &asked))?;
    let sweep = found.map_err(|issue| refused(py, &issue))?;
    json(py, &SweepDocument::at_hand(&table.source, &sweep))
}

/// The cycles of a train, one row a cycle.
#[pyfunction]
pub fn cycles(py: Python<'_>, table: &Readings, stated: &Stated) -> PyResult<ArrowTable> {
    let run = run_of(py, &table.source, table, stated)?;
    let found = py.detach(|| in_memory::cycles(&run));
    results::table(py, found.map_err(|issue| refused(py, &issue))?)
}

/// The JSON Schema of a document of the program.
#[pyfunction]
pub fn schema(py: Python<'_>, name: &str) -> PyResult<&'static str> {
    let found = ieap::cli::schema_named(name);
    let remedy = "one of those that `ieap list schemas` lists";
    found
        .map(|schema| schema.text)
        .ok_or_else(|| bad_argument(py, name, "there is no such schema", remedy))
}

/// The unit that a key says; empty where it says none.
#[pyfunction]
pub fn unit_of_key(key: &str) -> &'static str {
    ieap::domain::unit_of_key(key).unwrap_or_default()
}
