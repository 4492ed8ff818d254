//! Raw values of a segment: chunk after chunk, contiguous or interleaved, the last chunk maybe cut.

use super::cursor::{Cursor, DataType};
use super::segments::{Object, Property, RawData, RawIndex};
use crate::formats::ReadError;
use crate::formats::error::quoted;

/// Adds the values of a segment to its objects.
///
/// # Errors
/// The segment has values, but no object says which; texts that are interleaved.
pub fn add(bytes: &[u8], objects: &mut [Object], raw: &RawData) -> Result<(), ReadError> {
    let indices: Vec<(usize, RawIndex)> = raw
        .order
        .iter()
        .filter_map(|&place| Some((place, objects[place].index?)))
        .collect();
    let chunk: u64 = indices
        .iter()
        .fold(0, |sum, (_, index)| sum.saturating_add(index.bytes));
    if chunk == 0 {
        return Ok(());
    }
    let mut cursor = Cursor {
        bytes: &bytes[..raw.bytes.end],
        at: raw.bytes.start,
        big_endian: raw.big_endian,
    };
    if indices.iter().any(|(_, index)| index.stride.is_some()) {
        return super::daqmx::add(&cursor, objects, &indices);
    }
    if raw.interleaved {
        return interleaved(&mut cursor, objects, &indices, raw.bytes.start);
    }
    while cursor.at < raw.bytes.end {
        for (place, index) in &indices {
            contiguous(&mut cursor, &mut objects[*place], *index);
        }
    }
    Ok(())
}

fn contiguous(cursor: &mut Cursor<'_>, object: &mut Object, index: RawIndex) {
    let length = usize::try_from(index.bytes).unwrap_or(usize::MAX);
    let end = cursor.at.saturating_add(length).min(cursor.bytes.len());
    match index.kind {
        DataType::Text => {
            let is_whole = end - cursor.at == length;
            let count = if is_whole {
                index.count.min(index.bytes / 4)
            } else {
                0
            };
            object.values.extend((0..count).map(|_| f64::NAN));
        }
        kind => {
            let mut part = Cursor {
                bytes: &cursor.bytes[..end],
                ..*cursor
            };
            part.numbers(kind, &mut object.values);
        }
    }
    cursor.at = end;
}

fn interleaved(
    cursor: &mut Cursor<'_>,
    objects: &mut [Object],
    indices: &[(usize, RawIndex)],
    start: usize,
) -> Result<(), ReadError> {
    if indices.iter().any(|(_, index)| index.kind == DataType::Text) {
        return Err(ReadError::Structure {
            offset: start as u64,
            found: "texts among interleaved values".to_owned(),
            needed: "values of a fixed size",
        });
    }
    loop {
        for (place, index) in indices {
            match cursor.number(index.kind) {
                Some(number) => objects[*place].values.push(number),
                None => return Ok(()),
            }
        }
    }
}

/// Applies the linear scale of a channel whose values are stored raw.
///
/// # Errors
/// The values are raw and their scale is none that was ever seen.
pub fn scale(object: &mut Object) -> Result<(), ReadError> {
    let text = |name: &str| match object.property(name) {
        Some(Property::Text(text)) => Some(text.as_str()),
        _ => None,
    };
    let number = |name: &str| match object.property(name) {
        Some(Property::Number(number)) => Some(*number),
        _ => None,
    };
    if text("NI_Scaling_Status") != Some("unscaled") {
        return Ok(());
    }
    let scales = number("NI_Number_Of_Scales").unwrap_or(0.0);
    let kind = text("NI_Scale[1]_Scale_Type");
    let linear = (
        number("NI_Scale[1]_Linear_Slope"),
        number("NI_Scale[1]_Linear_Y_Intercept"),
    );
    let source = number("NI_Scale[1]_Linear_Input_Source").unwrap_or(0.0);
    let has_raw_scale = text("NI_Scale[0]_Scale_Type").is_some();
    match (kind, linear) {
        (Some("Linear"), (Some(slope), Some(intercept)))
            if scales == 2.0 && source == 0.0 && !has_raw_scale =>
        {
            object
                .values
                .iter_mut()
                .for_each(|value| *value = *value * slope + intercept);
            Ok(())
        }
        _ => Err(ReadError::NeverSeen {
            what: "this scale of raw TDMS values",
            found: format!("{scales} scales, {}", quoted(kind.unwrap_or("none"))),
        }),
    }
}
