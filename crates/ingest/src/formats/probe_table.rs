//! Tables of a four-point probe: the resistance of a strip's electrodes per square, by sample and date (CSV, TSV).
//!
//! A row is a reading: sample, date, resistance with its unit; beside it may stand its standard error, the face of the
//! strip, the number of flexings so far and the humidity. The table of each sample is one of the reading, its rows in the
//! order of the file, which may be any; times are seconds from the date of the file's first row, so that those before it
//! are negative; a date without a time of day is its noon.

use std::collections::BTreeMap;
use std::sync::Arc;

use jiff::civil::DateTime;

use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::formats::policy::PROBE_HEADER_WITHIN;
use crate::table::layout;
use crate::text::dictionary::{ERRORS, FACES, FLEXED, MEASURED, PER_SQUARE};
use crate::text::header::Header;
use crate::text::names::{names_time, sheet_column};
use crate::text::{Cell, Decimal, Delimiter, Line, Lines, number};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::tag::keys;
use ieap_domain::{Channel, Issue, Quantity};

/// Reader of probe tables.
pub struct ProbeTable;

/// Format id.
pub const ID: &str = "probe-table";
/// Names of the columns that the tables of the reading have: numbers in the unit that the name says.
pub const RESISTANCE: &str = "resistance_ohm_per_sq";
/// Standard error of a reading.
pub const ERROR: &str = "standard_error_ohm_per_sq";
/// Number of the face, in the order in which the file first names them.
pub const FACE: &str = "face";
/// Flexings of the strip so far.
pub const FLEXINGS: &str = "flexings";
/// Relative humidity.
pub const HUMIDITY: &str = "relative_humidity_percent";

