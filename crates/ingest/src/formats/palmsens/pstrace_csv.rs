//! PalmSens PSTrace text export (.csv): curves side by side, two columns each, under a row of units without names.
//!
//! The first line is the moment of the EXPORT; `Date and time measurement:` is the start of each curve. Current is in
//! the unit of the row, µA as a rule. Encoding is UTF-16 or UTF-8 with its mark, or Windows-1252; one more byte order
//! mark may follow the last line. Impedance exports name their columns (`freq / Hz`). Only commas between the cells
//! were ever seen; another delimiter is refused.

use crate::formats::assemble::{Raw, assemble_untimed};
use crate::formats::cells::CellTable;
use crate::formats::error::{ReadError, quoted};
use crate::formats::policy::UNITS_WITHIN;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::{self, DateOrder};
use crate::formats::{About, Format, ReadContext, delimited};
use crate::text::header::{Header, Meaning};
use crate::text::{Cell, Decimal, Line, Lines, decode, number};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::Issue;

/// Reader of PSTrace text.
pub struct PstraceCsv;

const EXPORTED: &str = "Date and time:";
const MEASURED: &str = "Date and time measurement:";
const IMPEDANCE_EXPORTED: &str = "File date:";

/// One curve: where its columns stand, its title and its start.
struct Curve {
    headers: Vec<Header>,
    first_column: usize,
    title: String,
    start: Option<String>,
}

