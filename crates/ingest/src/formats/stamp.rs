//! Dates whose order of day and month the format fixes, or that the file counts as a number.

use std::borrow::Cow;

use jiff::ToSpan;
use jiff::civil::{Date, DateTime};

use super::error::quoted;
use crate::text::names::half_width;
use crate::{StartedAt, Timestamp};
pub use ieap_domain::DateOrder;
use ieap_domain::Issue;

/// Date and time of `raw` in the order that the format fixes, `basis`; with an issue where it is no date.
pub fn in_order(raw: &str, order: DateOrder, kind: Timestamp, basis: &str) -> (StartedAt, Option<Issue>) {
    let local = civil(raw, order);
    let issue = local.is_none().then(|| {
        Issue::warning("date-uncertain", format!("{} is no date and time", quoted(raw)))
            .mend("tag the run with started_at = \"2024-03-10T12:00:00\"")
    });
    let stamp = StartedAt {
        raw: raw.to_owned(),
        kind,
        local: local.map(|local| local.to_string()),
        offset: None,
        basis: basis.to_owned(),
    };
    (stamp, issue)
}

/// Days since 1899-12-30, as spreadsheets and Delphi programs count them, to the nearest second or, where the
/// number has the digits for it, millisecond.
pub fn from_day_number(days: f64, to_milliseconds: bool) -> Option<DateTime> {
    let milliseconds = if to_milliseconds {
        (days * 86_400_000.0).round()
    } else {
        (days * 86_400.0).round() * 1000.0
    };
    let epoch = Date::new(1899, 12, 30)
        .ok()?
        .to_datetime(jiff::civil::Time::midnight());
    let in_range = milliseconds.is_finite() && (0.0..=1e14).contains(&milliseconds);
    in_range
        .then(|| epoch.checked_add((milliseconds as i64).milliseconds()).ok())
        .flatten()
}

/// The start that all parts of a file share. Where parts started at different moments none is the file's, and an
/// issue says so.
pub fn shared(starts: impl IntoIterator<Item = StartedAt>, issues: &mut Vec<Issue>) -> Option<StartedAt> {
    let mut starts = starts.into_iter();
    let first = starts.next()?;
    match starts.find(|other| other.local != first.local) {
        None => Some(first),
        Some(other) => {
            let message = format!(
                "parts of the file started at different moments, {} and {}; none is taken as the start of all",
                quoted(&first.raw),
                quoted(&other.raw)
            );
            let mend = "tag each run with its started_at, or export each part into a file of its own";
            issues.push(Issue::warning("starts-differ", message).mend(mend));
            None
        }
    }
}

/// Half-days in words, morning first.
const HALF_DAYS: [(&str, &str); 10] = [
    ("a. m.", "AM"),
    ("p. m.", "PM"),
    ("a.m.", "AM"),
    ("p.m.", "PM"),
    ("午前", "AM"),
    ("午後", "PM"),
    ("上午", "AM"),
    ("下午", "PM"),
    ("오전", "AM"),
    ("오후", "PM"),
];
/// Eras that years are counted in, with the year before their first.
const ERAS: [(&str, u32); 2] = [("令和", 2018), ("平成", 1988)];

/// A date or time of day with numbers and marks for what is written in words: `2026年3月19日 午前11時40分` and `令和8年3月19日` as
/// `2026/3/19 11:40 AM`.
pub fn in_digits(raw: &str) -> Cow<'_, str> {
    if raw.is_ascii() && !raw.contains("m.") {
        return Cow::Borrowed(raw);
    }
    let mut text = half_width(raw).into_owned();
    for (era, before) in ERAS {
        let year = text.split_once(era).and_then(|(_, rest)| rest.split_once('年'));
        let year = year
            .and_then(|(year, _)| Some((year.to_owned(), if year == "元" { 1 } else { year.parse().ok()? })));
        if let Some((written, number)) = year {
            let number: u32 = number;
            text = text.replacen(&format!("{era}{written}"), &(before + number).to_string(), 1);
        }
    }
    let mut half = None;
    for (word, latin) in HALF_DAYS {
        if let Some(at) = text.find(word) {
            text.replace_range(at..at + word.len(), " ");
            half = Some(latin);
        }
    }
    let mark = |c: char| match c {
        '年' | '月' | '년' | '월' => Some('/'),
        '日' | '일' => Some(' '),
        '時' | '时' | '点' | '分' | '시' | '분' => Some(':'),
        '秒' | '초' => None,
        c => Some(c),
    };
    let marked: String = text.chars().filter_map(mark).collect();
    let words: Vec<&str> = marked
        .split_whitespace()
        .map(|word| word.trim_end_matches(':'))
        .collect();
    Cow::Owned(words.into_iter().chain(half).collect::<Vec<_>>().join(" "))
}

