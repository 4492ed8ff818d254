//! What times the rows of a table where a profile states it.

use jiff::civil::DateTime;

use super::epoch::{self, Epoch};
use super::kind::is_moment_in;
use super::read::{Settled, Table};
use super::stated::{AsStated, Stated, TimeBase};
use super::times::{Dates, Elapsed, by_dates, by_wall, past_midnight, unread, with_elapsed};
use crate::formats::ReadContext;
use crate::formats::cells::CellColumn;
use crate::formats::error::{ReadError, quoted};
use crate::formats::stamp::{self, DateOrder};
use crate::text::header::Header;
use ieap_domain::Issue;
use ieap_domain::unit::Conversion;

/// Times the rows as it is stated.
///
/// # Errors
/// More than a twentieth of the rows have a time that is none, or the times do not follow each other.
pub(super) fn settle(
    table: &mut Table<'_>,
    (stated, placed): (&Stated, &AsStated),
    context: &ReadContext,
    issues: &mut Vec<Issue>,
) -> Result<Settled, ReadError> {
    let columns = &placed.times;
    let elapsed = |column: usize, numbers: Vec<f64>, conversion| Elapsed {
        column,
        numbers,
        stated: Some(conversion),
    };
    match &stated.time {
        TimeBase::Counted {
            conversion,
            since_1970,
            ..
        } => {
            let column = columns[0];
            let numbers = table.cells.columns[column].numbers.clone();
            if *since_1970 && numbers.iter().any(|number| number.is_finite()) {
                let epoch = Epoch::stated(column, conversion.apply(1.0));
                return Ok(by_wall(table, epoch::wall(table, epoch, None).into()));
            }
            with_elapsed(
                table,
                elapsed(column, numbers, *conversion),
                None,
                context,
                issues,
            )
        }
        TimeBase::Clock { order, zone, .. } => {
            let texts: Vec<String> = match columns[..] {
                [time, day, ..] => (table.texts_of(day).iter().zip(table.texts_of(time)))
                    .map(|(day, time)| format!("{day} {time}"))
                    .collect(),
                _ => table
                    .texts_of(columns[0])
                    .into_iter()
                    .map(str::to_owned)
                    .collect(),
            };
            // Dates of a workbook are written out year first, whatever its texts are.
            let orders = [*order, DateOrder::YearFirst];
            let orders = &orders[..1 + usize::from(stated.is_sheet())];
            let is_date = |text: &str| is_moment_in(&stamp::in_digits(text), orders);
            let needed = format!("date and time, {}", order.words());
            refuse(table, columns[0], unread(&texts, is_date, &needed))?;
            let dates = Dates {
                orders,
                order: Some(*order),
                zone: zone.as_ref(),
            };
            let wall = by_dates(table, columns.clone(), &texts, dates, issues)?;
            let mut settled = by_wall(table, wall);
            settled.started_at = settled.started_at.filter(|_| !stated.zero_is_step);
            Ok(settled)
        }
        TimeBase::TimeOfDay { .. } => {
            let column = columns[0];
            let mut numbers = times_of_day(table, column)?;
            past_midnight(&mut numbers, issues);
            let first = numbers.iter().copied().find(|number| number.is_finite());
            numbers
                .iter_mut()
                .for_each(|number| *number -= first.unwrap_or(0.0));
            let elapsed = elapsed(column, numbers, Conversion::IDENTITY);
            with_elapsed(table, elapsed, None, context, issues)
        }
        TimeBase::Interval { interval_s } => {
            let rows = table.cells.rows();
            table.headers.push(Header {
                raw_name: format!("row number x {interval_s} s"),
                ..Header::with_unit("time", "s")
            });
            table.cells.columns.push(CellColumn {
                numbers: (0..rows).map(|row| row as f64 * interval_s).collect(),
                filled: rows,
                ..CellColumn::default()
            });
            Ok(Settled::default())
        }
    }
}

fn refuse(table: &Table<'_>, column: usize, unread: Option<(String, &str)>) -> Result<(), ReadError> {
    let Some((found, first)) = unread else {
        return Ok(());
    };
    Err(ReadError::Column {
        line: table.cells.line_of_row.first().map_or(0, |line| *line as usize),
        index: column + 1,
        column: quoted(&table.headers[column].raw_name),
        reason: format!("{found}, first {}", quoted(first)),
    })
}

/// Seconds of the day of each row.
fn times_of_day(table: &Table<'_>, column: usize) -> Result<Vec<f64>, ReadError> {
    let day = |text: &str| stamp::civil(&format!("2000-01-01 {text}"), DateOrder::YearFirst);
    let texts = table.texts_of(column);
    refuse(
        table,
        column,
        unread(&texts, |text| day(text).is_some(), "time of day"),
    )?;
    let midnight: Option<DateTime> = day("00:00:00");
    let second = |text: &&str| Some(day(text)?.duration_since(midnight?).as_secs_f64());
    Ok(texts
        .iter()
        .map(|text| second(text).unwrap_or(f64::NAN))
        .collect())
}
