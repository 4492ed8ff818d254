//! The parts of an .xlsx, unpacked into nothing and counted before the library that reads them makes room for what they
//! hold or declare.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::error::{ReadError, escaped};

/// What kind of container a message speaks of.
const KIND: &str = "spreadsheet (zip archive)";
/// Most sheets that are read of a workbook, .xls too. Chosen: a workbook of a year of days has 366.
pub const MOST_SHEETS: usize = 1000;
/// Most of each of the elements below. Chosen: programs write at most 64,000 formats of cells.
const MOST_KEPT: usize = 100_000;
/// Elements of which the library keeps each, whatever it holds, in more bytes than it takes in the file.
const KEPT: [&[u8]; 9] = [
    b"xf",
    b"font",
    b"fill",
    b"border",
    b"numFmt",
    b"definedName",
    b"Relationship",
    b"mergeCell",
    b"sheet",
];
/// Most texts that cells share, for which the library makes room by what their list declares.
const MOST_SHARED_TEXTS: u64 = 1 << 20;
/// Most bytes of the longest mark of a list of formats, times its formats: each format of cells keeps a copy of its font.
const MOST_COPIED: usize = 64 << 20;
/// Bytes behind a mark that are looked at; a block keeps so many for the next one.
const LOOKED_AT: usize = 64;
/// Bytes that are looked through at once.
const BLOCK: usize = 256 << 10;

/// Refuses an .xlsx that unpacks to more than `limit` bytes, or whose parts hold more than the library can take.
///
/// # Errors
/// That, or the archive is damaged.
pub fn check(bytes: &[u8], limit: u64) -> Result<(), ReadError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    let mut declared: u64 = 0;
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| broken(&error))?;
        declared = declared.saturating_add(member.size());
        within(declared, limit)?;
    }
    let mut left = limit;
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| broken(&error))?;
        let mut part = Part::default();
        left -= part.look_through(member.take(left + 1), left)?;
    }
    Ok(())
}

/// The text of one part of a workbook that was looked through, at most so many bytes of it.
pub fn text_of(bytes: &[u8], name: &str, limit: u64) -> Option<String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut text = String::new();
    let member = archive.by_name(name).ok()?;
    member.take(limit).read_to_string(&mut text).ok()?;
    Some(text)
}

fn within(found: u64, limit: u64) -> Result<(), ReadError> {
    if found <= limit {
        return Ok(());
    }
    Err(ReadError::TooLarge {
        what: "the spreadsheet, once unpacked,".to_owned(),
        found,
        limit,
    })
}

fn broken(error: &dyn std::fmt::Display) -> ReadError {
    ReadError::BrokenContainer {
        kind: KIND,
        found: escaped(&error.to_string()),
    }
}

/// What is known of one part.
#[derive(Default)]
struct Part {
    kept: [usize; KEPT.len()],
    shared_texts: u64,
    /// Bytes since the last `<`, and the most that there were.
    since_mark: usize,
    longest_mark: usize,
    place: Place,
    /// Whether a `<` stands within a mark, which no writer does.
    is_nested: bool,
}

/// Where in a document a byte stands.
#[derive(Default, Clone, Copy, PartialEq)]
enum Place {
    #[default]
    Text,
    Mark,
    /// Within these quotes of a mark.
    Quoted(u8),
}

impl Part {
    /// Looks through a part, and gives its length.
    fn look_through(&mut self, mut part: impl Read, limit: u64) -> Result<u64, ReadError> {
        let mut block = Vec::with_capacity(BLOCK + LOOKED_AT);
        let mut length = 0;
        loop {
            let more = (&mut part).take(BLOCK as u64).read_to_end(&mut block);
            let more = more.map_err(|error| broken(&error))?;
            length += more as u64;
            within(length, limit)?;
            let kept = if more == 0 { 0 } else { LOOKED_AT.min(block.len()) };
            let looked_at = block.len() - kept;
            for at in 0..looked_at {
                self.byte(block[at], &block[at + 1..block.len().min(at + LOOKED_AT)])?;
            }
            if more == 0 {
                self.formats()?;
                return Ok(length);
            }
            block.drain(..looked_at);
        }
    }

