//! A frame as JSON: an object a row; and lists in its cells.

use std::io::{self, Write};

use ieap_show::{FrameCells, FrameColumn, Printed};
use serde_json::{Map, Value};

/// Words of a list: JSON in files, with `between` them for people.
pub fn list<S: AsRef<str>>(words: &[S], between: &str) -> Printed<String> {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    let printed = (!words.is_empty()).then(|| words.join(between));
    Printed(serde_json::json!(words).to_string(), printed.into())
}

/// Its rows. A missing number is null; yes and no are `flag` of them, for a database has 1 and 0.
pub fn rows(table: &[FrameColumn], flag: fn(bool) -> Value) -> impl Iterator<Item = Value> {
    let cell = move |cells: &FrameCells, row: usize| match cells {
        FrameCells::Texts(cells) => cells[row].as_deref().into(),
        FrameCells::Numbers(cells) => cells[row].into(),
        FrameCells::Counts(cells) => cells[row].into(),
        FrameCells::Flags(cells) => cells[row].map_or(Value::Null, flag),
    };
    let height = table.first().map_or(0, |column| column.cells.len());
    (0..height).map(move |row| {
        let pairs = table
            .iter()
            .map(|column| (column.name.clone(), cell(&column.cells, row)));
        Value::Object(pairs.collect::<Map<_, _>>())
    })
}

/// Writes `table` to `out` as an array, one row a line, as pandas and DuckDB read it.
///
/// # Errors
/// Those of the writer.
pub fn write(table: &[FrameColumn], out: &mut dyn Write) -> io::Result<()> {
    out.write_all(b"[")?;
    for (at, row) in rows(table, Value::Bool).enumerate() {
        let start = if at == 0 { "\n" } else { ",\n" };
        write!(out, "{start}{row}")?;
    }
    out.write_all(b"\n]\n")
}
