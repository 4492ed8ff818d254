//! Segments of a LabVIEW measurement file as text: keys with the cells behind them, names, rows.

use crate::text::{Delimiter, Line};

const END_OF_HEADER: &str = "***End_of_Header***";

/// Keys with the cells behind them.
pub type Keys<'a> = Vec<(&'a str, Vec<&'a str>)>;

/// One segment as text.
pub struct Segment<'a> {
    /// Keys of its header.
    pub keys: Keys<'a>,
    /// Names of its columns.
    pub names: Vec<&'a str>,
    /// Line of the names.
    pub names_line: usize,
    /// Lines that hold anything below the names.
    pub rows: Vec<Line<'a>>,
}

/// The keys up to the end of a header, and the line behind it.
pub fn keys<'a>(lines: &[Line<'a>], delimiter: Delimiter) -> (Keys<'a>, usize) {
    let mut keys = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let mut cells = split(line.text, delimiter);
        let key = cells[0];
        if key == END_OF_HEADER {
            return (keys, at + 1);
        }
        if !key.is_empty() {
            // The cell of the key keeps its place, so that others keep the number of their column.
            cells[0] = "";
            keys.push((key, cells));
        }
    }
    (Vec::new(), lines.len())
}

/// The cell of a key in a column; the key itself stands in column 0.
pub fn value<'a>(keys: &Keys<'a>, key: &str, column: usize) -> Option<&'a str> {
    let (_, cells) = keys.iter().find(|(name, _)| *name == key)?;
    cells.get(column).copied()
}

/// The segments behind a file's header.
pub fn segments<'a>(lines: &[Line<'a>], delimiter: Delimiter) -> Vec<Segment<'a>> {
    let mut segments = Vec::new();
    let mut rest = lines;
    loop {
        let (keys, after) = keys(rest, delimiter);
        let Some((names, rows)) = rest[after..].split_first() else {
            return segments;
        };
        let begins_next = |line: &Line<'_>| line.text.starts_with("Channels");
        let end = rows.iter().position(begins_next).unwrap_or(rows.len());
        let filled = |line: &&Line<'a>| !line.text.trim().is_empty();
        segments.push(Segment {
            keys,
            names: split(names.text, delimiter),
            names_line: names.number,
            rows: rows[..end].iter().filter(filled).copied().collect(),
        });
        rest = &rows[end..];
    }
}

/// Cells of a key of the segment that hold anything.
pub fn declared<'a>(segment: &Segment<'a>, key: &str) -> Vec<&'a str> {
    let found = segment.keys.iter().find(|(name, _)| *name == key);
    let cells = found.map_or(&[][..], |(_, cells)| cells.as_slice());
    cells.iter().copied().filter(|cell| !cell.is_empty()).collect()
}

fn split(text: &str, delimiter: Delimiter) -> Vec<&str> {
    let mut cells = Vec::new();
    delimiter.split(text, |_, cell| cells.push(cell.trim()));
    cells
}
