//! Seconds of the rows from what a profile says of the time.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use super::definition::{Profile, TimeBase};
use crate::formats::cells::{CellColumn, CellTable};
use crate::formats::error::{ReadError, quoted};
use crate::formats::policy::BAD_SHARE;
use crate::formats::stamp::{self, DateOrder};
use crate::text::header::{Header, Meaning};
use crate::{StartedAt, Timestamp};
use ieap_domain::unit::Conversion;
use ieap_domain::{Issue, Quantity};

/// Puts seconds into the time column (or adds one) and gives the start that follows from it.
///
/// `places` are the columns that the profile names, the time's first.
///
/// # Errors
/// More than a twentieth of the rows have a time that is none.
pub(super) fn apply(
    profile: &Profile,
    headers: &mut Vec<Header>,
    cells: &mut CellTable,
    places: &[usize],
    issues: &mut Vec<Issue>,
) -> Result<Option<StartedAt>, ReadError> {
    let known = |unit: &str, conversion: Conversion, header: &mut Header| {
        header.raw_unit = unit.to_owned();
        header.meaning = Meaning::Known {
            quantity: Quantity::Time,
            conversion,
        };
    };
    match &profile.time {
        TimeBase::Elapsed { unit, conversion, .. } => {
            known(unit, *conversion, &mut headers[places[0]]);
            Ok(None)
        }
        TimeBase::Epoch { unit, conversion, .. } => {
            known(unit, *conversion, &mut headers[places[0]]);
            Ok(since_first(&mut cells.columns[places[0]], *conversion))
        }
        TimeBase::Clock {
            date_column,
            order,
            zone,
            ..
        } => {
            let date_at = date_column.as_ref().map(|_| places[1]);
            let moments = moments(cells, places[0], date_at, *order);
            check_readable(cells, places[0], &headers[places[0]], &moments, order.words())?;
            let start = from_moments(
                cells,
                places[0],
                &moments,
                zone.as_ref(),
                profile.time_zero_is_step,
            );
            known("s", Conversion::IDENTITY, &mut headers[places[0]]);
            if let Some(date_at) = date_at {
                headers[date_at].meaning = Meaning::Other;
            }
            Ok(start)
        }
        TimeBase::TimeOfDay { .. } => {
            let moments = past_midnight(times_of_day(cells, places[0]), issues);
            check_readable(cells, places[0], &headers[places[0]], &moments, "hh:mm:ss")?;
            from_moments(cells, places[0], &moments, None, false);
            known("s", Conversion::IDENTITY, &mut headers[places[0]]);
            Ok(None)
        }
        TimeBase::Interval { interval_s } => {
            let rows = cells.rows();
            headers.push(Header {
                raw_name: format!("row number x {interval_s} s"),
                ..Header::with_unit("time", "s")
            });
            cells.columns.push(CellColumn {
                numbers: (0..rows).map(|row| row as f64 * interval_s).collect(),
                filled: rows,
                ..CellColumn::default()
            });
            Ok(None)
        }
    }
}

/// Numbers since 1970 become numbers since the first row; gives that row's moment.
fn since_first(column: &mut CellColumn, conversion: Conversion) -> Option<StartedAt> {
    let first = *column.numbers.iter().find(|number| number.is_finite())?;
    column.numbers.iter_mut().for_each(|number| *number -= first);
    let seconds = conversion.apply(first);
    let in_range = seconds.abs() < 1e11;
    let nanoseconds = (seconds * 1e9).round();
    let moment = in_range.then(|| jiff::Timestamp::from_nanosecond(nanoseconds as i128).ok());
    let local = moment
        .flatten()
        .map(|moment| TimeZone::UTC.to_datetime(moment).to_string());
    Some(StartedAt {
        raw: first.to_string(),
        kind: Timestamp::Start,
        offset: local.as_ref().map(|_| "+00:00".to_owned()),
        local,
        basis: "the first row's time since 1970, UTC".to_owned(),
    })
}

/// The moment of each row, from one column or two.
fn moments(
    cells: &CellTable,
    time_at: usize,
    date_at: Option<usize>,
    order: DateOrder,
) -> Vec<Option<DateTime>> {
    let rows = cells.rows();
    let times = texts(&cells.columns[time_at], rows);
    let dates = date_at.map(|at| texts(&cells.columns[at], rows));
    (0..rows)
        .map(|row| {
            let time = times[row]?;
            match &dates {
                Some(dates) => stamp::civil(&format!("{} {time}", dates[row]?), order),
                None => of_sheet(time).or_else(|| stamp::civil(time, order)),
            }
        })
        .collect()
}

