//! Tables of any other logger: dates beside temperature, humidity, pressure, oxygen or water, as text or in a workbook.
//!
//! Where the table stands and what times its rows the one reader of tables finds ([`crate::table`]). A unit that the file does
//! not name is told by the range of the readings, or asked. Rows of several sensors that a column of words tells apart are a
//! table for each sensor.

use std::collections::BTreeMap;

use super::meaning::{ClimateColumn, climate_column, of_label, spoken_of};
use crate::formats::assemble::{Raw, assemble};
use crate::formats::error::quoted;
use crate::formats::plausible::is_impossible;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::table::columns::said_by_unit;
use crate::table::kind::Kind;
use crate::table::policy::{AIR_IN_CELSIUS, LARGEST_FRACTION, SMOOTHER_WITHIN};
use crate::table::shape::Shape;
use crate::table::{self, Question, Table, epoch, start, times, zone};
use crate::text::dictionary::{Role, SENSORS, SERIALS, VALUE_LABELS, is_among};
use crate::text::header::{Header, Meaning};
use crate::text::lines::lines_of;
use crate::text::names::{names_time, role};
use crate::text::{Decoded, Line, number};
use crate::{Reading, RunTable};
use ieap_domain::number::{fixed, percent};
use ieap_domain::unit::{self, Conversion};
use ieap_domain::{Issue, Quantity, RunStatus};
use ieap_numerics::robust::upper_median;

/// Reader of tables with dates.
pub struct ClimateTable;

