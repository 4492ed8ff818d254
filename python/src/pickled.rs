//! Tables and what is stated of them as plain values, for `pickle` and `copy`.

use std::sync::Arc;

use ieap::domain::{Channel, Quantity};
use ieap::pipeline::standalone::in_memory::{self, ReadTable};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Value, json};

use crate::error::fault;
use crate::readings::Readings;
use crate::stated::Stated;

/// Version of what is written: another is refused.
const VERSION: u64 = 2;

/// A table: everything but the readings as JSON, and the readings channel by channel, times before values.
pub fn of_table<'py>(py: Python<'py>, table: &Readings) -> PyResult<(String, Vec<Bound<'py, PyBytes>>)> {
    let read = &table.read;
    let mut numbers: Vec<Bound<'py, PyBytes>> = Vec::new();
    let channel = |channel: &Channel| {
        json!({
            "quantity": channel.quantity.key(), "raw_name": channel.raw_name, "raw_unit": channel.raw_unit,
            "position_mm": channel.position_mm, "excluded": channel.excluded.to_vec(),
        })
    };
    for channel in &read.channels {
        numbers.push(PyBytes::new(py, bytemuck::cast_slice(&channel.time_s)));
        numbers.push(PyBytes::new(py, bytemuck::cast_slice(&channel.values)));
    }
    let document = json!({
        "version": VERSION, "source": table.source, "read": **read,
        "channels": read.channels.iter().map(channel).collect::<Vec<_>>(),
        "stated": table.stated.as_deref(),
    });
    Ok((document.to_string(), numbers))
}

/// A table out of what [`of_table`] gave.
#[pyfunction]
pub fn table_again(py: Python<'_>, document: &str, numbers: Vec<Bound<'_, PyBytes>>) -> PyResult<Readings> {
    table(document, &numbers).ok_or_else(|| {
        fault(
            py,
            "a pickled table",
            "it was written by another version, or is damaged",
        )
    })
}

/// What is stated, out of its JSON.
#[pyfunction]
pub fn stated_again(py: Python<'_>, document: &str) -> PyResult<Stated> {
    let why = "it was written by another version, or is damaged";
    let inner = serde_json::from_str(document).map_err(|_| fault(py, "what was pickled", why))?;
    Ok(Stated { inner })
}

fn table(document: &str, numbers: &[Bound<'_, PyBytes>]) -> Option<Readings> {
    let whole: Value = serde_json::from_str(document).ok()?;
    if whole["version"].as_u64()? != VERSION {
        return None;
    }
    let doubles = |bytes: &Bound<'_, PyBytes>| -> Arc<[f64]> {
        let number = |eight: &[u8]| f64::from_ne_bytes(eight.try_into().unwrap_or_default());
        bytes.as_bytes().chunks_exact(8).map(number).collect()
    };
    let mut pairs = numbers.chunks_exact(2);
    let mut channels: Vec<Channel> = Vec::new();
    for own in whole["channels"].as_array()? {
        let [times, values] = pairs.next()? else {
            return None;
        };
        let time_s = doubles(times);
        // Channels of one clock share their times, as when they were read.
        let shared = channels.iter().find(|other| other.time_s == time_s);
        let time_s = shared.map_or(time_s, |other| other.time_s.clone());
        channels.push(Channel {
            quantity: Quantity::from_key(own["quantity"].as_str()?)?,
            raw_name: own["raw_name"].as_str()?.to_owned(),
            raw_unit: own["raw_unit"].as_str()?.to_owned(),
            position_mm: own["position_mm"].as_f64(),
            time_s,
            values: doubles(values),
            excluded: part::<Vec<u32>>(&own["excluded"])?.into(),
            own_clock: false,
            open_zero: None,
        });
    }
    let read = ReadTable {
        channels,
        ..part(&whole["read"])?
    };
    let mut table = Readings::new(read, part(&whole["source"])?);
    table.stated = part::<Option<in_memory::Stated>>(&whole["stated"])?.map(Arc::new);
    Some(table)
}

fn part<T: serde::de::DeserializeOwned>(value: &Value) -> Option<T> {
    serde_json::from_value(value.clone()).ok()
}
