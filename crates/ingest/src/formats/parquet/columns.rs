//! Columns of a Parquet file to columns of cells.

use parquet::basic::{ConvertedType, Encoding, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::schema::types::ColumnDescriptor;

use super::error::{broken, failed};
use crate::formats::cells::CellColumn;
use crate::formats::error::ReadError;
use crate::text::Cell;

/// Rows that are decoded at once.
const CHUNK: usize = 4096;

/// What a column holds, where it can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Numbers or yes and no, with their sign.
    Number,
    /// Whole numbers without a sign: the bytes are those of numbers with one.
    Unsigned,
    /// Texts.
    Text,
}

impl Kind {
    /// What the column holds, or in words what it holds that is not read.
    pub fn of(column: &ColumnDescriptor) -> Result<Kind, &'static str> {
        if column.path().parts().len() > 1 || column.max_rep_level() > 0 {
            return Err("lists or groups");
        }
        match (column.physical_type(), column.logical_type_ref()) {
            (Type::BOOLEAN | Type::FLOAT | Type::DOUBLE, _) => Ok(Kind::Number),
            (Type::INT32 | Type::INT64, Some(LogicalType::Integer(whole))) => {
                if whole.is_signed {
                    Ok(Kind::Number)
                } else {
                    Ok(Kind::Unsigned)
                }
            }
            (Type::INT32 | Type::INT64, None) => of_older_files(column.converted_type()),
            (Type::BYTE_ARRAY, Some(LogicalType::String)) => Ok(Kind::Text),
            (Type::BYTE_ARRAY, None) if column.converted_type() == ConvertedType::UTF8 => Ok(Kind::Text),
            (_, Some(LogicalType::Timestamp(_))) | (Type::INT96, _) => Err("points in time"),
            (_, Some(LogicalType::Date | LogicalType::Time(_))) => Err("dates or times of day"),
            (_, Some(LogicalType::Decimal(_))) => Err("decimal numbers of fixed point"),
            _ => Err("bytes without a meaning"),
        }
    }
}

/// Whether the table of contents lists an encoding of texts by their differences: see `pages`.
pub fn is_by_delta(column: &ColumnChunkMetaData) -> bool {
    let mask = column.encodings_mask();
    mask.is_set(Encoding::DELTA_LENGTH_BYTE_ARRAY) || mask.is_set(Encoding::DELTA_BYTE_ARRAY)
}

/// Whole numbers of files that state their meaning in the way of before 2018.
fn of_older_files(kind: ConvertedType) -> Result<Kind, &'static str> {
    use ConvertedType as C;
    match kind {
        C::NONE | C::INT_8 | C::INT_16 | C::INT_32 | C::INT_64 => Ok(Kind::Number),
        C::UINT_8 | C::UINT_16 | C::UINT_32 | C::UINT_64 => Ok(Kind::Unsigned),
        C::DECIMAL => Err("decimal numbers of fixed point"),
        _ => Err("dates or times"),
    }
}

/// Adds the rows of a row group to a column; `max_level` is the level of a cell that is not empty.
pub fn fill(
    column: &mut CellColumn,
    reader: ColumnReader,
    kind: Kind,
    max_level: i16,
) -> Result<(), ReadError> {
    let unsigned = kind == Kind::Unsigned;
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            numbers(column, reader, max_level, |&yes| f64::from(u8::from(yes)))
        }
        ColumnReader::Int32ColumnReader(reader) if unsigned => {
            numbers(column, reader, max_level, |&n| f64::from(n as u32))
        }
        ColumnReader::Int32ColumnReader(reader) => numbers(column, reader, max_level, |&n| f64::from(n)),
        ColumnReader::Int64ColumnReader(reader) if unsigned => {
            numbers(column, reader, max_level, |&n| n as u64 as f64)
        }
        ColumnReader::Int64ColumnReader(reader) => numbers(column, reader, max_level, |&n| n as f64),
        ColumnReader::FloatColumnReader(reader) => numbers(column, reader, max_level, |&n| f64::from(n)),
        ColumnReader::DoubleColumnReader(reader) => numbers(column, reader, max_level, |&n| n),
        ColumnReader::ByteArrayColumnReader(reader) => rows(reader, max_level, |text| {
            let text = text.map(|text| text.as_utf8().map_err(failed)).transpose()?;
            let text = text.unwrap_or("");
            let cell = if text.trim().is_empty() {
                Cell::Empty
            } else {
                Cell::Text
            };
            column.push(column.numbers.len() + 1, cell, || text.to_owned());
            Ok(())
        }),
        _ => Err(broken("a column is of another kind than its schema says")),
    }
}

fn numbers<T: DataType>(
    column: &mut CellColumn,
    reader: ColumnReaderImpl<T>,
    max_level: i16,
    number_of: impl Fn(&T::T) -> f64,
) -> Result<(), ReadError> {
    rows(reader, max_level, |value| {
        let number = value.map(&number_of);
        let cell = match number {
            None => Cell::Empty,
            Some(number) if number.is_finite() => Cell::Number(number),
            Some(_) => Cell::NotFinite,
        };
        column.push(column.numbers.len() + 1, cell, || {
            number.map_or(String::new(), |number| number.to_string())
        });
        Ok(())
    })
}

/// Gives every row of a column to `take`, `None` where its cell is empty.
fn rows<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    max_level: i16,
    mut take: impl FnMut(Option<&T::T>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut values: Vec<T::T> = Vec::new();
    let mut levels: Vec<i16> = Vec::new();
    loop {
        values.clear();
        levels.clear();
        let (count, ..) = reader
            .read_records(CHUNK, Some(&mut levels), None, &mut values)
            .map_err(failed)?;
        if count == 0 {
            return Ok(());
        }
        let mut filled = values.iter();
        if max_level == 0 {
            filled.by_ref().try_for_each(|value| take(Some(value)))?;
        }
        for &level in &levels {
            let value = if level == max_level {
                Some(
                    filled
                        .next()
                        .ok_or_else(|| broken("a page ends before its cells do"))?,
                )
            } else {
                None
            };
            take(value)?;
        }
        if filled.next().is_some() {
            return Err(broken("a page holds more values than cells"));
        }
    }
}
