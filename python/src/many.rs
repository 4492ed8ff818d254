//! Many runs at once, as tables with one run a row.

use ieap::domain::Issue;
use ieap::pipeline::standalone::in_memory::{self, RunAtHand};
use ieap::pipeline::{DiagnoseChoice, FitChoice, PipelineError};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrow::{ArrowTable, batches};
use crate::error::{fault, refused};
use crate::fit::{choice, draws_of};
use crate::results::{self, Fitted};
use crate::rows::{Found, RowRun, runs};
use crate::work::interruptible;

/// Fits every row of a table, on all cores.
#[pyfunction]
#[pyo3(signature = (table, model = None, method = None, simultaneous = false, seed = None, threads = None, known = Vec::new()))]
#[expect(clippy::too_many_arguments, reason = "one for each thing that Python states")]
pub fn fit_many(
    py: Python<'_>,
    table: &Bound<'_, PyAny>,
    model: Option<String>,
    method: Option<String>,
    simultaneous: bool,
    seed: Option<u64>,
    threads: Option<usize>,
    known: Vec<String>,
) -> PyResult<ArrowTable> {
    let chosen = FitChoice {
        known: crate::fit::known(py, &known)?,
        ..choice(model, method, simultaneous, seed)
    };
    let mut options = in_memory::fit_options(&chosen).map_err(|issue| refused(py, &issue))?;
    // No column says what the noise of a run at hand is like, which takes several times as long as its fit.
    options.describes_noise = false;
    let found = all_runs(table)?;
    let fitted: Vec<Fitted> = interruptible(py, threads, || {
        let fit = |(name, row): RowRun| {
            let (stated, result) = match row {
                Ok(Found::AtHand(run)) => (
                    in_memory::fit(&run, &options, &chosen.known).map(|(_, stated)| stated),
                    None,
                ),
                Ok(Found::OfCampaign(row)) => {
                    let (stated, result) = row.fit(&chosen);
                    (stated, Some(result))
                }
                Err(issue) => (Err(issue), None),
            };
            Fitted { name, stated, result }
        };
        found.into_par_iter().map(fit).collect()
    })?;
    results::fits(&fitted)
        .map(ArrowTable::new)
        .map_err(|error| fault(py, "a table of fits", &error.to_string()))
}

/// Diagnoses all rows of a table as one group; a table of one row.
#[pyfunction]
#[pyo3(signature = (group, table, model = None, draws = None, seed = None, threads = None))]
pub fn diagnose_rows(
    py: Python<'_>,
    group: &str,
    table: &Bound<'_, PyAny>,
    model: Option<String>,
    draws: Option<usize>,
    seed: Option<u64>,
    threads: Option<usize>,
) -> PyResult<ArrowTable> {
    let found = all_runs(table)?;
    let draws = draws_of(py, draws)?;
    let choice = DiagnoseChoice { model, draws, seed };
    let (mut runs, mut left_out): (Vec<RunAtHand>, Vec<Issue>) = (Vec::new(), Vec::new());
    for row in found {
        match of_group(row) {
            Ok(run) => runs.push(run),
            Err(issue) => left_out.push(issue),
        }
    }
    let entry = interruptible(py, threads, || -> Result<_, PipelineError> {
        match (runs.is_empty(), left_out.first()) {
            (true, Some(issue)) => Ok(Err(issue.clone())),
            _ => in_memory::diagnose(group, &runs.iter().collect::<Vec<_>>(), &choice),
        }
    })?;
    let entry = entry.map_err(|error| crate::error::failed(py, &error))?;
    let said: Vec<String> = left_out
        .iter()
        .map(|issue| format!("{}: {}", issue.place, issue.message))
        .collect();
    let table = results::findings(&[(group.to_owned(), entry, said)]);
    table
        .map(ArrowTable::new)
        .map_err(|error| fault(py, "a table of findings", &error.to_string()))
}

/// A run of a group, or why the group goes without it, with the run's name.
fn of_group((name, run): RowRun) -> Result<RunAtHand, Issue> {
    run.map(Found::run).map_err(|issue| {
        let place = match issue.place.is_empty() {
            true => name,
            false => format!("{name}, {}", issue.place),
        };
        issue.at(place)
    })
}

fn all_runs(table: &Bound<'_, PyAny>) -> PyResult<Vec<RowRun>> {
    let mut found: Vec<RowRun> = Vec::new();
    for batch in batches(table)? {
        let own = table.py().detach(|| runs(&batch, found.len()));
        found.extend(own);
    }
    Ok(found)
}
