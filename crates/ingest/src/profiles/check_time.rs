//! Checks of what a profile says of time: its base, zone and order of dates, and the line that states a start.

use jiff::tz::{Offset, TimeZone};
use toml::Spanned;

use super::check::{Checker, shown, span};
use super::definition::{StartLine, TimeBase};
use super::error::ProfileError as Error;
use super::raw;
use crate::Timestamp;
use crate::formats::stamp::DateOrder;
use ieap_domain::Quantity;
use ieap_domain::unit;

const ORDERS: &str = "\"year-first\", \"month-first\" or \"day-first\"";
const BASES: &str = "\"elapsed\", \"epoch\", \"clock\", \"time-of-day\" or \"interval\"";

impl Checker<'_> {
    pub(super) fn time(&self, time: raw::Time, at: Option<usize>) -> Result<TimeBase, Error> {
        let base = self.word(&time.base, "[time] base")?;
        let column = || {
            let column = time.column.as_ref().ok_or_else(|| {
                self.refused(
                    at,
                    "[time] column",
                    "it is missing",
                    "the name of the time column, or its number",
                )
            })?;
            self.column_ref(column, "[time] column")
        };
        let unit = || {
            let text = time.unit.as_ref().map_or("", |unit| unit.get_ref());
            let conversion = unit::conversion(Quantity::Time, text).map_err(|error| {
                self.refused(
                    span(&time.unit).or(at),
                    "[time] unit",
                    &error.to_string(),
                    "the unit of the numbers",
                )
            })?;
            Ok((text.to_owned(), conversion))
        };
        let allowed: &[&str] = match base {
            Some("elapsed") => &["column", "unit"],
            Some("epoch") => &["column", "unit"],
            Some("clock") => &["column", "date_column", "order", "zone"],
            Some("time-of-day") => &["column"],
            Some("interval") => &["interval_s"],
            other => {
                let found = other.map_or("it is missing".to_owned(), shown);
                return Err(self.refused(span(&time.base).or(at), "[time] base", &found, BASES));
            }
        };
        let stated = [
            ("column", time.column.is_some()),
            ("date_column", time.date_column.is_some()),
            ("unit", time.unit.is_some()),
            ("order", time.order.is_some()),
            ("zone", time.zone.is_some()),
            ("interval_s", time.interval_s.is_some()),
        ];
        if let Some((key, _)) = stated.iter().find(|(key, is)| *is && !allowed.contains(key)) {
            let place = format!("[time] {key}");
            let needed = format!("for that base only {}", allowed.join(", "));
            let found = format!("it has no meaning beside base = {}", shown(base.unwrap_or("")));
            return Err(self.refused(at, &place, &found, &needed));
        }
        Ok(match base {
            Some("elapsed") => {
                let (unit, conversion) = unit()?;
                TimeBase::Elapsed {
                    column: column()?,
                    unit,
                    conversion,
                }
            }
            Some("epoch") => {
                let (unit, conversion) = unit()?;
                TimeBase::Epoch {
                    column: column()?,
                    unit,
                    conversion,
                }
            }
            Some("clock") => TimeBase::Clock {
                column: column()?,
                date_column: time
                    .date_column
                    .as_ref()
                    .map(|column| self.column_ref(column, "[time] date_column"))
                    .transpose()?,
                order: self.order(&time.order, "[time] order", at)?,
                zone: self.zone(&time.zone)?,
            },
            Some("time-of-day") => TimeBase::TimeOfDay { column: column()? },
            _ => {
                let interval_s = time.interval_s.as_ref().map(|interval| *interval.get_ref());
                match interval_s.filter(|interval| interval.is_finite() && *interval > 0.0) {
                    Some(interval_s) => TimeBase::Interval { interval_s },
                    None => {
                        let found = interval_s.map_or("it is missing".to_owned(), |found| found.to_string());
                        let at = span(&time.interval_s).or(at);
                        return Err(self.refused(
                            at,
                            "[time] interval_s",
                            &found,
                            "seconds between two rows",
                        ));
                    }
                }
            }
        })
    }

    fn order(
        &self,
        order: &Option<Spanned<String>>,
        place: &str,
        at: Option<usize>,
    ) -> Result<DateOrder, Error> {
        let word = self.word(order, place)?;
        word.and_then(DateOrder::from_key).ok_or_else(|| {
            let found = word.map_or("it is missing".to_owned(), shown);
            self.refused(span(order).or(at), place, &found, ORDERS)
        })
    }

    fn zone(&self, zone: &Option<Spanned<String>>) -> Result<Option<TimeZone>, Error> {
        let Some(name) = self.word(zone, "[time] zone")? else {
            return Ok(None);
        };
        match TimeZone::get(name).ok().or_else(|| offset_of(name)) {
            Some(zone) => Ok(Some(zone)),
            None => {
                let needed = "an IANA name such as \"Europe/Tallinn\" or \"UTC\", or an offset such as \"+02:00\"; leave \
                              it out where the campaign's own zone holds";
                Err(self.refused(span(zone), "[time] zone", &shown(name), needed))
            }
        }
    }

    pub(super) fn start(&self, start: Spanned<raw::Start>) -> Result<StartLine, Error> {
        let at = Some(start.span().start);
        let start = start.into_inner();
        let begins = start.line_begins.filter(|text| !text.is_empty()).ok_or_else(|| {
            self.refused(
                at,
                "[start] line_begins",
                "it is missing",
                "the text that the line begins with",
            )
        })?;
        let kind = match self.word(&start.kind, "[start] kind")? {
            Some("start") => Timestamp::Start,
            Some("end") => Timestamp::End,
            Some("export") => Timestamp::Export,
            other => {
                let found = other.map_or("it is missing".to_owned(), shown);
                let at = span(&start.kind).or(at);
                return Err(self.refused(at, "[start] kind", &found, "\"start\", \"end\" or \"export\""));
            }
        };
        Ok(StartLine {
            begins,
            order: self.order(&start.order, "[start] order", at)?,
            kind,
        })
    }
}

/// `+02:00`, `-0530`.
fn offset_of(text: &str) -> Option<TimeZone> {
    let (sign, digits) = match text.split_at_checked(1)? {
        ("+", digits) => (1, digits),
        ("-", digits) => (-1, digits),
        _ => return None,
    };
    let digits = digits.replace(':', "");
    if digits.len() != 4 || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (hours, minutes): (i32, i32) = (digits[..2].parse().ok()?, digits[2..].parse().ok()?);
    if hours > 14 || minutes > 59 {
        return None;
    }
    let offset = Offset::from_seconds(sign * (hours * 3600 + minutes * 60)).ok()?;
    Some(TimeZone::fixed(offset))
}
