//! Data elements of a .mat file: a tag of type and size, then the data, filled up to eight bytes.

use crate::formats::error::ReadError;
use crate::formats::unpacking::of_zlib;

/// Types of data; numbers of the format.
pub const INT8: u32 = 1;
pub const UINT8: u32 = 2;
pub const INT16: u32 = 3;
pub const UINT16: u32 = 4;
pub const INT32: u32 = 5;
pub const UINT32: u32 = 6;
pub const SINGLE: u32 = 7;
pub const DOUBLE: u32 = 9;
pub const INT64: u32 = 12;
pub const UINT64: u32 = 13;
pub const MATRIX: u32 = 14;
pub const COMPRESSED: u32 = 15;
pub const UTF8: u32 = 16;
pub const UTF16: u32 = 17;

/// Bytes of a file, or of what was packed in it, with the order of bytes in numbers.
#[derive(Clone, Copy)]
pub struct Bytes<'a> {
    pub bytes: &'a [u8],
    pub is_big_endian: bool,
    /// Where they begin in the file; of packed bytes where the packed ones do.
    pub offset: u64,
}

/// One element.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    pub kind: u32,
    pub data: Bytes<'a>,
}

impl<'a> Bytes<'a> {
    /// Takes the next element off; none at the end.
    pub fn next(&mut self) -> Result<Option<Element<'a>>, ReadError> {
        if self.bytes.is_empty() {
            return Ok(None);
        }
        let head = self
            .bytes
            .get(..8)
            .ok_or_else(|| self.broken("the head of an element breaks off"))?;
        let word = |at: usize| self.word(&head[at..at + 4]);
        // A small element has size and type in one word and its data in the other.
        let (kind, size, start, whole) = match word(0) >> 16 {
            0 => {
                let size = word(4) as usize;
                let filled = match word(0) {
                    COMPRESSED => size,
                    _ => size.checked_next_multiple_of(8).unwrap_or(usize::MAX),
                };
                (word(0), size, 8usize, filled.saturating_add(8))
            }
            size => (word(0) & 0xffff, size as usize, 4, 8),
        };
        let end = start.saturating_add(size);
        let data = self
            .bytes
            .get(start..end)
            .filter(|_| start == 8 || size <= 4)
            .ok_or_else(|| {
                self.broken(&format!(
                    "an element declares {size} bytes, {} are there",
                    self.bytes.len().saturating_sub(start)
                ))
            })?;
        let element = Element {
            kind,
            data: Bytes {
                bytes: data,
                offset: self.offset + start as u64,
                ..*self
            },
        };
        // The last element need not be filled up.
        let taken = whole.min(self.bytes.len());
        self.bytes = &self.bytes[taken..];
        self.offset += taken as u64;
        Ok(Some(element))
    }

    /// The next element, of one of these types.
    pub fn expect(&mut self, kinds: &[u32], what: &'static str) -> Result<Element<'a>, ReadError> {
        let here = *self;
        match self.next()? {
            Some(element) if kinds.contains(&element.kind) => Ok(element),
            Some(element) => {
                Err(here.broken(&format!("an element of type {} in place of {what}", element.kind)))
            }
            None => Err(here.broken(&format!("{what} is missing"))),
        }
    }

    fn word(&self, bytes: &[u8]) -> u32 {
        let bytes: [u8; 4] = std::array::from_fn(|at| bytes[at]);
        if self.is_big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        }
    }

    /// That these bytes are not as the format says.
    pub fn broken(&self, found: &str) -> ReadError {
        ReadError::Structure {
            offset: self.offset,
            found: found.to_owned(),
            needed: "a whole .mat file of version 5; save it again",
        }
    }
}

impl Element<'_> {
    /// How many numbers it holds; 0 where its type is unknown.
    pub fn count(&self) -> usize {
        let width = match self.kind {
            INT8 | UINT8 | UTF8 => 1,
            INT16 | UINT16 | UTF16 => 2,
            INT32 | UINT32 | SINGLE => 4,
            INT64 | UINT64 | DOUBLE => 8,
            _ => return 0,
        };
        self.data.bytes.len() / width
    }

    /// The numbers that it holds, whatever they are stored as: MATLAB stores whole doubles as small integers.
    pub fn numbers(&self) -> Result<Vec<f64>, ReadError> {
        macro_rules! of {
            ($number:ty) => {{
                const WIDTH: usize = size_of::<$number>();
                let parts = self.data.bytes.chunks_exact(WIDTH);
                if !parts.remainder().is_empty() {
                    return Err(self.data.broken("a list of numbers breaks off in a number"));
                }
                let number = |part: &[u8]| {
                    let bytes: [u8; WIDTH] = std::array::from_fn(|at| part[at]);
                    match self.data.is_big_endian {
                        true => <$number>::from_be_bytes(bytes) as f64,
                        false => <$number>::from_le_bytes(bytes) as f64,
                    }
                };
                parts.map(number).collect()
            }};
        }
        Ok(match self.kind {
            INT8 => of!(i8),
            UINT8 | UTF8 => of!(u8),
            INT16 => of!(i16),
            UINT16 | UTF16 => of!(u16),
            INT32 => of!(i32),
            UINT32 => of!(u32),
            SINGLE => of!(f32),
            DOUBLE => of!(f64),
            INT64 => of!(i64),
            UINT64 => of!(u64),
            other => return Err(self.data.broken(&format!("numbers of the unknown type {other}"))),
        })
    }

    /// What it packs; at most `limit` bytes.
    pub fn unpacked(&self, limit: u64) -> Result<Vec<u8>, ReadError> {
        let unpacked = of_zlib(self.data.bytes, limit).map_err(|error| {
            self.data
                .broken(&format!("a packed variable cannot be unpacked ({error})"))
        })?;
        unpacked.ok_or_else(|| ReadError::TooLarge {
            what: "the .mat file unpacked".to_owned(),
            found: limit + 1,
            limit,
        })
    }
}
