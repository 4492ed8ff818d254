//! What the cells of an .xls take, found before the library that reads it makes room for them: two cells in the corners of
//! a sheet would take 64 GB with all that lie between them, and a program that asks for so much is ended.
//!
//! Records after Microsoft's [MS-XLS].

use super::compound::MOST_AROUND;
use super::error::ReadError;
use super::workbook_parts::{MOST_SHEETS, too_many};

/// Most cells that a sheet may span without holding a good part of them.
const MOST_SPANNED: u64 = 1 << 20;
/// Cells that a fuller sheet may span for each that it holds.
const SPANNED_FOR_EACH: u64 = 4;

const BEGIN: u16 = 0x0809;
const END: u16 = 0x000A;
const SHEET: u16 = 0x0085;
const DIMENSIONS: u16 = 0x0200;
const SEVERAL_NUMBERS: u16 = 0x00BD;
/// Number, label, rich text, boolean or error, packed number, shared text, formula: they begin with row and column.
const CELLS: [u16; 7] = [0x0203, 0x0204, 0x00D6, 0x0205, 0x027E, 0x00FD, 0x0006];
const SHARED_TEXTS: u16 = 0x00FC;
const SHARED_TEXT: u16 = 0x00FD;
const CONTINUED: u16 = 0x003C;
const FORMULA: u16 = 0x0006;
/// Where the length of its formula stands in a record of one.
const FORMULA_AT: usize = 20;
/// Texts, and where their lengths stand in them.
const TEXTS: [(u16, usize); 3] = [(0x0204, 6), (0x00D6, 6), (0x0207, 0)];
/// Bytes that a letter takes at most.
const LETTER_BYTES: u64 = 3;
/// How many times its own length the records of a workbook may be read, where sheets lie within one another.
const TIMES: u64 = 4;

/// What is known of the cells of one sheet.
#[derive(Default)]
struct Extent {
    cells: u64,
    rows: Option<(u32, u32)>,
    columns: Option<(u32, u32)>,
    /// Product of the sheet's stated dimensions.
    stated: u64,
    /// Bytes of its records.
    walked: u64,
    /// Bytes of its texts, those that are shared for each cell.
    text_bytes: u64,
}

/// Refuses the records of an .xls whose cells would need room out of proportion to their number, or whose texts more than
/// `limit` bytes. Formulas, which nobody asks for, are emptied: each may be written out at many times its length.
///
/// # Errors
/// That.
pub fn check(stream: &mut [u8], limit: u64) -> Result<(), ReadError> {
    let large = |what: &str, found: u64, limit: u64| {
        let what = what.to_owned();
        Err(ReadError::TooLarge { what, found, limit })
    };
    if stream.len() as u64 > limit.min(MOST_AROUND) {
        return large("the workbook", stream.len() as u64, limit.min(MOST_AROUND));
    }
    empty_formulas(stream);
    let starts = sheet_starts(stream);
    if starts.len() > MOST_SHEETS {
        return Err(too_many("sheets", starts.len(), MOST_SHEETS));
    }
    let shared = shared_texts(stream);
    let (mut cells, mut spanned, mut walked, mut texts) = (0, 0u64, 0, 0u64);
    for start in starts {
        let extent = Extent::of(stream.get(start..).unwrap_or(&[]), &shared);
        cells += extent.cells;
        walked += extent.walked;
        texts = texts.saturating_add(extent.text_bytes);
        spanned = spanned.saturating_add(extent.spanned().max(extent.stated));
        if spanned > MOST_SPANNED && spanned / SPANNED_FOR_EACH > cells {
            return Err(ReadError::SheetTooWide {
                sheet: "of the workbook".to_owned(),
                row: u64::from(extent.rows.map_or(0, |(_, last)| last)) + 1,
                column: u64::from(extent.columns.map_or(0, |(_, last)| last)) + 1,
                limit: MOST_SPANNED,
            });
        }
        if walked > stream.len() as u64 * TIMES {
            return large(
                "what its sheets hold of one another",
                walked,
                stream.len() as u64 * TIMES,
            );
        }
        if texts > limit {
            return large("the texts of the workbook's cells", texts, limit);
        }
    }
    Ok(())
}

/// Says of every formula that it has no length.
fn empty_formulas(stream: &mut [u8]) {
    let mut at = 0;
    while let Some(head) = stream.get(at..at + 4) {
        let (kind, length) = (short(head, 0) as u16, short(head, 2) as usize);
        if kind == FORMULA
            && length >= FORMULA_AT + 2
            && let Some(formula) = stream.get_mut(at + 4 + FORMULA_AT..at + 6 + FORMULA_AT)
        {
            formula.fill(0);
        }
        at += 4 + length;
    }
}

/// Bytes of each text that cells share.
fn shared_texts(stream: &[u8]) -> Vec<u64> {
    let mut records = Records(stream).skip_while(|(kind, _)| *kind != SHARED_TEXTS);
    let Some((_, first)) = records.next() else {
        return Vec::new();
    };
    let further = records.take_while(|(kind, _)| *kind == CONTINUED);
    let mut texts = Texts {
        data: first.get(8..).unwrap_or_default(),
        further: further.map(|(_, data)| data),
    };
    std::iter::from_fn(|| texts.next()).collect()
}

