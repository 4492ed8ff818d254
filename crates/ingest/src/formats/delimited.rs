//! A delimited text file as a whole: encoding, comments, layout, cells, and whether it was cut.

use std::borrow::Cow;

use super::cells::CellTable;
use super::error::{ReadError, quoted};
use crate::text::grid::{Dialect, push_line};
use crate::text::lines::lines_of;
use crate::text::units_in_cells::lifted;
use crate::text::whole_line::sign_of_whole;
use crate::text::{Cell, Decimal, Decoded, Delimiter, Line, decode, number};
use ieap_domain::{Issue, RunStatus};

/// A delimited text before its columns get their meaning.
#[derive(Debug)]
pub struct Text<'a> {
    /// Encoding found.
    pub encoding: &'static str,
    /// Its lines, without a cut one.
    pub lines: Vec<Line<'a>>,
    /// Complete or cut.
    pub status: RunStatus,
    /// Evidence for `status`.
    pub status_evidence: String,
}

impl Text<'_> {
    /// Evidence of a format that declares no number of rows.
    pub fn evidence(&self) -> String {
        undeclared(self.status, self.status_evidence.clone())
    }

    /// Comments and lines before the names, in the file's order.
    pub fn metadata(&self, names_at: Option<usize>) -> Vec<(String, String)> {
        metadata(&self.lines, names_at.unwrap_or(0))
    }
}

/// Evidence of how a file ended whose format declares no number of rows.
pub fn undeclared(status: RunStatus, evidence: String) -> String {
    match status {
        RunStatus::Complete => evidence + "; the format declares no number of rows",
        _ => evidence,
    }
}

/// The lines of a delimited text. What stands behind a NUL byte is no text: a disk without power leaves it.
///
/// # Errors
/// The file has no whole line yet.
pub fn text<'a>(decoded: &'a Decoded<'_>, issues: &mut Vec<Issue>) -> Result<Text<'a>, ReadError> {
    let whole: &str = &decoded.text;
    let (readable, nul_at) = match whole.find('\0') {
        Some(at) => (&whole[..at], Some(at)),
        None => (whole, None),
    };
    let mut lines = lines_of(readable);
    let (mut status, mut status_evidence) = drop_cut_line(&mut lines, issues);
    if let Some(at) = nul_at {
        let line = readable.matches('\n').count() + 1;
        status = RunStatus::Cut;
        status_evidence = format!("from byte {at} of the text on it holds NUL bytes");
        let message = format!(
            "from line {line} on the file holds {} NUL bytes and what follows them; it is read up to there",
            whole[at..].matches('\0').count()
        );
        issues.push(
            Issue::warning("nul-bytes", message)
                .at(format!("line {line}"))
                .mend("copy the file again; the end of the record is lost where the original has it, too"),
        );
    }
    if lines.is_empty() {
        return Err(ReadError::header_only(1, "its first line has no end yet"));
    }
    note_replacements(decoded, &lines, issues);
    Ok(Text {
        encoding: decoded.encoding,
        lines,
        status,
        status_evidence,
    })
}

/// The cells of lines under a header on line `header_line`; blank lines hold none.
pub fn cells_of(header_line: usize, columns: usize, lines: &[Line<'_>], dialect: Dialect) -> CellTable {
    let mut cells = CellTable::new(header_line, &vec![false; columns], lines.len());
    for line in lines.iter().filter(|line| !line.text.trim().is_empty()) {
        push_line(&mut cells, *line, dialect);
    }
    cells
}

/// Decimal sign of rows whose delimiter is known: the one under which their cells are numbers.
///
/// # Errors
/// Some cells are numbers with a point only, others with a comma only.
pub fn decimal_of<'a>(
    rows: impl IntoIterator<Item = &'a Line<'a>>,
    delimiter: Delimiter,
) -> Result<Decimal, ReadError> {
    let (mut point, mut comma) = (None, None);
    for row in rows {
        delimiter.split(row.text, |_, text| {
            let reads = |decimal| matches!(number::parse(text, decimal), Cell::Number(_));
            match (reads(Decimal::Point), reads(Decimal::Comma)) {
                (true, false) => point = point.or(Some((row.number, text))),
                (false, true) => comma = comma.or(Some((row.number, text))),
                _ => {}
            }
        });
        if point.is_some() && comma.is_some() {
            break;
        }
    }
    match (point, comma) {
        (Some((_, with_point)), Some((line, with_comma))) => Err(ReadError::AmbiguousNumbers {
            line,
            found: format!("{} stands beside {}", quoted(with_comma), quoted(with_point)),
            mend: "export anew with one decimal sign in the whole file",
        }),
        (None, Some(_)) => Ok(Decimal::Comma),
        _ => Ok(Decimal::Point),
    }
}

