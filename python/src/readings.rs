//! Readings of runs.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_buffer::{Buffer, ScalarBuffer};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use bytes::Bytes;
use ieap::domain::{Channel, Issue, Quantity};
use ieap::pipeline::standalone::in_memory::{self, Column, ReadTable};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrow::{ArrowTable, batches};
use crate::columns::{is_duration, numbers};
use crate::error::{failed, fault, refused};
use crate::pickled;

/// Everything but the readings as JSON, and the readings.
type Parts<'py> = (String, Vec<Bound<'py, PyBytes>>);

/// Readings of a run in canonical units, with all that is known of them. Python has them as `ieap.Table`.
#[pyclass(frozen, module = "ieap._native")]
pub struct Readings {
    pub read: Arc<ReadTable>,
    /// What came with the readings: of a campaign its strip, drive and tags.
    pub stated: Option<Arc<in_memory::Stated>>,
    /// The file, the run, or where else the readings are from.
    pub source: String,
}

impl Readings {
    /// Readings that nothing is stated of.
    pub fn new(read: ReadTable, source: String) -> Readings {
        Readings {
            read: Arc::new(read),
            stated: None,
            source,
        }
    }
}

#[pymethods]
impl Readings {
    #[getter]
    fn source(&self) -> &str {
        &self.source
    }

    /// The readings as columns, in their place.
    fn columns(&self, py: Python<'_>) -> PyResult<ArrowTable> {
        let told = |error: ArrowError| fault(py, "an Arrow table of the readings", &error.to_string());
        batch(&self.read, &self.source).map(ArrowTable::new).map_err(told)
    }

    /// Everything but the readings, as JSON.
    fn describe(&self, py: Python<'_>) -> PyResult<String> {
        let read = &self.read;
        let columns = names(&read.channels).into_iter().zip(&read.channels);
        let columns: Vec<_> = columns
            .map(|(name, channel)| {
                let mut summary = serde_json::json!(channel.summary());
                summary["name"] = name.into();
                summary["unit"] = channel.quantity.unit().into();
                summary
            })
            .collect();
        let document = serde_json::json!({
            "source": self.source, "format": read.format, "reader_version": read.reader_version,
            "technique": read.technique, "status": read.status, "started_at": read.started_at,
            "time_zero_is_step": read.time_zero_is_step, "tags": tags(read), "columns": columns,
            "flags": read.flags, "issues": read.issues,
            "original_metadata": read.original_metadata,
        });
        serde_json::to_string(&document).map_err(|error| fault(py, "a description", &error.to_string()))
    }

    /// Where the numbers of a column lie in memory, for tests that nothing is copied.
    fn _address(&self, name: &str) -> Option<usize> {
        let at = names(&self.read.channels).iter().position(|own| own == name)?;
        Some(self.read.channels[at].values.as_ptr() as usize)
    }

    /// For `pickle` and `copy`: readings, what is known of them, and what is stated.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts<'py>)> {
        let again = py.import("ieap._native")?.getattr("table_again")?;
        Ok((again, pickled::of_table(py, self)?))
    }

    fn __repr__(&self) -> String {
        let read = &self.read;
        let of = |channel: &Channel, name: &String| {
            let summary = channel.summary();
            let end = |number: Option<f64>| number.map_or("-".to_owned(), shown);
            format!(
                "  {name}: {} readings, {} .. {}",
                summary.readings,
                end(summary.first),
                end(summary.last)
            )
        };
        let names = names(&read.channels);
        let mut lines = vec![format!(
            "<ieap.Table {:?}: {} rows, format {}, {}>",
            self.source,
            times(&read.channels).len(),
            read.format,
            read.status
        )];
        lines.extend(
            read.channels
                .iter()
                .zip(&names)
                .map(|(channel, name)| of(channel, name)),
        );
        lines.extend(
            read.issues
                .iter()
                .map(|issue| format!("  {}: {}", issue.severity.key(), issue.message)),
        );
        lines.join("\n")
    }
}

/// Reads the tables of a file.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Readings>> {
    let found = py
        .detach(|| in_memory::read(&path))
        .map_err(|error| failed(py, &error))?;
    let shown = path.display().to_string();
    let at_file = |issue: Issue| {
        let place = [shown.as_str(), &issue.place].join(", ");
        issue.at(place.trim_end_matches(", ").to_owned())
    };
    let tables = found.map_err(|issue| refused(py, &at_file(issue)))?;
    Ok(tables
        .into_iter()
        .map(|read| {
            let source = format!("{shown}{}", read.name);
            Readings::new(read, source)
        })
        .collect())
}

/// A table of columns of doubles in the machine's order of bytes, with the number of readings that were masked.
#[pyfunction]
pub fn arrays(py: Python<'_>, columns: Vec<(String, Bound<'_, PyBytes>, usize)>) -> PyResult<Readings> {
    let number = |eight: &[u8]| f64::from_ne_bytes(eight.try_into().unwrap_or_default());
    let doubles = |bytes: &Bound<'_, PyBytes>| bytes.as_bytes().chunks_exact(8).map(number).collect();
    let masked = columns.iter().filter(|(_, _, masked)| *masked > 0);
    let told: Vec<Issue> = masked
        .map(|(name, _, masked)| {
            let message = format!("{masked} masked readings are taken as empty cells");
            Issue::note("readings-masked", message).at(format!("column {name}"))
        })
        .collect();
    let columns = columns
        .iter()
        .map(|(name, bytes, _)| Column::new(name.clone(), doubles(bytes)))
        .collect();
    let mut read = py
        .detach(|| in_memory::arrays(columns))
        .map_err(|issue| refused(py, &issue))?;
    read.issues.extend(told);
    Ok(Readings::new(read, "arrays".to_owned()))
}

