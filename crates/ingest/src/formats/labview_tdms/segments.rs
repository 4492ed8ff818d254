//! Segments of a TDMS file: lead-in, objects with their properties, and where the raw values stand.

use std::collections::HashMap;

use super::cursor::{Cursor, DataType, TimeStamp};
use super::daqmx::{self, Stride};
use crate::formats::ReadError;

/// Bytes of a lead-in.
const LEAD_IN: usize = 28;
/// A segment whose writer did not come back to write its length.
const NOT_CLOSED: u64 = u64::MAX;

const HAS_META: u32 = 1 << 1;
const HAS_NEW_LIST: u32 = 1 << 2;
const HAS_RAW: u32 = 1 << 3;
const IS_INTERLEAVED: u32 = 1 << 5;
const IS_BIG_ENDIAN: u32 = 1 << 6;

const NO_VALUES: u32 = u32::MAX;
const SAME_AS_BEFORE: u32 = 0;

/// Value of a property.
#[derive(Debug, Clone, PartialEq)]
pub enum Property {
    /// A number, or a truth value as 0 and 1.
    Number(f64),
    /// A text.
    Text(String),
    /// A moment.
    Time(TimeStamp),
}

/// Values of one object in each chunk of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawIndex {
    /// Type of the values.
    pub kind: DataType,
    /// Values in a chunk.
    pub count: u64,
    /// Bytes in a chunk.
    pub bytes: u64,
    /// Where a DAQmx value stands among those of its channels.
    pub stride: Option<Stride>,
}

/// An object with everything known of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Object {
    /// Its path, `/'group'/'channel'`.
    pub path: String,
    /// Properties in the file's order, the latest value of each.
    pub properties: Vec<(String, Property)>,
    /// The latest index of its values.
    pub index: Option<RawIndex>,
    /// Its numbers, or NaN for each text.
    pub values: Vec<f64>,
    /// Whether its values are texts.
    pub is_text: bool,
    /// Whether its values are moments.
    pub is_time: bool,
}

impl Object {
    /// Group and channel of the path `/'group'/'channel'`; a quote inside a name is doubled.
    pub fn names(&self) -> Option<(String, String)> {
        let inner = self.path.strip_prefix("/'")?.strip_suffix('\'')?;
        let (group, channel) = inner.split_once("'/'")?;
        Some((group.replace("''", "'"), channel.replace("''", "'")))
    }

    /// A property.
    pub fn property(&self, name: &str) -> Option<&Property> {
        self.properties
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value)
    }
}

/// A segment's raw values: which objects, how, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct RawData {
    /// Objects with values, in the order in which they stand in a chunk.
    pub order: Vec<usize>,
    /// First byte and the byte behind the last one, cut at the file's end.
    pub bytes: std::ops::Range<usize>,
    /// Whether one value of each object follows the other.
    pub interleaved: bool,
    /// Whether the most significant byte stands first.
    pub big_endian: bool,
}

/// The structure of a file.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    /// Every object.
    pub objects: Vec<Object>,
    /// Place of each path among them.
    known: HashMap<String, usize>,
    /// Objects with values in the segment before.
    order: Vec<usize>,
    /// Whether each object is among those.
    is_listed: Vec<bool>,
    /// Segments read.
    pub segments: usize,
    /// Why the file is not whole; none where it is.
    pub broken_off: Option<String>,
}

/// The next segment: its raw values and where the one after it starts.
struct Segment {
    raw: Option<RawData>,
    end: usize,
}

impl Structure {
    /// Reads every segment and hands the raw values of each to `each`.
    ///
    /// # Errors
    /// The bytes are no TDMS, contradict themselves, or hold what was never seen.
    pub fn read(
        bytes: &[u8],
        mut each: impl FnMut(&mut [Object], &RawData) -> Result<(), ReadError>,
    ) -> Result<Structure, ReadError> {
        let mut structure = Structure::default();
        let mut at = 0;
        while at < bytes.len() {
            let Some(segment) = structure.segment(bytes, at)? else {
                break;
            };
            structure.segments += 1;
            if let Some(raw) = &segment.raw {
                each(&mut structure.objects, raw)?;
            }
            at = segment.end;
        }
        Ok(structure)
    }

    fn segment(&mut self, bytes: &[u8], start: usize) -> Result<Option<Segment>, ReadError> {
        let mut cursor = Cursor {
            bytes,
            at: start,
            big_endian: false,
        };
        let lead_in = (cursor.take(4), cursor.u32());
        let (Some(mark), Some(contents)) = lead_in else {
            return Ok(self.broken(start, "in the lead-in of a segment"));
        };
        if mark != b"TDSm" {
            return Err(ReadError::Structure {
                offset: start as u64,
                found: "no segment begins here".to_owned(),
                needed: "TDSm",
            });
        }
        cursor.big_endian = contents & IS_BIG_ENDIAN != 0;
        let (Some(_version), Some(next), Some(raw)) = (cursor.u32(), cursor.u64(), cursor.u64()) else {
            return Ok(self.broken(start, "in the lead-in of a segment"));
        };
        let body = start + LEAD_IN;
        let end = self.end(bytes.len(), body, next);
        let raw_start = usize::try_from(raw)
            .ok()
            .and_then(|raw| body.checked_add(raw))
            .unwrap_or(usize::MAX);
        if next != NOT_CLOSED && raw > next {
            return Err(ReadError::Structure {
                offset: start as u64,
                found: format!("values at {raw} behind the segment's end at {next}"),
                needed: "values inside the segment",
            });
        }
        let before = self.clone_lists();
        if contents & HAS_META != 0 {
            if contents & HAS_NEW_LIST != 0 {
                self.order.clear();
                self.is_listed.fill(false);
            }
            let part = &bytes[..end.min(raw_start)];
            let mut cursor = Cursor {
                bytes: part,
                ..cursor
            };
            if self.objects(&mut cursor)?.is_none() {
                self.restore(before);
                return Ok(self.broken(start, "in the objects of a segment"));
            }
        }
        let has_raw = contents & HAS_RAW != 0 && raw_start < end;
        let raw = has_raw.then(|| RawData {
            order: self.order.clone(),
            bytes: raw_start..end,
            interleaved: contents & IS_INTERLEAVED != 0,
            big_endian: contents & IS_BIG_ENDIAN != 0,
        });
        Ok(Some(Segment { raw, end }))
    }

