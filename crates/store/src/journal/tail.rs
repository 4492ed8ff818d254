//! The end of a journal: its last line, and half a line that a crash left.

use std::io::{self, Read, Seek, SeekFrom};

use super::entry::End;
use super::line;
use ieap_system::fs::File;

/// Bytes of the end that are looked at first: more than most lines have.
const FIRST_LOOK_BYTES: u64 = 16 * 1024;

/// Where a journal ends.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Last {
    /// Number of the last line; 0 where there is none.
    pub n: u64,
    /// Its checksum; none where there is no line, or where the last one is damaged.
    pub sum: Option<String>,
    /// Bytes up to its end.
    pub bytes: u64,
}

impl Last {
    /// The same as an end of a course.
    pub fn end(&self) -> End {
        End {
            n: self.n,
            sum: self.sum.clone(),
        }
    }
}

/// The bytes without the part after the last line feed: a line whose writing was cut short, of which nobody was told. A
/// disk that lost its power may keep the length of a line and not its content, which then reads as zeros.
pub fn without_torn_end(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n');
    &bytes[..end.map_or(0, |end| end + 1)]
}

/// Cuts off a torn end, and leaves the file where the next line goes.
pub(super) fn mended(file: &mut File) -> io::Result<Last> {
    let size = file.metadata()?.len();
    let last = last(file, size)?;
    if last.bytes < size {
        let mut torn = Vec::new();
        file.seek(SeekFrom::Start(last.bytes))?;
        Read::by_ref(file)
            .take(size - last.bytes)
            .read_to_end(&mut torn)?;
        refuse_foreign(&torn)?;
        file.set_len(last.bytes)?;
    }
    file.seek(SeekFrom::Start(last.bytes))?;
    Ok(last)
}

/// The last whole line of the first `size` bytes.
pub(super) fn last(file: &mut File, size: u64) -> io::Result<Last> {
    let mut look = FIRST_LOOK_BYTES;
    loop {
        let from = size.saturating_sub(look);
        let mut end = Vec::new();
        file.seek(SeekFrom::Start(from))?;
        Read::by_ref(file).take(size - from).read_to_end(&mut end)?;
        let whole = without_torn_end(&end);
        match last_line(whole, from == 0) {
            None if from > 0 => look *= 8,
            found => {
                let (n, sum) = found.unwrap_or_default();
                let bytes = from + whole.len() as u64;
                return Ok(Last { n, sum, bytes });
            }
        }
    }
}

/// Refuses an end that no journal left: a file of somebody else may have this name, by a copy or a second name of it.
fn refuse_foreign(torn: &[u8]) -> io::Result<()> {
    let zeros = torn.iter().rev().take_while(|&&byte| byte == 0).count();
    let part = &torn[..torn.len() - zeros];
    let begins = |whole: &[u8], part: &[u8]| part.iter().zip(whole).all(|(found, wanted)| found == wanted);
    // What was written first may be what the disk has lost.
    if torn.first() == Some(&0) || begins(line::BEGIN.as_bytes(), part) {
        Ok(())
    } else {
        Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "its end is not one that a journal has, and nothing of it was changed: move the file away, and the next `ieap run` writes the journal from the database",
        ))
    }
}

/// Number and checksum of the last line; damaged ones after the last that can be read count as one each. None where none can
/// be read.
fn last_line(whole: &[u8], is_from_start: bool) -> Option<(u64, Option<String>)> {
    let lines: Vec<&[u8]> = whole.strip_suffix(b"\n")?.split(|&byte| byte == b'\n').collect();
    // The first one may be cut off by where the look begins: its checksum tells.
    let read = lines.iter().rev().enumerate();
    let mut found = read.filter_map(|(after, text)| {
        let line = line::read(text).ok()?;
        let sum = (after == 0).then(|| line.sum().to_owned());
        Some((line.n + after as u64, sum))
    });
    found
        .next()
        .or_else(|| is_from_start.then_some((lines.len() as u64, None)))
}
