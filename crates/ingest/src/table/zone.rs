//! The time zone of a file's clock: in the names of the columns that time the rows, or in a line above them. One that is spoken of
//! and not understood is said.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use crate::StartedAt;
use crate::formats::error::quoted;
use crate::text::dictionary::{ZONE_LETTERS, ZONES};
use crate::text::names::half_width;
use ieap_domain::Issue;

/// Code of the warning of a zone that is not understood.
pub const NOT_UNDERSTOOD: &str = "zone-not-understood";

/// Takes the zone that names of columns or lines above the table state, where the start has none yet.
pub fn complete<'t, 'h: 't>(
    started_at: Option<StartedAt>,
    names: impl Iterator<Item = &'t str>,
    head: impl Iterator<Item = &'h str>,
    issues: &mut Vec<Issue>,
) -> Option<StartedAt> {
    let mut start = started_at?;
    if start.offset.is_some() {
        return Some(start);
    }
    let at: Option<DateTime> = start.moment().and_then(|moment| moment.parse().ok());
    let mut unread = None;
    for text in names.chain(head.map(|line| -> &'t str { line })) {
        match zone_in(text, at.unwrap_or_default()) {
            Found::Nothing => {}
            Found::Offset(offset) => {
                start.offset = Some(offset);
                return Some(start);
            }
            Found::Unread => unread = unread.or(Some(text)),
        }
    }
    if let Some(text) = unread {
        let message = format!(
            "{} speaks of a time zone that is not understood; the clock is read in the zone of campaign.toml",
            quoted(text.trim())
        );
        issues.push(Issue::warning(NOT_UNDERSTOOD, message).mend(
            "write it as UTC+02:00 or Europe/Tallinn, or tag the run (or state of the log's [[sensor]]) what its clock shows",
        ));
    }
    Some(start)
}

/// What a text says of a zone.
#[derive(Debug, PartialEq, Eq)]
enum Found {
    /// Nothing.
    Nothing,
    /// Its offset from UTC, `+02:00`.
    Offset(String),
    /// Something that is not understood.
    Unread,
}

fn zone_in(text: &str, at: DateTime) -> Found {
    let text = half_width(text).replace('\u{2212}', "-");
    let lower = text.to_lowercase();
    // What a logger writes for the offset that it counts in comes before what the place is called.
    let found = after_utc(&lower)
        .or_else(|| named(&text, at))
        .or_else(|| by_letters(&text, &lower))
        .or_else(|| speaks_of_zones(&lower).then(|| after_word(&lower)).flatten());
    match found {
        Some(minutes) => Found::Offset(shown(minutes)),
        None if speaks_of_zones(&lower) && says_something(&lower) => Found::Unread,
        None => Found::Nothing,
    }
}

/// Whether words in small letters are about time zones.
fn speaks_of_zones(lower: &str) -> bool {
    let words = || lower.split(|c: char| !c.is_alphanumeric());
    let speaks = |zone: &str| {
        if zone.is_ascii() {
            words().any(|word| word == zone)
        } else {
            lower.contains(zone)
        }
    };
    ZONES.split(';').any(speaks)
}

/// Whether anything stands behind the word for a zone, or it is itself a statement as `summer time` is.
fn says_something(lower: &str) -> bool {
    let mut words = lower
        .split([':', '=', ',', ';', '\t'])
        .filter(|part| part.chars().any(char::is_alphanumeric));
    words.next().is_some_and(|first| !is_about_dates(first))
        && (words.next().is_some() || lower.contains(['(', '[', '+', '-']))
}

/// Whether a text is a date, which says of a zone nothing that others do not.
fn is_about_dates(text: &str) -> bool {
    text.bytes().filter(u8::is_ascii_digit).count() > 6
}

/// Minutes from UTC behind `UTC`, `GMT` or in place of it `Z`; 0 where nothing stands there.
fn after_utc(lower: &str) -> Option<i64> {
    for word in ["utc", "gmt"] {
        for (at, _) in lower.match_indices(word) {
            let before = lower[..at].chars().next_back();
            let behind = &lower[at + word.len()..];
            if before.is_some_and(char::is_alphabetic) || behind.starts_with(char::is_alphabetic) {
                continue;
            }
            let behind = behind.trim_start_matches([' ', '(', '[', '_', ':', '=']);
            return Some(offset(behind).unwrap_or(0));
        }
    }
    None
}

/// Minutes of an offset at the beginning of a text: `+02:00`, `+0200`, `-7`, `+5.5`, `+2 h`.
pub(crate) fn offset(text: &str) -> Option<i64> {
    let sign = match text.as_bytes().first()? {
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let rest = text[1..].trim_start();
    let (hours, behind) = rest.split_at(digits(rest));
    let minutes = match (hours.len(), behind.strip_prefix([':', '.', ','])) {
        (4, _) => 60 * hours[..2].parse::<i64>().ok()? + hours[2..].parse::<i64>().ok()?,
        (1 | 2, Some(part)) if digits(part) == 2 && !behind.starts_with([',', '.']) => {
            60 * hours.parse::<i64>().ok()? + part[..2].parse::<i64>().ok()?
        }
        (1 | 2, Some(part)) if digits(part) > 0 && behind.starts_with('.') => {
            (60.0 * format!("{hours}.{}", &part[..digits(part)]).parse::<f64>().ok()?).round() as i64
        }
        (1 | 2, _) => 60 * hours.parse::<i64>().ok()?,
        _ => return None,
    };
    (minutes <= 14 * 60).then_some(sign * minutes)
}

/// A zone by the name of its place: `Europe/Tallinn`.
fn named(text: &str, at: DateTime) -> Option<i64> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '/' | '_' | '-' | '+');
    let mut names = text.split(|c: char| !is_part(c)).filter(|name| {
        name.split('/').count() > 1
            && name
                .split('/')
                .all(|part| part.starts_with(|c: char| c.is_ascii_uppercase()))
    });
    let zone = names.find_map(|name| TimeZone::get(name).ok())?;
    let moment = zone.to_ambiguous_timestamp(at).compatible().ok()?;
    Some(i64::from(zone.to_offset(moment).seconds()) / 60)
}

