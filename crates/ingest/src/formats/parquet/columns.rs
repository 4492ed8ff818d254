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
    /// Numbers of fixed point: whole ones with so many digits behind the point. Durations are such, of seconds.
    Fixed(i32),
    /// Numbers of two bytes.
    Half,
    /// Texts.
    Text,
}

impl Kind {
    /// What the column holds, or in words what it holds that is not read; of a duration with its digits behind the second.
    pub fn of(column: &ColumnDescriptor, of_duration: Option<i32>) -> Result<Kind, &'static str> {
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
            (_, Some(LogicalType::Decimal(decimal))) => Ok(Kind::Fixed(decimal.scale)),
            (_, None) if column.converted_type() == ConvertedType::DECIMAL => {
                Ok(Kind::Fixed(column.type_scale()))
            }
            (Type::FIXED_LEN_BYTE_ARRAY, Some(LogicalType::Float16)) => Ok(Kind::Half),
            (Type::INT64, None) if of_duration.is_some() => Ok(Kind::Fixed(of_duration.unwrap_or_default())),
            (Type::INT32 | Type::INT64, None) => of_older_files(column.converted_type()),
            (Type::BYTE_ARRAY, Some(LogicalType::String)) => Ok(Kind::Text),
            (Type::BYTE_ARRAY, None) if column.converted_type() == ConvertedType::UTF8 => Ok(Kind::Text),
            (_, Some(LogicalType::Timestamp(_))) | (Type::INT96, _) => Err("points in time"),
            (_, Some(LogicalType::Date | LogicalType::Time(_))) => Err("dates or times of day"),
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
    let scale = match kind {
        Kind::Fixed(scale) => scale,
        _ => 0,
    };
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            numbers(column, reader, max_level, |&yes| f64::from(u8::from(yes)))
        }
        ColumnReader::Int32ColumnReader(reader) if unsigned => {
            numbers(column, reader, max_level, |&n| f64::from(n as u32))
        }
        ColumnReader::Int32ColumnReader(reader) => {
            numbers(column, reader, max_level, |&n| at_scale(f64::from(n), scale))
        }
        ColumnReader::Int64ColumnReader(reader) if unsigned => {
            numbers(column, reader, max_level, |&n| n as u64 as f64)
        }
        ColumnReader::Int64ColumnReader(reader) => {
            numbers(column, reader, max_level, |&n| at_scale(n as f64, scale))
        }
        ColumnReader::FixedLenByteArrayColumnReader(reader) if kind == Kind::Half => {
            numbers(column, reader, max_level, |bytes| half(bytes.data()))
        }
        ColumnReader::FixedLenByteArrayColumnReader(reader) => numbers(column, reader, max_level, |bytes| {
            at_scale(whole(bytes.data()), scale)
        }),
        ColumnReader::ByteArrayColumnReader(reader) if matches!(kind, Kind::Fixed(_)) => {
            numbers(column, reader, max_level, |bytes| {
                at_scale(whole(bytes.data()), scale)
            })
        }
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

/// A whole number with so many digits behind the point, rounded once.
fn at_scale(whole: f64, digits: i32) -> f64 {
    let ten = 10f64.powi(digits.abs());
    if digits < 0 { whole * ten } else { whole / ten }
}

/// A whole number with its sign, the highest byte first; NaN where it is longer than any decimal.
fn whole(bytes: &[u8]) -> f64 {
    if bytes.len() > size_of::<i128>() {
        return f64::NAN;
    }
    let sign = bytes
        .first()
        .map_or(0, |first| i128::from((*first).cast_signed() >> 7));
    bytes.iter().fold(sign, |all, byte| all << 8 | i128::from(*byte)) as f64
}

/// A number of IEEE 754's binary16, the lowest byte first.
fn half(bytes: &[u8]) -> f64 {
    let &[low, high] = bytes else {
        return f64::NAN;
    };
    let bits = u16::from_le_bytes([low, high]);
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    let size = match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
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