impl Format for PstraceCsv {
    fn about(&self) -> About {
        About {
            id: "palmsens-csv",
            title: "PalmSens PSTrace text export (.csv)",
            extensions: &["csv"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = text
            .lines()
            .find(|line| !line.trim_matches([',', ' ']).is_empty());
        let begins = first.unwrap_or("").trim_start_matches('"');
        if begins.starts_with(EXPORTED) || begins.starts_with(IMPEDANCE_EXPORTED) {
            return Match::Certain("the first line is Date and time or File date");
        }
        // Exports without the moment of their export begin with the titles of their curves.
        let lines: Vec<&str> = text.lines().take(UNITS_WITHIN).collect();
        let units = lines.iter().position(|line| is_units(line));
        let is_curve = |line: &&str| line.starts_with(MEASURED) || is_titles(line);
        Match::certain_if(
            units.is_some_and(|at| lines[..at].iter().any(is_curve)),
            "titles of curves such as `CV i vs E` above a row of units",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let mut issues = Vec::new();
        let decoded = decode(bytes);
        let text = decoded.text.trim_end_matches('\u{feff}');
        let mut lines: Vec<Line<'_>> = Lines::new(text).collect();
        let (status, status_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let names_at = lines
            .iter()
            .position(|line| is_units(line.text) || is_names(line.text));
        let names_at = names_at.ok_or_else(|| ReadError::header_only(lines.len(), "no row of units"))?;
        let (preamble, rows) = (&lines[..names_at], &lines[names_at + 1..]);
        let curves = curves(preamble, &lines[names_at])?;
        let mut tables = Vec::new();
        for curve in &curves {
            let cells = cells(curve, lines[names_at].number, rows);
            let name = match (curves.len(), curve.title.as_str()) {
                (1, _) => String::new(),
                (_, "") => "curve".to_owned(),
                (_, title) => title.to_owned(),
            };
            let raw = Raw::of_instrument(name, curve.headers.clone(), cells);
            tables.push(assemble_untimed(raw, &mut issues)?);
        }
        make_names_unique(&mut tables);
        let technique = curves.first().map(|curve| technique(&curve.title).to_owned());
        Ok(Reading {
            is_step_response: curves
                .iter()
                .all(|curve| matches!(self::technique(&curve.title), "Chronoamperometry" | "CA i vs t")),
            technique,
            encoding: Some(decoded.encoding),
            status,
            status_evidence: delimited::undeclared(status, status_evidence),
            started_at: started_at(&curves, preamble, &mut issues),
            tables,
            original_metadata: preamble
                .iter()
                .filter(|line| !line.text.trim_matches(',').trim().is_empty())
                .map(|line| {
                    let (key, value) = line.text.split_once(',').unwrap_or((line.text, ""));
                    (key.trim_end_matches(':').to_owned(), value.to_owned())
                })
                .collect(),
            issues,
            ..self.reading()
        })
    }
}

/// Titles of curves, `Cyclic Voltammetry: CV i vs E` or `CV i vs E Scan 1`, in every other cell.
fn is_titles(text: &str) -> bool {
    let first = text.split(',').next().unwrap_or("");
    [" i vs E", " i vs t", " E vs t", " E vs i"]
        .iter()
        .any(|axes| first.contains(axes))
}

/// A row such as `s,µA` or `V,µA,V,µA`.
fn is_units(text: &str) -> bool {
    let text = text.trim_end_matches([',', ';', '\t', ' ']);
    let cells: Vec<&str> = text.split([',', ';', '\t']).map(str::trim).collect();
    cells.len() >= 2 && cells.iter().all(|cell| name_of(cell).is_some())
}

/// The row of names of an impedance export.
fn is_names(text: &str) -> bool {
    text.starts_with("freq / Hz")
}

/// The quantity that a unit stands for: the row gives no names.
fn name_of(unit: &str) -> Option<&'static str> {
    match unit {
        "s" => Some("time"),
        "V" | "mV" => Some("potential"),
        "A" | "mA" | "\u{b5}A" | "\u{3bc}A" | "uA" | "nA" | "pA" => Some("current"),
        "C" | "mC" | "\u{b5}C" | "\u{3bc}C" => Some("charge"),
        _ => None,
    }
}

fn curves(preamble: &[Line<'_>], units: &Line<'_>) -> Result<Vec<Curve>, ReadError> {
    if !units.text.contains(',') {
        return Err(ReadError::NeverSeen {
            what: "an export of PSTrace without commas between its cells",
            found: quoted(units.text),
        });
    }
    let row = |is_wanted: &dyn Fn(&str) -> bool| -> Vec<&str> {
        let line = preamble.iter().rev().find(|line| is_wanted(line.text));
        line.map_or(Vec::new(), |line| line.text.split(',').map(str::trim).collect())
    };
    let dates = row(&|text| text.starts_with(MEASURED));
    if is_names(units.text) {
        let cells = units.text.trim_end_matches(',').split(',');
        return Ok(vec![Curve {
            headers: impedance_headers(cells),
            first_column: 0,
            title: "Impedance Spectroscopy".to_owned(),
            start: row(&|text| text.starts_with(EXPORTED))
                .get(1)
                .map(|text| (*text).to_owned()),
        }]);
    }
    let measured_at = preamble.iter().position(|line| line.text.starts_with(MEASURED));
    let titles_at = measured_at
        .and_then(|at| at.checked_sub(1))
        .or_else(|| preamble.iter().rposition(|line| is_titles(line.text)));
    let titles: Vec<&str> = match titles_at {
        Some(at) => preamble[at].text.split(',').map(str::trim).collect(),
        None => Vec::new(),
    };
    let units: Vec<&str> = units
        .text
        .trim_end_matches([',', ' '])
        .split(',')
        .map(str::trim)
        .collect();
    if !units.len().is_multiple_of(2) {
        return Err(ReadError::NeverSeen {
            what: "an export of PSTrace with an odd number of columns",
            found: format!("{} columns", units.len()),
        });
    }
    let curve = |(index, pair): (usize, &[&str])| Curve {
        headers: pair
            .iter()
            .map(|unit| Header::with_unit(name_of(unit).unwrap_or(""), unit))
            .collect(),
        first_column: 2 * index,
        title: titles.get(2 * index).copied().unwrap_or("").to_owned(),
        start: dates.get(2 * index + 1).map(|text| (*text).to_owned()),
    };
    Ok(units.chunks(2).enumerate().map(curve).collect())
}

/// PSTrace prints the imaginary part with the sign of `neg. Phase`, which stands beside it, and without saying so.
fn impedance_headers<'a>(cells: impl Iterator<Item = &'a str>) -> Vec<Header> {
    let mut headers: Vec<Header> = cells.map(Header::parse).collect();
    let negated = headers
        .iter()
        .any(|header| header.raw_name.starts_with("neg. Phase"));
    for header in headers
        .iter_mut()
        .filter(|header| negated && header.raw_name.starts_with("Z''"))
    {
        if let Meaning::Known { conversion, .. } = &mut header.meaning {
            *conversion = conversion.negated();
        }
    }
    headers
}

/// The cells of one curve; curves end at different rows.
fn cells(curve: &Curve, header_line: usize, rows: &[Line<'_>]) -> CellTable {
    let columns = curve.headers.len();
    let mut table = CellTable::new(header_line, &vec![false; columns], rows.len());
    for row in rows {
        let cells = row.text.split(',').skip(curve.first_column).take(columns);
        let cells: Vec<&str> = cells.collect();
        // A byte order mark may stand on a line of its own behind the last row.
        if cells
            .iter()
            .all(|cell| cell.trim_matches('\u{feff}').trim().is_empty())
        {
            continue;
        }
        for (column, text) in table.columns.iter_mut().zip(&cells) {
            let cell = number::parse(text, Decimal::Point);
            column.push(row.number, if *text == "-" { Cell::Empty } else { cell }, || {
                (*text).to_owned()
            });
        }
        table.end_row(row.number, cells.len());
    }
    table
}

/// `Chronoamperometry [5]: CA i vs t` without its number and its label.
fn technique(title: &str) -> &str {
    let name = title.split(':').next().unwrap_or("");
    name.split('[').next().unwrap_or("").trim()
}

fn make_names_unique(tables: &mut [RunTable]) {
    for index in 1..tables.len() {
        let (before, rest) = tables.split_at_mut(index);
        if before.iter().any(|table| table.name == rest[0].name) {
            rest[0].name = format!("{} ({})", rest[0].name, index + 1);
        }
    }
}

/// The moment in the line that states when the file was exported; titles of curves stand in its place where it is not.
fn moment_of_export(text: &str) -> Option<&str> {
    let (key, moment) = text.trim_start_matches('"').split_once(',')?;
    let is_export = [EXPORTED, IMPEDANCE_EXPORTED].contains(&key.trim_end_matches('"').trim());
    is_export.then(|| moment.trim_matches([',', '"', ' ']))
}

fn started_at(curves: &[Curve], preamble: &[Line<'_>], issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let starts = curves.iter().filter_map(|curve| curve.start.as_deref());
    let starts: Vec<&str> = starts.filter(|text| !text.is_empty()).collect();
    if starts.is_empty() {
        let exported = preamble.iter().find_map(|line| moment_of_export(line.text))?;
        return Some(stamp::in_order(exported, DateOrder::YearFirst, Timestamp::Export, "year first").0);
    }
    let mut found = Vec::new();
    let stamps = starts.into_iter().map(|text| {
        let (stamp, issue) = stamp::in_order(text, DateOrder::YearFirst, Timestamp::Start, "year first");
        found.extend(issue);
        stamp
    });
    let stamps: Vec<StartedAt> = stamps.collect();
    issues.extend(found);
    stamp::shared(stamps, issues)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start_of(text: &str) -> Option<StartedAt> {
        let read = PstraceCsv.read(text.as_bytes(), &ReadContext::default());
        read.unwrap().started_at
    }

    #[test]
    fn titles_of_curves_are_no_date() {
        let rows = "V,mA,V,mA\r\n0.1,1.5,0.1,2\r\n0.2,2.5,0.2,3\r\n";
        let titles = format!("CV i vs E Scan 1,,CV i vs E Scan 2,\r\n{rows}");
        assert_eq!(start_of(&titles), None);
        let dated = start_of(&format!("Date and time:,2026-05-13 10:20:30\r\n{titles}")).unwrap();
        assert_eq!(dated.local.as_deref(), Some("2026-05-13T10:20:30"));
        assert_eq!(dated.kind, Timestamp::Export);
    }
}
