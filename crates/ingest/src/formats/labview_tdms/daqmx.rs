//! Raw DAQmx values in TDMS: the samples of all channels side by side in one buffer, row after row.

use super::cursor::{Cursor, DataType};
use super::segments::{Object, RawIndex};
use crate::formats::ReadError;

/// Index of analogue channels.
const FORMAT_CHANGING: u32 = 0x0000_1269;
/// Index of digital lines.
const DIGITAL_LINE: u32 = 0x0000_126A;

/// Place of a channel's value in a row of the buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stride {
    /// Bytes from the start of the row.
    pub offset: usize,
    /// Bytes of a row.
    pub width: usize,
}

/// Whether an index is one of DAQmx.
pub fn is_daqmx(kind: u32) -> bool {
    matches!(kind, FORMAT_CHANGING | DIGITAL_LINE)
}

/// Reads the index of a channel; none where the file ends in it.
///
/// # Errors
/// Digital lines, several scalers or buffers, unknown types.
pub fn raw_index(cursor: &mut Cursor<'_>, kind: u32) -> Result<Option<RawIndex>, ReadError> {
    if kind == DIGITAL_LINE {
        return Err(never_seen("a digital line"));
    }
    let (Some(_type), Some(_dimension), Some(count)) = (cursor.u32(), cursor.u32(), cursor.u64()) else {
        return Ok(None);
    };
    let Some(scalers) = cursor.u32() else {
        return Ok(None);
    };
    if scalers != 1 {
        return Err(never_seen(&format!("{scalers} scalers of a channel")));
    }
    let scaler = (
        cursor.u32(),
        cursor.u32(),
        cursor.u32(),
        cursor.u32(),
        cursor.u32(),
    );
    let (Some(code), Some(buffer), Some(offset), Some(_bitmap), Some(_scale)) = scaler else {
        return Ok(None);
    };
    let (Some(buffers), Some(width)) = (cursor.u32(), cursor.u32()) else {
        return Ok(None);
    };
    if buffers != 1 || buffer != 0 {
        return Err(never_seen(&format!("{buffers} buffers")));
    }
    let kind = match code {
        0 => DataType::U8,
        1 => DataType::I8,
        2 => DataType::U16,
        3 => DataType::I16,
        4 => DataType::U32,
        5 => DataType::I32,
        _ => return Err(never_seen(&format!("type {code}"))),
    };
    let (offset, width) = (offset as usize, width as usize);
    let fits = kind.size().is_some_and(|size| offset + size <= width);
    if !fits {
        return Err(ReadError::Structure {
            offset: cursor.at as u64,
            found: format!("a value at {offset} of rows of {width} bytes"),
            needed: "a value inside its row",
        });
    }
    Ok(Some(RawIndex {
        kind,
        count,
        bytes: count.saturating_mul(width as u64),
        stride: Some(Stride { offset, width }),
    }))
}

fn never_seen(found: &str) -> ReadError {
    ReadError::NeverSeen {
        what: "this kind of raw DAQmx data",
        found: found.to_owned(),
    }
}

/// Adds the values of a segment: every row holds one of each channel. A cut row gives the values that are whole.
///
/// # Errors
/// Channels of DAQmx beside others, or rows of different widths.
pub fn add(
    cursor: &Cursor<'_>,
    objects: &mut [Object],
    indices: &[(usize, RawIndex)],
) -> Result<(), ReadError> {
    let width = indices[0].1.stride.map_or(0, |stride| stride.width);
    let fits = |(_, index): &(usize, RawIndex)| index.stride.is_some_and(|stride| stride.width == width);
    if width == 0 || !indices.iter().all(fits) {
        return Err(never_seen("rows of different widths"));
    }
    for row in (cursor.at..cursor.bytes.len()).step_by(width) {
        for (place, index) in indices {
            let at = row + index.stride.map_or(0, |stride| stride.offset);
            if let Some(number) = (Cursor { at, ..*cursor }).number(index.kind) {
                objects[*place].values.push(number);
            }
        }
    }
    Ok(())
}
