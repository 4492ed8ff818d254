//! The moments of a logger's rows: dates in the order that fits all of them, offsets, and a clock set back.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use crate::formats::policy::{DOUBT_BITS, GOING_BACK_SHARE};
use crate::formats::stamp::{self, DateOrder};
use ieap_numerics::robust::upper_median;

/// A year, s.
const YEAR_S: f64 = 31_557_600.0;
/// By how much clocks go back at the end of summer time, s.
const SUMMER_TIME_S: f64 = 3600.0;

/// The moments of all rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// Order of day, month and year.
    pub order: DateOrder,
    /// What the clock showed at the first row; UTC where the rows state offsets.
    pub first: DateTime,
    /// Time since the first row, s; an hour that the clock was set back by is counted.
    pub elapsed_s: Vec<f64>,
    /// Where the clock was set back by an hour: time since the first row, and seconds.
    pub set_back: Vec<(f64, f64)>,
    /// Whether each row states its offset from UTC.
    pub in_utc: bool,
}

/// Why no order of day, month and year can be taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoOrder {
    /// None makes all rows dates that follow each other.
    Fits,
    /// These fit alike.
    Several(Vec<DateOrder>),
}

/// Reads the dates of all rows under that one of `orders` in which their steps are the most alike and go forward.
///
/// # Errors
/// No order fits, or two fit about equally well.
pub fn moments(texts: &[&str], orders: &[DateOrder]) -> Result<Moments, NoOrder> {
    moments_in(texts, orders, None, GOING_BACK_SHARE)
}

/// As [`moments`], of a clock in a zone (the moments are in UTC then), of whose rows a share may go back.
///
/// # Errors
/// As [`moments`].
pub fn moments_in(
    texts: &[&str],
    orders: &[DateOrder],
    zone: Option<&TimeZone>,
    most_back: f64,
) -> Result<Moments, NoOrder> {
    let mut read_as: Vec<(f64, DateOrder, Vec<DateTime>)> = Vec::new();
    let in_utc = texts.first().is_some_and(|text| with_offset(text).is_some());
    for &order in orders {
        let read = |text: &&str| match (in_utc, with_offset(text)) {
            (true, Some((date, offset_s))) => {
                let span = jiff::SignedDuration::from_secs(offset_s);
                stamp::civil(date, order)?.checked_sub(span).ok()
            }
            (false, None) => utc_in(zone, stamp::civil(text, order)?),
            _ => None,
        };
        let Some(read) = texts.iter().map(read).collect::<Option<Vec<DateTime>>>() else {
            continue;
        };
        let back = read.windows(2).filter(|pair| pair[1] < pair[0]).count();
        if back as f64 > (most_back * read.len() as f64).max(1.0) {
            continue;
        }
        read_as.push((price(&read), order, read));
    }
    let least = read_as
        .iter()
        .map(|(price, ..)| *price)
        .fold(f64::INFINITY, f64::min);
    read_as.retain(|(price, ..)| *price < least + DOUBT_BITS);
    match read_as.len() {
        0 => Err(NoOrder::Fits),
        1 => {
            let (_, order, read) = read_as.remove(0);
            Ok(elapsed(order, &read, in_utc || zone.is_some()))
        }
        _ => Err(NoOrder::Several(
            read_as.into_iter().map(|(_, order, _)| order).collect(),
        )),
    }
}

/// What a clock shows, in UTC where its zone is known.
fn utc_in(zone: Option<&TimeZone>, local: DateTime) -> Option<DateTime> {
    let Some(zone) = zone else {
        return Some(local);
    };
    let zoned = local.to_zoned(zone.clone()).ok()?;
    Some(TimeZone::UTC.to_datetime(zoned.timestamp()))
}

/// What the steps of rows tell against an order of their dates, in bits: the usual step costs nothing, any other as much as it
/// differs from that, and one back ten more.
fn price(read: &[DateTime]) -> f64 {
    const BACK_BITS: f64 = 10.0;
    let steps_s: Vec<f64> = (read.windows(2))
        .map(|pair| pair[1].duration_since(pair[0]).as_secs_f64())
        .collect();
    let mut sizes: Vec<f64> = steps_s.iter().map(|step| step.abs()).collect();
    let usual = upper_median(&mut sizes).unwrap_or(0.0).max(1.0);
    let of_step = |step: &f64| {
        let back = if *step < 0.0 { BACK_BITS } else { 0.0 };
        (1.0 + (step - usual).abs() / usual).log2() + back
    };
    steps_s.iter().map(of_step).sum()
}

