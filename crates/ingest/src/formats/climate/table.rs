//! Tables of any other logger: a column of dates beside temperature or relative humidity, delimited text.
//!
//! The time of day may stand in a column of its own beside the dates. Lines before the header are metadata. Delimiter and decimal sign are found; the order of day and month is the
//! one in which all rows are dates that follow each other. Rows that state an offset from UTC are read by it.
//! Columns whose unit is not named are taken as °C and percent, and an issue says so.

use super::meaning::{ClimateColumn, climate_column};
use super::moments::moments;
use super::wall_clock::{Log, offset};
use crate::Reading;
use crate::formats::error::quoted;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::DateOrder;
use crate::formats::{Format, ReadContext, ReadError, delimited};
use crate::text::header::{Header, Meaning};
use crate::text::policy::HEADER_WITHIN_LINES;
use crate::text::{Delimiter, Line, Lines, number};
use ieap_domain::{Issue, Quantity, RunStatus};

/// Reader of tables with dates.
pub struct ClimateTable;

const ORDERS: &[DateOrder] = &[DateOrder::MonthFirst, DateOrder::DayFirst, DateOrder::YearFirst];
/// Names of columns of dates, in small letters without what stands in brackets or behind a comma.
const DATES: [&str; 21] = [
    "time",
    "date",
    "date time",
    "datetime",
    "timestamp",
    "record time",
    "date/time",
    "date & time",
    "date and time",
    "time stamp",
    "zeit",
    "datum",
    "datum/zeit",
    "datum/uhrzeit",
    "aeg",
    "kuupäev",
    "uhrzeit",
    "kellaaeg",
    "time of day",
    "clock",
    "scan sweep time",
];

