//! Dates as instrument software writes them: in the order of the computer's locale, which the file does not name.

use jiff::civil::{Date, DateTime, Time};

use super::error::quoted;
use crate::{StartedAt, Timestamp};
use ieap_domain::Issue;

/// Code of the issue of a date that is not used.
pub const DATE_UNCERTAIN: &str = "date-uncertain";

/// Why a date is not used whose parts may be read in two ways.
pub const EITHER_ORDER: &str = "day and month may stand in either order";

/// The issue of a date `raw` that is not used as the start, for that reason.
pub fn uncertain(raw: &str, reason: &str) -> Issue {
    let message = format!("{} is not used as the start: {reason}", quoted(raw));
    let by_tag = "tag the run with started_at = \"2024-03-10T12:00:00\"";
    Issue::warning(DATE_UNCERTAIN, message).mend(match reason {
        EITHER_ORDER => format!(
            "state date_order = \"day-first\" (or month-first) in campaign.toml, [campaign], keep the file beside one whose \
             date shows the order, or {by_tag}"
        ),
        _ => by_tag.to_owned(),
    })
}

/// Order of day and month, with the reason for it.
struct Order {
    day_first: bool,
    basis: String,
}

/// Reads a date and a time of day; without a time it is a day. `others` are further dates, written by the same software in the same order,
/// with the names they have in the file; they may decide what the date itself leaves open.
///
/// Returns the issue beside it where the order, or the whole stamp, stays unknown.
pub fn started_at(
    date: &str,
    time: &str,
    kind: Timestamp,
    others: &[(&str, &str)],
) -> (StartedAt, Option<Issue>) {
    let raw = format!("{date} {time}").trim().to_owned();
    let (local, basis) = match read(date, time, others) {
        Ok((local, basis)) => (Some(local), basis),
        Err(basis) => (None, basis),
    };
    let issue = local.is_none().then(|| uncertain(&raw, &basis));
    let stamp = StartedAt {
        raw,
        kind,
        local,
        offset: None,
        basis,
    };
    (stamp, issue)
}

fn read(date: &str, time: &str, others: &[(&str, &str)]) -> Result<(String, String), String> {
    let (mark, parts) = parts(date).ok_or("it holds no date of three numbers")?;
    let has_time = !time.trim().is_empty();
    let clock = has_time.then(|| clock(time).ok_or("its time of day cannot be read"));
    let clock = clock.transpose()?;
    let (order, [first, second, third]) = (order(mark, &parts, others), parts);
    let (year, month, day, basis) = match order {
        None if first > 31 => (first, second, third, "year first".to_owned()),
        None if clock.is_none() => return Err(format!("{EITHER_ORDER}, and it holds no time of day")),
        None => return Err(EITHER_ORDER.to_owned()),
        Some(Order {
            day_first: true,
            basis,
        }) => (third, second, first, basis),
        Some(Order {
            day_first: false,
            basis,
        }) => (third, first, second, basis),
    };
    if year < 1970 {
        return Err("the year has no four digits".to_owned());
    }
    let small = |part: u32| i8::try_from(part).map_err(|_| "no such day or month".to_owned());
    let date = Date::new(year as i16, small(month)?, small(day)?).map_err(|_| "no such day".to_owned())?;
    Ok(match clock {
        Some(clock) => (DateTime::from_parts(date, clock).to_string(), basis),
        None => (date.to_string(), format!("{basis}; a day, for no time is stated")),
    })
}

/// The separator and the three numbers of a date.
fn parts(date: &str) -> Option<(char, [u32; 3])> {
    let mark = date.chars().find(|c| matches!(c, '.' | '/' | '-'))?;
    let mut numbers = date.trim().split(mark).map(|part| match part.trim() {
        digits if digits.len() <= 4 && digits.chars().all(|c| c.is_ascii_digit()) => digits.parse().ok(),
        _ => None,
    });
    let parts = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some((mark, parts))
}

fn order(mark: char, parts: &[u32; 3], others: &[(&str, &str)]) -> Option<Order> {
    let [first, second, _] = *parts;
    if first > 31 {
        return None;
    }
    if let Some(order) = order_of_one(mark, first, second) {
        return Some(order);
    }
    others.iter().find_map(|(name, date)| {
        let (other_mark, [first, second, _]) = self::parts(date)?;
        let order =
            order_of_one(other_mark, first, second).filter(|_| other_mark == mark && first != second)?;
        Some(Order {
            basis: format!("{} in {name}: {}", order.basis, quoted(date)),
            ..order
        })
    })
}

fn order_of_one(mark: char, first: u32, second: u32) -> Option<Order> {
    let order = |day_first: bool, basis: &str| {
        Some(Order {
            day_first,
            basis: basis.to_owned(),
        })
    };
    match (first, second) {
        (13..=31, 1..=12) => order(true, "day first, for the first part exceeds 12"),
        (1..=12, 13..=31) => order(false, "month first, for the second part exceeds 12"),
        _ if mark == '.' => order(true, "day first, as dates with dots are written"),
        _ if first == second => order(true, "day and month are the same number"),
        _ => None,
    }
}