const ORDERS: [DateOrder; 3] = [DateOrder::MonthFirst, DateOrder::DayFirst, DateOrder::YearFirst];
impl Format for ProbeTable {
    fn about(&self) -> About {
        About {
            id: ID,
            title: "four-point probe, a table of electrode resistance per square with sample and date (CSV, TSV)",
            extensions: &["csv", "txt", "tsv"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let lines: Vec<Line<'_>> = Lines::new(text).take(PROBE_HEADER_WITHIN + 1).collect();
        match header(&lines) {
            Some(_) => Match::Possible {
                score: 0.9,
                reason: "a sample, a date and a resistance per square",
            },
            None => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let text = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = text.lines();
        let status = delimited::drop_cut_line(&mut lines, &mut issues);
        let Some(header) = header(&lines) else {
            return Err(ReadError::NoHeader {
                line: 1,
                found: quoted(lines.first().map_or("", |line| line.text)),
            });
        };
        let rows: Vec<&Line<'_>> = (lines[header.at + 1..].iter())
            .filter(|line| !line.text.trim().is_empty() && !line.text.starts_with('#'))
            .collect();
        if rows.is_empty() {
            return Err(ReadError::header_only(lines[header.at].number, "no row"));
        }
        let decimal = delimited::decimal_of(rows.iter().take(256).copied(), header.delimiter)?;
        let rows: Vec<Row> = rows.iter().map(|line| header.row(line, decimal)).collect();
        let (moments, order) = moments(&rows, context.date_order, &header.names[header.date])?;
        let first = moments[0];
        let tables = tables(&header, &rows, &moments, first, &mut issues);
        if tables.is_empty() {
            return Err(ReadError::header_only(
                lines[header.at].number,
                "no row has a sample and a resistance above zero",
            ));
        }
        Ok(Reading {
            is_step_response: false,
            encoding: Some(text.encoding),
            status: status.0,
            status_evidence: delimited::undeclared(status.0, status.1),
            started_at: Some(StartedAt {
                raw: rows[0].date.clone(),
                kind: Timestamp::Start,
                local: Some(first.to_string()),
                offset: None,
                basis: format!("the first row, {}", order.words()),
            }),
            tables,
            issues,
            ..self.reading()
        })
    }
}

/// The header row.
struct Head {
    at: usize,
    delimiter: Delimiter,
    names: Vec<String>,
    sample: usize,
    date: usize,
    /// Column of the resistance, and Ohm per unit of it.
    resistance: (usize, f64),
    /// Column of its standard error, and Ohm per unit of it.
    error: Option<(usize, f64)>,
    face: Option<usize>,
    flexings: Option<usize>,
    humidity: Option<usize>,
}

/// One row as the file has it.
struct Row {
    line: usize,
    sample: String,
    date: String,
    resistance: Option<f64>,
    error: Option<f64>,
    face: String,
    flexings: Option<f64>,
    humidity: Option<f64>,
}

fn header(lines: &[Line<'_>]) -> Option<Head> {
    let is_probe = |line: &Line<'_>| {
        let lower = line.text.to_lowercase();
        is_in(PER_SQUARE, &lower.replace('_', " "))
    };
    if !lines.iter().any(is_probe) {
        return None;
    }
    let shapes = layout::shapes(lines).into_iter();
    let named = shapes.filter_map(|shape| Some((shape.names_at?, shape)));
    named
        .into_iter()
        .find_map(|(at, shape)| columns(at, shape.delimiter, shape.names))
}

/// Whether one of these words stands in a text in small letters.
fn is_in(words: &str, lower: &str) -> bool {
    words.split(';').any(|word| lower.contains(word))
}

fn columns(at: usize, delimiter: Delimiter, names: Vec<String>) -> Option<Head> {
    let lower: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
    let named = |is: &dyn Fn(&str) -> bool| names.iter().position(|name| is(name));
    let starts = |words: &'static str| {
        let is = |name: &String| words.split(';').any(|word| name.starts_with(word));
        lower.iter().position(is)
    };
    let measures =
        |name: &str, quantity: Quantity| Header::parse(name).meaning.named_quantity() == Some(quantity);
    let per_square: Vec<(usize, f64)> = (lower.iter().enumerate())
        .filter_map(|(at, name)| Some((at, ohm(name, &names[at])?)))
        .collect();
    let is_error = |at: usize| is_in(ERRORS, &lower[at]);
    let resistance = *per_square.iter().find(|(at, _)| !is_error(*at))?;
    Some(Head {
        at,
        delimiter,
        sample: named(&|name| sheet_column(name) == Some(keys::SAMPLE))?,
        date: named(&names_time).or_else(|| starts(MEASURED))?,
        error: per_square.iter().find(|(at, _)| is_error(*at)).copied(),
        face: starts(FACES).filter(|face| *face != resistance.0),
        flexings: starts(FLEXED),
        humidity: named(&|name| measures(name, Quantity::RelativeHumidity)),
        resistance,
        names,
    })
}

/// Ohm per unit of a column of a resistance per square; none where it is none.
fn ohm(lower: &str, name: &str) -> Option<f64> {
    let lower = lower.replace('_', " ");
    let is_per_square = is_in(PER_SQUARE, &lower);
    let is_ohm = lower.contains("ohm") || name.contains(['Ω', 'Ω']);
    if !is_per_square || !is_ohm {
        return None;
    }
    // The letter before the unit: mΩ/sq and MΩ/sq differ by its case.
    let at = name
        .to_lowercase()
        .find("ohm")
        .or_else(|| name.find(['Ω', 'Ω']))?;
    let before = name.get(..at)?.chars().next_back().unwrap_or(' ');
    let starts_word = name
        .get(..at)
        .and_then(|text| text.chars().rev().nth(1))
        .is_none_or(|c| !c.is_alphabetic());
    Some(match before {
        'm' if starts_word => 1e-3,
        'k' if starts_word => 1e3,
        'M' if starts_word => 1e6,
        _ => 1.0,
    })
}

impl Head {
    fn row(&self, line: &Line<'_>, decimal: Decimal) -> Row {
        let mut cells: Vec<&str> = Vec::new();
        self.delimiter
            .split(line.text, |_, cell| cells.push(number::unquote(cell).trim()));
        let text = |at: usize| cells.get(at).copied().unwrap_or("");
        let number = |at: Option<usize>, factor: f64| match number::parse(text(at?), decimal) {
            Cell::Number(value) if value.is_finite() => Some(value * factor),
            _ => None,
        };
        Row {
            line: line.number,
            sample: text(self.sample).to_owned(),
            date: text(self.date).to_owned(),
            resistance: number(Some(self.resistance.0), self.resistance.1),
            error: self.error.and_then(|(at, factor)| number(Some(at), factor)),
            face: self.face.map_or("", text).to_owned(),
            flexings: number(self.flexings, 1.0),
            humidity: number(self.humidity, 1.0),
        }
    }
}

/// The dates of all rows under the one order in which all are dates.
fn moments(
    rows: &[Row],
    stated: Option<DateOrder>,
    column: &str,
) -> Result<(Vec<DateTime>, DateOrder), ReadError> {
    let read = |order: DateOrder| -> Option<Vec<DateTime>> {
        let of_row = |row: &Row| {
            let text = row.date.trim_end_matches('Z');
            let noon = || stamp::civil(&format!("{text} 12:00"), order);
            stamp::civil(&text.replace('T', " "), order).or_else(noon)
        };
        rows.iter().map(of_row).collect()
    };
    let mut found: Vec<(DateOrder, Vec<DateTime>)> = Vec::new();
    for order in ORDERS {
        match read(order) {
            Some(moments) if !found.iter().any(|(_, known)| *known == moments) => {
                found.push((order, moments))
            }
            _ => {}
        }
    }
    let with_dots = rows[0].date.chars().find(|c| matches!(c, '.' | '/' | '-')) == Some('.');
    let wanted = if with_dots {
        Some(DateOrder::DayFirst)
    } else {
        stated
    };
    if found.len() > 1
        && let Some(wanted) = wanted
    {
        found.retain(|(order, _)| *order == wanted);
    }
    let reason = match found.len() {
        1 => {
            let (order, moments) = found.remove(0);
            return Ok((moments, order));
        }
        0 => "no order of day, month and year makes all rows dates",
        _ => "several orders of day, month and year fit all rows",
    };
    Err(ReadError::AmbiguousDates {
        line: rows[0].line,
        column: quoted(column),
        found: format!("{reason}, first {}", quoted(&rows[0].date)),
        first: rows[0].date.clone(),
    })
}

/// A reading of one sample: time since the first row of the file, s, the row, and which face it is of.
type Read<'a> = (f64, &'a Row, f64);

/// The table of each sample, by name; rows that say nothing are left out and told.
fn tables(
    header: &Head,
    rows: &[Row],
    moments: &[DateTime],
    first: DateTime,
    issues: &mut Vec<Issue>,
) -> Vec<RunTable> {
    let mut faces: Vec<&str> = Vec::new();
    let mut samples: BTreeMap<&str, Vec<(f64, &Row, f64)>> = BTreeMap::new();
    let mut left_out: Vec<&Row> = Vec::new();
    for (row, moment) in rows.iter().zip(moments) {
        let is_whole = !row.sample.is_empty() && row.resistance.is_some_and(|ohm| ohm > 0.0);
        if !is_whole {
            left_out.push(row);
            continue;
        }
        let face = faces
            .iter()
            .position(|face| *face == row.face)
            .unwrap_or_else(|| {
                faces.push(&row.face);
                faces.len() - 1
            });
        let elapsed_s = moment.duration_since(first).as_secs_f64();
        let own = samples.entry(&row.sample).or_default();
        own.push((elapsed_s, row, face as f64));
    }
    if let Some(row) = left_out.first() {
        let message = format!(
            "{} of {} rows have no sample, or no resistance above zero",
            left_out.len(),
            rows.len()
        );
        issues.push(
            Issue::warning("probe-rows-left-out", message)
                .at(format!("line {}", row.line))
                .mend("fill the cells, or take the rows away"),
        );
    }
    let table = |(sample, own): (&str, Vec<Read>)| {
        let channel = |name: &str, unit: &str, of: &dyn Fn(&Read) -> Option<f64>| {
            let known = own.iter().filter_map(|entry| Some((entry.0, of(entry)?)));
            let (times, values): (Vec<f64>, Vec<f64>) = known.unzip();
            Channel {
                raw_name: name.to_owned(),
                raw_unit: unit.to_owned(),
                ..Channel::new(Quantity::Other, Arc::from(times), Arc::from(values))
            }
        };
        let mut channels = vec![channel(RESISTANCE, "Ω/sq", &|entry| entry.1.resistance)];
        let more = [
            channel(ERROR, "Ω/sq", &|entry| {
                entry.1.error.filter(|error| *error > 0.0)
            }),
            channel(FLEXINGS, "", &|entry| entry.1.flexings),
            channel(HUMIDITY, "%", &|entry| entry.1.humidity),
        ];
        channels.extend(more.into_iter().filter(|channel| !channel.is_empty()));
        if header.face.is_some() {
            channels.push(channel(FACE, "", &|entry| Some(entry.2)));
        }
        RunTable {
            name: sample.to_owned(),
            rows: own.len(),
            channels,
            time_column: Some((header.names[header.date].clone(), String::new())),
            printed_time: None,
            flags: Vec::new(),
            time_first_last_s: own.first().zip(own.last()).map(|(first, last)| (first.0, last.0)),
            time_zero_is_step: false,
            clock_set_back: Vec::new(),
        }
    };
    samples.into_iter().map(table).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{read, recognise};

    fn reading(text: &str) -> Reading {
        read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap()
    }

    fn values<'a>(reading: &'a Reading, sample: &str, name: &str) -> (&'a [f64], &'a [f64]) {
        let table = reading.tables.iter().find(|table| table.name == sample).unwrap();
        let channel = table
            .channels
            .iter()
            .find(|channel| channel.raw_name == name)
            .unwrap();
        (&channel.time_s, &channel.values)
    }