impl Format for ClimateTable {
    fn id(&self) -> &'static str {
        "climate-table"
    }

    fn title(&self) -> &'static str {
        "climate logger, any table with dates beside temperature, humidity, pressure, oxygen or water (CSV, TSV)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["csv", "txt", "tsv", "dat"]
    }

    fn version(&self) -> u32 {
        3
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let lines: Vec<Line<'_>> = Lines::new(&text).take(HEADER_WITHIN_LINES + 2).collect();
        if is_log(&lines) {
            Match::Possible {
                score: 0.8,
                reason: "a column of dates beside temperature, humidity, pressure, oxygen or water",
            }
        } else {
            Match::No
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let text = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = text.lines();
        let (status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let evidence = match status {
            RunStatus::Complete => evidence + "; the format declares no number of rows",
            _ => evidence,
        };
        let reader = (self.id(), self.version());
        let date_order = context.date_order;
        read_lines(
            reader,
            Some(text.encoding),
            date_order,
            &lines,
            (status, evidence),
            issues,
        )
    }
}

/// Whether lines hold the table of a logger.
pub fn is_log(lines: &[Line<'_>]) -> bool {
    find_header(lines).is_some_and(|header| header.has_dates(lines))
}

/// Reads the lines of a logger's table for the reader of that id and version; its status is that of the lines, and
/// `date_order` counts where its dates fit several.
///
/// # Errors
/// No header, no row, dates that cannot be read, or that can be read in two orders.
pub fn read_lines(
    reader: (&'static str, u32),
    encoding: Option<&'static str>,
    date_order: Option<DateOrder>,
    lines: &[Line<'_>],
    status: (RunStatus, String),
    mut issues: Vec<Issue>,
) -> Result<Reading, ReadError> {
    let Some(header) = find_header(lines) else {
        let first = lines.first().map_or("", |line| line.text);
        return Err(ReadError::NoHeader {
            line: 1,
            found: quoted(first),
        });
    };
    let names_line = lines[header.at];
    let rows = &lines[header.at + 1..];
    let (headers, is_text) = header.columns(names_line.number, &mut issues);
    let log = Log {
        reader,
        time_at: header.time_at,
        clock_at: header.clock_at,
        orders: ORDERS,
        date_order,
        offset: offset(&header.names[header.time_at]),
        delimiter: header.delimiter,
        decimal: delimited::decimal_of(rows.iter().take(256), header.delimiter)?,
        rows_may_end_early: true,
        header_line: names_line.number,
        headers,
        is_text,
        rows,
    };
    let mut metadata = preamble(&lines[..header.at]);
    metadata.extend(header.stated_once(rows));
    log.read(encoding, status, metadata, issues)
}

/// The header row.
struct HeaderRow {
    at: usize,
    delimiter: Delimiter,
    names: Vec<String>,
    time_at: usize,
    /// Column of times of day beside the dates.
    clock_at: Option<usize>,
}

fn find_header(lines: &[Line<'_>]) -> Option<HeaderRow> {
    for (at, line) in lines.iter().enumerate().take(HEADER_WITHIN_LINES) {
        for delimiter in [Delimiter::Tab, Delimiter::Semicolon, Delimiter::Comma] {
            let mut names = Vec::new();
            delimiter.split(line.text, |_, cell| names.push(number::unquote(cell).to_owned()));
            let Some((time_at, clock_at)) = times_among(&names, delimiter, &lines[at + 1..]) else {
                continue;
            };
            // A response of a sample makes it a run, whatever else was logged with it.
            let is_response = |name: &String| {
                let quantity = Header::parse(name).meaning.named_quantity();
                quantity.is_some_and(Quantity::is_response)
            };
            if names.iter().any(is_response) {
                return None;
            }
            let has_climate = names
                .iter()
                .enumerate()
                .any(|(index, name)| index != time_at && climate_column(name, "").is_some());
            if has_climate {
                return Some(HeaderRow {
                    at,
                    delimiter,
                    names,
                    time_at,
                    clock_at,
                });
            }
        }
    }
    None
}

/// The column of dates, and that of the times of day where these stand in a column of their own: by the names, and by
/// the first row where several names would do.
fn times_among(names: &[String], delimiter: Delimiter, rows: &[Line<'_>]) -> Option<(usize, Option<usize>)> {
    let named: Vec<usize> = (0..names.len())
        .filter(|&at| is_date_column(&names[at]))
        .collect();
    let first_named = *named.first()?;
    let Some(first) = rows.iter().find(|row| !row.text.trim().is_empty()) else {
        return Some((first_named, None));
    };
    let mut cells = Vec::new();
    delimiter.split(first.text, |_, cell| cells.push(number::unquote(cell)));
    let text_at = |at: usize| cells.get(at).copied().unwrap_or("");
    if let Some(&whole) = named.iter().find(|&&at| is_moment(text_at(at))) {
        return Some((whole, None));
    }
    let pairs = named
        .iter()
        .flat_map(|&date| named.iter().map(move |&clock| (date, clock)));
    let mut apart = pairs.filter(|(date, clock)| date != clock);
    let is_pair =
        |&(date, clock): &(usize, usize)| is_moment(&format!("{} {}", text_at(date), text_at(clock)));
    let pair = apart.find(is_pair).map(|(date, clock)| (date, Some(clock)));
    Some(pair.unwrap_or((first_named, None)))
}

/// Whether a text is a date with a time of day; one date may well fit two orders.
fn is_moment(text: &str) -> bool {
    !matches!(moments(&[text], ORDERS), Err(super::moments::NoOrder::Fits))
}

fn is_date_column(name: &str) -> bool {
    let bare = name
        .split(['(', '[', ','])
        .next()
        .unwrap_or("")
        .trim()
        .to_lowercase()
        .replace('_', " ");
    let bare = bare.trim_end_matches(" utc").trim_end_matches(" local");
    DATES.contains(&bare)
}

impl HeaderRow {
    /// Whether the first row has a date where dates are to be; a number there is an elapsed time.
    fn has_dates(&self, lines: &[Line<'_>]) -> bool {
        let first = lines[self.at + 1..]
            .iter()
            .find(|line| !line.text.trim().is_empty());
        let Some(first) = first else {
            return true;
        };
        let (mut date, mut clock) = ("", None);
        self.delimiter.split(first.text, |index, cell| {
            if index == self.time_at {
                date = number::unquote(cell);
            } else if Some(index) == self.clock_at {
                clock = Some(number::unquote(cell));
            }
        });
        match clock {
            Some(clock) => is_moment(&format!("{date} {clock}")),
            None => is_moment(date),
        }
    }

    /// The columns and which of them hold texts. The first of each quantity is interpreted; the others keep their
    /// names and units, for the file does not say which sensor stands beside the sample.
    fn columns(&self, line: usize, issues: &mut Vec<Issue>) -> (Vec<Header>, Vec<bool>) {
        let mut taken: Vec<Quantity> = Vec::new();
        let mut assumed: Vec<String> = Vec::new();
        let mut headers = Vec::new();
        for (index, name) in self.names.iter().enumerate() {
            let found = climate_column(name, "").filter(|_| index != self.time_at);
            let mut header = Header::other(name);
            if let Some(ClimateColumn {
                quantity,
                conversion,
                unit_is_stated,
                ..
            }) = found
            {
                if !unit_is_stated {
                    assumed.push(name.clone());
                    header.raw_unit = String::new();
                }
                if !taken.contains(&quantity) {
                    taken.push(quantity);
                    header.meaning = Meaning::Known { quantity, conversion };
                }
            }
            headers.push(header);
        }
        if !assumed.is_empty() {
            let message = format!(
                "no unit stands in {}: temperatures are taken as °C, humidities as percent",
                assumed
                    .iter()
                    .map(|name| quoted(name))
                    .collect::<Vec<_>>()
                    .join(", ")
            );
            let mend = "write the unit into the header, as in Temperature (°C)";
            issues.push(
                Issue::note("unit-assumed", message)
                    .at(format!("line {line}"))
                    .mend(mend),
            );
        }
        let is_text = self.names.iter().map(|name| is_serial(name)).collect();
        (headers, is_text)
    }

    /// A serial number that stands in the first row only, in a column of its own.
    fn stated_once(&self, rows: &[Line<'_>]) -> Option<(String, String)> {
        let at = self.names.iter().position(|name| is_serial(name))?;
        let mut found = None;
        self.delimiter.split(rows.first()?.text, |index, cell| {
            if index == at && !cell.trim().is_empty() {
                found = Some(number::unquote(cell).to_owned());
            }
        });
        Some((self.names[at].clone(), found?))
    }
}

fn is_serial(name: &str) -> bool {
    let lower = name.to_lowercase();
    ["serial number", "serial no", "serial", "s/n", "seriennummer"].contains(&lower.trim_end_matches('.'))
}

/// Lines before the header: `key: value` or text.
fn preamble(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let pair = |line: &Line<'_>| {
        let text = line.text.trim().trim_matches('"').trim();
        (!text.is_empty()).then(|| match text.split_once(':') {
            Some((key, value)) if key.len() <= 40 => (key.trim().to_owned(), value.trim().to_owned()),
            _ => ("preamble".to_owned(), text.to_owned()),
        })
    };
    lines.iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{read, recognise};

    #[test]
    fn a_run_with_dates_and_a_temperature_stays_a_run() {
        let text = "timestamp,time_s,current_a,temperature_c\n2026-01-01 10:00:00,0,1e-3,21\n\
                    2026-01-01 10:00:01,1,9e-4,21\n";
        let (format, _) = recognise(&FileHead::of("a.csv", text.as_bytes())).unwrap();
        assert_eq!(format.id(), "plain-table");
        let log = text.replace("current_a", "battery_v");
        let (format, _) = recognise(&FileHead::of("a.csv", log.as_bytes())).unwrap();
        assert_eq!(format.id(), "climate-table");
    }

    #[test]
    fn an_elapsed_time_is_no_date() {
        for text in [
            "Time,Temperature (°C)\n0,21\n1,22\n",
            "time (s),temperature_c\n0,21\n1,22\n",
        ] {
            assert_eq!(
                ClimateTable.recognise(&FileHead::of("a.csv", text.as_bytes())),
                Match::No,
                "{text}"
            );
        }
    }

    #[test]
    fn a_date_and_a_time_of_day_may_stand_in_two_columns() {
        let one =
            "Date Time;Temperature (°C);RH (%)\n13.02.2026 23:50:00;21,5;40\n14.02.2026 00:00:00;21,25;41\n";
        let two = "Nr;Uhrzeit;Datum;Temperature (°C);RH (%)\n1;23:50:00;13.02.2026;21,5;40\n2;00:00:00;14.02.2026;21,25;41\n";
        let read = |text: &str| read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap();
        let (one, two) = (read(one), read(two));
        assert_eq!((one.format, two.format), ("climate-table", "climate-table"));
        let numbers = |reading: &Reading, quantity: Quantity| {
            let channels = &reading.tables[0].channels;
            let channel = channels.iter().find(|c| c.quantity == quantity).unwrap();
            (channel.time_s.to_vec(), channel.values.to_vec())
        };
        for quantity in [Quantity::Temperature, Quantity::RelativeHumidity] {
            assert_eq!(numbers(&one, quantity), numbers(&two, quantity));
        }
        assert_eq!(
            numbers(&two, Quantity::Temperature),
            (vec![0.0, 600.0], vec![21.5, 21.25])
        );
        let start = two.started_at.clone().unwrap();
        assert_eq!(
            (start.raw.as_str(), start.local),
            ("13.02.2026 23:50:00", one.started_at.unwrap().local)
        );
        assert!(two.issues.is_empty(), "{:?}", two.issues);
    }

    #[test]
    fn two_columns_that_make_no_moment_are_no_log() {
        let text = "Date;Time;RH (%)\n13.02.2026;soon;40\n";
        assert_eq!(
            ClimateTable.recognise(&FileHead::of("a.csv", text.as_bytes())),
            Match::No
        );
        // Dates whose order cannot be told are refused, wherever the time of day stands.
        let text = "Date;Time;RH (%)\n01/02/2026;10:00;40\n01/02/2026;11:00;40\n";
        let refused = read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap_err();
        assert!(matches!(refused, ReadError::AmbiguousDates { .. }), "{refused}");
    }

    #[test]
    fn dots_are_day_first_and_what_is_stated_counts_where_the_rows_leave_it_open() {
        let read = |text: &str, date_order| {
            let context = ReadContext {
                date_order,
                ..ReadContext::default()
            };
            let reading = read("a.csv", text.as_bytes(), &context)?;
            let start = reading.started_at.unwrap();
            Ok::<_, ReadError>((start.local.unwrap(), start.basis))
        };
        let dots = "Datum;Temp (°C);RH (%)\n02.03.2026 10:00;21,5;40,1\n02.03.2026 10:10;21,6;40,2\n";
        let (local, basis) = read(dots, None).unwrap();
        assert_eq!(local, "2026-03-02T10:00:00");
        assert!(basis.contains("as dates with dots are written"), "{basis}");
        let slashes = dots.replace("02.03.2026", "02/03/2026");
        let refused = read(&slashes, None).unwrap_err();
        for mend in ["date_order", "ieap profile", "beside a file", "year first"] {
            assert!(refused.mend().contains(mend), "{}", refused.mend());
        }
        let day = read(&slashes, Some(DateOrder::DayFirst)).unwrap();
        assert_eq!(day.0, "2026-03-02T10:00:00");
        let month = read(&slashes, Some(DateOrder::MonthFirst)).unwrap();
        assert_eq!(month.0, "2026-02-03T10:00:00");
        // What the rows themselves show counts more.
        let certain = slashes.replace("02/03/2026 10:10", "13/03/2026 10:10");
        assert_eq!(
            read(&certain, Some(DateOrder::MonthFirst)).unwrap().0,
            "2026-03-02T10:00:00"
        );
    }

    #[test]
    fn one_broken_date_refuses_the_file_with_its_reason() {
        let text = "Time,RH (%)\n2026-01-01 10:00:00,40\nyesterday,41\n2026-01-01 10:02:00,42\n";
        let refused = read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap_err();
        assert!(matches!(refused, ReadError::AmbiguousDates { .. }), "{refused}");
    }
}