/// Reads over the texts of a list that goes on from record to record.
struct Texts<'a, I> {
    data: &'a [u8],
    further: I,
}

impl<'a, I: Iterator<Item = &'a [u8]>> Texts<'a, I> {
    fn next(&mut self) -> Option<u64> {
        while self.data.is_empty() {
            self.data = self.further.next()?;
        }
        let letters = short(self.data, 0);
        let flags = *self.data.get(2)?;
        self.data = &self.data[3..];
        let mut behind = 0;
        if flags & 8 != 0 {
            behind += 4 * short(self.data, 0) as usize;
            self.data = self.data.get(2..)?;
        }
        if flags & 4 != 0 {
            behind += (short(self.data, 0) | short(self.data, 2) << 16) as usize;
            self.data = self.data.get(4..)?;
        }
        let (mut left, mut width) = (letters as usize, 1 + usize::from(flags & 1));
        loop {
            let taken = left.min(self.data.len() / width);
            self.data = &self.data[taken * width..];
            left -= taken;
            if left == 0 {
                break;
            }
            let (&flags, rest) = self.further.next()?.split_first()?;
            (self.data, width) = (rest, 1 + usize::from(flags & 1));
        }
        while behind > self.data.len() {
            behind -= self.data.len();
            self.data = self.further.next()?;
        }
        self.data = &self.data[behind..];
        Some(u64::from(letters) * LETTER_BYTES)
    }
}

/// Where the records of each sheet begin.
fn sheet_starts(stream: &[u8]) -> Vec<usize> {
    let globals = Records(stream).take_while(|(kind, _)| *kind != END);
    globals
        .filter(|(kind, data)| *kind == SHEET && data.len() >= 4)
        .map(|(_, data)| u32::from_le_bytes([data[0], data[1], data[2], data[3]]) as usize)
        .collect()
}

impl Extent {
    fn of(records: &[u8], shared: &[u64]) -> Extent {
        let mut extent = Extent::default();
        // Charts within a sheet have records of their own between a begin and an end.
        let mut depth = 0;
        for (kind, data) in Records(records) {
            extent.walked += 4 + data.len() as u64;
            extent.text(kind, data, shared);
            match kind {
                BEGIN => depth += 1,
                END if depth <= 1 => break,
                END => depth -= 1,
                _ if depth > 1 => {}
                DIMENSIONS => extent.stated = extent.stated.saturating_add(stated(data)),
                SEVERAL_NUMBERS if data.len() >= 6 => {
                    let first = short(data, 2);
                    let last = short(data, data.len() - 2);
                    let count = u64::from(last.abs_diff(first)) + 1;
                    extent.add(short(data, 0), first, 0);
                    extent.add(short(data, 0), last, count);
                }
                _ if CELLS.contains(&kind) && data.len() >= 4 => {
                    extent.add(short(data, 0), short(data, 2), 1)
                }
                _ => {}
            }
        }
        extent
    }

    /// Counts a text by what it says of its length: the library makes room for that many letters.
    fn text(&mut self, kind: u16, data: &[u8], shared: &[u64]) {
        if kind == SHARED_TEXT {
            let number = short(data, 6) | short(data, 8) << 16;
            self.text_bytes += shared.get(number as usize).unwrap_or(&0);
        }
        if let Some((_, at)) = TEXTS.iter().find(|(own, _)| *own == kind) {
            self.text_bytes += u64::from(short(data, *at)) * LETTER_BYTES;
        }
    }

    fn add(&mut self, row: u32, column: u32, count: u64) {
        let wider = |range: Option<(u32, u32)>, at: u32| {
            range.map_or(Some((at, at)), |(first, last)| {
                Some((first.min(at), last.max(at)))
            })
        };
        self.rows = wider(self.rows, row);
        self.columns = wider(self.columns, column);
        self.cells += count;
    }

    fn spanned(&self) -> u64 {
        let size = |range: Option<(u32, u32)>| range.map_or(0, |(first, last)| u64::from(last - first) + 1);
        size(self.rows) * size(self.columns)
    }
}

/// Cells for which the library makes room by a record of dimensions, which states the first ones and those after the last
/// in 4 and 2 bytes, or in 2 each. A sheet whose first row lies after its last is taken for one of all rows that a number
/// of 4 bytes can tell: the library subtracts the two without a look at which is larger.
fn stated(data: &[u8]) -> u64 {
    let long = |at: usize| short(data, at) | short(data, at + 2) << 16;
    let (rows, columns) = match data.len() {
        10 => ((short(data, 0), short(data, 2)), (short(data, 4), short(data, 6))),
        14.. => ((long(0), long(4)), (short(data, 8), short(data, 10))),
        _ => return 0,
    };
    if rows.1 == 0 || columns.1 == 0 {
        return 1;
    }
    // A first column beyond the last that exists is taken for none.
    let first = if columns.0 > 0xFF || columns.1 < columns.0 {
        0
    } else {
        columns.0
    };
    let rows = rows.1.wrapping_sub(rows.0);
    u64::from(rows) * u64::from(columns.1 - first).max(1)
}

