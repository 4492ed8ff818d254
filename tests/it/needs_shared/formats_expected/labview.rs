//! LabVIEW text and TDMS.

use ieap::domain::RunStatus;
use ieap::ingest::Reading;
use serde_json::Value;

use super::held::{Held, columns};

pub fn lvm(held: &mut Held, reading: &Reading, expected: &Value) {
    let segments = expected["segments"].as_array().unwrap();
    held.same("segments", reading.tables.len(), segments.len());
    for (table, segment) in reading.tables.iter().zip(segments) {
        held.rows(table, &segment["shape"][0]);
        let labels = segment["labels"].as_array().unwrap();
        // The other reader leaves the empty X out of its rows and drops bytes that it cannot decode.
        let of_rows: Vec<&str> = labels
            .iter()
            .filter_map(Value::as_str)
            .filter(|label| *label != "Comment")
            .collect();
        let all = columns(table);
        let mut place = 0;
        for (index, label) in of_rows.iter().enumerate() {
            if *label == "X_Value" && place > 0 {
                continue;
            }
            let found = all
                .iter()
                .filter(|column| column.name != "X_Value" || *label == "X_Value")
                .nth(place);
            place += usize::from(*label != "X_Value");
            let Some(column) = found else { continue };
            held.value(
                "first",
                column,
                column.first,
                segment["first_row"][index].as_f64().unwrap(),
            );
            held.value(
                "last",
                column,
                column.last,
                segment["last_row"][index].as_f64().unwrap(),
            );
            let sum = segment["col_sums"][index].as_f64().unwrap();
            if !column.sum.is_nan() && column.quantity.unit().is_empty() {
                held.close(&format!("sum of {}", column.name), column.sum, sum);
            }
        }
        if let Some(delta) = segment["Delta_X"][0]
            .as_f64()
            .filter(|_| !labels.contains(&"X_Value".into()))
        {
            let (first, last) = table.time_first_last_s.unwrap();
            held.close("last time", last, first + delta * (table.rows - 1) as f64);
        }
    }
    let date = expected["header"]["Date"].as_str().unwrap().replace('/', "-");
    let local = reading
        .started_at
        .as_ref()
        .and_then(|at| at.local.clone())
        .unwrap_or_default();
    held.same("date", local.split('T').next().unwrap(), date.as_str());
}

pub fn tdms(held: &mut Held, reading: &Reading, expected: &Value) {
    let groups = expected["groups"].as_object().into_iter().flatten();
    for (group, channels) in groups {
        for (name, channel) in channels.as_object().into_iter().flatten() {
            one_channel(held, reading, group, name, channel);
        }
    }
    for (name, channel) in expected["channels"].as_object().into_iter().flatten() {
        one_channel(held, reading, "", name, channel);
    }
    let is_incomplete = expected["incomplete_final_segment"]
        .as_bool()
        .or(expected["file_status"]["incomplete_final_segment"].as_bool());
    // The other reader takes a file that ends in a segment's header for a whole one.
    let is_cut = is_incomplete == Some(true) || held_name_says_cut(expected);
    held.same("cut", reading.status == RunStatus::Cut, is_cut);
}

fn held_name_says_cut(expected: &Value) -> bool {
    expected["file"]
        .as_str()
        .is_some_and(|name| name.contains("truncated"))
}

fn one_channel(held: &mut Held, reading: &Reading, group: &str, name: &str, channel: &Value) {
    let is_group = |table_name: &str| table_name.is_empty() || group.is_empty() || table_name == group;
    let mut all = reading
        .tables
        .iter()
        .filter(|table| is_group(&table.name))
        .flat_map(columns);
    let Some(column) = all.find(|column| column.name == name) else {
        let is_number = channel["first"]
            .as_str()
            .is_some_and(|text| text.parse::<f64>().is_ok());
        held.same(&format!("channel {name} of numbers is missing"), is_number, false);
        return;
    };
    let number = |key: &str| {
        channel[key]
            .as_str()
            .and_then(|text| text.parse::<f64>().ok())
            .unwrap()
    };
    held.same(
        &format!("readings of {name}"),
        column.rows as u64,
        channel["n"].as_u64().unwrap(),
    );
    held.value("first", &column, column.first, number("first"));
    held.value("last", &column, column.last, number("last"));
    let unit = channel["properties"]["unit_string"]
        .as_str()
        .or(channel["props"]["unit_string"].as_str());
    if let Some(unit) = unit {
        held.same(&format!("unit of {name}"), column.unit.as_str(), unit);
    }
}
