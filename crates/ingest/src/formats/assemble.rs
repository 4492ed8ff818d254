//! From cells to channels: units, order of time, text among numbers, ranges, and what a run needs.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::cells::{CellColumn, CellTable};
use super::columns::{judge_columns, read_flags};
use super::error::{ReadError, quoted};
use super::plausible::{implausible, is_impossible};
use super::time_axis::{self, TimeAxis};
use super::{no_reading, range_end, rivals};
use crate::RunTable;
use crate::formats::policy::{BAD_SHARE, MOSTLY_CAPACITIVE};
use crate::text::header::{Header, Meaning};
use ieap_domain::number::exact;
use ieap_domain::unit::Conversion;
use ieap_domain::{Channel, FlaggedStretch, Issue, Quantity};

/// A table as read, with what its columns mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Raw {
    /// Name of the table in the file; empty where there is one only.
    pub name: String,
    /// Meaning of each column.
    pub headers: Vec<Header>,
    /// The cells.
    pub cells: CellTable,
    /// Rows that the instrument marks, in order.
    pub flags: Vec<RowFlag>,
    /// Column with the printed time, where the table is timed by another one.
    pub printed_time: Option<String>,
    /// Whether time zero is the voltage step.
    pub time_zero_is_step: bool,
    /// Whether the table must be a run: without a time column it is refused then.
    pub must_be_run: bool,
    /// Whether it is also refused without a response or a modulus.
    pub must_respond: bool,
}

/// The mark of one row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowFlag {
    /// The row.
    pub row: u32,
    /// Name of the column of flags.
    pub column: String,
    /// The flag as the file has it.
    pub flag: String,
    /// Whether the row's current is no measurement, as in an overload.
    pub excludes: bool,
}

impl Raw {
    /// A table with an instrument's own clock, which may be no run at all.
    pub fn of_instrument(name: String, headers: Vec<Header>, cells: CellTable) -> Raw {
        Raw {
            name,
            headers,
            cells,
            flags: Vec::new(),
            printed_time: None,
            time_zero_is_step: false,
            must_be_run: false,
            must_respond: false,
        }
    }
}

/// Makes the channels of a table and notes what a reader must know.
///
/// Where the table has no time column and need not be a run, channels are numbered by row.
///
/// # Errors
/// No row; too many ragged rows; no usable time column; time out of order; no response.
pub fn assemble(mut raw: Raw, issues: &mut Vec<Issue>) -> Result<RunTable, ReadError> {
    table_of(&mut raw, issues)
}

fn table_of(raw: &mut Raw, issues: &mut Vec<Issue>) -> Result<RunTable, ReadError> {
    let rows = raw.cells.rows();
    if rows == 0 {
        return Err(ReadError::header_only(raw.cells.header_line, "no row of numbers"));
    }
    check_ragged(raw, issues)?;
    read_flags(raw);
    let mut meanings = judge_columns(raw, issues);
    let is_spectrum = is_spectrum(&meanings);
    // Rows of a spectrum stand for frequencies: a time that is that of its start, or too coarse to tell them apart, orders none.
    let orders = |index: &usize| {
        let times = &raw.cells.columns[*index].numbers;
        !is_spectrum || times.windows(2).all(|pair| pair[1] > pair[0])
    };
    let time_index = time_column(raw, &meanings)?.filter(orders);
    let axis = match time_index {
        Some(index) => {
            let conversion = meanings[index].conversion();
            let column = &raw.headers[index].raw_name;
            let time_s: Vec<f64> = raw.cells.columns[index]
                .numbers
                .iter()
                .map(|&t| conversion.apply(t))
                .collect();
            time_axis::increasing(&time_s, &raw.cells, column, issues)?
        }
        None if raw.must_be_run && !is_spectrum => {
            let message = "no column of times: the readings of the sweep are numbered by row";
            issues.push(Issue::note("time-not-used", message).at(format!("line {}", raw.cells.header_line)));
            TimeAxis::of_rows(rows)
        }
        None => TimeAxis::of_rows(rows),
    };
    if axis.rows.is_empty() {
        return Err(ReadError::header_only(
            raw.cells.header_line,
            "no row with a time",
        ));
    }
    // An instrument's software writes its own columns in an order of its own.
    if raw.must_be_run {
        rivals::settle(&raw.headers, &raw.cells, &mut meanings, issues)?;
    }
    let mut channels = channels(raw, &meanings, time_index, &axis, issues);
    issues.extend(turn_imaginary(&mut channels));
    let responds = |channel: &Channel| {
        channel.is_response() || channel.quantity.is_modulus() || channel.quantity == Quantity::BlockingForce
    };
    if raw.must_respond && !is_spectrum && !channels.iter().any(responds) {
        return Err(no_response(raw, &meanings));
    }
    Ok(RunTable {
        flags: flagged_stretches(&raw.flags, &axis),
        printed_time: raw.printed_time.clone(),
        name: raw.name.clone(),
        rows,
        channels,
        time_column: time_index.map(|index| {
            let header = &raw.headers[index];
            (header.raw_name.clone(), header.raw_unit.clone())
        }),
        time_first_last_s: time_index.and_then(|_| Some((*axis.time_s.first()?, *axis.time_s.last()?))),
        time_zero_is_step: raw.time_zero_is_step,
        clock_set_back: Vec::new(),
    })
}

