//! A Parquet file row by row: what other programs hand over that is no run.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use parquet::file::reader::FileReader;
use parquet::record::{Field, Row};
use serde_json::Value;

use crate::formats::parquet::opened;
use crate::formats::unpacking;

/// Cells of each row by the name of their column, as JSON has them; a column of dates, bytes or maps is left out.
///
/// # Errors
/// In words, why the file cannot be read.
pub fn read(bytes: &[u8]) -> Result<Vec<BTreeMap<String, Value>>, String> {
    // The library ends by a panic on some damaged files.
    let read = || rows(bytes);
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("the file is damaged".to_owned()))
}

fn rows(bytes: &[u8]) -> Result<Vec<BTreeMap<String, Value>>, String> {
    let in_words = |error: parquet::errors::ParquetError| error.to_string();
    let (reader, _) = opened(bytes, unpacking::MOST).map_err(|error| error.to_string())?;
    let rows = reader.get_row_iter(None).map_err(in_words)?;
    rows.map(|row| Ok(cells(&row.map_err(in_words)?).collect()))
        .collect()
}

fn cells(row: &Row) -> impl Iterator<Item = (String, Value)> {
    row.get_column_iter()
        .filter_map(|(name, field)| Some((name.clone(), value(field)?)))
}

/// A cell as JSON; none of what JSON does not have.
fn value(field: &Field) -> Option<Value> {
    Some(match field {
        Field::Null => Value::Null,
        Field::Bool(flag) => (*flag).into(),
        Field::Int(number) => (*number).into(),
        Field::Long(number) => (*number).into(),
        Field::UInt(number) => (*number).into(),
        Field::ULong(number) => (*number).into(),
        Field::Float(number) => (*number).into(),
        Field::Double(number) => (*number).into(),
        Field::Str(text) => text.as_str().into(),
        Field::Group(row) => cells(row).collect(),
        Field::ListInternal(list) => list.elements().iter().filter_map(value).collect(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_no_parquet_is_refused_in_words() {
        assert!(super::read(b"PAR1 and nothing more PAR1").is_err());
        assert!(super::read(b"").is_err());
    }
}
