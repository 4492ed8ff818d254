//! In which orders of day, month and year a date can be read, and which of several is taken.

use crate::formats::climate::moments::with_offset;
use crate::formats::stamp::{self, DateOrder};
use crate::table::policy::RECENT_YEAR;

/// The orders in which a date can be read; dots are written day first.
pub fn orders(date: &str) -> Vec<DateOrder> {
    let bare = with_offset(date).map_or(date, |(bare, _)| bare);
    let found: Vec<DateOrder> = (DateOrder::ALL.into_iter())
        .filter(|order| stamp::civil(bare, *order).is_some())
        .collect();
    match taken(date, &found, None) {
        Some((order, _)) => vec![order],
        None => found,
    }
}

/// A date without an offset from UTC.
fn bare_date(date: &str) -> &str {
    with_offset(date).map_or(date, |(bare, _)| bare)
}

/// Of several orders the one that somebody states; else day first, where dots stand between the numbers and the year is the last.
pub fn taken(
    first: &str,
    orders: &[DateOrder],
    stated: Option<DateOrder>,
) -> Option<(DateOrder, &'static str)> {
    if let Some(stated) = stated.filter(|order| orders.contains(order)) {
        let reason = ", as campaign.toml states or other files of the folder show";
        return Some((stated, reason));
    }
    let with_dots = first.chars().find(|c| matches!(c, '.' | '/' | '-')) == Some('.');
    let year = |order: DateOrder| {
        (orders.contains(&order))
            .then(|| stamp::civil(bare_date(first), order))
            .flatten()
    };
    // `26.03.11` is of 2026 or of 2011: there the custom is no witness.
    let is_recent = |order| year(order).is_some_and(|moment| moment.year() >= RECENT_YEAR);
    let is_day_first = with_dots
        && orders.contains(&DateOrder::DayFirst)
        && (!orders.contains(&DateOrder::YearFirst)
            || (is_recent(DateOrder::DayFirst) && !is_recent(DateOrder::YearFirst)));
    is_day_first.then_some((DateOrder::DayFirst, ", as dates with dots are written"))
}
