//! Results as Arrow tables with one row a run or a group.

use std::sync::Arc;

use arrow_array::builder::{ListBuilder, StringBuilder};
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, Int64Array, ListArray, RecordBatch, StringArray, StructArray,
};
use arrow_buffer::OffsetBuffer;
use arrow_schema::{ArrowError, DataType, Field, Fields};
use ieap::domain::{Estimate, Issue};
use ieap::pipeline::documents::diagnosis::GroupEntry;
use ieap::pipeline::fits::result::FitResult;
use ieap::pipeline::standalone::in_memory::FitAtHand;
use ieap::show::{Frame, FrameCells};
use pyo3::prelude::*;

use crate::arrow::ArrowTable;
use crate::error::fault;

/// What the fit of a row came to.
pub struct Fitted {
    /// Name of the run.
    pub name: String,
    /// The fit, or why there is none.
    pub stated: Result<FitAtHand, Issue>,
    /// The same as a campaign takes it, of a run of a campaign.
    pub result: Option<FitResult>,
}

/// Fits, or the reason why there is none. The columns are the same for every model.
pub fn fits(rows: &[Fitted]) -> Result<RecordBatch, ArrowError> {
    let fits: Vec<Option<&FitAtHand>> = rows.iter().map(|row| row.stated.as_ref().ok()).collect();
    // What names the result of a run of a campaign stands there also where there is no fit.
    let named = |of_fit: fn(&FitAtHand) -> &str, of_result: fn(&FitResult) -> &str| {
        let text = |row: &Fitted| match (&row.stated, &row.result) {
            (Ok(fit), _) => Some(of_fit(fit).to_owned()),
            (Err(_), result) => result.as_ref().map(|result| of_result(result).to_owned()),
        };
        texts(rows.iter().map(text))
    };
    let text = |of: fn(&FitAtHand) -> &str| texts(fits.iter().map(|fit| fit.map(of)));
    let number = |of: fn(&FitAtHand) -> Option<f64>| numbers(fits.iter().map(|fit| fit.and_then(of)));
    let count = |of: fn(&FitAtHand) -> usize| counts(fits.iter().map(|fit| fit.map(|fit| of(fit) as i64)));
    let mut columns: Vec<(&str, ArrayRef)> = vec![
        ("run", texts(rows.iter().map(|row| Some(row.name.as_str())))),
        ("model", text(|fit| &fit.model)),
        ("model_version", count(|fit| fit.model_version as usize)),
        (
            "code_version",
            named(|fit| fit.code_version, |result| &result.code_version),
        ),
        ("built_from", named(|fit| fit.built_from, |result| &result.built_from)),
        (
            "data_hash",
            named(|fit| &fit.data_hash, |result| &result.data_hash),
        ),
        (
            "input_hash",
            named(|fit| &fit.input_hash, |result| &result.input_hash),
        ),
        (
            "converged",
            flags(fits.iter().map(|fit| fit.map(|fit| fit.converged))),
        ),
        ("why_stopped", text(|fit| &fit.why_stopped)),
        ("method", text(|fit| &fit.method)),
        ("n_samples", count(|fit| fit.n_samples)),
        (
            "parameters",
            estimates(&fits, |fit| fit.parameters.iter().map(|(key, own)| (key, own)).collect())?,
        ),
        (
            "nuisances",
            estimates(&fits, |fit| fit.nuisances.iter().map(|own| (&own.key, &own.estimate)).collect())?,
        ),
        ("r_squared_current", number(|fit| fit.r_squared_current)),
        ("r_squared_curvature", number(|fit| fit.r_squared_curvature)),
        ("issues", issues(&fits)?),
    ];
    columns.extend(reasons(rows.iter().map(|row| row.stated.as_ref().err())));
    columns.extend(for_import(rows));
    with_nulls(columns)
}