/// Text of each row's cell.
fn texts(column: &CellColumn, rows: usize) -> Vec<Option<&str>> {
    let mut texts = vec![None; rows];
    for (row, text) in &column.texts {
        if let Some(slot) = texts.get_mut(*row as usize) {
            *slot = Some(text.as_str());
        }
    }
    texts
}

/// A date of a workbook: a number of days.
fn of_sheet(text: &str) -> Option<DateTime> {
    let days = text.strip_prefix("date ")?.parse::<f64>().ok()?;
    stamp::from_day_number(days, true)
}

fn times_of_day(cells: &CellTable, time_at: usize) -> Vec<Option<DateTime>> {
    let texts = texts(&cells.columns[time_at], cells.rows());
    let time = |text: &str| stamp::civil(&format!("2000-01-01 {text}"), DateOrder::YearFirst);
    texts.into_iter().map(|text| text.and_then(time)).collect()
}

/// Adds a day wherever the time of day goes back by more than half of one.
fn past_midnight(moments: Vec<Option<DateTime>>, issues: &mut Vec<Issue>) -> Vec<Option<DateTime>> {
    const HALF_A_DAY_S: f64 = 43_200.0;
    let (mut days, mut last) = (0i64, None::<DateTime>);
    let moved = moments
        .into_iter()
        .map(|moment| {
            let moment = moment?;
            if last.is_some_and(|last| last.duration_since(moment).as_secs_f64() > HALF_A_DAY_S) {
                days += 1;
            }
            last = Some(moment);
            moment.checked_add(jiff::Span::new().try_days(days).ok()?).ok()
        })
        .collect();
    if days > 0 {
        let message = format!("the times of day pass midnight {days} time(s); each adds a day");
        issues.push(Issue::note("midnight-passed", message));
    }
    moved
}

fn check_readable(
    cells: &CellTable,
    time_at: usize,
    header: &Header,
    moments: &[Option<DateTime>],
    needed: &str,
) -> Result<(), ReadError> {
    let bad = moments.iter().filter(|moment| moment.is_none()).count();
    if bad <= 1 || bad as f64 <= BAD_SHARE * moments.len() as f64 {
        return Ok(());
    }
    let first = moments.iter().position(Option::is_none).unwrap_or(0);
    let text = texts(&cells.columns[time_at], cells.rows())[first].unwrap_or("");
    Err(ReadError::Column {
        line: cells.line_of_row[first] as usize,
        index: time_at + 1,
        column: quoted(&header.raw_name),
        reason: format!(
            "{bad} of {} cells hold no date and time in the order {needed}, first {}",
            moments.len(),
            quoted(text)
        ),
    })
}

/// Puts seconds since the first moment into the column; gives that moment as the start.
fn from_moments(
    cells: &mut CellTable,
    time_at: usize,
    moments: &[Option<DateTime>],
    zone: Option<&TimeZone>,
    zero_is_step: bool,
) -> Option<StartedAt> {
    let raw = texts(&cells.columns[time_at], cells.rows())
        .into_iter()
        .flatten()
        .next()
        .map(str::to_owned);
    let first = moments.iter().flatten().next().copied();
    let zoned = |moment: DateTime| zone.and_then(|zone| moment.to_zoned(zone.clone()).ok());
    let since = |moment: DateTime, first: DateTime| match (zoned(moment), zoned(first)) {
        (Some(moment), Some(first)) => moment.duration_since(&first).as_secs_f64(),
        _ => moment.duration_since(first).as_secs_f64(),
    };
    let column = &mut cells.columns[time_at];
    column.numbers = moments
        .iter()
        .map(|moment| match (moment, first) {
            (Some(moment), Some(first)) => since(*moment, first),
            _ => f64::NAN,
        })
        .collect();
    column.texts.clear();
    column.keep_text = false;
    let first = first.filter(|_| !zero_is_step)?;
    Some(StartedAt {
        raw: raw.unwrap_or_default(),
        kind: Timestamp::Start,
        local: Some(first.to_string()),
        offset: zoned(first).map(|zoned| offset_text(zoned.offset())),
        basis: "the first row's date, as the profile reads it".to_owned(),
    })
}

/// `+02:00`
fn offset_text(offset: jiff::tz::Offset) -> String {
    let minutes = offset.seconds() / 60;
    let sign = if minutes < 0 { '-' } else { '+' };
    format!("{sign}{:02}:{:02}", minutes.abs() / 60, minutes.abs() % 60)
}
