//! The text columns of a Parquet file, row by row: what other programs hand over that is no run.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::record::Field;

/// Texts of each row by the name of their column; what is null or no text is left out.
///
/// # Errors
/// In words, why the file cannot be read.
pub fn read(bytes: &[u8]) -> Result<Vec<BTreeMap<String, String>>, String> {
    // The library ends by a panic on some damaged files.
    let read = || rows(bytes).map_err(|error| error.to_string());
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("the file is damaged".to_owned()))
}

fn rows(bytes: &[u8]) -> Result<Vec<BTreeMap<String, String>>, parquet::errors::ParquetError> {
    let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes))?;
    let mut rows = Vec::new();
    for row in reader.get_row_iter(None)? {
        let row = row?;
        let texts = row.get_column_iter().filter_map(|(name, field)| match field {
            Field::Str(text) => Some((name.clone(), text.clone())),
            _ => None,
        });
        rows.push(texts.collect());
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_no_parquet_is_refused_in_words() {
        assert!(super::read(b"PAR1 and nothing more PAR1").is_err());
        assert!(super::read(b"").is_err());
    }
}
