//! JSON: every number in full, the printed text beside it, and what each cell was made from.

use serde_json::{Map, Value, json};

use super::shown::{ShownCell, caption, grid, remarks};
use ieap_analysis::pooling::Pooled;
use ieap_analysis::tables::{Cell, Content, Table};
use ieap_domain::safe_text::json_text;

/// Schema of the document.
const SCHEMA: &str = "ieap/table/1";

/// Writes the table.
pub fn write(table: &Table) -> String {
    let text = serde_json::to_string_pretty(&document(table)).unwrap_or_default();
    format!("{}\n", json_text(&text))
}

fn document(table: &Table) -> Value {
    let columns = table.columns.iter().map(|column| {
        json!({
            "key": column.key,
            "symbol": column.symbol,
            "quantity": column.quantity,
            "unit": column.unit,
        })
    });
    let rows = table.rows.iter().zip(grid(table)).map(|(row, shown)| {
        let cells = table.columns.iter().zip(row.cells.iter().zip(&shown));
        let cells: Map<String, Value> = cells
            .map(|(column, (cell, shown))| (column.key.clone(), cell_value(table, cell, shown)))
            .collect();
        json!({ "label": row.label, "cells": cells })
    });
    json!({
        "schema": SCHEMA,
        "table": table.name,
        "caption": caption(table),
        "notice": table.notice,
        "origin": table.origin,
        "columns": columns.collect::<Vec<_>>(),
        "rows": rows.collect::<Vec<_>>(),
        "remarks": remarks(table),
    })
}

fn cell_value(table: &Table, cell: &Cell, shown: &ShownCell) -> Value {
    let mut value = Map::new();
    value.insert("text".to_owned(), Value::String(shown.text()));
    value.insert("kind".to_owned(), json!(kind(&cell.content)));
    value.extend(numbers(&cell.content));
    if !cell.notes.is_empty() {
        let notes: Vec<&String> = cell
            .notes
            .iter()
            .filter_map(|&note| table.notes.get(note))
            .collect();
        value.insert("notes".to_owned(), json!(notes));
    }
    let used = cell.sources.iter().filter(|source| source.left_out.is_none());
    let mut names: Vec<&str> = used.map(|source| source.name.as_str()).collect();
    names.dedup();
    if !names.is_empty() {
        value.insert("from".to_owned(), json!(names));
    }
    Value::Object(value)
}

/// Kind of a content, as scripts tell them apart.
fn kind(content: &Content) -> &'static str {
    match content {
        Content::Text(_) => "text",
        Content::Exact(_) => "exact",
        Content::Rough(..) | Content::Score(_) => "number",
        Content::Measured(_) => "measured",
        Content::Bound { .. } => "bound",
        Content::NotDetermined => "not_determined",
        Content::Missing => "missing",
    }
}

/// The numbers of a content, unrounded.
fn numbers(content: &Content) -> Map<String, Value> {
    let object = match content {
        Content::Exact(number) | Content::Rough(number, _) | Content::Score(number) => {
            json!({ "value": number })
        }
        Content::Measured(measured) => {
            let mut object = json!({
                "value": measured.value,
                "standard_error": measured.standard_error,
                "low_95": measured.low_95,
                "high_95": measured.high_95,
            });
            if let (Some(pooled), Some(object)) = (&measured.pooled, object.as_object_mut()) {
                object.insert("pooled".to_owned(), pooled_value(pooled));
            }
            object
        }
        Content::Bound { low, high } => json!({ "value": null, "low_95": low, "high_95": high }),
        _ => json!({}),
    };
    match object {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

/// Where the uncertainty of a mean comes from.
fn pooled_value(pooled: &Pooled) -> Value {
    json!({
        "runs": pooled.runs,
        "samples": pooled.samples,
        "standard_error_from_fits": pooled.fit_standard_error,
        "standard_deviation_between_runs": pooled.between_runs,
        "standard_deviation_between_samples": pooled.between_samples,
    })
}