/// As [`assemble`], for tables that need not be a run: where the time does not increase, the channels are
/// numbered by row and the time is kept as a column of its own.
///
/// # Errors
/// No row, or too many ragged rows.
pub fn assemble_untimed(mut raw: Raw, issues: &mut Vec<Issue>) -> Result<RunTable, ReadError> {
    let mut found = Vec::new();
    let first = table_of(&mut raw, &mut found);
    let Err(error @ ReadError::TimeOrder { .. }) = first else {
        issues.extend(found);
        return first;
    };
    let message = format!("{error}; its readings are numbered by row");
    issues.push(Issue::note("time-not-used", message).at(error.place()));
    for header in &mut raw.headers {
        if header.meaning.quantity() == Some(Quantity::Time) {
            header.meaning = Meaning::Other;
        }
    }
    table_of(&mut raw, issues)
}

/// Whether columns are those of an impedance spectrum: a frequency, and two parts of the impedance.
pub fn is_spectrum(meanings: &[Meaning]) -> bool {
    let has = |quantity| {
        meanings
            .iter()
            .any(|meaning| meaning.quantity() == Some(quantity))
    };
    let cartesian = has(Quantity::ImpedanceReal) && has(Quantity::ImpedanceImaginary);
    let polar = has(Quantity::ImpedanceMagnitude) && has(Quantity::ImpedancePhase);
    has(Quantity::Frequency) && (cartesian || polar)
}

/// Whether columns are those of a modulus swept over the frequency, without any time.
pub fn is_modulus_sweep(meanings: &[Meaning]) -> bool {
    let mut named = meanings.iter().filter_map(Meaning::named_quantity);
    let has_time = named.clone().any(|quantity| quantity == Quantity::Time);
    let has_modulus = meanings
        .iter()
        .filter_map(Meaning::quantity)
        .any(Quantity::is_modulus);
    !has_time && has_modulus && named.any(|quantity| quantity == Quantity::Frequency)
}

/// Turns an imaginary part that is positive nearly wherever it is large: many tables name a column Z'' and hold -Z''.
fn turn_imaginary(channels: &mut [Channel]) -> Option<Issue> {
    let channel = channels
        .iter_mut()
        .find(|channel| channel.quantity == Quantity::ImpedanceImaginary)?;
    let positive = channel.values.iter().filter(|value| **value > 0.0).count();
    let (mut above, mut all) = (0.0, 0.0);
    for value in channel.values.iter().filter(|value| value.is_finite()) {
        above += value.max(0.0);
        all += value.abs();
    }
    if all == 0.0 || above <= MOSTLY_CAPACITIVE * all {
        return None;
    }
    channel.values = channel.values.iter().map(|value| -value).collect();
    let message = format!(
        "{positive} of {} imaginary parts under {} are positive, as of a coil; a sample is capacitive, so they are taken \
         as those of -Z''",
        channel.len(),
        quoted(&channel.raw_name)
    );
    Some(
        Issue::warning("imaginary-part-turned", message)
            .mend("name the column -Z'' in the table if that is right"),
    )
}

