//! The start that lines above a table state.

use crate::formats::climate::moments::with_offset;
use crate::formats::date::EITHER_ORDER;
use crate::formats::error::quoted;
use crate::formats::stamp::{self, DateOrder};
use crate::table::Answers;
use crate::table::dates_above::{dated, says_no_start};
use crate::table::order::orders;
use crate::table::stated::StartLine;
use crate::table::zone::shown;
use crate::{StartedAt, Timestamp};
use ieap_domain::Issue;

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
    c.is_whitespace() || "\";,:=|\t'".contains(c)
}

/// The start that lines above a table state: behind a word for it, else the one full date that stands there, whatever is before
/// it. One whose date can be read in several orders is left open.
pub fn stated<'l>(head: impl Iterator<Item = &'l str>, stated: Option<DateOrder>) -> Option<StartedAt> {
    let lines: Vec<&str> = head.collect();
    let named = lines.iter().find_map(|line| {
        let text = line.trim_start_matches(['"', '#', ' ', '\t']);
        let (_, rest) = after_word(text)?;
        of_date(rest.trim_matches(is_mark), stated)
    });
    named.or_else(|| the_one_above(&lines, stated))
}

/// The date of the line that a profile names.
pub fn behind<'l>(
    head: impl Iterator<Item = &'l str>,
    wanted: &StartLine,
    issues: &mut Vec<Issue>,
) -> Option<StartedAt> {
    let after = |line: &'l str| {
        line.trim()
            .trim_start_matches('"')
            .strip_prefix(wanted.begins.as_str())
    };
    let Some(rest) = head.into_iter().find_map(after) else {
        let message = format!("no line begins with {}", quoted(&wanted.begins));
        issues.push(Issue::warning("date-uncertain", message).at("[start] line_begins"));
        return None;
    };
    let date = rest.trim_matches(is_mark);
    let (start, issue) = stamp::in_order(date, wanted.order, wanted.kind, "as the profile says");
    issues.extend(issue);
    Some(start)
}

/// A start that no word names, as somebody answered what it is.
pub fn answered(start: Option<StartedAt>, answers: &Answers) -> Option<StartedAt> {
    let start = start?;
    let open = start.basis.strip_prefix(ONLY_DATE);
    let (Some(behind), Some(answer)) = (open, answers.of("start")) else {
        return Some(start);
    };
    let kind = match answer {
        "none" => return None,
        "end" => Timestamp::End,
        _ => Timestamp::Start,
    };
    let basis = format!("the date above the table behind {behind}, the {answer}, as was answered");
    Some(StartedAt { kind, basis, ..start })
}

/// The one full date above a table of which no word says that it is another moment.
fn the_one_above(lines: &[&str], stated: Option<DateOrder>) -> Option<StartedAt> {
    let mut found = dated(&lines[..lines.len().min(MOST_LINES)]);
    found.retain(|dated| !says_no_start(dated.label));
    found.dedup_by(|a, b| a.date == b.date);
    // Of a calibration and a start years apart the later one is the start; of two of one day nobody knows.
    let starts: Vec<StartedAt> = found
        .iter()
        .filter_map(|dated| of_date(&dated.date, stated))
        .collect();
    let day = |start: &StartedAt| {
        start
            .local
            .as_deref()
            .map(|local| local[..local.len().min(10)].to_owned())
    };
    let latest = starts.iter().filter_map(day).max();
    let mut of_latest = starts
        .iter()
        .filter(|start| starts.len() == 1 || day(start) == latest);
    let only = of_latest.next().filter(|_| of_latest.next().is_none())?;
    let label = found
        .iter()
        .find(|dated| dated.date == only.raw)
        .map_or("", |dated| dated.label);
    let basis = match only.basis.strip_prefix("a line above the table") {
        Some(order) => format!("{ONLY_DATE}{}{order}", quoted(label)),
        None => only.basis.clone(),
    };
    Some(StartedAt {
        basis,
        ..only.clone()
    })
}

/// What is said of a start that no word names: what the basis of its date begins with.
pub const ONLY_DATE: &str = "the one full date above the table, behind ";
/// Lines above a table in which a start is looked for. Chosen.
const MOST_LINES: usize = 200;

/// The start that a date states, in the order that it shows or that is stated; none where it is no date.
pub fn of_date(date: &str, stated: Option<DateOrder>) -> Option<StartedAt> {
    let orders = orders(date);
    let order = match orders.as_slice() {
        [] => return None,
        [only] => Some(*only),
        several => stated.filter(|order| several.contains(order)),
    };
    let (bare, offset_s) = match with_offset(date) {
        Some((bare, offset_s)) => (bare, Some(offset_s)),
        None => (date, None),
    };
    let local = order.and_then(|order| stamp::civil(bare, order));
    let offset = offset_s.map(|offset_s| shown(offset_s / 60));
    Some(StartedAt {
        raw: date.to_owned(),
        kind: Timestamp::Start,
        local: local.map(|local| local.to_string()),
        offset,
        basis: match order {
            Some(order) => format!("a line above the table, {}", order.words()),
            None => EITHER_ORDER.to_owned(),
        },
    })
}