/// What `ieap import-fits` takes, as JSON; empty for runs that no campaign holds.
fn for_import(rows: &[Fitted]) -> [(&'static str, ArrayRef); 4] {
    let part =
        |of: fn(&FitResult) -> Option<String>| texts(rows.iter().map(|row| row.result.as_ref().and_then(of)));
    [
        ("asked", part(|result| serde_json::to_string(&result.asked).ok())),
        (
            "fit",
            part(|result| serde_json::to_string(result.fit.as_ref()?).ok()),
        ),
        (
            "issue",
            part(|result| serde_json::to_string(result.issue.as_ref()?).ok()),
        ),
        ("checksum", part(|result| Some(result.checksum.clone()))),
    ]
}

/// A group: its name, what was found or why nothing was, and its runs that could not be used, with the reason.
pub type FoundGroup = (String, Result<GroupEntry, Issue>, Vec<String>);

/// Findings, or the reason why there is none.
pub fn findings(rows: &[FoundGroup]) -> Result<RecordBatch, ArrowError> {
    let found: Vec<Option<&GroupEntry>> = rows.iter().map(|(_, entry, _)| entry.as_ref().ok()).collect();
    let number = |of: fn(&GroupEntry) -> Option<f64>| numbers(found.iter().map(|entry| entry.and_then(of)));
    let documents = found
        .iter()
        .map(|entry| entry.and_then(|entry| serde_json::to_string(entry).ok()));
    let causes = found.iter().map(|entry| cause(entry.as_ref()?));
    let mut columns: Vec<(&str, ArrayRef)> = vec![
        ("group", texts(rows.iter().map(|(name, ..)| Some(name.as_str())))),
        (
            "runs",
            lists(found.iter().map(|entry| entry.map(|entry| entry.runs.as_slice()))),
        ),
        (
            "left_out",
            lists(rows.iter().map(|(_, _, left_out)| Some(left_out.as_slice()))),
        ),
        (
            "verdict",
            texts(found.iter().map(|entry| entry.map(|entry| key(&entry.verdict)))),
        ),
        (
            "sentence",
            texts(
                found
                    .iter()
                    .map(|entry| entry.map(|entry| entry.sentence.as_str())),
            ),
        ),
        ("p_misfit", number(|entry| entry.p_misfit)),
        ("q_misfit", number(|entry| entry.q_misfit)),
        (
            "causes",
            lists(found.iter().map(|entry| entry.map(|entry| entry.set.as_slice()))),
        ),
        ("most_probable", texts(causes)),
        (
            "most_probable_mass",
            number(|entry| entry.posterior.first().map(|first| first.mass)),
        ),
        (
            "gain_deviance",
            number(|entry| entry.gain.as_ref().map(|gain| gain.proof.deviance)),
        ),
        (
            "next_run",
            texts(
                found
                    .iter()
                    .map(|entry| entry.as_ref()?.next_run.as_ref().map(|next| next.drive.as_str())),
            ),
        ),
        ("document", texts(documents)),
    ];
    columns.extend(reasons(rows.iter().map(|(_, entry, _)| entry.as_ref().err())));
    with_nulls(columns)
}

/// A kind or a verdict as JSON writes it.
fn key(of: &impl serde::Serialize) -> String {
    match serde_json::to_value(of) {
        Ok(serde_json::Value::String(key)) => key,
        _ => String::new(),
    }
}

/// What stands first in the posterior.
fn cause(entry: &GroupEntry) -> Option<String> {
    let first = entry.posterior.first()?;
    let differ = first.parameters_that_differ.join(", ");
    Some(match (&first.effect, differ.is_empty()) {
        (Some(effect), _) => effect.clone(),
        (None, false) => format!("{}: {differ}", key(&first.kind)),
        (None, true) => key(&first.kind),
    })
}

/// Place, reason and remedy of what was refused.
fn reasons<'a>(issues: impl Iterator<Item = Option<&'a Issue>> + Clone) -> [(&'static str, ArrayRef); 3] {
    let part = |of: fn(&Issue) -> &str| texts(issues.clone().map(|issue| issue.map(of)));
    [
        ("refused_place", part(|issue| &issue.place)),
        ("refused_reason", part(|issue| &issue.message)),
        ("refused_remedy", part(|issue| &issue.mend)),
    ]
}

fn with_nulls(columns: Vec<(&str, ArrayRef)>) -> Result<RecordBatch, ArrowError> {
    RecordBatch::try_from_iter_with_nullable(columns.into_iter().map(|(name, column)| (name, column, true)))
}

fn numbers(cells: impl Iterator<Item = Option<f64>>) -> ArrayRef {
    Arc::new(cells.collect::<Float64Array>())
}

fn counts(cells: impl Iterator<Item = Option<i64>>) -> ArrayRef {
    Arc::new(cells.collect::<Int64Array>())
}

fn flags(cells: impl Iterator<Item = Option<bool>>) -> ArrayRef {
    Arc::new(cells.collect::<BooleanArray>())
}

fn texts<T: AsRef<str>>(cells: impl Iterator<Item = Option<T>>) -> ArrayRef {
    Arc::new(cells.collect::<StringArray>())
}

/// A list of words in each row.
fn lists<'a>(cells: impl Iterator<Item = Option<&'a [String]>>) -> ArrayRef {
    let mut built = ListBuilder::new(StringBuilder::new());
    for cell in cells {
        cell.into_iter()
            .flatten()
            .for_each(|word| built.values().append_value(word));
        built.append(cell.is_some());
    }
    Arc::new(built.finish())
}