    /// Looks at a byte and those behind it.
    fn byte(&mut self, byte: u8, behind: &[u8]) -> Result<(), ReadError> {
        self.since_mark += 1;
        match (self.place, byte) {
            (place, b'<') => {
                self.is_nested |= place != Place::Text;
                self.place = Place::Mark;
                self.longest_mark = self.longest_mark.max(self.since_mark);
                self.since_mark = 0;
                self.mark(behind)?;
            }
            (Place::Mark, b'>') => self.place = Place::Text,
            (Place::Mark, b'"' | b'\'') => self.place = Place::Quoted(byte),
            (Place::Quoted(quotes), _) if quotes == byte => self.place = Place::Mark,
            (Place::Mark, b'u') if behind.starts_with(b"niqueCount") => {
                declared_texts(&behind["niqueCount".len()..])?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Refuses a list of formats whose copies would fill the memory.
    fn formats(&self) -> Result<(), ReadError> {
        let formats = self.kept[0];
        let longest = self.longest_mark.max(self.since_mark);
        if formats > 0 && self.is_nested {
            return Err(broken(&"a mark within a mark, in its formats of cells"));
        }
        match formats.saturating_mul(longest) {
            copied if copied > MOST_COPIED => {
                Err(too_many("bytes in its formats of cells", copied, MOST_COPIED))
            }
            _ => Ok(()),
        }
    }

    /// Counts what begins with the bytes behind a `<`.
    fn mark(&mut self, behind: &[u8]) -> Result<(), ReadError> {
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'/' | b'>' | b'<');
        let name = behind.split(is_end).next().unwrap_or_default();
        let name = name.rsplit(|byte| *byte == b':').next().unwrap_or_default();
        if name == b"si" {
            self.shared_texts += 1;
            return declared_texts_within(self.shared_texts);
        }
        let Some(kind) = KEPT.iter().position(|kept| *kept == name) else {
            return Ok(());
        };
        self.kept[kind] += 1;
        let most = if name == b"sheet" { MOST_SHEETS } else { MOST_KEPT };
        if self.kept[kind] <= most {
            return Ok(());
        }
        let what = format!("elements {}", String::from_utf8_lossy(name));
        Err(too_many(&what, self.kept[kind], most))
    }
}

/// Refuses a list of shared texts that declares more than there can be; `behind` is what follows the attribute's name.
fn declared_texts(behind: &[u8]) -> Result<(), ReadError> {
    let is_filling = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'=' | b'"' | b'\'');
    let filling = behind.iter().take_while(|byte| is_filling(byte)).count();
    let digits = behind[filling..].iter().take_while(|byte| byte.is_ascii_digit());
    let number = digits.fold(0u64, |number, digit| {
        number.saturating_mul(10).saturating_add(u64::from(digit - b'0'))
    });
    if filling == behind.len() && !behind.is_empty() {
        return Err(broken(&"a number of shared texts is not where it is declared"));
    }
    declared_texts_within(if filling == 0 { 0 } else { number })
}

fn declared_texts_within(count: u64) -> Result<(), ReadError> {
    if count <= MOST_SHARED_TEXTS {
        return Ok(());
    }
    Err(too_many(
        "texts that cells share",
        count as usize,
        MOST_SHARED_TEXTS as usize,
    ))
}

/// Refuses a workbook that holds more than is read of something.
pub fn too_many(what: &str, found: usize, most: usize) -> ReadError {
    ReadError::TooMany {
        what: what.to_owned(),
        found: found as u64,
        most: most as u64,
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::*;

    fn archive(content: &[u8]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        writer.start_file("xl/worksheets/sheet1.xml", options).unwrap();
        writer.write_all(content).unwrap();
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn what_unpacks_to_too_much_is_refused() {
        let bytes = archive(&[b' '; 100_000]);
        assert!(bytes.len() < 1_000);
        assert_eq!(check(&bytes, 100_000), Ok(()));
        let refused = check(&bytes, 99_999).unwrap_err();
        assert!(matches!(refused, ReadError::TooLarge { found: 100_000, .. }));
        assert_eq!(refused.code(), "too-large");
    }

    #[test]
    fn a_declared_size_that_lies_is_found_out() {
        let mut bytes = archive(&[b' '; 100_000]);
        let size = 100_000u32.to_le_bytes();
        let places: Vec<usize> = (0..bytes.len() - 4)
            .filter(|&at| bytes[at..at + 4] == size)
            .collect();
        assert_eq!(places.len(), 2, "local header and central directory");
        for at in places {
            bytes[at..at + 4].copy_from_slice(&10u32.to_le_bytes());
        }
        assert!(check(&bytes, 50_000).is_err());
    }

    #[test]
    fn a_damaged_archive_is_named() {
        let bytes = archive(&[b' '; 1_000]);
        let error = check(&bytes[..bytes.len() / 2], 1 << 20).unwrap_err();
        assert!(matches!(error, ReadError::BrokenContainer { .. }), "{error}");
    }

    #[test]
    fn what_the_library_makes_room_for_is_counted_wherever_a_block_ends() {
        let refused = |content: &str| check(&archive(content.as_bytes()), 64 << 20).is_err();
        for before in [0, 1, BLOCK - LOOKED_AT, BLOCK - 8, BLOCK - 1, BLOCK] {
            let of = |inside: &str| format!("<a>{}{inside}</a>", " ".repeat(before));
            for (inside, most) in [("<x:sheet a='1'/>", MOST_SHEETS), ("<font/>", MOST_KEPT)] {
                assert!(!refused(&of(&inside.repeat(most))), "{inside} {before}");
                assert!(refused(&of(&inside.repeat(most + 1))), "{inside} {before}");
            }
            for (declared, is_refused) in [
                ("<sst uniqueCount=\"1048576\"/>", false),
                ("<sst uniqueCount=\"1048577\"/>", true),
                ("<b:sst\nuniqueCount = '99999999999999999999999'/>", true),
                ("<t>uniqueCount 9999999999</t>", false),
            ] {
                assert_eq!(refused(&of(declared)), is_refused, "{declared} {before}");
            }
        }
        let padded = format!("<sst uniqueCount{}=\"9\"/>", " ".repeat(100));
        assert!(refused(&padded));
    }

    #[test]
    fn a_font_that_every_format_copies_is_refused() {
        let styles = |name: &str| format!("<font><name val=\"{name}\"/></font>{}", "<xf/>".repeat(1000));
        let refused = |name: &str| check(&archive(styles(name).as_bytes()), 64 << 20).is_err();
        assert!(!refused("Calibri"));
        assert!(!refused(&"x".repeat(60_000)));
        assert!(refused(&"x".repeat(70_000)));
        assert!(refused(&"<".repeat(70_000)));
        assert!(refused(&("><".repeat(70_000))));
    }
}
