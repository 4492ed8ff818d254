//! A delimited text file as a whole: encoding, comments, layout, cells, and whether it was cut.

use super::cells::CellTable;
use super::error::{ReadError, quoted};
use crate::text::grid::{Dialect, is_blank_or_comment, push_line};
use crate::text::header::Header;
use crate::text::layout::{self, Layout};
use crate::text::whole_line::sign_of_whole;
use crate::text::{Cell, Decimal, Decoded, Delimiter, Line, Lines, decode, number};
use ieap_domain::{Issue, RunStatus};

/// What was read before columns get their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct DelimitedText {
    /// Encoding found.
    pub encoding: &'static str,
    /// Columns as the header describes them.
    pub headers: Vec<Header>,
    /// The cells.
    pub cells: CellTable,
    /// Comments and lines before the header, in the file's order.
    pub metadata: Vec<(String, String)>,
    /// Complete or cut.
    pub status: RunStatus,
    /// Evidence for `status`.
    pub status_evidence: String,
}

/// Reads a delimited text; `is_text` says which columns hold texts, such as overload flags.
///
/// # Errors
/// The file is empty, has no header or no data, or can be read in two ways.
pub fn read(
    bytes: &[u8],
    is_text: impl Fn(&Header) -> bool,
    issues: &mut Vec<Issue>,
) -> Result<DelimitedText, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let decoded = decode(bytes);
    let mut lines: Vec<Line<'_>> = Lines::new(&decoded.text).collect();
    let (status, status_evidence) = drop_cut_line(&mut lines, issues);
    if lines.is_empty() {
        return Err(ReadError::HeaderOnly {
            line: 1,
            found: "its first line has no end yet".to_owned(),
        });
    }
    note_replacements(&decoded, &lines, issues);
    let Layout {
        dialect,
        headers,
        header_at,
        data_at,
    } = layout::decide(&lines)?;
    let keep_text: Vec<bool> = headers.iter().map(is_text).collect();
    let mut cells = CellTable::new(lines[header_at].number, &keep_text, lines.len() - data_at);
    for line in &lines[data_at..] {
        if !is_blank_or_comment(line.text) {
            push_line(&mut cells, *line, dialect);
        }
    }
    Ok(DelimitedText {
        encoding: decoded.encoding,
        headers,
        cells,
        metadata: metadata(&lines, header_at),
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
        Ok(decode(bytes))
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
fn metadata(lines: &[Line<'_>], header_at: usize) -> Vec<(String, String)> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_metadata_and_a_cut_line_goes() {
        let mut issues = Vec::new();
        let text =
            "# sample: CNaf-01\n# two words here, no key\ntime_s,current_a\n0,1\n# later = yes\n1,2\n2,3";
        let read = read(text.as_bytes(), |_| false, &mut issues).unwrap();
        assert_eq!(read.metadata[0], ("sample".to_owned(), "CNaf-01".to_owned()));
        assert_eq!(read.metadata[1].0, "comment");
        assert_eq!(read.metadata[2], ("later".to_owned(), "yes".to_owned()));
        assert_eq!((read.cells.rows(), read.status), (2, RunStatus::Cut));
        assert_eq!(
            (issues[0].code.as_str(), issues[0].place.as_str()),
            ("file-cut", "line 7")
        );
    }

    #[test]
    fn a_whole_last_row_without_a_line_end_is_read() {
        for (text, rows) in [
            ("time_s\tcurrent_a\n0\t1.5E-04\n1\t2.5E-04", 2),
            ("time_s,current_a\n0,1.50\n1,2.25\n2,3.00\n3,3.25", 4),
            ("time_s\tcurrent_a\n0\t1.5E-04\n1\t2.5E-0", 1),
        ] {
            let mut issues = Vec::new();
            let read = read(text.as_bytes(), |_| false, &mut issues).unwrap();
            let is_cut = read.status == RunStatus::Cut;
            assert_eq!((read.cells.rows(), is_cut), (rows, rows == 1), "{text:?}");
            assert_eq!(
                issues.iter().any(|issue| issue.code == "file-cut"),
                is_cut,
                "{text:?}"
            );
        }
    }

    #[test]
    fn a_first_line_without_an_end_waits() {
        let error = read(b"time_s,curr", |_| false, &mut Vec::new()).unwrap_err();
        assert!(error.is_pending());
    }
}