/// A number of a header, whose decimal sign may differ from that of the tables.
pub fn header_number(text: &str) -> Option<f64> {
    [Decimal::Point, Decimal::Comma]
        .into_iter()
        .find_map(|decimal| match number::parse(text, decimal) {
            Cell::Number(number) => Some(number),
            _ => None,
        })
}

/// The text of a file.
///
/// # Errors
/// [`ReadError::Empty`]: there are no bytes.
pub fn decoded(bytes: &[u8]) -> Result<Decoded<'_>, ReadError> {
    if bytes.is_empty() {
        Err(ReadError::Empty)
    } else {
        let decoded = decode(bytes);
        Ok(match lifted(&decoded.text) {
            Some(text) => Decoded {
                text: Cow::Owned(text),
                ..decoded
            },
            None => decoded,
        })
    }
}

/// Drops a last line without an end, unless it shows that it is whole: else its last number may lack digits and nothing
/// shows it.
pub fn drop_cut_line(lines: &mut Vec<Line<'_>>, issues: &mut Vec<Issue>) -> (RunStatus, String) {
    lines.pop_if(|line| !line.ended && line.text.trim().is_empty());
    if lines.last().is_none_or(|line| line.ended) {
        return (RunStatus::Complete, "the last line has its end".to_owned());
    }
    if let (Some(sign), Some(last)) = (sign_of_whole(lines), lines.last_mut()) {
        last.ended = true;
        last.text = last.text.trim_end_matches('\r');
        let evidence = format!("line {} has no line end, but is whole: {sign}", last.number);
        return (RunStatus::Complete, evidence);
    }
    let Some(line) = lines.pop() else {
        return (RunStatus::Complete, "there is no line".to_owned());
    };
    let evidence = format!("line {} has no line end; it is left out", line.number);
    let message = format!(
        "the last line {} has no line end, so a number in it may be cut",
        quoted(line.text)
    );
    issues.push(
        Issue::warning("file-cut", message)
            .at(format!("line {}", line.number))
            .mend("copy or export the file again; put a line end behind the last line if it is whole"),
    );
    (RunStatus::Cut, evidence)
}

/// Says so where code units of the file mean nothing in its encoding; a cut line is gone already.
pub fn note_replacements(decoded: &Decoded<'_>, lines: &[Line<'_>], issues: &mut Vec<Issue>) {
    if !decoded.has_replacements {
        return;
    }
    if let Some(line) = lines.iter().find(|line| line.text.contains('\u{fffd}')) {
        let message = format!(
            "bytes that are no {} are shown as U+FFFD: {}",
            decoded.encoding,
            quoted(line.text)
        );
        issues.push(Issue::warning("bad-encoding", message).at(format!("line {}", line.number)));
    }
}

/// `# key: value`, `# key = value`, other comments, and the lines before the header.
pub fn metadata(lines: &[Line<'_>], header_at: usize) -> Vec<(String, String)> {
    let mut metadata = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let text = line.text.trim();
        if let Some(comment) = text.strip_prefix('#') {
            metadata.push(key_and_value(comment.trim_start_matches('#').trim(), "comment"));
        } else if index < header_at && !text.is_empty() {
            metadata.push(key_and_value(text, "preamble"));
        }
    }
    metadata
}

fn key_and_value(text: &str, otherwise: &str) -> (String, String) {
    let is_key = |key: &&str| {
        let mut words = key.chars();
        !key.is_empty()
            && key.len() <= 40
            && words.all(|c| c.is_alphanumeric() || matches!(c, '_' | ' ' | '-' | '.'))
    };
    let cut = text.find([':', '=']);
    match cut
        .map(|at| (text[..at].trim(), text[at + 1..].trim()))
        .filter(|(key, _)| is_key(key))
    {
        Some((key, value)) => (key.to_owned(), value.to_owned()),
        None => (otherwise.to_owned(), text.to_owned()),
    }
}
