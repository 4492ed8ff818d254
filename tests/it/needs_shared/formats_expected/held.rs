//! Comparing what was read with what is expected, value by value.

use ieap::domain::unit::conversion;
use ieap::domain::{Quantity, RunStatus};
use ieap::ingest::{Reading, RunTable};
use serde_json::Value;

/// Values of one file that were compared, and those that differ.
pub struct Held {
    name: String,
    /// How many were compared.
    pub count: usize,
    /// What differs.
    pub wrong: Vec<String>,
}

/// A column of a table: the time or a channel.
pub struct Column {
    pub name: String,
    pub unit: String,
    pub quantity: Quantity,
    pub rows: usize,
    pub first: f64,
    pub last: f64,
    pub sum: f64,
}

/// Columns of a table, the time among them.
pub fn columns(table: &RunTable) -> Vec<Column> {
    let time =
        table
            .time_column
            .as_ref()
            .zip(table.time_first_last_s)
            .map(|((name, unit), (first, last))| Column {
                name: name.clone(),
                unit: unit.clone(),
                quantity: Quantity::Time,
                rows: table.rows,
                first,
                last,
                sum: f64::NAN,
            });
    let channels = table.channels.iter().map(|channel| Column {
        name: channel.raw_name.clone(),
        unit: channel.raw_unit.clone(),
        quantity: channel.quantity,
        rows: channel.len(),
        first: channel.values[0],
        last: channel.values[channel.len() - 1],
        sum: channel.values.iter().sum(),
    });
    time.into_iter().chain(channels).collect()
}

/// A number, also one in a text, with a point or a comma.
pub fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => text.trim().replace(',', ".").parse().ok(),
        _ => None,
    }
}

impl Held {
    pub fn new(name: &str) -> Held {
        Held {
            name: name.to_owned(),
            count: 0,
            wrong: Vec::new(),
        }
    }

    fn note(&mut self, is_right: bool, what: impl FnOnce() -> String) {
        self.count += 1;
        if !is_right {
            self.wrong.push(format!("{}: {}", self.name, what()));
        }
    }

    /// Two things that are the same.
    pub fn same<T: PartialEq + std::fmt::Debug>(&mut self, what: &str, found: T, expected: T) {
        let is_right = found == expected;
        self.note(is_right, || format!("{what} is {found:?}, expected {expected:?}"));
    }

    /// Two numbers that differ by the conversion of a unit at most.
    pub fn close(&mut self, what: &str, found: f64, expected: f64) {
        let is_right = (found - expected).abs() <= 1e-9 * expected.abs().max(found.abs());
        self.note(is_right, || format!("{what} is {found}, expected {expected}"));
    }

    /// First or last value of a column, where the expected one is in the file's own unit.
    pub fn value(&mut self, what: &str, column: &Column, found: f64, expected: f64) {
        let canonical =
            conversion(column.quantity, unit_of(column)).map(|conversion| conversion.apply(expected));
        match canonical {
            Ok(canonical) => {
                let sign = if is_negated(column) { -1.0 } else { 1.0 };
                self.close(&format!("{what} of {}", column.name), found, sign * canonical);
            }
            Err(error) => self.note(false, || format!("{} cannot be converted: {error}", column.name)),
        }
    }

    /// First and last value of a column that must be there.
    pub fn column(&mut self, table: &RunTable, name: &str, first: &Value, last: &Value) {
        let all = columns(table);
        let Some(column) = all.iter().find(|column| column.name == name) else {
            self.note(false, || format!("column {name} is missing"));
            return;
        };
        if let Some(expected) = number(first).filter(|number| number.is_finite()) {
            self.value("first", column, column.first, expected);
        }
        if let Some(expected) = number(last).filter(|number| number.is_finite()) {
            self.value("last", column, column.last, expected);
        }
    }

    /// `expected_status` as the expected values name it.
    pub fn status(&mut self, reading: &Reading, expected: &Value) {
        let status = match expected.as_str() {
            Some("complete") => RunStatus::Complete,
            Some("aborted") => RunStatus::Aborted,
            Some("truncated") => RunStatus::Cut,
            Some("running or saved before end") => RunStatus::StillRunning,
            Some(other) => panic!("{other} is no status"),
            None => return,
        };
        self.same("status", reading.status, status);
    }

    pub fn rows(&mut self, table: &RunTable, expected: &Value) {
        if let Some(rows) = expected.as_u64() {
            self.same("rows", table.rows as u64, rows);
        }
    }
}

/// Whether the file holds the column with the other sign: where its name says so, and in files of PalmSens.
fn is_negated(column: &Column) -> bool {
    let name = column.name.as_str();
    matches!(
        column.quantity,
        Quantity::ImpedanceImaginary | Quantity::ImpedancePhase
    ) && (name.starts_with(['-', '\u{2212}'])
        || name.starts_with("neg. ")
        || matches!(name, "ZIm" | "Phase" | "Z'' / Ohm"))
}

/// The unit that conversions are made from; a rebuilt or counted time is in seconds already.
fn unit_of(column: &Column) -> &str {
    match (column.quantity, column.unit.as_str()) {
        (Quantity::Time, "") => "s",
        (_, unit) => unit,
    }
}