/// A list of records in each row; empty where there is no fit.
fn records(
    lengths: impl Iterator<Item = usize>,
    columns: Vec<(&str, ArrayRef)>,
) -> Result<ArrayRef, ArrowError> {
    let fields = columns
        .iter()
        .map(|(name, column)| Field::new(*name, column.data_type().clone(), true));
    let fields: Fields = fields.collect();
    let columns = columns.into_iter().map(|(_, column)| column).collect();
    let records = StructArray::try_new(fields.clone(), columns, None)?;
    let item = Arc::new(Field::new("item", DataType::Struct(fields), true));
    let list = ListArray::try_new(item, OffsetBuffer::from_lengths(lengths), Arc::new(records), None)?;
    Ok(Arc::new(list))
}

/// Estimates of every fit with their keys.
fn estimates(
    fits: &[Option<&FitAtHand>],
    of: fn(&FitAtHand) -> Vec<(&String, &Estimate)>,
) -> Result<ArrayRef, ArrowError> {
    let all = || fits.iter().flatten().flat_map(|fit| of(fit));
    let number = |of: fn(&Estimate) -> Option<f64>| numbers(all().map(|(_, estimate)| of(estimate)));
    records(
        fits.iter().map(|fit| fit.map_or(0, |fit| of(fit).len())),
        vec![
            ("key", texts(all().map(|(key, _)| Some(key)))),
            ("value", number(|estimate| estimate.value)),
            ("standard_error", number(|estimate| estimate.standard_error)),
            ("low_95", number(|estimate| estimate.low_95)),
            ("high_95", number(|estimate| estimate.high_95)),
            (
                "at_bound",
                flags(all().map(|(_, estimate)| Some(estimate.at_bound))),
            ),
            (
                "reason",
                texts(all().map(|(_, estimate)| estimate.reason.as_ref())),
            ),
        ],
    )
}

fn issues(fits: &[Option<&FitAtHand>]) -> Result<ArrayRef, ArrowError> {
    let all = || fits.iter().flatten().flat_map(|fit| &fit.issues);
    let text = |of: fn(&Issue) -> &str| texts(all().map(|issue| Some(of(issue))));
    records(
        fits.iter().map(|fit| fit.map_or(0, |fit| fit.issues.len())),
        vec![
            ("severity", text(|issue| issue.severity.key())),
            ("code", text(|issue| &issue.code)),
            ("place", text(|issue| &issue.place)),
            ("message", text(|issue| &issue.message)),
            ("mend", text(|issue| &issue.mend)),
        ],
    )
}

/// A table for programs as one of Arrow.
pub fn table(py: Python<'_>, columns: Frame) -> PyResult<ArrowTable> {
    let array = |cells: FrameCells| -> ArrayRef {
        match cells {
            FrameCells::Numbers(cells) => Arc::new(Float64Array::from(cells)),
            FrameCells::Counts(cells) => Arc::new(Int64Array::from(cells)),
            FrameCells::Flags(cells) => Arc::new(BooleanArray::from(cells)),
            FrameCells::Texts(cells) => Arc::new(StringArray::from(cells)),
        }
    };
    let columns = columns
        .into_iter()
        .map(|column| (column.name, array(column.cells), true));
    RecordBatch::try_from_iter_with_nullable(columns)
        .map(ArrowTable::new)
        .map_err(|error| fault(py, "a table", &error.to_string()))
}
