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

/// Its rows. A missing number is null; yes and no are `flag` of them.
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

/// The same as they are written, for whoever only hands them on; yes and no are `flags` of them, for a database has 1 and 0.
pub fn texts(table: &[FrameColumn], flags: [&'static str; 2]) -> impl Iterator<Item = String> {
    let key = |column: &FrameColumn| format!("{}:", Value::from(column.name.as_str()));
    let keys: Vec<String> = table.iter().map(key).collect();
    let height = table.first().map_or(0, |column| column.cells.len());
    (0..height).map(move |row| {
        let mut text = vec![b'{'];
        for (column, key) in table.iter().zip(&keys) {
            if text.len() > 1 {
                text.push(b',');
            }
            text.extend_from_slice(key.as_bytes());
            // Writing into memory cannot fail.
            let _ = match &column.cells {
                FrameCells::Texts(cells) => serde_json::to_writer(&mut text, &cells[row]),
                FrameCells::Numbers(cells) => serde_json::to_writer(&mut text, &cells[row]),
                FrameCells::Counts(cells) => serde_json::to_writer(&mut text, &cells[row]),
                FrameCells::Flags(cells) => {
                    let flag = cells[row].map_or("null", |is_so| flags[usize::from(is_so)]);
                    text.extend_from_slice(flag.as_bytes());
                    Ok(())
                }
            };
        }
        text.push(b'}');
        String::from_utf8_lossy(&text).into_owned()
    })
}

/// Writes `table` to `out` as an array, one row a line, as pandas and DuckDB read it.
///
/// # Errors
/// Those of the writer.
pub fn write(table: &[FrameColumn], out: &mut dyn Write) -> io::Result<()> {
    out.write_all(b"[")?;
    for (at, row) in texts(table, ["false", "true"]).enumerate() {
        let start = if at == 0 { "\n" } else { ",\n" };
        write!(out, "{start}{row}")?;
    }
    out.write_all(b"\n]\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_written_as_their_values_are() {
        let column = |name: &str, cells| FrameColumn {
            name: name.to_owned(),
            quantity: String::new(),
            headed_unit: String::new(),
            cells,
        };
        let words = ["a \"b\"", "\u{a0}µ\n"].map(|text| Some(text.to_owned()));
        let table = [
            column(
                "words",
                FrameCells::Texts(words.into_iter().chain([None]).collect()),
            ),
            column(
                "numbers",
                FrameCells::Numbers(vec![Some(-1.182e-5), Some(20.0), Some(f64::NAN)]),
            ),
            column("counts", FrameCells::Counts(vec![Some(-3), None, Some(i64::MAX)])),
            column(
                "flags \"\"",
                FrameCells::Flags(vec![Some(true), Some(false), None]),
            ),
        ];
        let expected: Vec<String> = rows(&table, Value::Bool).map(|row| row.to_string()).collect();
        assert_eq!(texts(&table, ["false", "true"]).collect::<Vec<_>>(), expected);
        let in_database = rows(&table, |flag| i32::from(flag).into()).map(|row| row.to_string());
        assert_eq!(
            texts(&table, ["0", "1"]).collect::<Vec<_>>(),
            in_database.collect::<Vec<_>>()
        );
        assert_eq!(texts(&[], ["0", "1"]).count(), 0);
    }
}
