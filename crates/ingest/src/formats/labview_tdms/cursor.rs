//! Reading numbers and texts from a TDMS file in the byte order of a segment.

use crate::formats::ReadError;

/// A place in a file with its byte order.
#[derive(Debug, Clone, Copy)]
pub struct Cursor<'a> {
    /// The whole file, or the part that may be read.
    pub bytes: &'a [u8],
    /// Place, bytes from the start.
    pub at: usize,
    /// Whether the most significant byte stands first.
    pub big_endian: bool,
}

impl<'a> Cursor<'a> {
    /// The next `count` bytes; none where the file ends before.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut array: [u8; N] = self.take(N)?.try_into().ok()?;
        if self.big_endian {
            array.reverse();
        }
        Some(array)
    }

    /// An unsigned 32-bit number.
    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// An unsigned 64-bit number.
    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// A text with its length before it.
    pub fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        self.take(length)
            .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// A number of that type; NaN for types that are no number.
    pub fn number(&mut self, kind: DataType) -> Option<f64> {
        let number = match kind {
            DataType::I8 => f64::from(i8::from_le_bytes(self.array()?)),
            DataType::I16 => f64::from(i16::from_le_bytes(self.array()?)),
            DataType::I32 => f64::from(i32::from_le_bytes(self.array()?)),
            DataType::I64 => i64::from_le_bytes(self.array()?) as f64,
            DataType::U8 | DataType::Bool => f64::from(u8::from_le_bytes(self.array()?)),
            DataType::U16 => f64::from(u16::from_le_bytes(self.array()?)),
            DataType::U32 => f64::from(self.u32()?),
            DataType::U64 => self.u64()? as f64,
            DataType::F32 => f64::from(f32::from_le_bytes(self.array()?)),
            DataType::F64 => f64::from_le_bytes(self.array()?),
            DataType::Time => {
                let time = self.time()?;
                time.seconds as f64 + time.fraction()
            }
            DataType::Text => return None,
        };
        Some(number)
    }

    /// Adds every whole number of that type up to the end.
    pub fn numbers(&mut self, kind: DataType, into: &mut Vec<f64>) {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        // The types that long records have, without a decision for each value.
        let read = match (kind, self.big_endian) {
            (DataType::F64, false) => all(rest, into, f64::from_le_bytes),
            (DataType::F32, false) => all(rest, into, |bytes| f64::from(f32::from_le_bytes(bytes))),
            (DataType::I16, false) => all(rest, into, |bytes| f64::from(i16::from_le_bytes(bytes))),
            (DataType::I32, false) => all(rest, into, |bytes| f64::from(i32::from_le_bytes(bytes))),
            _ => 0,
        };
        self.at += read;
        while let Some(number) = self.number(kind) {
            into.push(number);
        }
    }

    /// A time stamp; its two parts stand in the other order where the most significant byte stands first.
    pub fn time(&mut self) -> Option<TimeStamp> {
        let (first, second) = (self.u64()?, self.u64()?);
        let (fractions, seconds) = if self.big_endian {
            (second, first)
        } else {
            (first, second)
        };
        Some(TimeStamp {
            seconds: seconds as i64,
            fractions,
        })
    }
}

/// Adds a number for every `N` bytes; gives how many bytes were read.
fn all<const N: usize>(bytes: &[u8], into: &mut Vec<f64>, number: impl Fn([u8; N]) -> f64) -> usize {
    let (whole, rest) = bytes.as_chunks::<N>();
    into.reserve(whole.len());
    into.extend(whole.iter().map(|bytes| number(*bytes)));
    bytes.len() - rest.len()
}

/// Seconds since 1904-01-01 UTC, and parts of 2^64 of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TimeStamp {
    /// Whole seconds.
    pub seconds: i64,
    /// Parts of 2^64 of a second.
    pub fractions: u64,
}

impl TimeStamp {
    /// The part of a second.
    pub fn fraction(self) -> f64 {
        self.fractions as f64 / 2f64.powi(64)
    }

    /// Time since an earlier moment, s.
    pub fn seconds_after(self, earlier: TimeStamp) -> f64 {
        let whole = self.seconds.saturating_sub(earlier.seconds) as f64;
        whole + (self.fraction() - earlier.fraction())
    }
}

/// Types of values that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are those of the Rust types")]
pub enum DataType {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Bool,
    Time,
    Text,
}

impl DataType {
    /// The type of a code.
    ///
    /// # Errors
    /// Complex and extended numbers, fixed points and DAQmx data were never seen.
    pub fn of(code: u32) -> Result<DataType, ReadError> {
        Ok(match code {
            1 => DataType::I8,
            2 => DataType::I16,
            3 => DataType::I32,
            4 => DataType::I64,
            5 => DataType::U8,
            6 => DataType::U16,
            7 => DataType::U32,
            8 => DataType::U64,
            9 | 0x19 => DataType::F32,
            10 | 0x1A => DataType::F64,
            0x20 => DataType::Text,
            0x21 => DataType::Bool,
            0x44 => DataType::Time,
            _ => {
                return Err(ReadError::NeverSeen {
                    what: "this type of TDMS values",
                    found: format!("type {code:#x}"),
                });
            }
        })
    }

    /// Bytes of one value; a text has no fixed size.
    pub fn size(self) -> Option<usize> {
        Some(match self {
            DataType::I8 | DataType::U8 | DataType::Bool => 1,
            DataType::I16 | DataType::U16 => 2,
            DataType::I32 | DataType::U32 | DataType::F32 => 4,
            DataType::I64 | DataType::U64 | DataType::F64 => 8,
            DataType::Time => 16,
            DataType::Text => return None,
        })
    }
}