/// A zone by the letters of one clock: `CET`, where the text is about time.
fn by_letters(text: &str, lower: &str) -> Option<i64> {
    let is_about_time = speaks_of_zones(lower) || crate::text::names::names_time(text);
    let words = text.split(|c: char| !c.is_ascii_alphanumeric());
    let known = |word: &str| ZONE_LETTERS.iter().find(|(letters, _)| *letters == word);
    words
        .into_iter()
        .filter(|_| is_about_time)
        .find_map(known)
        .map(|(_, minutes)| *minutes)
}

/// An offset that stands anywhere behind the word for a zone.
fn after_word(lower: &str) -> Option<i64> {
    if is_about_dates(lower) {
        return None;
    }
    lower
        .match_indices(['+', '-'])
        .find_map(|(at, _)| offset(&lower[at..]))
}

/// An offset from UTC as it is kept: `+02:00`.
pub(super) fn shown(minutes: i64) -> String {
    let sign = if minutes < 0 { '-' } else { '+' };
    format!("{sign}{:02}:{:02}", minutes.abs() / 60, minutes.abs() % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zone_is_read_in_any_spelling_or_said_to_be_unread() {
        let at: DateTime = "2026-07-01T12:00:00".parse().unwrap();
        let offset = |text: &str| Found::Offset(text.to_owned());
        for (text, expected) in [
            ("datetime_utc", offset("+00:00")),
            ("Tijd (UTC)", offset("+00:00")),
            ("Date Time, GMT-07:00", offset("-07:00")),
            ("time zone, UTC+0000", offset("+00:00")),
            ("Time [UTC+5:30]", offset("+05:30")),
            ("Zeitzone: +1", offset("+01:00")),
            ("timestamp (UTC -3)", offset("-03:00")),
            ("Timezone;Europe/Tallinn", offset("+03:00")),
            ("Uhrzeit (MESZ)", offset("+02:00")),
            ("时区: UTC+8", offset("+08:00")),
            ("time zone: Central", Found::Unread),
            ("Time zone: IST", Found::Unread),
            ("Time (s)", Found::Nothing),
            ("Zone 3 temperature", Found::Nothing),
            ("2026-07-01 12:00:00", Found::Nothing),
            ("Humidity (%)", Found::Nothing),
        ] {
            assert_eq!(zone_in(text, at), expected, "{text}");
        }
    }
}
