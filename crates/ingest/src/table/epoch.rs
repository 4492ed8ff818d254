//! Numbers since 1970, as loggers and scripts write moments: seconds, milliseconds or microseconds, by their size.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use super::kind::Kind;
use super::read::Table;
use crate::formats::climate::moments::Moments;
use crate::formats::stamp::DateOrder;
use crate::table::policy::EPOCH_SINCE_1990_S;
use crate::text::header::Meaning;
use crate::text::names::names_time;
use crate::text::{Cell, Decimal, number};
use ieap_domain::Quantity;

/// Whether a cell holds a number that is a moment since 1990.
pub fn is_moment(cell: &str) -> bool {
    let number = number::parse(cell, Decimal::Point);
    matches!(number, Cell::Number(number) if UNITS_S.iter().any(|unit_s| EPOCH_SINCE_1990_S.contains(&(number * unit_s))))
}

/// Seconds, milliseconds, microseconds.
const UNITS_S: [f64; 3] = [1.0, 1e-3, 1e-6];

/// A column of such numbers.
pub struct Epoch {
    column: usize,
    /// Seconds of one unit.
    unit_s: f64,
}

/// The moments that it gives.
pub struct EpochWall {
    /// The columns spent on it.
    pub columns: Vec<usize>,
    /// Rows that have a moment.
    pub at: Vec<usize>,
    /// The moments, in UTC.
    pub moments: Moments,
    /// The first number as the file has it.
    pub raw: String,
    /// Offset from UTC, `+00:00` where no local time stands beside it.
    pub offset: String,
}

/// The column of numbers since 1970, where one is named as a time and all its numbers lie since 1990.
pub fn find(table: &Table<'_>) -> Option<Epoch> {
    (0..table.headers.len()).find_map(|column| {
        let header = &table.headers[column];
        let is_named = names_time(&header.raw_name)
            && !matches!(header.meaning.quantity(), Some(quantity) if quantity != Quantity::Time);
        if table.kind(column) != Kind::Number || !is_named {
            return None;
        }
        let numbers = &table.cells.columns[column].numbers;
        let stated_s = match &header.meaning {
            Meaning::Known { conversion, .. } => Some(conversion.apply(1.0)),
            _ => None,
        };
        let fits = |unit_s: &f64| {
            if stated_s.is_some_and(|stated_s| (stated_s / unit_s - 1.0).abs() > 1e-9) {
                return false;
            }
            let mut filled = numbers.iter().filter(|number| number.is_finite()).peekable();
            filled.peek().is_some() && filled.all(|number| EPOCH_SINCE_1990_S.contains(&(number * unit_s)))
        };
        let unit_s = UNITS_S.into_iter().find(fits)?;
        Some(Epoch { column, unit_s })
    })
}

/// The moments of the rows; a local time beside them gives the offset from UTC.
pub fn wall(table: &Table<'_>, epoch: Epoch, local: Option<(Vec<usize>, DateTime)>) -> EpochWall {
    let numbers = &table.cells.columns[epoch.column].numbers;
    let at: Vec<usize> = (0..numbers.len())
        .filter(|row| numbers[*row].is_finite())
        .collect();
    let first = numbers[at[0]];
    let elapsed_s = at
        .iter()
        .map(|row| (numbers[*row] - first) * epoch.unit_s)
        .collect();
    let utc = utc(first * epoch.unit_s);
    let (mut columns, mut moment, mut offset) = (vec![epoch.column], utc, "+00:00".to_owned());
    if let Some((local_columns, local)) = local {
        columns.extend(local_columns);
        let minutes = (local.duration_since(utc).as_secs_f64() / 60.0).round() as i64;
        if minutes.abs() <= 14 * 60 {
            let sign = if minutes < 0 { '-' } else { '+' };
            offset = format!("{sign}{:02}:{:02}", minutes.abs() / 60, minutes.abs() % 60);
            moment = local;
        }
    }
    EpochWall {
        columns,
        at,
        moments: Moments {
            order: DateOrder::YearFirst,
            first: moment,
            elapsed_s,
            set_back: Vec::new(),
            in_utc: true,
        },
        raw: first.to_string(),
        offset,
    }
}

fn utc(seconds: f64) -> DateTime {
    let moment = jiff::Timestamp::from_nanosecond((seconds * 1e6).round() as i128 * 1000);
    moment.map_or(DateTime::default(), |moment| TimeZone::UTC.to_datetime(moment))
}