    /// Where the segment ends, cut at the file's end.
    fn end(&mut self, length: usize, body: usize, next: u64) -> usize {
        if next == NOT_CLOSED {
            self.broken_off = Some("the last segment was never closed by its writer".to_owned());
            return length;
        }
        let declared = usize::try_from(next).ok().and_then(|next| body.checked_add(next));
        match declared.filter(|end| *end <= length) {
            Some(end) => end,
            None => {
                let missing = (body as u64).saturating_add(next).saturating_sub(length as u64);
                self.broken_off = Some(format!("the last segment lacks {missing} bytes"));
                length
            }
        }
    }

    fn broken(&mut self, at: usize, place: &str) -> Option<Segment> {
        self.broken_off = Some(format!("the file ends {place} that starts at byte {at}"));
        None
    }

    /// What a segment's objects may change; kept, for a cut segment must change nothing.
    fn clone_lists(&self) -> (Vec<usize>, usize, Vec<usize>) {
        let properties = self
            .objects
            .iter()
            .map(|object| object.properties.len())
            .collect();
        (self.order.clone(), self.objects.len(), properties)
    }

    fn restore(&mut self, (order, objects, properties): (Vec<usize>, usize, Vec<usize>)) {
        self.objects.truncate(objects);
        self.is_listed = vec![false; objects];
        order.iter().for_each(|&place| self.is_listed[place] = true);
        self.order = order;
        self.known.retain(|_, place| *place < objects);
        for (object, count) in self.objects.iter_mut().zip(properties) {
            object.properties.truncate(count);
        }
    }

    /// Reads the objects of a segment; none where the file ends among them.
    fn objects(&mut self, cursor: &mut Cursor<'_>) -> Result<Option<()>, ReadError> {
        let Some(count) = cursor.u32() else {
            return Ok(None);
        };
        for _ in 0..count {
            let Some(path) = cursor.text() else {
                return Ok(None);
            };
            let place = self.place(&path);
            let Some(kind) = cursor.u32() else { return Ok(None) };
            match kind {
                NO_VALUES if self.is_listed[place] => {
                    self.is_listed[place] = false;
                    self.order.retain(|other| *other != place);
                }
                NO_VALUES => {}
                SAME_AS_BEFORE if self.objects[place].index.is_some() => self.list(place),
                SAME_AS_BEFORE => {
                    return Err(ReadError::Structure {
                        offset: cursor.at as u64,
                        found: "values as before of an object without any".to_owned(),
                        needed: "an index of values",
                    });
                }
                _ => {
                    let index = if daqmx::is_daqmx(kind) {
                        daqmx::raw_index(cursor, kind)?
                    } else {
                        raw_index(cursor)?
                    };
                    let Some(index) = index else {
                        return Ok(None);
                    };
                    let object = &mut self.objects[place];
                    object.index = Some(index);
                    object.is_text = index.kind == DataType::Text;
                    object.is_time = index.kind == DataType::Time;
                    self.list(place);
                }
            }
            if properties(cursor, &mut self.objects[place])?.is_none() {
                return Ok(None);
            }
        }
        Ok(Some(()))
    }

    fn place(&mut self, path: &str) -> usize {
        if let Some(place) = self.known.get(path) {
            return *place;
        }
        self.objects.push(Object {
            path: path.to_owned(),
            ..Object::default()
        });
        self.is_listed.push(false);
        self.known.insert(path.to_owned(), self.objects.len() - 1);
        self.objects.len() - 1
    }

    fn list(&mut self, place: usize) {
        if !std::mem::replace(&mut self.is_listed[place], true) {
            self.order.push(place);
        }
    }
}

fn raw_index(cursor: &mut Cursor<'_>) -> Result<Option<RawIndex>, ReadError> {
    let (Some(code), Some(_dimension), Some(count)) = (cursor.u32(), cursor.u32(), cursor.u64()) else {
        return Ok(None);
    };
    let kind = DataType::of(code)?;
    let bytes = match kind.size() {
        Some(size) => count.saturating_mul(size as u64),
        None => match cursor.u64() {
            Some(bytes) => bytes,
            None => return Ok(None),
        },
    };
    Ok(Some(RawIndex {
        kind,
        count,
        bytes,
        stride: None,
    }))
}

fn properties(cursor: &mut Cursor<'_>, object: &mut Object) -> Result<Option<()>, ReadError> {
    let Some(count) = cursor.u32() else {
        return Ok(None);
    };
    for _ in 0..count {
        let (Some(name), Some(code)) = (cursor.text(), cursor.u32()) else {
            return Ok(None);
        };
        let value = match DataType::of(code)? {
            DataType::Text => cursor.text().map(Property::Text),
            DataType::Time => cursor.time().map(Property::Time),
            kind => cursor.number(kind).map(Property::Number),
        };
        let Some(value) = value else { return Ok(None) };
        match object.properties.iter_mut().find(|(key, _)| *key == name) {
            Some((_, known)) => *known = value,
            None => object.properties.push((name, value)),
        }
    }
    Ok(Some(()))
}