/// The unit that a column's name says; empty where it says none.
#[pyfunction]
pub fn unit_of(name: &str) -> String {
    in_memory::unit_of(name)
}

/// A table of any library that speaks Arrow; its columns are named as those of a plain run table.
#[pyfunction]
pub fn from_arrow(py: Python<'_>, table: &Bound<'_, PyAny>) -> PyResult<Readings> {
    let batches = batches(table)?;
    let schema = batches[0].schema();
    let (mut columns, mut unread) = (Vec::new(), Vec::new());
    for (index, field) in schema.fields().iter().enumerate() {
        let parts: Option<Vec<Vec<f64>>> = batches.iter().map(|batch| numbers(batch.column(index))).collect();
        match parts {
            Some(parts) => columns.push(Column {
                are_durations: is_duration(field.data_type()),
                ..Column::new(field.name().clone(), parts.concat())
            }),
            None => {
                let message = format!("a column of {} is not read", field.data_type());
                unread.push(Issue::note("column-unread", message).at(format!("column {}", field.name())));
            }
        }
    }
    let mut read = py
        .detach(|| in_memory::arrays(columns))
        .map_err(|issue| refused(py, &issue))?;
    read.issues.extend(unread);
    Ok(Readings::new(read, "arrow".to_owned()))
}

/// A reading in a line for people: four digits.
fn shown(number: f64) -> String {
    match number.abs() {
        size if size == 0.0 || (1e-2..1e4).contains(&size) => format!("{number:.4}"),
        _ => format!("{number:.3e}"),
    }
}

/// Tags that the header gives.
fn tags(read: &ReadTable) -> HashMap<&str, &str> {
    read.header_tags
        .iter()
        .map(|(key, value, _)| (key.as_str(), value.as_str()))
        .collect()
}

/// A name for each channel: the canonical column, with the place along the strip; that of the file where there is none.
fn names(channels: &[Channel]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(channels.len());
    for channel in channels {
        let place = channel
            .position_mm
            .map_or(String::new(), |place| format!("@{place}"));
        let wanted = match channel.quantity {
            Quantity::Other => channel.raw_name.clone(),
            quantity => format!("{}{place}", quantity.column()),
        };
        let (mut name, mut number) = (wanted.clone(), 1);
        while names.contains(&name) || name == Quantity::Time.column() {
            number += 1;
            name = format!("{wanted} ({number})");
        }
        names.push(name);
    }
    names
}

/// The times of all channels: theirs where they have it in common, else all of them in order.
fn times(channels: &[Channel]) -> Arc<[f64]> {
    let Some(first) = channels.first() else {
        return Arc::from([]);
    };
    let first = &first.time_s;
    if channels
        .iter()
        .all(|channel| Arc::ptr_eq(&channel.time_s, first) || channel.time_s == *first)
    {
        return first.clone();
    }
    let mut all: Vec<f64> = channels
        .iter()
        .flat_map(|channel| channel.time_s.iter().copied())
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all.into()
}

/// Memory that Arrow shares with a channel.
struct Shared(Arc<[f64]>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }
}

/// The same numbers as an Arrow column, in the same place.
fn shared(values: &Arc<[f64]>) -> ArrayRef {
    let buffer = Buffer::from(Bytes::from_owner(Shared(values.clone())));
    Arc::new(Float64Array::new(
        ScalarBuffer::new(buffer, 0, values.len()),
        None,
    ))
}

/// A channel at the times of the table; without a copy where it was read at just these.
fn column(channel: &Channel, times: &Arc<[f64]>) -> ArrayRef {
    if channel.time_s == *times {
        return shared(&channel.values);
    }
    let mut readings = channel.time_s.iter().zip(channel.values.iter()).peekable();
    let at = |time_s: &f64| {
        readings
            .next_if(|(own, _)| *own == time_s)
            .map(|(_, value)| *value)
    };
    Arc::new(times.iter().map(at).collect::<Float64Array>())
}

fn batch(read: &ReadTable, source: &str) -> Result<RecordBatch, ArrowError> {
    let times = times(&read.channels);
    let time = Field::new(Quantity::Time.column(), DataType::Float64, false);
    let mut fields = vec![time.with_metadata(HashMap::from([("unit".to_owned(), "s".to_owned())]))];
    let mut columns = vec![shared(&times)];
    for (name, channel) in names(&read.channels).into_iter().zip(&read.channels) {
        let metadata = [
            ("unit", channel.quantity.unit().to_owned()),
            ("raw_name", channel.raw_name.clone()),
            ("raw_unit", channel.raw_unit.clone()),
            ("excluded_readings", channel.excluded.len().to_string()),
        ];
        let metadata: HashMap<String, String> = metadata
            .into_iter()
            .map(|(key, value)| (key.to_owned(), value))
            .collect();
        fields.push(Field::new(name, DataType::Float64, true).with_metadata(metadata));
        columns.push(column(channel, &times));
    }
    let mut metadata: HashMap<String, String> = [
        ("ieap.source", source),
        ("ieap.format", &read.format),
        ("ieap.status", &read.status),
        ("ieap.technique", read.technique.as_deref().unwrap_or_default()),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()))
    .into();
    metadata.extend(
        tags(read)
            .into_iter()
            .map(|(key, value)| (format!("ieap.tag.{key}"), value.to_owned())),
    );
    let issues = serde_json::to_string(&read.issues).unwrap_or_default();
    metadata.insert("ieap.issues".to_owned(), issues);
    RecordBatch::try_new(Arc::new(Schema::new_with_metadata(fields, metadata)), columns)
}
