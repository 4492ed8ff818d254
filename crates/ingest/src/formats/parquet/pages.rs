//! What the heads of pages declare, checked before a library reserves memory by it.
//!
//! A head is a record in the compact protocol of Thrift (Apache Thrift, doc/specs/thrift-compact-protocol.md); its fields
//! are those of `PageHeader` in the Parquet format's parquet.thrift. Only whole numbers are looked at.

use parquet::basic::Type;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};

use super::columns::Kind;
use super::error::broken;
use crate::formats::error::ReadError;

/// Deepest nesting of records in a head; the format itself needs three.
const DEEPEST: u32 = 8;
/// Fewest bytes that a value of a dictionary takes: four of a number or of the length of a text, fewer of what has a length of
/// its own.
fn least_bytes(column: &ColumnChunkMetaData) -> i64 {
    match column.column_type() {
        Type::FIXED_LEN_BYTE_ARRAY => i64::from(column.column_descr().type_length().max(1)),
        _ => 4,
    }
}

/// Encodings of texts, as parquet.thrift numbers them, whose pages state beside their head how many texts they hold: the
/// library makes room for that number as it is. Columns in them are left out.
const TEXTS_BY_DELTA: [i64; 2] = [6, 7];

/// Fields of a head, by the numbers of parquet.thrift; those of inner records follow the outer number by two digits.
mod field {
    pub const UNPACKED_BYTES: u32 = 2;
    pub const PACKED_BYTES: u32 = 3;
    pub const VALUES: u32 = 501;
    pub const ENCODING: u32 = 502;
    pub const ENCODING_V2: u32 = 804;
    pub const DICTIONARY_VALUES: u32 = 701;
    pub const VALUES_V2: u32 = 801;
}

/// What one head declares.
#[derive(Debug, Default)]
struct Declared {
    unpacked_bytes: i64,
    packed_bytes: i64,
    values: i64,
    dictionary_values: i64,
    encoding: i64,
}

/// Checks the pages of every column that is read.
pub fn check(bytes: &[u8], file: &ParquetMetaData, kept: &[(usize, Kind)]) -> Result<(), ReadError> {
    for (number, group) in file.row_groups().iter().enumerate() {
        for (leaf, _) in kept {
            let column = group.column(*leaf);
            check_column(bytes, column, group.num_rows()).map_err(|found| {
                broken(&format!(
                    "row group {}, column {}: {found}",
                    number + 1,
                    column.column_path()
                ))
            })?;
        }
    }
    Ok(())
}

fn check_column(bytes: &[u8], column: &ColumnChunkMetaData, rows: i64) -> Result<(), String> {
    let first = column
        .dictionary_page_offset()
        .unwrap_or_else(|| column.data_page_offset());
    let end = first.checked_add(column.compressed_size());
    let range = usize::try_from(first)
        .ok()
        .zip(end.and_then(|end| usize::try_from(end).ok()));
    let pages = range.and_then(|(first, end)| bytes.get(first..end));
    let mut rest = pages.ok_or("its pages are declared to lie outside the file")?;
    let (mut unpacked, mut values) = (0i64, 0i64);
    while !rest.is_empty() && values < rows {
        let mut head = Compact { rest };
        let declared = head
            .page()
            .ok_or("the head of a page is no whole record of numbers")?;
        let packed = usize::try_from(declared.packed_bytes).ok();
        rest = packed
            .and_then(|packed| head.rest.get(packed..))
            .ok_or_else(|| format!("a page declares {} bytes", declared.packed_bytes))?;
        if declared.dictionary_values < 0
            || declared.dictionary_values > declared.unpacked_bytes.max(0) / least_bytes(column)
        {
            return Err(format!(
                "a dictionary declares {} values in {} bytes",
                declared.dictionary_values, declared.unpacked_bytes
            ));
        }
        unpacked = unpacked.saturating_add(declared.unpacked_bytes);
        values = values.saturating_add(declared.values);
        if declared.unpacked_bytes < 0 || unpacked > column.uncompressed_size() {
            return Err(format!(
                "its pages declare {unpacked} bytes unpacked, the table of contents {}",
                column.uncompressed_size()
            ));
        }
        if TEXTS_BY_DELTA.contains(&declared.encoding) {
            return Err("a page is in another encoding than the table of contents lists".to_owned());
        }
        if declared.values < 0 {
            return Err(format!("a page declares {} values", declared.values));
        }
    }
    if values == rows {
        Ok(())
    } else {
        Err(format!(
            "its pages declare {values} values, its row group {rows} rows"
        ))
    }
}

/// A reader of the compact protocol; `None` wherever the bytes do not hold what they must.
struct Compact<'a> {
    rest: &'a [u8],
}

impl Compact<'_> {
    fn page(&mut self) -> Option<Declared> {
        let mut page = Declared::default();
        self.record(0, 0, &mut |at, number| match at {
            field::UNPACKED_BYTES => page.unpacked_bytes = number,
            field::PACKED_BYTES => page.packed_bytes = number,
            field::VALUES | field::VALUES_V2 => page.values = number,
            field::DICTIONARY_VALUES => page.dictionary_values = number,
            field::ENCODING | field::ENCODING_V2 => page.encoding = number,
            _ => {}
        })?;
        Some(page)
    }

    /// Reads a record to its end and tells its whole numbers.
    fn record(&mut self, outer: u32, depth: u32, found: &mut dyn FnMut(u32, i64)) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        let mut number = 0u32;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            number = match u32::from(head >> 4) {
                0 => u32::try_from(self.signed()?).ok()?,
                step => number + step,
            };
            let at = outer.checked_mul(100)?.checked_add(number)?;
            self.value(head & 15, at, depth, found)?;
        }
    }

    fn value(&mut self, kind: u8, at: u32, depth: u32, found: &mut dyn FnMut(u32, i64)) -> Option<()> {
        match kind {
            1 | 2 => Some(()),
            3 => self.skip(1),
            4..=6 => {
                found(at, self.signed()?);
                Some(())
            }
            7 => self.skip(8),
            8 => {
                let length = usize::try_from(self.unsigned()?).ok()?;
                self.skip(length)
            }
            12 => self.record(at, depth + 1, found),
            // A head holds no lists, sets or maps.
            _ => None,
        }
    }

    fn byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(first)
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.rest = self.rest.get(count..)?;
        Some(())
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut number = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    /// A number whose sign stands in the lowest bit.
    fn signed(&mut self) -> Option<i64> {
        let number = self.unsigned()?;
        Some((number >> 1) as i64 ^ -((number & 1) as i64))
    }
}
