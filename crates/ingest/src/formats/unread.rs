//! Kinds of files that are known and not read: they are refused by their name, with what to do instead.

use super::error::ReadError;
use super::recognition::FileHead;

/// What a file is, and how to get its readings in.
type Kind = (&'static str, &'static str, &'static str);

const AS_TABLE: &str = "export the run as a plain table, a spreadsheet or Parquet, with units in the names";

/// The refusal of a file that is known and not read; none for any other.
pub fn refusal(head: &FileHead<'_>) -> Option<ReadError> {
    let (kind, sign, mend) = binary(head).or_else(|| text(head))?;
    Some(ReadError::NotRead { kind, sign, mend })
}

fn binary(head: &FileHead<'_>) -> Option<Kind> {
    /// Bytes before the name of the first member of a zip archive.
    const NAME_AT: usize = 30;
    let bytes = head.bytes;
    let member = bytes.get(NAME_AT..).unwrap_or_default();
    match bytes {
        [0x89, b'H', b'D', b'F', ..] => {
            Some(("an HDF5 or NetCDF-4 file", "it begins with \\x89HDF", AS_TABLE))
        }
        [b'C', b'D', b'F', 1 | 2 | 5, ..] => Some(("a NetCDF-3 file", "it begins with CDF", AS_TABLE)),
        [b'P', b'K', 3, 4, ..] if member.starts_with(b"Streams/") => Some((
            "a binary file of NETZSCH Proteus (.ngb-*)",
            "a zip archive of Streams/",
            "export it as text from Proteus (ASCII file, with names and units)",
        )),
        // The beginning of both files that were seen; alone it would be too little.
        [0, 0, 0xFF, 0xFF, 0xFF, 0xFE | 0xFF, ..] if head.extension() == "ism" => Some((
            "a binary impedance file of Zahner (.ism)",
            "the extension .ism, and the first six bytes of such files",
            "export the spectrum as text: frequency, real and imaginary part, with units in the names",
        )),
        bytes if bytes.starts_with(b"SQLite format 3\0") => {
            Some(("an SQLite database", "it begins with SQLite format 3", AS_TABLE))
        }
        bytes if bytes.starts_with(b"%PDF") => Some(("a PDF document", "it begins with %PDF", AS_TABLE)),
        _ => None,
    }
}

fn text(head: &FileHead<'_>) -> Option<Kind> {
    let text = head.text()?;
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let (first, second) = (lines.next()?, lines.next().unwrap_or(""));
    let is_json =
        first.starts_with(['{', '[']) && (first.len() > 1 || second.starts_with(['"', '{', '[', '}', ']']));
    if is_json && (first == "{" || first == "[" || first.starts_with("{\"") || first.starts_with("[{")) {
        return Some(("a JSON document", "it begins with a brace", AS_TABLE));
    }
    if first.starts_with("<?xml") || first.starts_with("<!DOCTYPE") || first.starts_with("<html") {
        Some(("an XML or HTML document", "it begins with a tag", AS_TABLE))
    } else {
        None
    }
}