fn elapsed(order: DateOrder, read: &[DateTime], in_utc: bool) -> Moments {
    let first = read[0];
    let since = |moment: &DateTime| moment.duration_since(first).as_secs_f64();
    let clock_s: Vec<f64> = read.iter().map(since).collect();
    let interval_s = median_step(&clock_s);
    let mut set_back: Vec<(f64, f64)> = Vec::new();
    let mut total_s = 0.0;
    let mut elapsed_s: Vec<f64> = Vec::with_capacity(clock_s.len());
    let mut ahead_from: Option<usize> = None;
    for (index, &clock) in clock_s.iter().enumerate() {
        let step = if index == 0 {
            interval_s
        } else {
            clock - clock_s[index - 1]
        };
        if !in_utc && is_usual(step - SUMMER_TIME_S, interval_s) {
            ahead_from = Some(index);
        }
        if !in_utc && is_set_back(step, interval_s) {
            // An hour that the clock was ahead by is taken back, and no hour came twice.
            if let Some(from) = ahead_from.take() {
                elapsed_s[from..]
                    .iter_mut()
                    .for_each(|ahead_s| *ahead_s -= SUMMER_TIME_S);
                elapsed_s.push(clock + total_s);
                continue;
            }
            total_s += SUMMER_TIME_S;
            set_back.push((clock + total_s, SUMMER_TIME_S));
        }
        elapsed_s.push(clock + total_s);
    }
    // Summer time ends once a year: a clock that goes back more often is faulty, and its rows out of order go.
    let years = elapsed_s.last().copied().unwrap_or(0.0) / YEAR_S;
    if set_back.len() as f64 > years + 1.0 {
        (elapsed_s, set_back) = (clock_s, Vec::new());
    }
    Moments {
        order,
        first,
        elapsed_s,
        set_back,
        in_utc,
    }
}

/// Whether a step is the usual one on a clock that was set back by an hour meanwhile.
fn is_set_back(step_s: f64, interval_s: f64) -> bool {
    step_s <= 0.0 && interval_s <= SUMMER_TIME_S && is_usual(step_s + SUMMER_TIME_S, interval_s)
}

/// Whether a step is about the usual one.
fn is_usual(step_s: f64, interval_s: f64) -> bool {
    (step_s - interval_s).abs() <= (0.1 * interval_s).max(2.0)
}

fn median_step(clock_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = clock_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    upper_median(&mut steps).unwrap_or(0.0)
}

/// A date without its offset from UTC, and that offset, s: `2026-11-20T10:00:00+02:00`, `...Z`.
pub(crate) fn with_offset(text: &str) -> Option<(&str, i64)> {
    let text = text.trim();
    if let Some(date) = text.strip_suffix(['Z', 'z']) {
        return Some((date, 0));
    }
    if let Some(date) = text.strip_suffix("UTC").or_else(|| text.strip_suffix("GMT")) {
        return Some((date, 0));
    }
    // A date such as 2026-11-20 alone ends so, too: an offset follows a time of day.
    let colon = text.find(':')?;
    let sign = colon + text[colon..].rfind(['+', '-'])?;
    let (date, offset) = text.split_at(sign);
    offset_s(offset).map(|offset| (date, offset))
}

