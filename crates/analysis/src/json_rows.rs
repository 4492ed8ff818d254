//! A data frame as JSON: an array with an object a row, as pandas and DuckDB read it.

use std::io::Write;

use polars::prelude::{AnyValue, DataFrame, PolarsError, PolarsResult};
use serde_json::{Map, Value};

/// Writes `table` to `out`, one row a line. A missing number is null.
///
/// # Errors
/// Those of the writer, or a column of a kind that no exported table has.
pub fn write(table: &DataFrame, out: &mut dyn Write) -> PolarsResult<()> {
    let failed = |error: std::io::Error| PolarsError::from(error);
    out.write_all(b"[").map_err(failed)?;
    for row in 0..table.height() {
        let mut object = Map::new();
        for column in table.columns() {
            object.insert(column.name().to_string(), value(column.get(row)?)?);
        }
        let start = if row == 0 { "\n" } else { ",\n" };
        write!(out, "{start}{}", Value::Object(object)).map_err(failed)?;
    }
    out.write_all(b"\n]\n").map_err(failed)
}

fn value(cell: AnyValue) -> PolarsResult<Value> {
    Ok(match cell {
        AnyValue::Null => Value::Null,
        AnyValue::Boolean(flag) => flag.into(),
        AnyValue::String(text) => text.into(),
        // A column of one text in every row comes so.
        AnyValue::StringOwned(text) => text.as_str().into(),
        AnyValue::UInt32(count) => count.into(),
        AnyValue::UInt64(count) => count.into(),
        AnyValue::Int64(count) => count.into(),
        // JSON has no infinities: such a number is null.
        AnyValue::Float64(number) => number.into(),
        other => {
            let kind = other.dtype().to_string();
            return Err(PolarsError::ComputeError(
                format!("no JSON for a column of {kind}").into(),
            ));
        }
    })
}
