//! Where the header of a delimited text stands, what separates its cells and which decimal sign it uses.
//!
//! The decision comes from the grammar of the data and never from the computer's locale: a reading holds where
//! every data line has as many fields as the header and the columns ieap knows are numbers. Where two readings
//! hold and give different numbers the file is refused.

use super::delimiter::Delimiter;
use super::grid::{Dialect, is_blank_or_comment};
use super::header::{Header, Meaning};
use super::likely::headed_by_unit;
use super::lines::Line;
use super::number::{self, Cell, Decimal};
use super::unit_row::unit_row;
use crate::formats::assemble::{is_modulus_sweep, is_spectrum};
use crate::formats::error::{ReadError, quoted};
use crate::text::policy::{HEADER_WITHIN_LINES, LINES_ASKED, OBEYING_SHARE};
use ieap_domain::Quantity;

/// What was decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Delimiter and decimal sign.
    pub dialect: Dialect,
    /// Columns as the header describes them.
    pub headers: Vec<Header>,
    /// Index of the header line among the lines given.
    pub header_at: usize,
    /// Index of the first data line among the lines given; a row of units may stand between.
    pub data_at: usize,
}

/// A header found under one delimiter.
struct Found {
    delimiter: Delimiter,
    headers: Vec<Header>,
    header_at: usize,
    /// Its line in the file.
    header_line: usize,
    data_at: usize,
}

/// One way to read the file.
struct Candidate {
    found: usize,
    decimal: Decimal,
    /// Columns that ieap knows and that are numbers; then columns that are numbers; then cells that are.
    grade: (usize, usize, usize),
    numbers: Vec<Vec<Option<u64>>>,
}

