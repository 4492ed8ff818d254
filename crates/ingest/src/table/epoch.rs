//! Numbers that are moments, by their size: seconds, milliseconds or microseconds since 1970, as loggers and scripts write them,
//! seconds since 1904, as LabVIEW does, and days since the year 0, the `datenum` of MATLAB.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use super::kind::Kind;
use super::read::Table;
use super::zone::shown;
use crate::formats::climate::moments::Moments;
use crate::formats::stamp::DateOrder;
use crate::table::policy::{LATEST_WITHOUT_WITNESS_S, OUR_TIME_S, WITNESS_WITHIN_S};
use crate::text::header::Meaning;
use crate::text::names::names_time;
use crate::text::{Cell, Decimal, number};
use ieap_domain::Quantity;

/// Whether a cell holds a number that is a moment of our time.
pub fn is_moment(cell: &str) -> bool {
    let number = number::parse(cell, Decimal::Point);
    let is_one = |number: f64| {
        COUNTS.iter().any(|count| {
            count.word.is_empty() && !count.needs_witness && OUR_TIME_S.contains(&count.since_1970_s(number))
        })
    };
    matches!(number, Cell::Number(number) if is_one(number))
}

/// A way to count moments.
#[derive(Debug, Clone, Copy)]
struct Count {
    /// Seconds of one unit.
    unit_s: f64,
    /// From zero to 1970, s.
    zero_to_1970_s: f64,
    /// What the name of its column must hold; empty: nothing.
    word: &'static str,
    /// Whether it counts in UTC.
    in_utc: bool,
    /// Whether only a date above the table shows that it counts so.
    needs_witness: bool,
    reason: &'static str,
}

impl Count {
    fn since_1970_s(&self, number: f64) -> f64 {
        number * self.unit_s - self.zero_to_1970_s
    }
}

const SINCE_1970: &str = ", numbers since 1970";
const fn since_1970(unit_s: f64) -> Count {
    Count {
        unit_s,
        zero_to_1970_s: 0.0,
        word: "",
        in_utc: true,
        needs_witness: false,
        reason: SINCE_1970,
    }
}
const COUNTS: [Count; 7] = [
    since_1970(1.0),
    since_1970(1e-3),
    since_1970(1e-6),
    Count {
        zero_to_1970_s: 2_082_844_800.0,
        reason: ", seconds since 1904",
        ..since_1970(1.0)
    },
    Count {
        zero_to_1970_s: 2_209_161_600.0,
        in_utc: false,
        needs_witness: true,
        reason: ", seconds since 1899-12-30, as the date above the table shows",
        ..since_1970(1.0)
    },
    Count {
        zero_to_1970_s: 2_208_988_800.0,
        in_utc: false,
        needs_witness: true,
        reason: ", seconds since 1900, as the date above the table shows",
        ..since_1970(1.0)
    },
    Count {
        unit_s: 86_400.0,
        zero_to_1970_s: 719_529.0 * 86_400.0,
        word: "datenum",
        in_utc: false,
        needs_witness: false,
        reason: ", days since the year 0",
    },
];

/// A column of such numbers.
pub struct Epoch {
    column: usize,
    count: Count,
}

impl Epoch {
    /// That of a column that is stated to count units of so many seconds from 1970.
    pub fn stated(column: usize, unit_s: f64) -> Epoch {
        Epoch {
            column,
            count: since_1970(unit_s),
        }
    }
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
    /// Offset from UTC, `+00:00` where no local time stands beside it; none of a local count.
    pub offset: Option<String>,
    /// How it is counted, in words.
    pub reason: &'static str,
}

/// The column of such numbers, where one is named as a time and all its numbers are of our time.
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
        let lower = header.raw_name.to_lowercase();
        let fits = |count: &Count| {
            let is_other = |stated_s: f64| (stated_s / count.unit_s - 1.0).abs() > 1e-9;
            if stated_s.is_some_and(is_other) || !lower.contains(count.word) {
                return false;
            }
            let mut filled = numbers.iter().filter(|number| number.is_finite()).peekable();
            filled.peek().is_some() && filled.all(|number| OUR_TIME_S.contains(&count.since_1970_s(*number)))
        };
        let first = numbers.iter().copied().find(|number| number.is_finite())?;
        let is_witnessed = |count: &Count| {
            let moment = utc(count.since_1970_s(first));
            let apart = |date: &DateTime| date.duration_since(moment).as_secs_f64().abs();
            table
                .dates_above
                .iter()
                .any(|date| apart(date) < WITNESS_WITHIN_S)
        };
        let fitting: Vec<Count> = COUNTS.into_iter().filter(fits).collect();
        let witnessed = fitting.iter().copied().find(is_witnessed);
        // A moment in years to come is none that was measured.
        let alone =
            |count: &Count| !count.needs_witness && count.since_1970_s(first) < LATEST_WITHOUT_WITNESS_S;
        let count = witnessed.or_else(|| fitting.iter().copied().find(alone))?;
        Some(Epoch { column, count })
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
        .map(|row| (numbers[*row] - first) * epoch.count.unit_s)
        .collect();
    let utc = utc(epoch.count.since_1970_s(first));
    let own = epoch.count.in_utc.then(|| "+00:00".to_owned());
    let (mut columns, mut moment, mut offset) = (vec![epoch.column], utc, own);
    if let Some((local_columns, local)) = local {
        columns.extend(local_columns);
        let minutes = (local.duration_since(utc).as_secs_f64() / 60.0).round() as i64;
        if minutes.abs() <= 14 * 60 {
            offset = Some(shown(minutes));
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
            in_utc: epoch.count.in_utc,
        },
        raw: first.to_string(),
        offset,
        reason: epoch.count.reason,
    }
}

fn utc(seconds: f64) -> DateTime {
    let moment = jiff::Timestamp::from_nanosecond((seconds * 1e6).round() as i128 * 1000);
    moment.map_or(DateTime::default(), |moment| TimeZone::UTC.to_datetime(moment))
}
