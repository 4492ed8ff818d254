//! Ivium, BioLogic, CH Instruments, PalmSens.

use ieap::ingest::{Reading, Timestamp};
use serde_json::Value;

use super::held::{Held, columns, number};

/// Local start, without fractions of a second.
fn start(reading: &Reading) -> Option<String> {
    let local = reading.started_at.as_ref()?.local.clone()?;
    Some(local.split('.').next().unwrap_or("").to_owned())
}

/// First and last row as a list of numbers, in the order of the file's columns.
fn row_by_name(held: &mut Held, reading: &Reading, names: &[&str], expected: &Value) {
    let table = &reading.tables[0];
    for (index, name) in names.iter().enumerate() {
        held.column(table, name, &expected["first"][index], &expected["last"][index]);
    }
}

pub fn ivium(held: &mut Held, reading: &Reading, expected: &Value) {
    if let Some(sets) = expected["pyimpspec"].as_array() {
        held.same("sets", reading.tables.len(), sets.len());
        for (table, set) in reading.tables.iter().zip(sets) {
            held.rows(table, &set["points"]);
            held.column(table, "frequency/Hz", &set["f_first"], &set["f_last"]);
        }
        let primary = &expected["pyvium"]["primary_data"];
        let all: usize = reading.tables.iter().map(|table| table.rows).sum();
        held.same("rows of all sets", all as u64, primary["rows"].as_u64().unwrap());
        row_by_name(
            held,
            reading,
            &["Z real/Ohm", "Z imaginary/Ohm", "frequency/Hz"],
            primary,
        );
        return;
    }
    held.rows(&reading.tables[0], &expected["rows"]);
    held.status(reading, &expected["expected_status"]);
    row_by_name(held, reading, &["time/s", "I/A", "E/V"], expected);
    if let Some(condition) = expected["endcondition"].as_str() {
        let word = condition.split(" (").next().unwrap();
        let evidence = &reading.status_evidence;
        held.same("end condition", evidence.contains(&format!("\"{word}\"")), true);
    }
    if let Some(date) = expected["start_from_QR"].as_str() {
        held.same("start", start(reading).as_deref(), Some(date));
    }
    if let Some(count) = expected["actual_columns"].as_u64() {
        held.same("columns", columns(&reading.tables[0]).len() as u64, count);
    }
}

/// A column's name as the other readers have it.
fn peer_name(raw_name: &str) -> String {
    match raw_name {
        "control/V" => "control_V".to_owned(),
        "control/mA" => "control_I".to_owned(),
        "<Ewe/V>" => "<Ewe>".to_owned(),
        "ox/red" => "ox or red".to_owned(),
        "Q charge/discharge/mA.h" => "Q charge or discharge".to_owned(),
        _ => raw_name
            .rsplit_once('/')
            .map_or(raw_name, |(name, _)| name)
            .to_owned(),
    }
}

pub fn biologic(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    held.status(reading, &expected["expected_status"]);
    held.rows(table, &expected["rows"]);
    for (name, first_last) in expected["columns_of_use"].as_object().into_iter().flatten() {
        held.column(table, name, &first_last[0], &first_last[1]);
    }
    if let Some(text) = expected["start"].as_str() {
        let local = reading.started_at.as_ref().and_then(|at| at.local.as_deref());
        held.same("start", local, text.split(' ').next());
    }
    galvani(held, reading, &expected["galvani"]);
    let impedance_rows = &expected["n"];
    held.rows(table, impedance_rows);
    // The other reader must be told the locale; the wrong one gives numbers without their decimal sign.
    let Some(peer) = ["yadg_en_GB", "yadg_de_DE"]
        .into_iter()
        .map(|key| &expected[key])
        .find(|peer| fits(reading, peer))
    else {
        let has_read = expected["yadg_en_GB"]["rows"].is_u64();
        held.same("a reading of the peer that fits", has_read, false);
        return;
    };
    held.rows(table, &peer["rows"]);
    for column in columns(table) {
        let found = &peer["columns"][&peer_name(&column.name)];
        // The same name twice, in different units, is one column there.
        let is_unique = columns(table)
            .iter()
            .filter(|other| peer_name(&other.name) == peer_name(&column.name))
            .count();
        if let (Some(first), Some(last), 1) = (found["first"].as_f64(), found["last"].as_f64(), is_unique) {
            held.value("first", &column, column.first, first);
            held.value("last", &column, column.last, last);
        }
    }
    if let (Some(uts), Some(time), Some(local)) = (
        peer["columns"]["uts"]["first"].as_f64(),
        peer["columns"]["time"]["first"].as_f64(),
        start(reading),
    ) {
        let zone = peer["timezone_assumed"].as_str().unwrap_or("Europe/Berlin");
        let milliseconds = ((uts - time) * 1000.0).round() as i64;
        let zoned = jiff::Timestamp::from_millisecond(milliseconds)
            .unwrap()
            .in_tz(zone)
            .unwrap();
        let second = zoned.datetime().to_string();
        held.same("start", local.as_str(), second.split('.').next().unwrap());
    }
}