/// Decides how to read `lines`, all of which have their line end.
///
/// # Errors
/// No line names a time column, no data line follows, no reading holds, or several do.
pub fn decide(lines: &[Line<'_>]) -> Result<Layout, ReadError> {
    let mut found: Vec<Found> = Delimiter::ALL
        .into_iter()
        .filter_map(|d| find_header(lines, d))
        .collect();
    if found.is_empty() {
        return Err(no_header(lines));
    }
    let mut sample = sample(lines, &found, LINES_ASKED);
    if sample.is_empty() {
        let line = lines[found[0].header_at];
        return Err(ReadError::HeaderOnly {
            line: line.number,
            found: quoted(line.text),
        });
    }
    if !sample.iter().any(|line| line.text.contains(['.', ','])) {
        // Whole numbers only so far: the sign shows further down, or nowhere.
        sample = self::sample(lines, &found, usize::MAX);
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for (index, found) in found.iter().enumerate() {
        for decimal in [Decimal::Point, Decimal::Comma] {
            candidates.extend(judge(found, index, decimal, &sample));
        }
    }
    if candidates
        .iter()
        .any(|candidate| found[candidate.found].delimiter != Delimiter::Blanks)
    {
        // Blanks also stand inside names and texts: they separate columns only where nothing else does.
        candidates.retain(|candidate| found[candidate.found].delimiter != Delimiter::Blanks);
    }
    let best = choose(&candidates, &found, &sample)?;
    let decimal = best.decimal;
    let chosen = found.swap_remove(best.found);
    Ok(Layout {
        dialect: Dialect {
            delimiter: chosen.delimiter,
            decimal,
        },
        headers: chosen.headers,
        header_at: chosen.header_at,
        data_at: chosen.data_at,
    })
}

/// The first line that names a time column under `delimiter`.
fn find_header(lines: &[Line<'_>], delimiter: Delimiter) -> Option<Found> {
    let header_at = header_line(lines, delimiter)?;
    let mut cells = delimiter.header_cells(lines[header_at].text);
    while cells.last().is_some_and(|cell| cell.is_empty()) {
        cells.pop();
    }
    let units = units_below(lines, header_at, delimiter, &cells);
    let names: Vec<&str> = cells.iter().map(String::as_str).collect();
    Some(Found {
        delimiter,
        headers: headers(&names, units.as_ref().map(|(_, units)| units.as_slice())),
        header_at,
        header_line: lines[header_at].number,
        data_at: units.map_or(header_at, |(at, _)| at) + 1,
    })
}

/// The row of units below the names with its place; blank lines may stand between.
fn units_below(
    lines: &[Line<'_>],
    header_at: usize,
    delimiter: Delimiter,
    names: &[String],
) -> Option<(usize, Vec<String>)> {
    let below = lines.iter().enumerate().skip(header_at + 1);
    let (at, line) = below.clone().find(|(_, line)| !is_blank_or_comment(line.text))?;
    let cells = delimiter.header_cells(line.text);
    Some((at, unit_row(names.len(), cells.iter().map(String::as_str))?))
}

/// Headers of names; a name without a unit of its own takes that of the row of units. A number in the place of a name,
/// as oscilloscopes number their inputs, says nothing: the unit does, where only one input has it.
pub fn headers(names: &[&str], units: Option<&[String]>) -> Vec<Header> {
    let unit_of = |index: usize| {
        units
            .and_then(|units| units.get(index))
            .map_or("", String::as_str)
    };
    let is_number = |name: &str| {
        let bare = number::unquote(name);
        !bare.is_empty() && bare.bytes().all(|byte| byte.is_ascii_digit())
    };
    let header = |(index, name): (usize, &&str)| match (Header::parse(name), unit_of(index)) {
        (header, unit) if header.raw_unit.is_empty() && !unit.is_empty() => {
            match headed_by_unit(name, unit) {
                Some(header) if is_number(name) => header,
                _ => Header::with_unit(name, unit),
            }
        }
        (header, _) => header,
    };
    let mut headers: Vec<Header> = names.iter().enumerate().map(header).collect();
    let quantities: Vec<Option<Quantity>> = headers.iter().map(|h| h.meaning.quantity()).collect();
    let is_only = |quantity| quantities.iter().filter(|other| **other == quantity).count() == 1;
    for (header, quantity) in headers.iter_mut().zip(&quantities) {
        if is_number(&header.raw_name) && !is_only(*quantity) {
            header.meaning = Meaning::Other;
        }
    }
    headers
}

/// The first line with a time column that can be used, else the first that speaks of time at all: a preamble may
/// hold `Time;12:30:05`. Units below the names make their time usable.
fn header_line(lines: &[Line<'_>], delimiter: Delimiter) -> Option<usize> {
    let mut speaks_of_time = None;
    for (index, line) in lines.iter().take(HEADER_WITHIN_LINES).enumerate() {
        if is_blank_or_comment(line.text) {
            continue;
        }
        let cells = delimiter.header_cells(line.text);
        if cells.len() < 2 {
            continue;
        }
        let names: Vec<&str> = cells.iter().map(String::as_str).collect();
        let found = time_among(names.iter().copied());
        if found == Some(true) {
            return Some(index);
        }
        if let Some((_, units)) = units_below(lines, index, delimiter, &cells)
            && (found.is_some() || axis_among(&meanings(&headers(&names, Some(&units)))) == Some(true))
        {
            return Some(index);
        }
        speaks_of_time = speaks_of_time.or(found.map(|_| index));
    }
    speaks_of_time
}

/// Whether a time column among two cells or more can be used; none where there is no such column. The frequency of a
/// spectrum, or of a modulus without any time, does as well.
pub fn time_among<'a>(cells: impl Iterator<Item = &'a str>) -> Option<bool> {
    let headers: Vec<Header> = cells.map(Header::parse).collect();
    axis_among(&meanings(&headers))
}

fn axis_among(meanings: &[Meaning]) -> Option<bool> {
    if meanings.len() < 2 {
        return None;
    }
    if is_spectrum(meanings) || is_modulus_sweep(meanings) {
        return Some(true);
    }
    let times = meanings
        .iter()
        .filter(|meaning| meaning.named_quantity() == Some(Quantity::Time));
    times
        .map(|meaning| meaning.quantity().is_some())
        .reduce(|a, b| a || b)
}

fn meanings(headers: &[Header]) -> Vec<Meaning> {
    headers.iter().map(|header| header.meaning.clone()).collect()
}

/// Data lines after the last of the headers found.
fn sample<'a>(lines: &[Line<'a>], found: &[Found], limit: usize) -> Vec<Line<'a>> {
    let data_at = found.iter().map(|found| found.data_at).max().unwrap_or(0);
    let data = lines[data_at.min(lines.len())..].iter().copied();
    data.filter(|line| !is_blank_or_comment(line.text))
        .take(limit)
        .collect()
}

/// The reading under one delimiter and decimal sign; none where fields or the time column do not obey it.
fn judge(found: &Found, index: usize, decimal: Decimal, sample: &[Line<'_>]) -> Option<Candidate> {
    let width = found.headers.len();
    let mut numeric = vec![0usize; width];
    let mut filled = vec![0usize; width];
    let mut even_lines = 0usize;
    let mut numbers = Vec::with_capacity(sample.len());
    for line in sample {
        let mut row = vec![None; width];
        let mut beyond = false;
        let fields = found.delimiter.split(line.text, |k, text| {
            if k >= width {
                beyond |= !text.trim().is_empty();
                return;
            }
            let cell = number::parse(text, decimal);
            filled[k] += usize::from(cell != Cell::Empty);
            numeric[k] += usize::from(matches!(cell, Cell::Number(_) | Cell::NotFinite));
            if let Cell::Number(number) = cell {
                row[k] = Some(number.to_bits());
            }
        });
        even_lines += usize::from(fields == width || (fields > width && !beyond));
        numbers.push(row);
    }
    let obeys = |part: usize, whole: usize| part > 0 && part as f64 >= OBEYING_SHARE * whole as f64;
    let is_number = |k: usize| obeys(numeric[k], filled[k]);
    let known = (0..width).filter(|&k| found.headers[k].meaning.named_quantity().is_some() && is_number(k));
    let meanings = meanings(&found.headers);
    let axis = if is_spectrum(&meanings) || is_modulus_sweep(&meanings) {
        Quantity::Frequency
    } else {
        Quantity::Time
    };
    let time = |k: &usize| found.headers[*k].meaning.named_quantity() == Some(axis);
    if !obeys(even_lines, sample.len()) || !known.clone().any(|k| time(&k)) {
        return None;
    }
    Some(Candidate {
        found: index,
        decimal,
        grade: (
            known.count(),
            (0..width).filter(|&k| is_number(k)).count(),
            numeric.iter().sum(),
        ),
        numbers,
    })
}

fn choose<'c>(
    candidates: &'c [Candidate],
    found: &[Found],
    sample: &[Line<'_>],
) -> Result<&'c Candidate, ReadError> {
    let Some(best) = candidates
        .iter()
        .reduce(|a, b| if b.grade > a.grade { b } else { a })
    else {
        return Err(no_reading(found, sample));
    };
    match candidates
        .iter()
        .find(|other| other.grade == best.grade && other.numbers != best.numbers)
    {
        None => Ok(best),
        Some(other) => Err(ReadError::AmbiguousNumbers {
            line: sample[0].number,
            found: format!(
                "{} can be read with {} and with {}, and the numbers differ",
                quoted(sample[0].text),
                reading(best, found),
                reading(other, found)
            ),
            mend: match best.decimal == other.decimal {
                true => "export with semicolons or tabs between the columns",
                false if is_comma_free(best, found) && is_comma_free(other, found) => {
                    "export with a point as decimal sign"
                }
                false => {
                    "export with a point as decimal sign, or with semicolons or tabs between the columns"
                }
            },
        }),
    }
}

/// Whether commas can stand for the decimal sign only.
fn is_comma_free(candidate: &Candidate, found: &[Found]) -> bool {
    found[candidate.found].delimiter != Delimiter::Comma
}

fn reading(candidate: &Candidate, found: &[Found]) -> String {
    let sign = match candidate.decimal {
        Decimal::Point => "decimal point",
        Decimal::Comma => "decimal comma",
    };
    format!(
        "{} between columns and {sign}",
        found[candidate.found].delimiter.label()
    )
}

/// No reading holds: says how the first data line differs from the header it was held against.
fn no_reading(found: &[Found], sample: &[Line<'_>]) -> ReadError {
    let widest = found
        .iter()
        .rev()
        // Blanks also stand inside names: they count only where nothing else separates.
        .max_by_key(|found| (found.delimiter != Delimiter::Blanks, found.headers.len()))
        .unwrap_or(&found[0]);
    let line = sample[0];
    let mut fields = Vec::new();
    widest.delimiter.split(line.text, |_, text| fields.push(text));
    ReadError::NoReading {
        header: widest.header_line,
        line: line.number,
        found: format!(
            "under the {} names of the header (between them: {}) stands {}, which has {} fields; no delimiter and \
             decimal sign makes the time column a number in every row",
            widest.headers.len(),
            widest.delimiter.label(),
            quoted(line.text),
            fields.len()
        ),
        mend: match (widest.delimiter, fields.len() == widest.headers.len()) {
            (_, true) => {
                "write only numbers below the name of the time, with one decimal sign in the whole file"
            }
            (Delimiter::Comma, false) => {
                "export with a point as decimal sign, or with semicolons or tabs between the columns"
            }
            (_, false) => {
                "give every row as many fields as there are names, and only numbers below the name of the time"
            }
        },
    }
}

fn no_header(lines: &[Line<'_>]) -> ReadError {
    if let Some(line) = lines
        .iter()
        .take(HEADER_WITHIN_LINES)
        .find(|line| names_frequency(line))
    {
        return ReadError::NoImpedance {
            line: line.number,
            found: quoted(line.text),
        };
    }
    let first = lines.iter().find(|line| !is_blank_or_comment(line.text));
    ReadError::NoHeader {
        line: first.map_or(0, |line| line.number),
        found: quoted(first.map_or("", |line| line.text)),
    }
}

/// Whether a line names a frequency beside other columns.
fn names_frequency(line: &Line<'_>) -> bool {
    let is_frequency =
        |cell: &String| Header::parse(cell).meaning.named_quantity() == Some(Quantity::Frequency);
    !is_blank_or_comment(line.text)
        && Delimiter::ALL.into_iter().any(|delimiter| {
            let cells = delimiter.header_cells(line.text);
            cells.len() > 1 && cells.iter().any(is_frequency)
        })
}

#[cfg(test)]
mod tests;
