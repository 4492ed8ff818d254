//! Checks of what a profile says of time: its base, zone and order of dates, and the line that states a start.

use jiff::tz::{Offset, TimeZone};
use toml::Spanned;

use super::check::{Checker, shown, span};
use super::error::ProfileError as Error;
use super::raw;
use crate::Timestamp;
use crate::formats::stamp::DateOrder;
use crate::table::stated::{StartLine, TimeBase};
use crate::table::zone;
use ieap_domain::Quantity;
use ieap_domain::unit;

impl Checker<'_> {
    pub(super) fn time(&self, time: raw::Time, at: usize) -> Result<TimeBase, Error> {
        let column = || {
            let needed = "the name of the time column, or its number";
            let column = time.column.as_ref();
            let column =
                column.ok_or_else(|| self.refused(Some(at), "[time] column", "it is missing", needed))?;
            self.column_ref(column, "[time] column")
        };
        let counted: &[&str] = &["column", "unit"];
        let bases = [
            ("elapsed", counted),
            ("epoch", counted),
            ("clock", &["column", "date_column", "order", "zone"]),
            ("time-of-day", &["column"]),
            ("interval", &["interval_s"]),
        ];
        let base = self.one_of(&time.base, "[time] base", at, &bases.map(|base| (base.0, base)))?;
        let stated = [
            ("column", time.column.is_some()),
            ("date_column", time.date_column.is_some()),
            ("unit", time.unit.is_some()),
            ("order", time.order.is_some()),
            ("zone", time.zone.is_some()),
            ("interval_s", time.interval_s.is_some()),
        ];
        let (base, allowed) = base;
        if let Some((key, _)) = stated.iter().find(|(key, is)| *is && !allowed.contains(key)) {
            let place = format!("[time] {key}");
            let needed = format!("for that base only {}", allowed.join(", "));
            let found = format!("it has no meaning beside base = {}", shown(base));
            return Err(self.refused(Some(at), &place, &found, &needed));
        }
        Ok(match base {
            "elapsed" | "epoch" => {
                let unit = time.unit.as_ref().map_or("", |unit| unit.get_ref());
                let conversion = unit::conversion(Quantity::Time, unit).map_err(|error| {
                    let at = span(&time.unit).or(Some(at));
                    self.refused(at, "[time] unit", &error.to_string(), "the unit of the numbers")
                })?;
                TimeBase::Counted {
                    column: column()?,
                    unit: unit.to_owned(),
                    conversion,
                    since_1970: base == "epoch",
                }
            }
            "clock" => {
                let date = time.date_column.as_ref();
                let date = date.map(|column| self.column_ref(column, "[time] date_column"));
                TimeBase::Clock {
                    columns: std::iter::once(column()).chain(date).collect::<Result<_, _>>()?,
                    order: self.one_of(&time.order, "[time] order", at, &orders())?,
                    zone: self.zone(&time.zone)?,
                }
            }
            "time-of-day" => TimeBase::TimeOfDay { column: column()? },
            _ => {
                let needed = "seconds between two rows";
                let rule = |interval: &f64| interval.is_finite() && *interval > 0.0;
                let interval_s = self.number(&time.interval_s, "[time] interval_s", needed, rule)?;
                let missing = || self.refused(Some(at), "[time] interval_s", "it is missing", needed);
                TimeBase::Interval {
                    interval_s: interval_s.ok_or_else(missing)?,
                }
            }
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
        let at = start.span().start;
        let start = start.into_inner();
        let needed = "the text that the line begins with";
        let begins = start.line_begins.filter(|text| !text.is_empty());
        let begins =
            begins.ok_or_else(|| self.refused(Some(at), "[start] line_begins", "it is missing", needed))?;
        let kinds = Timestamp::ALL.map(|kind| (kind.key(), kind));
        Ok(StartLine {
            begins,
            order: self.one_of(&start.order, "[start] order", at, &orders())?,
            kind: self.one_of(&start.kind, "[start] kind", at, &kinds)?,
        })
    }
}

/// The orders of a date by their words.
fn orders() -> [(&'static str, DateOrder); 3] {
    DateOrder::ALL.map(|order| (order.key(), order))
}

/// `+02:00`, `-0530`.
fn offset_of(text: &str) -> Option<TimeZone> {
    let is_plain = text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || b"+-:".contains(&byte));
    let minutes = zone::offset(text).filter(|_| is_plain)?;
    let offset = Offset::from_seconds(i32::try_from(60 * minutes).ok()?).ok()?;
    Some(TimeZone::fixed(offset))
}