fn short(data: &[u8], at: usize) -> u32 {
    data.get(at..at + 2)
        .map_or(0, |two| u32::from(u16::from_le_bytes([two[0], two[1]])))
}

/// Records of a stream, each with its kind; ends where one is not whole.
struct Records<'a>(&'a [u8]);

impl<'a> Iterator for Records<'a> {
    type Item = (u16, &'a [u8]);

    fn next(&mut self) -> Option<(u16, &'a [u8])> {
        let head = self.0.get(..4)?;
        let kind = u16::from_le_bytes([head[0], head[1]]);
        let length = usize::from(u16::from_le_bytes([head[2], head[3]]));
        let data = self.0.get(4..4 + length)?;
        self.0 = &self.0[4 + length..];
        Some((kind, data))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(kind: u16, words: &[u16]) -> Vec<u8> {
        let data: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        [&kind.to_le_bytes()[..], &(data.len() as u16).to_le_bytes(), &data].concat()
    }

    fn extent(records: &[Vec<u8>]) -> Extent {
        Extent::of(&records.concat(), &[])
    }

    #[test]
    fn the_span_of_a_sheet_is_that_of_its_outermost_cells() {
        let number = |row, column| record(0x0203, &[row, column, 0, 0, 0, 0, 0]);
        let found = extent(&[
            record(BEGIN, &[0x0600, 0x10]),
            number(2, 1),
            number(11, 3),
            record(BEGIN, &[0x0600, 0x20]),
            number(60_000, 200),
            record(END, &[]),
            record(SEVERAL_NUMBERS, &[5, 0, 0, 0, 0, 0, 0, 0, 4]),
            record(END, &[]),
            number(65_535, 255),
        ]);
        assert_eq!((found.cells, found.spanned()), (7, 50));
        assert_eq!(extent(&[number(0, 0), number(65_535, 65_535)]).spanned(), 1 << 32);
        assert_eq!(extent(&[]).spanned(), 0);
    }

    #[test]
    fn stated_dimensions_count_too() {
        let long = record(DIMENSIONS, &[0, 0, 0, 1, 0, 256, 0]);
        assert_eq!(extent(&[long]).stated, 65_536 * 256);
        assert_eq!(extent(&[record(DIMENSIONS, &[10, 30, 2, 5, 0])]).stated, 60);
        assert_eq!(extent(&[record(DIMENSIONS, &[1])]).stated, 0);
        assert_eq!(extent(&[record(DIMENSIONS, &[0, 0, 0, 0, 0])]).stated, 1);
    }

    #[test]
    fn a_first_row_after_the_last_counts_as_the_library_counts_it() {
        let turned = record(DIMENSIONS, &[30, 10, 0, 4, 0]);
        assert_eq!(extent(&[turned]).stated, (u64::from(u32::MAX) - 19) * 4);
        let long = record(DIMENSIONS, &[5, 0, 4, 0, 0, 1, 0]);
        assert_eq!(extent(&[long]).stated, u64::from(u32::MAX));
    }

    #[test]
    fn texts_that_cells_share_count_for_each_cell() {
        let list = [
            &[0u8; 8][..],
            &[4, 0, 0],
            b"abcd",
            &[3, 0, 1 | 8, 1, 0],
            b"a\0b\0",
        ]
        .concat();
        let record = |kind: u16, data: &[u8]| {
            [&kind.to_le_bytes()[..], &(data.len() as u16).to_le_bytes(), data].concat()
        };
        // The second text goes on in another record, with one byte a letter, and has four bytes behind it.
        let stream = [
            record(SHARED_TEXTS, &list),
            record(CONTINUED, b"\0c----\x02\0\0xy"),
        ]
        .concat();
        assert_eq!(shared_texts(&stream), [12, 9, 6]);
        let cell = |number: u8| record(SHARED_TEXT, &[0, 0, 0, 0, 0, 0, number, 0, 0, 0]);
        let cells = [cell(0), cell(1), cell(1), cell(9)].concat();
        let found = Extent::of(&cells, &shared_texts(&stream));
        assert_eq!((found.cells, found.text_bytes), (4, 30));
    }

    #[test]
    fn texts_count_by_what_they_say_and_formulas_are_emptied() {
        let label = |letters: u16| record(0x0204, &[0, 0, 0, letters, 0x6161, 0x6161]);
        assert_eq!(
            Extent::of(&label(u16::MAX), &[]).text_bytes,
            65_535 * LETTER_BYTES
        );
        let formula = |length: u16| record(FORMULA, &[1, 2, 0, 0, 0, 0, 0, 0, 0, 0, length, 0x0103]);
        let mut stream = [formula(2), label(4), formula(5)].concat();
        empty_formulas(&mut stream);
        assert_eq!(stream, [formula(0), label(4), formula(0)].concat());
    }
}