    const TABLE: &str = "# keithley\nDate;Sample;R (mΩ/sq);SD (mΩ/sq);Flexings;RH (%)\n\
        2026-03-02;S2;2500,5;100;0;34\n2026-03-01 10:30;S1;4,5e3;90;0;35\n2026-03-09;S2;2600;;1000;34\n";

    #[test]
    fn each_sample_has_its_readings_in_ohm_by_date() {
        let found = reading(TABLE);
        assert_eq!((found.format, found.tables.len()), (ID, 2));
        let (times, ohms) = values(&found, "S2", RESISTANCE);
        assert_eq!(ohms, [2.5005, 2.6]);
        // From noon of 2 March to noon of 9 March.
        assert_eq!(times, [0.0, 7.0 * 86_400.0]);
        let (times, errors) = values(&found, "S2", ERROR);
        assert_eq!((times.len(), errors), (1, [0.1].as_slice()));
        assert_eq!(values(&found, "S2", FLEXINGS).1, [0.0, 1000.0]);
        // A row of 1 March 10:30 that stands further down.
        assert_eq!(values(&found, "S1", RESISTANCE).0, [-91_800.0]);
        assert_eq!(found.started_at.unwrap().local.unwrap(), "2026-03-02T12:00:00");
    }

    #[test]
    fn units_are_told_by_their_letter() {
        for (name, factor) in [
            ("resistance_ohm_per_sq", Some(1.0)),
            ("R [kOhm/sq]", Some(1e3)),
            ("R (mΩ/□)", Some(1e-3)),
            ("Rs, Ω/square", Some(1.0)),
            ("R (MΩ/sq)", Some(1e6)),
            ("R (Ω)", None),
            ("resistance", None),
        ] {
            assert_eq!(ohm(&name.to_lowercase(), name), factor, "{name}");
        }
    }

    #[test]
    fn dates_that_can_be_read_in_two_ways_are_refused_and_rows_without_a_number_told() {
        let slashes = TABLE
            .replace("2026-03-02", "02/03/2026")
            .replace("2026-03-01 10:30", "01/03/2026")
            .replace("2026-03-09", "09/03/2026");
        let refused = read("a.csv", slashes.as_bytes(), &ReadContext::default()).unwrap_err();
        assert!(matches!(refused, ReadError::AmbiguousDates { .. }), "{refused}");
        let gap = reading(&TABLE.replace("2600", "over"));
        assert_eq!(gap.issues[0].code, "probe-rows-left-out");
        assert_eq!(values(&gap, "S2", RESISTANCE).1.len(), 1);
    }

    #[test]
    fn a_table_without_a_unit_is_none() {
        let text = "date,sample,resistance\n2026-03-02,S1,2.5\n";
        let found = recognise(&FileHead::of("a.csv", text.as_bytes()));
        assert!(!matches!(found, Ok((format, _)) if format.id() == ID));
    }
}
