//! The start that lines above a table state.

use crate::formats::stamp::{self, DateOrder};
use crate::table::times::taken;
use crate::{StartedAt, Timestamp};

/// What a line begins with that says when a run began, in small letters, the longer first.
const STARTS: &str = "startzeitpunkt;startzeit;startdatum;start date/time;start time;start date;start_time;started at;started;\
    start;messbeginn;beginn;begin;date and time;date/time;datum/zeit;datum;date et heure;date de début;heure de début;date;\
    acquisition date;recorded;début de la mesure;début;debut;mõõtmise algus;algusaeg;algus;kuupäev;inicio;fecha y hora;fecha;\
    inizio;data e ora;data;início;начало измерения;начало;дата;開始;开始";

/// The rest of a line that begins with such a word.
pub fn after_word(line: &str) -> Option<(&'static str, &str)> {
    let lower = line.to_lowercase();
    let word = STARTS.split(';').find(|word| lower.starts_with(word))?;
    let rest = line.get(word.len()..)?;
    // `Dates of calibration` is another word.
    let ends = rest.chars().next().is_none_or(|c| !c.is_alphanumeric());
    ends.then_some((word, rest))
}

/// Marks between such a word and its date.
pub fn is_mark(c: char) -> bool {
    c.is_whitespace() || "\";,:=\t'".contains(c)
}

/// The orders in which a date can be read; dots are written day first.
pub fn orders(date: &str) -> Vec<DateOrder> {
    let bare = crate::formats::climate::moments::with_offset(date).map_or(date, |(bare, _)| bare);
    let found: Vec<DateOrder> = (DateOrder::ALL.into_iter())
        .filter(|order| stamp::civil(bare, *order).is_some())
        .collect();
    match taken(date, &found, None) {
        Some((order, _)) => vec![order],
        None => found,
    }
}

/// The start that a line of the head states, where its date can be read in one order.
pub fn stated<'l>(head: impl Iterator<Item = &'l str>, stated: Option<DateOrder>) -> Option<StartedAt> {
    head.into_iter().find_map(|line| {
        let text = line.trim_start_matches(['"', '#', ' ', '\t']);
        let (_, rest) = after_word(text)?;
        let date = rest.trim_matches(is_mark);
        let orders = orders(date);
        let order = match orders.as_slice() {
            [only] => *only,
            several => stated.filter(|order| several.contains(order))?,
        };
        let (bare, offset_s) = match crate::formats::climate::moments::with_offset(date) {
            Some((bare, offset_s)) => (bare, Some(offset_s)),
            None => (date, None),
        };
        let local = stamp::civil(bare, order)?;
        let offset = offset_s.map(|offset_s| {
            let (sign, minutes) = (if offset_s < 0 { '-' } else { '+' }, offset_s.abs() / 60);
            format!("{sign}{:02}:{:02}", minutes / 60, minutes % 60)
        });
        Some(StartedAt {
            raw: date.to_owned(),
            kind: Timestamp::Start,
            local: Some(local.to_string()),
            offset,
            basis: format!("a line above the table, {}", order.words()),
        })
    })
}