/// The date and time in a text that holds nothing else: `05/26/2000 10:11:12.5 AM`, `Dec. 24, 2026   20:15:16`. The hour 24 is the
/// first of the next day.
pub fn civil(raw: &str, order: DateOrder) -> Option<DateTime> {
    let raw = &*in_digits(raw);
    let words = words(&date_first(raw))?;
    let [a, b, c, hour, minute, rest @ ..] = words.numbers() else {
        return None;
    };
    let (year, month, day) = match order {
        DateOrder::YearFirst => (a, b, c),
        DateOrder::MonthFirst => (c, a, b),
        DateOrder::DayFirst => (c, b, a),
    };
    let small = |(number, _): &(u32, usize)| i8::try_from(*number).ok();
    let year = match year {
        (number, 4) => *number,
        (number, 2) => 2000 + number,
        _ => return None,
    };
    let date = Date::new(i16::try_from(year).ok()?, small(month)?, small(day)?).ok()?;
    let (second, nanosecond) = match rest {
        [] => (0, 0),
        [second] => (small(second)?, 0),
        [second, (fraction, digits)] if *digits <= 9 => {
            let scale = 10u64.pow(9 - *digits as u32);
            (small(second)?, (u64::from(*fraction) * scale) as i32)
        }
        _ => return None,
    };
    let hour = match (small(hour)?, words.afternoon) {
        (24, None) if small(minute)? == 0 && (second, nanosecond) == (0, 0) => {
            return date
                .tomorrow()
                .ok()
                .map(|next| next.to_datetime(jiff::civil::Time::midnight()));
        }
        (hour, None) => hour,
        (hour @ 0..=12, Some(afternoon)) => hour % 12 + if afternoon { 12 } else { 0 },
        _ => return None,
    };
    let time = jiff::civil::Time::new(hour, small(minute)?, second, nanosecond).ok()?;
    Some(date.to_datetime(time))
}

/// The text with its date before its time of day: some loggers write `23:00:00 28/Mar/2026`.
fn date_first(raw: &str) -> Cow<'_, str> {
    let Some((first, rest)) = raw.trim().split_once(char::is_whitespace) else {
        return Cow::Borrowed(raw);
    };
    if !first.contains(':') || rest.contains(':') {
        return Cow::Borrowed(raw);
    }
    let rest = rest.trim_start();
    let half = rest
        .get(..2)
        .filter(|half| ["am", "pm"].contains(&half.to_lowercase().as_str()));
    match half {
        Some(half) => Cow::Owned(format!("{} {first} {half}", &rest[2..])),
        None => Cow::Owned(format!("{rest} {first}")),
    }
}

/// Most numbers that a date with a time of day holds: year, month, day, hour, minute, second, fraction.
const MOST_NUMBERS: usize = 7;

/// Numbers with their count of digits, and AM or PM. Logs hold a date in each of a million rows, so nothing is
/// allocated.
struct Words {
    found: [(u32, usize); MOST_NUMBERS],
    count: usize,
    afternoon: Option<bool>,
}

impl Words {
    fn numbers(&self) -> &[(u32, usize)] {
        &self.found[..self.count]
    }

    fn push(&mut self, number: u32, digits: usize) -> Option<()> {
        *self.found.get_mut(self.count)? = (number, digits);
        self.count += 1;
        Some(())
    }
}

/// Beginnings of the names of months in English, German, French, Spanish, Italian and Portuguese, without accents.
const MONTHS: [&[&str]; 12] = [
    &["jan", "ene", "gen", "janv"],
    &["feb", "fev", "febr"],
    &["mar", "mae", "mrz", "mars"],
    &["apr", "avr", "abr"],
    &["may", "mai", "mag"],
    &["jun", "juin", "giu"],
    &["jul", "juil", "lug"],
    &["aug", "aou", "ago"],
    &["sep", "set", "sept"],
    &["oct", "okt", "ott", "out"],
    &["nov"],
    &["dec", "dez", "dic"],
];