/// `9:55:44`, `17:18`, `2:05:00 PM`, `21:09:58.727375`.
fn clock(time: &str) -> Option<Time> {
    let upper = time.trim().to_ascii_uppercase();
    let (digits, afternoon) = match (upper.strip_suffix("AM"), upper.strip_suffix("PM")) {
        (Some(digits), _) => (digits.trim(), Some(false)),
        (_, Some(digits)) => (digits.trim(), Some(true)),
        _ => (upper.as_str(), None),
    };
    let mut parts = digits.split(':');
    let hour = parts.next()?.parse::<i8>().ok()?;
    let minute = parts.next()?.parse::<i8>().ok()?;
    let (second, nanosecond) = parts.next().map_or(Some((0, 0)), second)?;
    let hour = match afternoon {
        Some(_) if !(1..=12).contains(&hour) => return None,
        Some(is_afternoon) => hour % 12 + if is_afternoon { 12 } else { 0 },
        None => hour,
    };
    Time::new(hour, minute, second, nanosecond)
        .ok()
        .filter(|_| parts.next().is_none())
}

/// Seconds and nanoseconds of `58`, `58.727375` or `58,727`.
fn second(text: &str) -> Option<(i8, i32)> {
    let (whole, decimals) = text.split_once(['.', ',']).unwrap_or((text, "0"));
    let is_fraction = (1..=9).contains(&decimals.len()) && decimals.bytes().all(|byte| byte.is_ascii_digit());
    let nanosecond = format!("{decimals:0<9}").parse().ok()?;
    Some((whole.parse().ok()?, nanosecond)).filter(|_| is_fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn local(date: &str, time: &str) -> Option<String> {
        started_at(date, time, Timestamp::Start, &[]).0.local
    }

    #[test]
    fn the_order_of_day_and_month_is_decided_or_left_open() {
        for (date, time, expected) in [
            ("17.7.2024", "10:49:20", Some("2024-07-17T10:49:20")),
            ("2/13/2024", "9:55:44", Some("2024-02-13T09:55:44")),
            ("20-4-2023", "15:26", Some("2023-04-20T15:26:00")),
            ("12.11.2018", "18:49:49", Some("2018-11-12T18:49:49")),
            ("2024-03-10", "2:05:00 PM", Some("2024-03-10T14:05:00")),
            ("3/3/2019", "12:00:00 AM", Some("2019-03-03T00:00:00")),
            ("7/17/2024", "21:09:58.727375", Some("2024-07-17T21:09:58.727375")),
            ("17.7.2024", "21:09:58,5", Some("2024-07-17T21:09:58.5")),
            ("7/17/2024", "9:09:58.25 PM", Some("2024-07-17T21:09:58.25")),
            ("7/17/2024", "21:09:58.", None),
            ("7/17/2024", "21:09:58.7x", None),
            ("3/10/2019", "12:00:00", None),
            ("10-2-2020", "17:18:00", None),
            ("31/31/2020", "17:18:00", None),
            ("30/2/2020", "17:18:00", None),
            ("DD-M-YYYY", "HH:MM:SS", None),
            ("1/30/24", "10:00:00", None),
            ("1/30/2024", "25:00:00", None),
            ("1/30/2024", "13:00:00 PM", None),
            ("1/30/2024", "noon", None),
            ("1/30/2024", " ", Some("2024-01-30")),
            ("17.7.2024", "", Some("2024-07-17")),
            ("3/10/2019", "", None),
            ("", "", None),
        ] {
            assert_eq!(local(date, time).as_deref(), expected, "{date} {time}");
        }
    }

    #[test]
    fn what_stays_open_is_an_issue_and_another_date_may_decide() {
        let (stamp, issue) = started_at("3/10/2019", "12:00:00", Timestamp::Start, &[]);
        assert_eq!((stamp.raw.as_str(), stamp.local), ("3/10/2019 12:00:00", None));
        assert_eq!(issue.unwrap().code, "date-uncertain");
        let others = [("ENDDATE", "10.3.2019"), ("ENDDATE", "3/13/2019")];
        let (stamp, issue) = started_at("3/10/2019", "12:00:00", Timestamp::Start, &others);
        assert_eq!(
            (stamp.local.as_deref(), issue),
            (Some("2019-03-10T12:00:00"), None)
        );
        assert!(stamp.basis.contains("ENDDATE"), "{}", stamp.basis);
        let (day, issue) = started_at("3/10/2019", "", Timestamp::Start, &others);
        assert_eq!((day.local.as_deref(), issue), (Some("2019-03-10"), None));
        assert_eq!(day.moment(), None);
        assert!(
            day.basis.ends_with("a day, for no time is stated"),
            "{}",
            day.basis
        );
    }
}
