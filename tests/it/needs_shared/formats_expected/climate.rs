//! Climate loggers.

use ieap::ingest::Reading;
use serde_json::Value;

use super::held::{Held, columns, number};

pub fn loggers(held: &mut Held, reading: &Reading, expected: &Value) {
    held.same("step response", reading.is_step_response, false);
    let table = &reading.tables[0];
    if let Some(first) = expected["first_rows"].as_array() {
        // The row of names is counted there.
        held.same("rows", table.rows as u64 + 1, expected["rows"].as_u64().unwrap());
        rows(
            held,
            reading,
            first[0].as_array().unwrap(),
            &first[1],
            &expected["last_row"],
        );
        return;
    }
    let crosscheck = &expected["crosscheck"];
    held.rows(table, &crosscheck["rows"]);
    rows(
        held,
        reading,
        crosscheck["header"].as_array().unwrap(),
        &crosscheck["first"],
        &crosscheck["last"],
    );
    let peer = &expected["hoboreader"];
    if let (Some(time), Some(zone)) = (peer["first_time"].as_str(), peer["timezone"].as_str()) {
        let stamp = reading.started_at.as_ref().unwrap();
        let found = format!(
            "{}{}",
            stamp.local.as_deref().unwrap(),
            stamp.offset.as_deref().unwrap()
        );
        held.same("first time", found.replace('T', " "), time.replace('T', " "));
        held.same(
            "zone",
            format!("GMT{}", stamp.offset.as_deref().unwrap()),
            zone.to_owned(),
        );
    }
    if let (Some(first), Some(last)) = (peer["first_time"].as_str(), peer["last_time"].as_str()) {
        let moment = |text: &str| text.replace(' ', "T").parse::<jiff::Timestamp>().unwrap();
        let elapsed = moment(last).duration_since(moment(first)).as_secs_f64();
        held.close("last time", table.time_first_last_s.unwrap().1, elapsed);
    }
}

fn rows(held: &mut Held, reading: &Reading, names: &[Value], first: &Value, last: &Value) {
    let all = columns(&reading.tables[0]);
    for (index, name) in names.iter().filter_map(Value::as_str).enumerate() {
        let is_time = name.is_empty() || name.contains("GMT");
        // Names may repeat: the cell's place among them tells which is meant.
        let before = names[..index]
            .iter()
            .filter(|other| other.as_str() == Some(name))
            .count();
        let Some(column) = all
            .iter()
            .filter(|column| column.name == name)
            .nth(before)
            .filter(|_| !is_time)
        else {
            continue;
        };
        if let Some(expected) = number(&first[index]) {
            held.value("first", column, column.first, expected);
        }
        if let Some(expected) = number(&last[index]) {
            held.value("last", column, column.last, expected);
        }
    }
}