/// The number of a month by its name.
fn month(word: &str) -> Option<u32> {
    let lower = word.to_ascii_lowercase();
    let begins = |names: &&[&str]| names.iter().any(|name| lower.starts_with(name));
    MONTHS.iter().position(begins).map(|at| at as u32 + 1)
}

fn words(raw: &str) -> Option<Words> {
    let mut words = Words {
        found: [(0, 0); MOST_NUMBERS],
        count: 0,
        afternoon: None,
    };
    let mut rest = raw.trim();
    while let Some(first) = rest.bytes().next() {
        let kind = |byte: u8| (byte.is_ascii_digit(), byte.is_ascii_alphabetic());
        let end = rest.bytes().position(|byte| kind(byte) != kind(first));
        let (word, tail) = rest.split_at(end.unwrap_or(rest.len()));
        rest = tail;
        if first.is_ascii_digit() {
            words.push(word.parse().ok()?, word.len())?;
        } else if word.eq_ignore_ascii_case("am") {
            words.afternoon = Some(false);
        } else if word.eq_ignore_ascii_case("pm") {
            words.afternoon = Some(true);
        } else if first.is_ascii_alphabetic() {
            match month(word) {
                Some(month) => words.push(month, 2)?,
                None if word.eq_ignore_ascii_case("t") => {}
                None => return None,
            }
        } else if !word.bytes().all(|byte| b" \t.,:/-".contains(&byte)) {
            return None;
        }
    }
    Some(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn local(raw: &str, order: DateOrder) -> Option<String> {
        civil(raw, order).map(|local| local.to_string())
    }

    #[test]
    fn dates_in_a_fixed_order() {
        use DateOrder::{DayFirst, MonthFirst, YearFirst};
        for (raw, order, expected) in [
            (
                "06/14/2026 16:30:52.260",
                MonthFirst,
                Some("2026-06-14T16:30:52.26"),
            ),
            ("03-04-2020 11.12.13", MonthFirst, Some("2020-03-04T11:12:13")),
            (
                "Dec. 24, 2026   20:15:16",
                MonthFirst,
                Some("2026-12-24T20:15:16"),
            ),
            ("May 3, 2019  01:02:03", MonthFirst, Some("2019-05-03T01:02:03")),
            ("05/26/00 12:00:42 AM", MonthFirst, Some("2000-05-26T00:00:42")),
            ("24/07/20 13:00", DayFirst, Some("2020-07-24T13:00:00")),
            ("2026-05-13 10:20:30", YearFirst, Some("2026-05-13T10:20:30")),
            ("23:00:00 28/Mar/2026", DayFirst, Some("2026-03-28T23:00:00")),
            ("11:00:00 PM 28/03/2026", DayFirst, Some("2026-03-28T23:00:00")),
            (
                "2026年3月19日 11時40分05秒",
                YearFirst,
                Some("2026-03-19T11:40:05"),
            ),
            ("2026/03/19 午後1:40:00", YearFirst, Some("2026-03-19T13:40:00")),
            (
                "令和8年3月19日 午後0時05分",
                YearFirst,
                Some("2026-03-19T12:05:00"),
            ),
            ("令和8年3月19日 0時05分", YearFirst, Some("2026-03-19T00:05:00")),
            ("19/03/2026 12:20:00 p. m.", DayFirst, Some("2026-03-19T12:20:00")),
            ("12.05.2026 24:00:00", DayFirst, Some("2026-05-13T00:00:00")),
            ("12.05.2026 24:00:01", DayFirst, None),
            ("28. Okt 2026 10:00", DayFirst, Some("2026-10-28T10:00:00")),
            ("31/12/2020 10:00:00", MonthFirst, None),
            ("2026-05-13", YearFirst, None),
            ("DD.MM.YYYY HH:MM:SS", DayFirst, None),
            ("05/26/2000 13:00:00 PM", MonthFirst, None),
            ("", YearFirst, None),
        ] {
            assert_eq!(local(raw, order).as_deref(), expected, "{raw}");
        }
    }

    #[test]
    fn day_numbers() {
        let local = |days, fine| from_day_number(days, fine).map(|local| local.to_string());
        assert_eq!(
            local(45_579.933_380, false).as_deref(),
            Some("2024-10-14T22:24:04")
        );
        assert_eq!(
            local(45_301.250_000_625, true).as_deref(),
            Some("2024-01-10T06:00:00.054")
        );
        assert_eq!((local(f64::NAN, true), local(1e12, false)), (None, None));
    }
}