impl Format for ClimateTable {
    fn about(&self) -> About {
        About {
            id: "climate-table",
            title: "climate logger, any table with dates beside temperature, humidity, pressure, oxygen or water (CSV, TSV)",
            extensions: &["csv", "txt", "tsv", "dat"],
            version: 7,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let lines = lines_of(text);
        if is_log(&lines, || head.shape().ok().cloned()) {
            Match::Possible {
                score: 0.8,
                reason: "dates beside temperature, humidity, pressure, oxygen or water",
            }
        } else {
            Match::No
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        read_text(self.reading(), &delimited::decoded(bytes)?, context, |_| Ok(0))
    }
}

/// Reads the text of a logger for `reader`, which has read nothing yet; so many lines stand above its table as `above` says.
///
/// # Errors
/// As [`read_lines`]; the file is no text, or has no whole line yet.
pub fn read_text(
    reader: Reading,
    decoded: &Decoded<'_>,
    context: &ReadContext,
    above: impl FnOnce(&[Line<'_>]) -> Result<usize, ReadError>,
) -> Result<Reading, ReadError> {
    let mut issues = Vec::new();
    let text = delimited::text(decoded, &mut issues)?;
    let status = (text.status, text.evidence());
    let lines = &text.lines[above(&text.lines)?..];
    read_lines(reader, Some(text.encoding), context, lines, status, issues)
}

/// Whether lines hold the table of a logger: dates or a start beside climate, and no response of a sample, which makes a run of
/// it whatever else was logged with it. Where the table stands is asked only where lines speak of moments.
pub fn is_log(lines: &[Line<'_>], shape: impl FnOnce() -> Option<Shape>) -> bool {
    // No time of day, no number since 1970: that is told soonest.
    let speaks_of_moments =
        |line: &Line<'_>| line.text.contains([':', '時', '时']) || has_long_number(line.text);
    if !lines.iter().any(speaks_of_moments) {
        return false;
    }
    let Some(shape) = shape() else {
        return false;
    };
    let unit = |index: usize| shape.units.get(index).map_or("", String::as_str);
    let named = || shape.names.iter().enumerate();
    let is_response = |(index, name): (usize, &String)| {
        let header = if unit(index).is_empty() {
            Header::parse(name)
        } else {
            Header::with_unit(name, unit(index))
        };
        (header.meaning.named_quantity())
            .is_some_and(|quantity| quantity.is_response() || quantity.is_modulus())
    };
    let is_climate = |(index, name): (usize, &String)| {
        shape.kinds.get(index) == Some(&Kind::Number)
            && (climate_column(name, unit(index)).is_some()
                || (matches!(role(name), Role::Commanded | Role::Limit)
                    && spoken_of(name, unit(index)).is_some()))
    };
    let first = lines.get(shape.data_at).map_or("", |line| line.text);
    let labels_values = || {
        let mut has_label = false;
        shape.delimiter.split(first, |at, cell| {
            has_label |=
                shape.kinds.get(at) == Some(&Kind::Word) && of_label(number::unquote(cell)).is_some();
        });
        has_label && named().any(|(_, name)| is_among(VALUE_LABELS, &name.to_lowercase()))
    };
    let is_epoch = |(index, name): (usize, &String)| {
        let mut is_moment = false;
        shape.delimiter.split(first, |at, cell| {
            is_moment |= at == index && epoch::is_moment(cell)
        });
        is_moment && names_time(name)
    };
    let head = lines[..shape.names_at.unwrap_or(0)].iter().map(|line| line.text);
    let has_dates = shape
        .kinds
        .iter()
        .any(|kind| matches!(kind, Kind::Moment | Kind::Date))
        || named().any(is_epoch)
        || start::stated(head, None).is_some();
    has_dates && !named().any(is_response) && (named().any(is_climate) || labels_values())
}

/// Whether ten digits stand side by side.
fn has_long_number(text: &str) -> bool {
    let mut run = 0;
    text.bytes().any(|byte| {
        run = if byte.is_ascii_digit() { run + 1 } else { 0 };
        run >= 10
    })
}

/// Reads the lines of a logger's table for `reader`, which has read nothing yet; its status is that of the lines.
///
/// # Errors
/// As [`table::tables`] and [`times::settle`]; a unit that nothing tells is asked.
pub fn read_lines(
    reader: Reading,
    encoding: Option<&'static str>,
    context: &ReadContext,
    lines: &[Line<'_>],
    status: (RunStatus, String),
    mut issues: Vec<Issue>,
) -> Result<Reading, ReadError> {
    let mut tables = table::tables(lines, |_| false, context)?;
    issues.extend(tables[0].layout.between(lines));
    issues.extend(said_by_unit(&tables[0].headers, |quantity| {
        quantity == Quantity::Time
    }));
    if tables.len() > 1 {
        // However long a logger rested, its dates go on.
        let whole = table::joined(lines, &tables[0].layout, |_| false);
        if table::dates_go_on(&whole, &tables, None) {
            tables = vec![whole];
        }
    }
    let mut read = tables.remove(0);
    if !tables.is_empty() {
        let rows: usize = tables.iter().map(|table| table.cells.rows()).sum();
        let message = format!(
            "the names stand again: a logger that was started anew; {rows} rows behind them are left out"
        );
        issues.push(Issue::warning("table-refused", message).mend("save each part as a file of its own"));
    }
    let names_at = read.layout.shape.names_at.unwrap_or(0);
    let settled = times::settle(&mut read, context, &mut issues)?;
    let head = || lines[..names_at].iter();
    let above = || start::stated(head().map(|line| line.text), context.date_order);
    let started_at = settled
        .started_at
        .or_else(|| start::answered(above(), &context.answers));
    let timing = (settled.spent.iter().copied()).chain(time_of(&read));
    let names = timing.map(|at| read.headers[at].raw_name.as_str());
    let started_at = zone::complete(started_at, names, head().map(|line| line.text), &mut issues);
    let mut metadata = preamble(&lines[..names_at]);
    metadata.extend(stated_once(&read));
    let mut spent = settled.spent;
    spent.extend(serial_of_one(&read));
    let labels = labels(&read);
    let label = labels.as_ref().map(|labels| labels.column);
    let not_measured: Vec<usize> = (spent.iter().copied())
        .chain(label)
        .chain(labels.as_ref().map(|labels| labels.value))
        .collect();
    measured(&mut read, &not_measured, context, &mut issues)?;
    let mut sensors = sensors(&read, &not_measured);
    if let Some(labels) = &labels {
        sensors = labels.within(sensors, read.cells.rows());
    }
    let headers = read.headers.clone();
    spent.extend(label);
    read.drop_columns(&spent);
    let mut tables = Vec::new();
    for Part { sensor, rows, column } in sensors {
        let mut own = Vec::new();
        let mut headers = headers.clone();
        if let Some((value, header)) = column {
            headers[value] = header;
        }
        let mut at = 0..;
        headers.retain(|_| at.next().is_none_or(|at| !spent.contains(&at)));
        let raw = Raw::of_instrument(sensor, headers, read.cells.only(rows.as_deref()));
        tables.push(RunTable {
            clock_set_back: settled.set_back.clone(),
            ..assemble(raw, &mut own)?
        });
        own.retain(|issue| !issues.contains(issue));
        issues.extend(own);
    }
    Ok(Reading {
        encoding,
        status: status.0,
        status_evidence: status.1,
        started_at,
        tables,
        original_metadata: metadata,
        issues,
        ..reader
    })
}

/// Gives the columns their meaning. Of each quantity the one with the plainest name is interpreted, of several the first by the
/// alphabet, as campaigns ask them; the others keep their names and units, for the file does not say which sensor stands beside
/// the sample.
fn measured(
    read: &mut Table<'_>,
    spent: &[usize],
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<(), ReadError> {
    let mut taken: BTreeMap<Quantity, (String, usize, Meaning)> = BTreeMap::new();
    let mut told: Vec<String> = Vec::new();
    let time = |header: &Header| header.meaning.quantity() == Some(Quantity::Time);
    let has_humidity = (read.headers.iter())
        .filter_map(|header| climate_column(&header.raw_name, &header.raw_unit))
        .any(|column| column.quantity == Quantity::RelativeHumidity);
    for index in 0..read.headers.len() {
        if spent.contains(&index) || time(&read.headers[index]) {
            continue;
        }
        let (name, unit) = (
            read.headers[index].raw_name.clone(),
            read.layout.shape.units.get(index).cloned().unwrap_or_default(),
        );
        let mut header = Header {
            raw_unit: read.headers[index].raw_unit.clone(),
            ..Header::other(&name)
        };
        // Beside a humidity the letter is the temperature of the same sensor.
        let is_letter = has_humidity && name.trim() == "T" && unit.is_empty();
        let spoken = if is_letter { "temperature" } else { name.as_str() };
        let found = climate_column(spoken, &unit).filter(|_| read.kind(index) == Kind::Number);
        if let Some(ClimateColumn {
            quantity,
            mut conversion,
            unit_is_stated,
            part,
            ..
        }) = found
        {
            let line = read.cells.header_line;
            if !unit_is_stated {
                let told_unit = unit_of(quantity, &name, &read.cells.columns[index].numbers, context, line)?;
                conversion = told_unit.1;
                let key = if quantity == Quantity::Temperature {
                    "temperature"
                } else {
                    "humidity"
                };
                if context.answers.of(key).is_none() {
                    told.push(format!("{} is in {}", quoted(&name), told_unit.0));
                }
                header.raw_unit = told_unit.0.to_owned();
            }
            let meaning = Meaning::Known { quantity, conversion };
            if taken.get(&quantity).is_none_or(|(plainest, ..)| part < *plainest) {
                taken.insert(quantity, (part, index, meaning));
            }
        } else if matches!(role(&name), Role::Commanded | Role::Limit) && spoken_of(&name, &unit).is_some() {
            let message = format!(
                "column {} holds no measurement, by its name; it is not used",
                quoted(&name)
            );
            issues.push(Issue::note("column-not-measured", message));
        } else if read.kind(index) == Kind::Number
            && speaks_of_climate(&name)
            && !counts_rows(&read.cells.columns[index].numbers)
        {
            let message = format!("column {} is not known and is not used", quoted(&name));
            let mend = "name it with its unit, as in Temperature (°C) or RH (%)";
            issues.push(Issue::note("column-unread", message).mend(mend));
        }
        read.headers[index] = header;
    }
    for (_, index, meaning) in taken.into_values() {
        read.headers[index].meaning = meaning;
    }
    if !told.is_empty() {
        let message = format!(
            "units that the file does not name are told by the size of the readings: {}",
            told.join(", ")
        );
        let mend = "write the unit into the header, as in Temperature (°C)";
        issues.push(
            Issue::note("unit-told", message)
                .at(format!("line {}", read.cells.header_line))
                .mend(mend),
        );
    }
    Ok(())
}

/// The column that times the rows.
fn time_of(read: &Table<'_>) -> Option<usize> {
    let is_time = |header: &Header| header.meaning.quantity() == Some(Quantity::Time);
    read.headers.iter().position(is_time)
}

/// Whether a name that is not known may be that of a climate quantity all the same.
fn speaks_of_climate(name: &str) -> bool {
    !name.is_empty()
        && !is_serial(name)
        && role(name) == Role::Measured
        && !name.to_lowercase().contains("record")
}

/// Whether numbers count rows: each is one more than the one before.
fn counts_rows(numbers: &[f64]) -> bool {
    numbers.windows(2).all(|pair| pair[1] == pair[0] + 1.0)
}

/// The unit of readings that name none: that under which all of them can be what the column measures.
fn unit_of(
    quantity: Quantity,
    name: &str,
    numbers: &[f64],
    context: &ReadContext,
    line: usize,
) -> Result<(&'static str, Conversion), ReadError> {
    let finite = || {
        numbers
            .iter()
            .copied()
            .filter(|number| number.is_finite() && !is_impossible(Quantity::Other, *number, *number))
    };
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    });
    if quantity == Quantity::RelativeHumidity {
        let fraction = ("1", Conversion::scale(100.0, 1.0));
        let is_fraction = match context.answers.of("humidity") {
            _ if high > LARGEST_FRACTION || low > high => false,
            Some(answer) => answer == "fraction",
            None => {
                return Err(ReadError::Asked(Question {
                    key: "humidity",
                    column: name.to_owned(),
                    line,
                    found: format!("holds {low} to {high} and names no unit"),
                    answers: vec![
                        (
                            "fraction".to_owned(),
                            format!("it is {} to {}", fixed(100.0 * low, 1), percent(high, 1)),
                        ),
                        ("percent".to_owned(), format!("it is {low} to {high} %")),
                    ],
                }));
            }
        };
        return Ok(if is_fraction {
            fraction
        } else {
            ("%", Conversion::IDENTITY)
        });
    }
    let units = ["°C", "°F", "K"];
    let conversion =
        |word: &str| unit::conversion(Quantity::Temperature, word).unwrap_or(Conversion::IDENTITY);
    // Under °F the air would freeze, under K no sensor works.
    if low > high || (AIR_IN_CELSIUS.contains(&low) && AIR_IN_CELSIUS.contains(&high)) {
        return Ok(("°C", Conversion::IDENTITY));
    }
    if let Some(word) = units
        .into_iter()
        .find(|word| context.answers.of("temperature") == Some(word))
    {
        return Ok((word, conversion(word)));
    }
    Err(ReadError::Asked(Question {
        key: "temperature",
        column: name.to_owned(),
        line,
        found: format!("holds {low} to {high} and names no unit"),
        answers: units
            .map(|word| {
                let [low, high] = [low, high].map(|number| conversion(word).apply(number));
                (
                    word.to_owned(),
                    format!("it is {} to {} °C", fixed(low, 1), fixed(high, 1)),
                )
            })
            .to_vec(),
    }))
}

/// The rows of each sensor, where a column tells sensors apart: by its name, or because readings that jump from row to row are
/// smooth within the rows of each of its words.
fn sensors(read: &Table<'_>, spent: &[usize]) -> Vec<Part> {
    let columns = (0..read.headers.len()).filter(|column| !spent.contains(column));
    let several = columns.filter_map(|column| {
        let rows = rows_of_words(read, column)?;
        let lower = read.headers[column].raw_name.to_lowercase();
        let is_named = SENSORS.split(';').any(|name| lower.contains(name));
        // What has a unit or is known is a reading, whatever jumps with it.
        let header = &read.headers[column];
        let is_known = header
            .meaning
            .quantity()
            .is_some_and(|quantity| quantity != Quantity::Other);
        let is_reading = is_known || !header.raw_unit.is_empty();
        (is_named || (!is_reading && is_smooth_within(read, &rows))).then_some((is_named, rows))
    });
    let found = several
        .into_iter()
        .max_by_key(|(is_named, rows)| (*is_named, rows.len()));
    match found.map(|(_, rows)| rows) {
        Some(rows) => {
            let part = |(sensor, rows): (String, Vec<usize>)| Part {
                sensor,
                rows: Some(rows),
                column: None,
            };
            rows.into_iter().map(part).collect()
        }
        None => vec![Part::default()],
    }
}

/// A part of a table that is one sensor's.
#[derive(Debug, Clone, Default)]
struct Part {
    sensor: String,
    /// Its rows; none: all.
    rows: Option<Vec<usize>>,
    /// The column of values and what it measures in these rows, where another column names that.
    column: Option<(usize, Header)>,
}

/// A column whose words name what the values beside it measure.
struct Labels {
    column: usize,
    value: usize,
    /// What each word names, and its rows.
    words: Vec<(Header, Vec<usize>)>,
}

/// The columns of words and values, where a table has such.
fn labels(read: &Table<'_>) -> Option<Labels> {
    let is_value = |column: &usize| {
        read.kind(*column) == Kind::Number
            && is_among(VALUE_LABELS, &read.headers[*column].raw_name.to_lowercase())
    };
    let value = (0..read.headers.len()).find(is_value)?;
    let words_of = |column: usize| -> Option<Labels> {
        let mut rows: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        let texts = read.texts_of(column);
        texts
            .iter()
            .enumerate()
            .for_each(|(row, text)| rows.entry(text).or_default().push(row));
        let header = |word: &str| {
            let ClimateColumn {
                quantity, conversion, ..
            } = of_label(word)?;
            Some(Header {
                meaning: Meaning::Known { quantity, conversion },
                ..Header::other(word)
            })
        };
        let words = rows.into_iter().map(|(word, rows)| Some((header(word)?, rows)));
        Some(Labels {
            column,
            value,
            words: words.collect::<Option<_>>()?,
        })
    };
    (0..read.headers.len())
        .filter(|column| read.kind(*column) == Kind::Word)
        .find_map(words_of)
}

impl Labels {
    /// The parts of each sensor, one for each word.
    fn within(&self, sensors: Vec<Part>, rows: usize) -> Vec<Part> {
        let parts = sensors.iter().flat_map(|part| {
            self.words.iter().map(|(header, own)| {
                let all: Vec<usize> = part.rows.clone().unwrap_or_else(|| (0..rows).collect());
                Part {
                    rows: Some(
                        all.into_iter()
                            .filter(|row| own.binary_search(row).is_ok())
                            .collect(),
                    ),
                    column: Some((self.value, header.clone())),
                    ..part.clone()
                }
            })
        });
        parts
            .filter(|part| part.rows.as_ref().is_none_or(|rows| !rows.is_empty()))
            .collect()
    }
}

/// The rows of each word or whole number of a column that has several, each in several rows.
fn rows_of_words(read: &Table<'_>, column: usize) -> Option<BTreeMap<String, Vec<usize>>> {
    const MOST: usize = 64;
    let mut rows: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let is_time = |header: &Header| header.meaning.quantity() == Some(Quantity::Time);
    let times = read
        .headers
        .iter()
        .position(is_time)
        .map(|at| &read.cells.columns[at].numbers);
    // A row without a time is no reading: the mean of a footer names no sensor.
    let is_timed = |row: usize| times.is_none_or(|times| times.get(row).is_none_or(|time| time.is_finite()));
    let mut add = |word: String, row: usize| {
        if is_timed(row) {
            rows.entry(word).or_default().push(row);
        }
    };
    match read.kind(column) {
        Kind::Word => read
            .texts_of(column)
            .iter()
            .enumerate()
            .for_each(|(row, text)| add((*text).to_owned(), row)),
        Kind::Number => {
            let numbers = &read.cells.columns[column].numbers;
            if numbers.iter().any(|number| number.fract() != 0.0) {
                return None;
            }
            numbers
                .iter()
                .enumerate()
                .for_each(|(row, number)| add(number.to_string(), row));
        }
        _ => return None,
    }
    let is_told_apart = (2..=MOST).contains(&rows.len()) && rows.values().all(|rows| rows.len() > 1);
    is_told_apart.then_some(rows)
}

/// Whether a measured column changes less from row to row within the rows of each word than from row to row of the file.
fn is_smooth_within(read: &Table<'_>, rows: &BTreeMap<String, Vec<usize>>) -> bool {
    let steps = |numbers: &[f64], rows: &mut dyn Iterator<Item = usize>| -> Vec<f64> {
        let own: Vec<f64> = rows
            .map(|row| numbers[row])
            .filter(|number| number.is_finite())
            .collect();
        own.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect()
    };
    let measured = (0..read.headers.len()).filter(|column| {
        let known = read.headers[*column].meaning.quantity();
        known.is_some_and(|quantity| quantity != Quantity::Time && quantity != Quantity::Other)
    });
    measured.into_iter().any(|column| {
        let numbers = &read.cells.columns[column].numbers;
        let mut within: Vec<f64> = rows
            .values()
            .flat_map(|rows| steps(numbers, &mut rows.iter().copied()))
            .collect();
        let mut whole = steps(numbers, &mut (0..numbers.len()));
        let medians = upper_median(&mut within).zip(upper_median(&mut whole));
        medians.is_some_and(|(within, whole)| whole > SMOOTHER_WITHIN * within)
    })
}

/// A column of the serial number of the one logger: with several it tells them apart.
fn serial_of_one(read: &Table<'_>) -> Option<usize> {
    let at = read
        .headers
        .iter()
        .position(|header| is_serial(&header.raw_name))?;
    rows_of_words(read, at)
        .is_none_or(|words| words.len() <= 1)
        .then_some(at)
}

/// The serial number of the one logger, by the first row.
fn stated_once(read: &Table<'_>) -> Option<(String, String)> {
    let at = serial_of_one(read)?;
    let text = *read.first_row.get(at)?;
    (!text.is_empty()).then(|| (read.headers[at].raw_name.clone(), text.to_owned()))
}

fn is_serial(name: &str) -> bool {
    is_among(SERIALS, name.to_lowercase().trim_end_matches('.'))
}

/// Lines before the header: `key: value` or text.
fn preamble(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let pair = |line: &Line<'_>| {
        let text = number::unquote(
            line.text
                .trim_matches(|c: char| c.is_whitespace() || matches!(c, ',' | ';')),
        )
        .trim();
        (!text.is_empty()).then(|| match text.split_once([':', '=']) {
            Some((key, value)) if key.len() <= 40 => {
                let value = value.trim_matches(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"'));
                (key.trim().trim_matches('"').to_owned(), value.to_owned())
            }
            _ => ("preamble".to_owned(), text.to_owned()),
        })
    };
    lines.iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::stamp::DateOrder;
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
    fn a_row_without_a_date_is_left_out_and_said_and_many_refuse_the_file() {
        let text = "Time,RH (%)\n2026-01-01 10:00:00,40\nyesterday,41\n2026-01-01 10:02:00,42\n";
        let reading = read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap();
        assert_eq!(*reading.tables[0].channels[0].values, [40.0, 42.0]);
        assert!(reading.issues.iter().any(|issue| issue.code == "time-missing"));
        let text = text.to_owned() + "2026-01-01 10:03:00,43\ntoday,44\n2026-01-01 10:05:00,45\n";
        let refused = read("a.csv", text.as_bytes(), &ReadContext::default()).unwrap_err();
        assert!(matches!(refused, ReadError::AmbiguousDates { .. }), "{refused}");
    }
}
