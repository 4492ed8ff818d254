//! What Arrow's own schema says of columns that Parquet has no word for: durations, which stand as plain whole numbers.
//!
//! Every writer of the Arrow family keeps it under `ARROW:schema`: a message of Arrow's IPC format as a FlatBuffer in base64
//! (Arrow, format/Message.fbs and Schema.fbs). What does not read as one says nothing.

use parquet::file::metadata::FileMetaData;

const KEY: &str = "ARROW:schema";
/// The number of `Schema` among the headers of a message, and of `Duration` among the types of a field.
const SCHEMA: u8 = 1;
const DURATION: u8 = 18;
/// Places of what is read in the tables of the format.
const HEADER_KIND: usize = 1;
const HEADER: usize = 2;
const FIELDS: usize = 1;
const NAME: usize = 0;
const TYPE_KIND: usize = 2;
const TYPE: usize = 3;
const UNIT: usize = 0;
/// The unit where none is written: milliseconds.
const USUAL_UNIT: i16 = 1;

/// Names of the columns that are durations, each with its digits behind the second: 0, 3, 6 or 9.
pub(super) fn durations(file: &FileMetaData) -> Vec<(String, i32)> {
    let pairs = file.key_value_metadata().into_iter().flatten();
    let text = pairs
        .filter(|pair| pair.key == KEY)
        .find_map(|pair| pair.value.as_deref());
    let bytes = text.and_then(base64).unwrap_or_default();
    fields(&bytes).unwrap_or_default()
}

fn fields(message: &[u8]) -> Option<Vec<(String, i32)>> {
    // The size stands before the message, since 2019 behind a mark.
    let mark = [0xff; 4];
    let start = if message.starts_with(&mark) { 8 } else { 4 };
    let flat = Flat(message.get(start..)?);
    let root = flat.behind(0)?;
    if flat.byte(flat.place(root, HEADER_KIND)?)? != SCHEMA {
        return None;
    }
    let schema = flat.behind(flat.place(root, HEADER)?)?;
    let list = flat.behind(flat.place(schema, FIELDS)?)?;
    let of_field = |at: usize| {
        let field = flat.behind(at)?;
        if flat.byte(flat.place(field, TYPE_KIND)?)? != DURATION {
            return None;
        }
        let kind = flat.behind(flat.place(field, TYPE)?)?;
        let unit = flat
            .place(kind, UNIT)
            .map_or(Some(USUAL_UNIT), |at| flat.short(at))?;
        let digits = 3 * i32::from(unit);
        let name = flat.text(flat.behind(flat.place(field, NAME)?)?)?;
        (0..=9).contains(&digits).then_some((name, digits))
    };
    let places = (0..flat.word(list)?).map(|k| list.checked_add(4)?.checked_add(4 * k));
    Some(
        places
            .map_while(|at| at.filter(|at| *at < flat.0.len()))
            .filter_map(of_field)
            .collect(),
    )
}

/// A FlatBuffer; `None` wherever it does not hold what it must.
struct Flat<'a>(&'a [u8]);

impl Flat<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        self.0.get(at..at.checked_add(N)?)?.try_into().ok()
    }

    fn byte(&self, at: usize) -> Option<u8> {
        self.0.get(at).copied()
    }

    fn short(&self, at: usize) -> Option<i16> {
        self.bytes(at).map(i16::from_le_bytes)
    }

    fn word(&self, at: usize) -> Option<usize> {
        usize::try_from(u32::from_le_bytes(self.bytes(at)?)).ok()
    }

    /// What the offset at a place leads to.
    fn behind(&self, at: usize) -> Option<usize> {
        at.checked_add(self.word(at)?)
    }

    /// Where a table has one of its parts; none where it is left out.
    fn place(&self, table: usize, part: usize) -> Option<usize> {
        let back = i32::from_le_bytes(self.bytes(table)?);
        let list = usize::try_from(i64::try_from(table).ok()? - i64::from(back)).ok()?;
        let (size, at) = (self.short(list)?, 4 + 2 * part);
        if usize::try_from(size).ok()? < at + 2 {
            return None;
        }
        let off = u16::from_le_bytes(self.bytes(list.checked_add(at)?)?);
        (off > 0).then(|| table + usize::from(off))
    }

    fn text(&self, at: usize) -> Option<String> {
        let (from, size) = (at.checked_add(4)?, self.word(at)?);
        let bytes = self.0.get(from..from.checked_add(size)?)?;
        String::from_utf8(bytes.to_vec()).ok()
    }
}

/// The bytes that a text of base64 stands for.
fn base64(text: &str) -> Option<Vec<u8>> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut bytes, mut held, mut bits) = (Vec::with_capacity(text.len() * 3 / 4), 0u32, 0);
    for letter in text.bytes().filter(|letter| *letter != b'=') {
        let value = LETTERS.iter().position(|own| *own == letter)?;
        (held, bits) = (held << 6 | value as u32, bits + 6);
        if bits >= 8 {
            bits -= 8;
            bytes.push((held >> bits) as u8);
            held &= (1 << bits) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_its_standard() {
        assert_eq!(base64("Zm9vYmFy").unwrap(), b"foobar");
        assert_eq!(base64("Zm9vYg==").unwrap(), b"foob");
        assert_eq!(base64("//79").unwrap(), [0xff, 0xfe, 0xfd]);
        assert!(base64("a b").is_none());
    }

    #[test]
    fn what_is_no_schema_says_nothing_and_ends_nothing() {
        for bytes in [
            &[][..],
            &[0xff; 3],
            &[0xff; 64],
            &[0; 64],
            b"\x10\0\0\0\x0c\0\0\0",
        ] {
            assert_eq!(fields(bytes).unwrap_or_default(), []);
        }
    }
}
