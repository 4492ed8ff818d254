//! NETZSCH Proteus and TA TRIOS.

use ieap::ingest::Reading;
use serde_json::Value;

use super::held::{Held, columns, number};

pub fn netzsch(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    held.rows(table, &expected["rows"]);
    for (name, summary) in expected["summary"].as_object().into_iter().flatten() {
        held.column(table, name, &summary["first"], &summary["last"]);
    }
    let names: Vec<&str> = expected["columns"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    if expected["first"].is_array() {
        let fallback = [
            "Temp./°C",
            "Time/min",
            "f/Hz",
            "E'/MPa",
            "E''/MPa",
            "tan(d)/-",
            "dL/µm",
        ];
        let names = if names.is_empty() {
            fallback.to_vec()
        } else {
            names
        };
        for (index, name) in names.iter().enumerate() {
            held.column(table, name, &expected["first"][index], &expected["last"][index]);
        }
    }
    if let Some(zone) = expected["zone"].as_str() {
        let offset = reading.started_at.as_ref().and_then(|at| at.offset.as_deref());
        held.same("zone", (offset, zone), (Some("+02:00"), "UTC+2"));
    }
    for (key, value) in expected["header"].as_object().into_iter().flatten() {
        let found = reading.original_metadata.iter().find(|(name, _)| name == key);
        held.same(key, found.map(|(_, value)| value.as_str()), value.as_str());
    }
}

pub fn trios(held: &mut Held, reading: &Reading, expected: &Value) {
    let steps = expected["steps"].as_array().unwrap();
    held.same("steps", reading.tables.len(), steps.len());
    for (table, step) in reading.tables.iter().zip(steps) {
        held.same("step", Some(table.name.as_str()), step["name"].as_str());
        held.rows(table, &step["rows"]);
        let all = columns(table);
        for (index, name) in step["columns"].as_array().unwrap().iter().enumerate() {
            let (name, unit) = (
                name.as_str().unwrap(),
                step["units"][index].as_str().unwrap_or(""),
            );
            let found = all
                .iter()
                .find(|column| column.name == name && column.unit == unit);
            let (first, last) = (number(&step["first"][index]), number(&step["last"][index]));
            // Columns of dates and words are left out; of others every first and last value is held.
            match (found, first, last) {
                (Some(column), Some(first), Some(last)) => {
                    held.value("first", column, column.first, first);
                    held.value("last", column, column.last, last);
                }
                (None, Some(first), Some(_)) => {
                    held.same(&format!("{name} in {unit} is missing, first"), Some(first), None);
                }
                _ => {}
            }
        }
    }
}
