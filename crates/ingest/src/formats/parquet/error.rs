//! What is said of a Parquet file that contradicts itself.

use crate::formats::error::{ReadError, escaped};

pub(super) fn failed(error: parquet::errors::ParquetError) -> ReadError {
    broken(&error.to_string())
}

pub(super) fn broken(found: &str) -> ReadError {
    ReadError::BrokenContainer {
        kind: "Parquet file",
        found: escaped(found),
    }
}
