//! The table of a file as a profile places it: names, cells, lines.

use super::definition::{ColumnRef, Container, HeaderPlace, Profile};
use crate::formats::cells::CellTable;
use crate::formats::delimited;
use crate::formats::error::{ReadError, quoted};
use crate::formats::sheet_cells::{self, Sheet, SheetCell};
use crate::formats::unpacking;
use crate::text::grid::push_line;
use crate::text::{Decoded, Line, Lines, decode, number};
use ieap_domain::{Issue, RunStatus};

/// A table before its columns have a meaning.
pub(super) struct Found {
    /// Names of the columns; empty texts where the file has none.
    pub names: Vec<String>,
    /// The cells; columns of texts keep them.
    pub cells: CellTable,
    /// Lines before the table.
    pub preamble: Vec<String>,
    pub encoding: Option<&'static str>,
    pub status: RunStatus,
    pub status_evidence: String,
}

impl Profile {
    /// Whether the file is one that this profile reads; if not, why.
    ///
    /// A text is judged by its first bytes, a workbook as a whole.
    pub fn fits(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        /// Bytes that a text is judged by.
        const HEAD: usize = 64 << 10;
        if self.name.as_ref().is_some_and(|glob| !glob.fits(name)) {
            return Err("the file has another name".to_owned());
        }
        match &self.container {
            Container::Answers(_) => {
                let head = decode(&bytes[..bytes.len().min(HEAD)]);
                self.contains_all(&head.text)
            }
            Container::Text { .. } => {
                if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0") {
                    return Err("it is no text".to_owned());
                }
                let head = &bytes[..bytes.len().min(HEAD)];
                let decoded = self.decoded(head);
                if decoded.text.contains('\0') {
                    return Err("it is no text".to_owned());
                }
                self.contains_all(&decoded.text)?;
                let mut lines: Vec<Line<'_>> = Lines::new(&decoded.text).collect();
                lines.pop_if(|line| !line.ended);
                let names = self.text_names(&lines).map_err(|error| error.to_string())?;
                self.columns_of(&names.0).map(|_| ())
            }
            Container::Sheet { .. } => {
                let is_workbook = bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0");
                if !is_workbook {
                    return Err("it is no workbook".to_owned());
                }
                let sheets = sheet_cells::read(bytes, unpacking::MOST).map_err(|error| error.to_string())?;
                self.sheet(&sheets).map(|_| ())
            }
        }
    }

    /// The table of a file.
    ///
    /// # Errors
    /// The file is empty or ends before its rows, or the columns that the profile names are not there.
    pub(super) fn table(
        &self,
        bytes: &[u8],
        max_unpacked_bytes: u64,
        issues: &mut Vec<Issue>,
    ) -> Result<Found, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        match &self.container {
            Container::Text { .. } => self.text_table(bytes, issues),
            // Read by the reader of tables: see `Profile::read`.
            Container::Answers(_) => Err(ReadError::Empty),
            Container::Sheet { .. } => {
                let sheets = sheet_cells::read(bytes, max_unpacked_bytes)?;
                self.sheet_table(&sheets)
            }
        }
    }

    fn text_table(&self, bytes: &[u8], issues: &mut Vec<Issue>) -> Result<Found, ReadError> {
        let Container::Text { dialect, comment, .. } = &self.container else {
            return Err(ReadError::Empty);
        };
        let decoded = self.decoded(bytes);
        let mut lines: Vec<Line<'_>> = Lines::new(&decoded.text).collect();
        let (status, status_evidence) = delimited::drop_cut_line(&mut lines, issues);
        delimited::note_replacements(&decoded, &lines, issues);
        let (names, data_at) = self.text_names(&lines)?;
        let places = self.places(&names)?;
        let rows = lines.get(data_at..).unwrap_or_default();
        let header_line = data_at.max(1);
        let mut cells = CellTable::new(header_line, &self.keep_text(names.len(), &places), rows.len());
        for line in rows {
            let is_comment = !comment.is_empty() && line.text.trim_start().starts_with(comment.as_str());
            if !line.text.trim().is_empty() && !is_comment {
                push_line(&mut cells, *line, *dialect);
            }
        }
        let preamble = lines[..data_at.min(lines.len())].iter();
        Ok(Found {
            names,
            cells,
            preamble: preamble.map(|line| line.text.trim().to_owned()).collect(),
            encoding: Some(decoded.encoding),
            status,
            status_evidence,
        })
    }

    fn decoded<'b>(&self, bytes: &'b [u8]) -> Decoded<'b> {
        let Container::Text {
            encoding: Some(encoding),
            ..
        } = &self.container
        else {
            return decode(bytes);
        };
        let (text, used, has_replacements) = encoding.decode(bytes);
        Decoded {
            text,
            encoding: used.name(),
            has_replacements,
        }
    }

    fn contains_all(&self, text: &str) -> Result<(), String> {
        match self
            .contains
            .iter()
            .find(|wanted| !text.contains(wanted.as_str()))
        {
            Some(missing) => Err(format!("{} does not stand in it", quoted(missing))),
            None => Ok(()),
        }
    }

    /// Names of the columns, and the index of the first line of readings.
    fn text_names(&self, lines: &[Line<'_>]) -> Result<(Vec<String>, usize), ReadError> {
        let Container::Text { dialect, .. } = &self.container else {
            return Ok((Vec::new(), 0));
        };
        let ends_before = |line: usize, found: &str| ReadError::header_only(line, found);
        let header_at = match &self.header {
            HeaderPlace::None => {
                let data = lines.iter().skip(self.lines_after_header);
                let first = data.clone().find(|line| !line.text.trim().is_empty());
                let first = first.ok_or_else(|| ends_before(lines.len(), "no row"))?;
                let fields = dialect.delimiter.split(first.text, |_, _| {});
                return Ok((vec![String::new(); fields], self.lines_after_header));
            }
            HeaderPlace::Line(line) if *line <= lines.len() => line - 1,
            HeaderPlace::Line(_) => {
                return Err(ends_before(lines.len(), "the line of the names is not there yet"));
            }
            HeaderPlace::Contains(text) => lines
                .iter()
                .position(|line| line.text.contains(text.as_str()))
                .ok_or_else(|| ends_before(lines.len(), "no line holds the text that marks the names"))?,
        };
        let mut names: Vec<String> = dialect
            .delimiter
            .header_cells(lines[header_at].text)
            .iter()
            .map(|cell| number::unquote(cell).to_owned())
            .collect();
        while names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        Ok((names, header_at + 1 + self.lines_after_header))
    }

    /// Index of every column that the profile names, the time's first.
    fn columns_of(&self, names: &[String]) -> Result<Vec<usize>, String> {
        self.named_columns()
            .map(|column| {
                let named = |name: &String| {
                    let mut places = names.iter().enumerate().filter(|(_, found)| *found == name);
                    match (places.next(), places.next()) {
                        (Some((place, _)), None) => Ok(place),
                        (None, _) => Err(format!(
                            "no {}; there are {}",
                            column.shown(),
                            quoted(&names.join(", "))
                        )),
                        _ => Err(format!("{} stands twice: give its number", column.shown())),
                    }
                };
                match column {
                    ColumnRef::Name(name) => named(name),
                    ColumnRef::Index(index) if *index < names.len() => Ok(*index),
                    ColumnRef::Index(_) => Err(format!("no {}; there are {}", column.shown(), names.len())),
                }
            })
            .collect()
    }

    /// As [`Profile::columns_of`], as a refusal.
    pub(super) fn places(&self, names: &[String]) -> Result<Vec<usize>, ReadError> {
        self.columns_of(names).map_err(|reason| ReadError::Column {
            line: 0,
            index: 0,
            column: format!("of profile {}", self.id),
            reason,
        })
    }

    /// Which columns keep their texts: those of dates.
    fn keep_text(&self, columns: usize, places: &[usize]) -> Vec<bool> {
        let mut keep = vec![false; columns];
        if self.time.is_text() {
            let times = self.time.columns().len();
            places[..times].iter().for_each(|&place| keep[place] = true);
        }
        keep
    }

    /// The sheet that fits, with the index of its first row of readings and the names of its columns.
    fn sheet<'s>(&self, sheets: &'s [Sheet]) -> Result<(&'s Sheet, usize, Vec<String>), String> {
        let Container::Sheet { name } = &self.container else {
            return Err("it is no text".to_owned());
        };
        let mut reason = match name {
            Some(name) => format!("no sheet {}", quoted(name)),
            None => "it has no sheet".to_owned(),
        };
        let named = |sheet: &&Sheet| name.as_ref().is_none_or(|name| sheet.name == *name);
        for sheet in sheets.iter().filter(named) {
            match self.sheet_names(sheet) {
                Ok((data_at, names)) => match self.columns_of(&names) {
                    Ok(_) => return Ok((sheet, data_at, names)),
                    Err(missing) => reason = missing,
                },
                Err(missing) => reason = missing,
            }
        }
        Err(reason)
    }

    fn sheet_names(&self, sheet: &Sheet) -> Result<(usize, Vec<String>), String> {
        let width = sheet
            .rows
            .iter()
            .filter_map(|row| row.cells.last())
            .map(|(column, _)| *column as usize + 1)
            .max()
            .unwrap_or(0);
        let text = |cell: &SheetCell| match cell {
            SheetCell::Text(text) => text.trim().to_owned(),
            _ => String::new(),
        };
        let header_at = match &self.header {
            HeaderPlace::None => {
                return Ok((self.lines_after_header, vec![String::new(); width]));
            }
            HeaderPlace::Line(line) => sheet.rows.iter().position(|row| row.number as usize == *line),
            HeaderPlace::Contains(wanted) => sheet.rows.iter().position(|row| {
                row.cells
                    .iter()
                    .any(|(_, cell)| text(cell).contains(wanted.as_str()))
            }),
        };
        let header_at = header_at.ok_or("the row of the names is not there")?;
        let mut names = vec![String::new(); width];
        for (column, cell) in &sheet.rows[header_at].cells {
            names[*column as usize] = text(cell);
        }
        let row = sheet.rows[header_at].number as usize + self.lines_after_header;
        let data_at = sheet.rows.iter().position(|found| found.number as usize > row);
        Ok((data_at.unwrap_or(sheet.rows.len()), names))
    }

    fn sheet_table(&self, sheets: &[Sheet]) -> Result<Found, ReadError> {
        let (sheet, data_at, names) = self.sheet(sheets).map_err(|reason| ReadError::Column {
            line: 0,
            index: 0,
            column: format!("of profile {}", self.id),
            reason,
        })?;
        let places = self.places(&names)?;
        let rows = &sheet.rows[data_at..];
        let mut cells = CellTable::new(data_at.max(1), &self.keep_text(names.len(), &places), rows.len());
        let decimal = crate::table::sheet::decimal_of_texts(
            rows.iter().flat_map(|row| row.cells.iter().map(|(_, c)| c)),
        );
        for row in rows {
            let line = row.number as usize;
            for (index, column) in cells.columns.iter_mut().enumerate() {
                let (cell, text) = row.cell(index as u32, decimal);
                column.push(line, cell, || text.to_owned());
            }
            cells.end_row(line, names.len());
        }
        let before = sheet.rows[..data_at].iter();
        let joined = |row: &sheet_cells::SheetRow| {
            let texts = row.cells.iter().map(|(_, cell)| match cell {
                SheetCell::Number(number) => number.to_string(),
                SheetCell::Text(text) | SheetCell::Date(text) | SheetCell::Error(text) => text.clone(),
            });
            texts.collect::<Vec<_>>().join("\t")
        };
        Ok(Found {
            names,
            cells,
            preamble: before.map(joined).collect(),
            encoding: None,
            status: RunStatus::Complete,
            status_evidence: "the workbook is whole".to_owned(),
        })
    }
}