fn check_ragged(raw: &Raw, issues: &mut Vec<Issue>) -> Result<(), ReadError> {
    let (ragged, rows, needed) = (&raw.cells.ragged, raw.cells.rows(), raw.headers.len());
    let Some((line, found)) = &ragged.first else {
        return Ok(());
    };
    if ragged.count > 1 && ragged.count as f64 > BAD_SHARE * rows as f64 {
        return Err(ReadError::Ragged {
            line: *line,
            count: ragged.count,
            rows,
            found: found.parse().unwrap_or(0),
            needed,
        });
    }
    let message = format!(
        "{} of {rows} rows do not have the {needed} fields of the header, the first has {found}; missing cells \
         are empty, surplus ones are left out",
        ragged.count
    );
    issues.push(Issue::warning("ragged-rows", message).at(format!("line {line}")));
    Ok(())
}

/// The column that times the table: a corrected time where there is one, else the first.
fn time_column(raw: &Raw, meanings: &[Meaning]) -> Result<Option<usize>, ReadError> {
    let corrected = |index: &usize| {
        raw.headers[*index]
            .raw_name
            .to_lowercase()
            .starts_with("corrected time")
    };
    let mut times = (0..meanings.len()).filter(|&k| meanings[k].quantity() == Some(Quantity::Time));
    if let Some(first) = times.clone().find(corrected).or_else(|| times.next()) {
        return Ok(Some(first));
    }
    if !raw.must_be_run || is_spectrum(meanings) || is_modulus_sweep(meanings) {
        return Ok(None);
    }
    let line = raw.cells.header_line;
    for (index, header) in raw.headers.iter().enumerate() {
        if header.meaning.named_quantity() == Some(Quantity::Time) {
            let (column, text) = (quoted(&header.raw_name), &raw.cells.columns[index].text);
            let (line, reason) = match (&header.meaning, &text.first) {
                (Meaning::Refused { error, .. }, _) => (line, error.to_string()),
                (_, Some((line, found))) => (
                    *line,
                    format!("{} cells hold text, first {}", text.count, quoted(found)),
                ),
                _ => (line, "it holds no number".to_owned()),
            };
            return Err(ReadError::Column {
                line,
                index: index + 1,
                column,
                reason,
            });
        }
    }
    Err(ReadError::NoHeader {
        line,
        found: quoted(
            &raw.headers
                .iter()
                .map(|h| h.raw_name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        ),
    })
}

fn channels(
    raw: &mut Raw,
    meanings: &[Meaning],
    time_index: Option<usize>,
    axis: &TimeAxis,
    issues: &mut Vec<Issue>,
) -> Vec<Channel> {
    let all: Arc<[f64]> = axis.time_s.as_slice().into();
    let mut excluded_rows: Vec<u32> = raw.flags.iter().filter(|f| f.excludes).map(|f| f.row).collect();
    excluded_rows.sort_unstable();
    let mut shared: Vec<(Vec<u32>, Arc<[f64]>)> = Vec::new();
    let mut channels: Vec<Channel> = Vec::new();
    let mut flags: Vec<RowFlag> = Vec::new();
    let codes = codes(raw, meanings);
    let is_of_strip = meanings
        .iter()
        .any(|m| m.quantity().is_some_and(Quantity::is_response));
    for (index, header) in raw.headers.iter().enumerate() {
        let column = &mut raw.cells.columns[index];
        let is_texts = column.keep_text && header.meaning.quantity() != Some(Quantity::OpenCircuit);
        if Some(index) == time_index || is_texts || column.holds_text() {
            continue;
        }
        let mut quantity = meanings[index].quantity().unwrap_or(Quantity::Other);
        let first = channels.iter().find(|c| {
            c.quantity == quantity && c.position_mm == header.position_mm && quantity != Quantity::Other
        });
        if let Some(first) = first {
            let message = format!(
                "column {} measures what {} does; it is kept under its own name",
                quoted(&header.raw_name),
                quoted(&first.raw_name)
            );
            issues.push(Issue::note(rivals::DUPLICATE, message).at(format!("column {}", index + 1)));
            quantity = Quantity::Other;
        }
        if quantity == Quantity::Time {
            quantity = Quantity::Other;
        }
        // A second time, or a second current, keeps the file's own unit, for it is not interpreted.
        let conversion = match quantity {
            Quantity::Other => Conversion::IDENTITY,
            _ => meanings[index].conversion(),
        };
        let mut numbers = std::mem::take(&mut column.numbers);
        let gaps = take_impossible(&mut numbers, quantity, conversion, &codes);
        if let Some((first, number)) = gaps.first() {
            let message = format!(
                "{} of {} readings of {} are no measurements, first {}; left out",
                gaps.len(),
                column.filled,
                quoted(&header.raw_name),
                exact(*number)
            );
            let line = raw.cells.line_of_row[*first as usize];
            let issue = match quantity {
                Quantity::Other => Issue::note("impossible-reading", message),
                _ => Issue::warning("impossible-reading", message),
            };
            issues.push(issue.at(format!("line {line}")));
            let flag = |(row, number): &(u32, f64)| RowFlag {
                row: *row,
                column: header.raw_name.clone(),
                flag: exact(*number),
                excludes: false,
            };
            flags.extend(gaps.iter().map(flag));
        }
        let (rows, values) = finite(numbers, conversion, axis);
        if values.is_empty() {
            if quantity != Quantity::Other {
                let message = format!("column {} holds no number", quoted(&header.raw_name));
                issues.push(Issue::warning("empty-column", message).at(format!("column {}", index + 1)));
            }
            continue;
        }
        issues.extend(implausible(
            quantity,
            header,
            &values,
            &rows,
            axis,
            &raw.cells,
            is_of_strip,
        ));
        let mut channel = Channel {
            quantity,
            raw_name: header.raw_name.clone(),
            raw_unit: header.raw_unit.clone(),
            position_mm: header.position_mm.filter(|_| quantity != Quantity::Other),
            excluded: match quantity {
                Quantity::Current => excluded(&excluded_rows, axis, &rows),
                _ => Arc::from([]),
            },
            time_s: time_of(rows, &all, &mut shared),
            values: values.into(),
            own_clock: false,
            open_zero: None,
        };
        if quantity.is_response() {
            issues.extend(range_end::leave_out(&mut channel));
        }
        channels.push(channel);
    }
    raw.flags.extend(flags);
    raw.flags.sort_by_key(|flag| flag.row);
    channels
}

/// Numbers that are no reading of their column, with their rows: what an instrument writes where a sensor is off, it writes
/// for all that the sensor measures.
fn codes(raw: &Raw, meanings: &[Meaning]) -> BTreeSet<(usize, u64)> {
    let of_column = |(column, meaning): (&CellColumn, &Meaning)| {
        let (quantity, conversion) = (
            meaning.quantity().unwrap_or(Quantity::Other),
            meaning.conversion(),
        );
        let possible: Vec<f64> = (column.numbers.iter())
            .map(|number| {
                if is_impossible(quantity, *number, conversion.apply(*number)) {
                    f64::NAN
                } else {
                    *number
                }
            })
            .collect();
        let found = no_reading::codes(quantity, &possible);
        let is_code = |number: &f64| {
            quantity != Quantity::Other
                && number.is_finite()
                && (found.contains(&number.to_bits())
                    || is_impossible(quantity, *number, conversion.apply(*number)))
        };
        let rows = column
            .numbers
            .iter()
            .enumerate()
            .filter(|(_, number)| is_code(number));
        rows.map(|(row, number)| (row, number.to_bits()))
            .collect::<Vec<_>>()
    };
    raw.cells
        .columns
        .iter()
        .zip(meanings)
        .flat_map(of_column)
        .collect()
}

/// Takes numbers out that are no measurements; gives their rows.
fn take_impossible(
    numbers: &mut [f64],
    quantity: Quantity,
    conversion: Conversion,
    codes: &BTreeSet<(usize, u64)>,
) -> Vec<(u32, f64)> {
    let mut found = Vec::new();
    for (row, number) in numbers.iter_mut().enumerate() {
        let is_code = quantity != Quantity::Other && codes.contains(&(row, number.to_bits()));
        if is_code || is_impossible(quantity, *number, conversion.apply(*number)) {
            found.push((row as u32, *number));
            *number = f64::NAN;
        }
    }
    found
}

/// Indices on the axis with a finite number, and those numbers converted.
fn finite(mut numbers: Vec<f64>, conversion: Conversion, axis: &TimeAxis) -> (Vec<u32>, Vec<f64>) {
    if axis.rows.len() == numbers.len() {
        // Every row has its time, and mostly every cell its number.
        if conversion != Conversion::IDENTITY {
            numbers
                .iter_mut()
                .for_each(|number| *number = conversion.apply(*number));
        }
        if numbers.iter().all(|number| number.is_finite()) {
            return ((0..numbers.len() as u32).collect(), numbers);
        }
        let found = numbers
            .into_iter()
            .enumerate()
            .filter(|(_, number)| number.is_finite());
        return found.map(|(row, number)| (row as u32, number)).unzip();
    }
    let at = |(k, &row): (usize, &u32)| (k as u32, conversion.apply(numbers[row as usize]));
    let all = axis.rows.iter().enumerate().map(at);
    all.filter(|(_, value)| value.is_finite()).unzip()
}

/// Times of the channel with readings at `rows` of the axis: one array for all channels with the same rows.
fn time_of(rows: Vec<u32>, all: &Arc<[f64]>, shared: &mut Vec<(Vec<u32>, Arc<[f64]>)>) -> Arc<[f64]> {
    if rows.len() == all.len() {
        return all.clone();
    }
    if let Some((_, time_s)) = shared.iter().find(|(known, _)| *known == rows) {
        return time_s.clone();
    }
    let time_s: Arc<[f64]> = rows.iter().map(|&k| all[k as usize]).collect();
    shared.push((rows, time_s.clone()));
    time_s
}

/// Indices among the channel's readings of those that stand in excluded rows of the table.
fn excluded(excluded_rows: &[u32], axis: &TimeAxis, rows: &[u32]) -> Arc<[u32]> {
    if excluded_rows.is_empty() {
        return Arc::from([]);
    }
    let is_excluded = |k: &u32| {
        excluded_rows
            .binary_search(&axis.rows[rows[*k as usize] as usize])
            .is_ok()
    };
    (0..rows.len() as u32).filter(is_excluded).collect()
}

/// Rows with the same mark that follow each other, as stretches of time; rows without a time have none.
fn flagged_stretches(flags: &[RowFlag], axis: &TimeAxis) -> Vec<FlaggedStretch> {
    let mut stretches: Vec<(usize, FlaggedStretch)> = Vec::new();
    for flag in flags {
        let Ok(at) = axis.rows.binary_search(&flag.row) else {
            continue;
        };
        let time_s = axis.time_s[at];
        match stretches.last_mut() {
            Some((last, stretch))
                if *last + 1 == at && stretch.column == flag.column && stretch.flag == flag.flag =>
            {
                *last = at;
                stretch.to_s = time_s;
                stretch.readings += 1;
            }
            _ => stretches.push((
                at,
                FlaggedStretch {
                    column: flag.column.clone(),
                    flag: flag.flag.clone(),
                    from_s: time_s,
                    to_s: time_s,
                    readings: 1,
                    excludes: flag.excludes,
                },
            )),
        }
    }
    stretches.into_iter().map(|(_, stretch)| stretch).collect()
}

fn no_response(raw: &Raw, meanings: &[Meaning]) -> ReadError {
    let describe = |(index, header): (usize, &Header)| {
        let (name, text) = (quoted(&header.raw_name), &raw.cells.columns[index].text);
        match (&meanings[index], &header.meaning, &text.first) {
            (Meaning::Refused { error, .. }, ..) => format!("{name} ({error})"),
            (Meaning::Other, Meaning::Known { .. }, Some((_, first))) => {
                format!("{name} ({} cells hold text, first {})", text.count, quoted(first))
            }
            _ => name,
        }
    };
    let columns: Vec<String> = raw.headers.iter().enumerate().map(describe).collect();
    ReadError::NoResponse {
        line: raw.cells.header_line,
        found: columns.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Severity;

    fn raw(columns: &[(&str, &[f64])]) -> Raw {
        let headers = columns.iter().map(|(name, _)| Header::parse(name)).collect();
        let cells = CellTable::of_numbers(columns.iter().map(|(_, numbers)| numbers.to_vec()).collect());
        Raw::of_instrument(String::new(), headers, cells)
    }

    #[test]
    fn an_overload_is_a_warning_where_the_column_is_used() {
        let mut issues = Vec::new();
        let numbers: &[f64] = &[0.0, 9.9e37, 1.0];
        let columns = [
            ("Time (s)", &[0.0, 1.0, 2.0][..]),
            ("Current (A)", numbers),
            ("Aux 7", numbers),
        ];
        assemble(raw(&columns), &mut issues).unwrap();
        let found: Vec<(&str, Severity)> = issues.iter().map(|i| (i.code.as_str(), i.severity)).collect();
        let code = "impossible-reading";
        assert_eq!(found, [(code, Severity::Warning), (code, Severity::Note)]);
    }

    /// Imaginary parts as they are kept, and the codes of what is said of them.
    fn imaginary_of(imaginary_ohm: &[f64; 4]) -> (Vec<f64>, Vec<String>) {
        let mut issues = Vec::new();
        let spectrum = raw(&[
            ("Frequency (Hz)", &[1e3, 1e2, 1e1, 1.0]),
            ("Z' (ohm)", &[50.0, 60.0, 80.0, 90.0]),
            ("Z'' (ohm)", imaginary_ohm),
        ]);
        let table = assemble(spectrum, &mut issues).unwrap();
        let is_imaginary = |channel: &&Channel| channel.quantity == Quantity::ImpedanceImaginary;
        let channel = table.channels.iter().find(is_imaginary).unwrap();
        (
            channel.values.to_vec(),
            issues.into_iter().map(|issue| issue.code).collect(),
        )
    }

    #[test]
    fn imaginary_parts_as_of_a_coil_are_turned_and_those_of_a_sample_are_not() {
        let (values, codes) = imaginary_of(&[1.0, 5.0, 20.0, 40.0]);
        assert_eq!(values, [-1.0, -5.0, -20.0, -40.0]);
        assert_eq!(codes, ["imaginary-part-turned"]);
        // Signs that flip in noise where the parts are small say nothing.
        let (values, codes) = imaginary_of(&[-0.2, -0.1, 20.0, 40.0]);
        assert_eq!(values, [0.2, 0.1, -20.0, -40.0]);
        assert_eq!(codes, ["imaginary-part-turned"]);
        // The leads are a coil at high frequencies, whatever the sample is.
        for as_measured in [[-1.0, -5.0, -20.0, -40.0], [3.0, 1.0, -20.0, -40.0]] {
            let (values, codes) = imaginary_of(&as_measured);
            assert_eq!((values.as_slice(), codes.len()), (&as_measured[..], 0));
        }
    }

    /// Constant, whole seconds of a fast sweep, one repeat among many, and a clock that is set back.
    #[test]
    fn no_frequency_is_lost_for_a_time_that_tells_them_not_apart() {
        let count = 40;
        let rows = || (0..count).map(f64::from);
        let hz: Vec<f64> = rows().map(|k| 1e4 * 0.8f64.powf(k)).collect();
        let ohm: Vec<f64> = rows().map(|k| 50.0 + k).collect();
        let one_repeat = |k: f64| if k == 7.0 { 6.0 } else { k };
        let times: [&dyn Fn(f64) -> f64; 4] = [&|_| 0.0, &|k| (k / 5.0).floor(), &one_repeat, &|k| {
            (k - 20.0).abs()
        }];
        for time in times {
            let time: Vec<f64> = rows().map(time).collect();
            let columns = [
                ("Time (s)", &time[..]),
                ("Frequency (Hz)", &hz),
                ("Z' (ohm)", &ohm),
                ("-Z'' (ohm)", &ohm),
            ];
            let mut issues = Vec::new();
            let table = assemble(raw(&columns), &mut issues).unwrap();
            let found = ieap_domain::Spectrum::of(&table.channels);
            assert_eq!(
                (found.len(), found[0].frequency_hz.as_slice()),
                (1, &hz[..]),
                "{time:?}"
            );
            assert!(issues.is_empty(), "{issues:?}");
        }
    }

    #[test]
    fn an_overload_stays_with_its_reading_where_a_row_before_it_is_dropped() {
        let mut measured = raw(&[
            ("Time (s)", &[0.0, f64::NAN, 2.0, 3.0, 4.0]),
            ("Current (A)", &[1.0, 1.1, 1.2, 99.0, 1.4]),
            ("Voltage (V)", &[2.0, 2.0, 2.0, 2.0, 2.0]),
        ]);
        measured.flags = vec![RowFlag {
            row: 3,
            column: "Over".to_owned(),
            flag: "I".to_owned(),
            excludes: true,
        }];
        let table = assemble(measured, &mut Vec::new()).unwrap();
        let [current, voltage] = &table.channels[..] else {
            panic!("{:#?}", table.channels)
        };
        assert_eq!(*current.values, [1.0, 1.2, 99.0, 1.4]);
        assert_eq!((&*current.excluded, voltage.excluded.len()), (&[2][..], 0));
        assert_eq!((table.flags[0].from_s, table.flags[0].to_s), (3.0, 3.0));
    }
}