/// `+02:00`, `+0200` or `+02` in seconds.
pub fn offset_s(offset: &str) -> Option<i64> {
    let (sign, rest) = match offset.as_bytes().first()? {
        b'+' => (1, &offset[1..]),
        b'-' => (-1, &offset[1..]),
        _ => return None,
    };
    let (hours, minutes) = match rest.split_once(':') {
        Some(parts) => parts,
        None if rest.len() == 4 && rest.is_ascii() => rest.split_at(2),
        None => (rest, "00"),
    };
    let part = |text: &str| (text.len() == 2).then(|| text.parse::<i64>().ok()).flatten();
    let (hours, minutes) = (part(hours)?, part(minutes)?);
    (hours <= 18 && minutes < 60).then_some(sign * (3600 * hours + 60 * minutes))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: &[DateOrder] = &[DateOrder::MonthFirst, DateOrder::DayFirst, DateOrder::YearFirst];

    #[test]
    fn an_hour_that_comes_twice_is_counted_twice() {
        let texts = [
            "2026-10-25 03:40:00",
            "2026-10-25 03:50:00",
            "2026-10-25 03:00:00",
            "2026-10-25 03:10:00",
        ];
        let found = moments(&texts, ALL).unwrap();
        assert_eq!(found.elapsed_s, [0.0, 600.0, 1200.0, 1800.0]);
        assert_eq!(found.set_back, [(1200.0, 3600.0)]);
        let hourly = [
            "2026-10-25 02:00:00",
            "2026-10-25 03:00:00",
            "2026-10-25 03:00:00",
            "2026-10-25 04:00:00",
        ];
        let found = moments(&hourly, ALL).unwrap();
        assert_eq!(found.elapsed_s, [0.0, 3600.0, 7200.0, 10800.0]);
    }

    #[test]
    fn an_hour_that_the_clock_was_ahead_by_for_a_while_is_no_gap() {
        let texts = [
            "08 01:55", "08 02:00", "08 03:05", "08 03:10", "08 02:15", "08 02:20",
        ];
        let texts: Vec<String> = texts.iter().map(|text| format!("2026-03-{text}:00")).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let found = moments(&texts, ALL).unwrap();
        assert_eq!(found.elapsed_s, [0.0, 300.0, 600.0, 900.0, 1200.0, 1500.0]);
        assert_eq!(found.set_back, []);
    }

    #[test]
    fn a_clock_that_goes_back_every_hour_is_faulty() {
        let texts: Vec<String> = (0..400)
            .map(|k| format!("2026-10-25 {:02}:{:02}:00", 3 + k / 200, k % 200 * 60 / 200))
            .collect();
        let mut texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let again: Vec<&str> = texts[..200].to_vec();
        texts.splice(200..200, again.iter().copied());
        texts.splice(400..400, again);
        let found = moments(&texts, ALL).unwrap();
        assert_eq!((found.set_back.len(), found.elapsed_s[200]), (0, 0.0));
    }

    #[test]
    fn a_clock_set_right_by_seconds_is_not_an_hour() {
        let texts = [
            "2026-01-01 10:00:00",
            "2026-01-01 10:01:00",
            "2026-01-01 10:00:58",
            "2026-01-01 10:02:00",
        ];
        let found = moments(&texts, ALL).unwrap();
        assert_eq!((found.set_back.len(), found.elapsed_s[2]), (0, 58.0));
    }

    #[test]
    fn rows_that_state_offsets_are_read_as_utc() {
        let texts = [
            "2026-10-25T03:50:00+03:00",
            "2026-10-25T03:00:00+02:00",
            "2026-10-25T01:10:00Z",
        ];
        let found = moments(&texts, ALL).unwrap();
        assert!(found.in_utc);
        assert_eq!(found.first.to_string(), "2026-10-25T00:50:00");
        assert_eq!(found.elapsed_s, [0.0, 600.0, 1200.0]);
        assert_eq!(
            moments(&["2026-10-25T03:50:00Z", "2026-10-25T03:55:00"], ALL),
            Err(NoOrder::Fits)
        );
    }

    #[test]
    fn two_orders_are_told_apart_or_refused() {
        assert!(matches!(
            moments(&["01/02/26 10:00", "01/02/26 11:00"], ALL),
            Err(NoOrder::Several(_))
        ));
        let found = moments(&["12/02/26 10:00", "13/02/26 10:00"], ALL);
        assert!(matches!(found, Err(NoOrder::Several(_))), "{found:?}");
        let found = moments(&["30/01/2026 10:00", "01/02/2026 10:00"], ALL).unwrap();
        assert_eq!(found.order, DateOrder::DayFirst);
    }
}