fn fits(reading: &Reading, peer: &Value) -> bool {
    let all = columns(&reading.tables[0]);
    let voltage = all
        .iter()
        .find(|column| ["Ewe/V", "<Ewe>/V", "<Ewe/V>"].contains(&column.name.as_str()));
    let expected = voltage.and_then(|column| peer["columns"][&peer_name(&column.name)]["first"].as_f64());
    voltage
        .zip(expected)
        .is_some_and(|(column, expected)| (column.first - expected).abs() <= 1e-6 * expected.abs())
}

fn galvani(held: &mut Held, reading: &Reading, peer: &Value) {
    for (name, summary) in peer["columns"].as_object().into_iter().flatten() {
        if name != "flags" {
            held.column(&reading.tables[0], name, &summary["first"], &summary["last"]);
        }
    }
    held.rows(&reading.tables[0], &peer["rows"]);
}

pub fn chi(held: &mut Held, reading: &Reading, expected: &Value) {
    let table = &reading.tables[0];
    held.rows(table, &expected["rows"]);
    held.status(reading, &expected["expected_status"]);
    let names: Vec<&str> = expected["columns"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    if expected["first"].is_array() {
        row_by_name(held, reading, &names, expected);
    }
    for (name, summary) in expected["summary"].as_object().into_iter().flatten() {
        if number(&summary["first"]).is_some_and(f64::is_finite) {
            held.column(table, name, &summary["first"], &summary["last"]);
        }
    }
    if let Some(technique) = expected["technique"].as_str() {
        held.same("technique", reading.technique.as_deref(), Some(technique));
        held.same(
            "kind of date",
            reading.started_at.as_ref().map(|at| at.kind),
            Some(Timestamp::End),
        );
    }
    let grid_end =
        number(&expected["time_axis"]["end_of_regular_grid_s"]).or(number(&expected["grid_last_s"]));
    if let (Some(grid_end), Some((_, last))) = (grid_end, table.time_first_last_s) {
        held.close("last time of the samples", last, grid_end);
    }
    let unreadable = expected["unreadable_rows"]
        .as_array()
        .is_some_and(|rows| !rows.is_empty());
    held.same(
        "cut",
        reading.status.key() == "cut",
        unreadable || expected["unreadable_tail"].is_string(),
    );
}

pub fn palmsens(held: &mut Held, reading: &Reading, expected: &Value) {
    if let Some(units) = expected["unit_row"].as_str() {
        let all: Vec<_> = reading.tables.iter().flat_map(columns).collect();
        held.same(
            "columns",
            all.len(),
            units.trim_end_matches(',').split(',').count(),
        );
        for (index, column) in all.iter().enumerate() {
            if let (Some(first), Some(last)) = (
                number(&expected["first"][index]),
                number(&expected["last"][index]),
            ) {
                held.value("first", column, column.first, first);
                held.value("last", column, column.last, last);
            }
        }
        held.rows(&reading.tables[0], &expected["rows"]);
        return;
    }
    let measurement = &expected["measurements"][0];
    let arrays = measurement["arrays"].as_array().into_iter().flatten();
    let curves = measurement["curves"].as_array().into_iter().flatten();
    let expected_arrays: Vec<&Value> = arrays
        .chain(curves.flat_map(|curve| [&curve["x"], &curve["y"]]))
        .collect();
    for array in expected_arrays
        .into_iter()
        .filter(|array| array["n"].as_u64() > Some(0))
    {
        let name = array["description"].as_str().unwrap();
        let table = reading
            .tables
            .iter()
            .find(|table| columns(table).iter().any(|column| column.name == name));
        // Arrays of texts have no numbers.
        if let Some(table) = table {
            held.column(table, name, &array["first"], &array["last"]);
            held.rows(table, &array["n"]);
        }
    }
}
