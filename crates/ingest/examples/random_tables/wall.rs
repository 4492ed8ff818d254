//! Forms of date and time.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use crate::clock::digits;
use crate::dice::Dice;
use crate::truth::{SECOND, Truth};

/// Order and marks of a date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DateForm {
    /// `2026-03-28T23:00:00`.
    IsoT,
    /// `2026-03-28 23:00:00`.
    Iso,
    /// Year, month, day with slashes.
    YearFirst,
    /// Day, month, year with this mark; the year in two or four digits.
    DayFirst(char, bool),
    /// Month, day, year with slashes; the year in two or four digits.
    MonthFirst(bool),
    /// `28-Mar-2026`.
    MonthName,
    /// `2026年3月28日`.
    Kanji,
    /// `令和8年3月28日`.
    Era,
    /// Seconds or milliseconds since 1970.
    Epoch { ms: bool },
}

/// Offset from UTC as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Zone {
    /// Not at all.
    None,
    /// `Z`.
    Z,
    /// `+02:00`: minutes, and whether there is a colon.
    Offset(i32, bool),
}

/// How the half-days are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HalfDay {
    /// They are not: 24 hours.
    No,
    /// In front of the time, noon and midnight as 0.
    Before([&'static str; 2]),
    /// Behind it, noon and midnight as 12.
    Behind([&'static str; 2]),
}

/// Form of date and time.
#[derive(Debug, Clone, Copy)]
pub struct Wall {
    /// Date.
    pub form: DateForm,
    /// Words of the half-days of a time of 12 hours.
    pub half_day: HalfDay,
    /// Digits behind the second; none where seconds are left out.
    pub digits: Option<usize>,
    /// Offset.
    pub zone: Zone,
    /// One column, or date and time of day, or time of day and date.
    pub columns: Layout,
}

/// Columns of date and time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One.
    One,
    /// Date, time.
    DateTime,
    /// Time, date.
    TimeDate,
}

impl Wall {
    /// The form of a single stamp, to the second.
    pub fn stamp(dice: &mut Dice) -> Wall {
        Wall {
            form: dice.pick(&[
                DateForm::IsoT,
                DateForm::Iso,
                DateForm::Iso,
                DateForm::DayFirst('.', false),
                DateForm::DayFirst('/', false),
                DateForm::MonthFirst(false),
                DateForm::MonthName,
                DateForm::YearFirst,
            ]),
            half_day: HalfDay::No,
            digits: Some(0),
            zone: Zone::None,
            columns: dice.pick(&[Layout::One, Layout::One, Layout::DateTime]),
        }
    }

    /// Draws the form of such a table's dates.
    pub fn random(dice: &mut Dice, truth: &Truth) -> Wall {
        let short = dice.chance(0.3);
        let form = dice.weighted(&[
            (4, DateForm::IsoT),
            (6, DateForm::Iso),
            (1, DateForm::YearFirst),
            (4, DateForm::DayFirst('.', short)),
            (3, DateForm::DayFirst('/', short)),
            (1, DateForm::DayFirst('-', short)),
            (4, DateForm::MonthFirst(short)),
            (1, DateForm::MonthName),
            (1, DateForm::Epoch { ms: false }),
            (1, DateForm::Epoch { ms: true }),
        ]);
        let fine = digits(truth);
        let on_minutes =
            truth.interval_us % (60 * SECOND) == 0 && truth.start_us % (60 * SECOND) == 0 && fine == 0;
        let digits = match fine {
            0 if on_minutes && dice.chance(0.5) => None,
            0 if dice.chance(0.85) => Some(0),
            _ if dice.chance(0.2) => Some(0),
            _ => Some(dice.pick(&[fine.max(1), 3, 6])),
        };
        let is_epoch = matches!(form, DateForm::Epoch { .. });
        let is_iso = matches!(form, DateForm::Iso | DateForm::IsoT);
        let zones = [
            Zone::Z,
            Zone::Offset(120, true),
            Zone::Offset(120, false),
            Zone::Offset(-330, true),
        ];
        let zone = if is_iso && dice.chance(0.3) {
            dice.pick(&zones)
        } else {
            Zone::None
        };
        let may_part = form != DateForm::IsoT && !is_epoch;
        let two = [Layout::DateTime, Layout::TimeDate];
        let columns = if may_part && dice.chance(0.25) {
            dice.pick(&two)
        } else {
            Layout::One
        };
        Wall {
            form,
            half_day: if matches!(form, DateForm::MonthFirst(_)) && dice.chance(0.5) {
                HalfDay::Behind([" AM", " PM"])
            } else {
                HalfDay::No
            },
            digits: if form == (DateForm::Epoch { ms: true }) {
                Some(3)
            } else {
                digits.or(is_epoch.then_some(0))
            },
            zone,
            columns,
        }
    }

    /// Gives it the date and half-days of a language, where that has its own.
    pub fn natively(&mut self, dice: &mut Dice, language: usize) {
        let is_plain = matches!(
            self.form,
            DateForm::Iso | DateForm::YearFirst | DateForm::DayFirst(..)
        ) && self.zone == Zone::None;
        if !is_plain || dice.chance(0.5) {
            return;
        }
        let (forms, half_day): (&[DateForm], HalfDay) = match language {
            3 => (
                &[DateForm::DayFirst('/', false)],
                HalfDay::Behind([" a. m.", " p. m."]),
            ),
            8 => (
                &[DateForm::YearFirst, DateForm::Kanji, DateForm::Era],
                HalfDay::Before(["午前", "午後"]),
            ),
            9 => (
                &[DateForm::YearFirst, DateForm::Kanji],
                HalfDay::Before(["上午", "下午"]),
            ),
            _ => return,
        };
        self.form = dice.pick(forms);
        if dice.chance(0.5) {
            self.half_day = half_day;
        }
    }

    /// What of it belongs to one language.
    pub fn oddity(&self) -> Option<&'static str> {
        match (self.form, self.half_day) {
            (_, HalfDay::Before(_)) => Some("half-days in words before the time"),
            (DateForm::DayFirst(..), HalfDay::Behind(_)) => Some("half-days in words behind the time"),
            (DateForm::Era, _) => Some("dates of an era"),
            (DateForm::Kanji, _) => Some("dates with their units"),
            _ => None,
        }
    }

    /// The moment that is left of `us` when it is written.
    pub fn written_us(&self, us: i64) -> i64 {
        let step = self
            .digits
            .map_or(60 * SECOND, |digits| SECOND / 10_i64.pow(digits as u32));
        us.div_euclid(step) * step
    }

    /// Date and time of day.
    pub fn texts(&self, us: i64, comma: char) -> (String, String) {
        let us = self.written_us(us);
        if let DateForm::Epoch { ms } = self.form {
            let digits = if ms { 0 } else { self.digits.unwrap_or(0) };
            let value = us as f64 / if ms { 1e3 } else { 1e6 };
            return (
                format!("{value:.digits$}").replace('.', &comma.to_string()),
                String::new(),
            );
        }
        let at = Timestamp::from_microsecond(us)
            .unwrap_or_default()
            .to_zoned(TimeZone::UTC)
            .datetime();
        let (year, month, day) = (at.year(), at.month(), at.day());
        let short = |short: bool| {
            if short {
                format!("{:02}", year % 100)
            } else {
                year.to_string()
            }
        };
        let date = match self.form {
            DateForm::YearFirst => format!("{year}/{month:02}/{day:02}"),
            DateForm::DayFirst(mark, is_short) => {
                format!("{day:02}{mark}{month:02}{mark}{}", short(is_short))
            }
            DateForm::Kanji => format!("{year}年{month}月{day}日"),
            DateForm::Era if (year, month) < (2019, 5) => format!("平成{}年{month}月{day}日", year - 1988),
            DateForm::Era => format!("令和{}年{month}月{day}日", year - 2018),
            DateForm::MonthFirst(is_short) if self.half_day != HalfDay::No => {
                format!("{month}/{day}/{}", short(is_short))
            }
            DateForm::MonthFirst(is_short) => format!("{month:02}/{day:02}/{}", short(is_short)),
            DateForm::MonthName => format!("{day:02}-{}-{year}", at.strftime("%b")),
            _ => format!("{year}-{month:02}-{day:02}"),
        };
        (date, self.time_of_day(us, comma) + &self.zone_text())
    }

    fn time_of_day(&self, us: i64, comma: char) -> String {
        let second = us.div_euclid(SECOND).rem_euclid(86_400);
        let (hour, minute) = (second / 3600, second / 60 % 60);
        let shown = match self.half_day {
            HalfDay::No => format!("{hour:02}"),
            HalfDay::Before(_) => (hour % 12).to_string(),
            HalfDay::Behind(_) => ((hour + 11) % 12 + 1).to_string(),
        };
        let mut text = format!("{shown}:{minute:02}");
        if let Some(digits) = self.digits {
            text += &seconds(us.rem_euclid(60 * SECOND), digits, comma);
        }
        let half = usize::from(hour >= 12);
        match self.half_day {
            HalfDay::No => text,
            HalfDay::Before(words) => words[half].to_owned() + &text,
            HalfDay::Behind(words) => text + words[half],
        }
    }

    fn zone_text(&self) -> String {
        match self.zone {
            Zone::None => String::new(),
            Zone::Z => "Z".to_owned(),
            Zone::Offset(minutes, colon) => {
                let (sign, size) = (if minutes < 0 { '-' } else { '+' }, minutes.abs());
                format!(
                    "{sign}{:02}{}{:02}",
                    size / 60,
                    if colon { ":" } else { "" },
                    size % 60
                )
            }
        }
    }

    /// The text of one column that holds both.
    pub fn whole(&self, us: i64, comma: char) -> String {
        let (date, time) = self.texts(us, comma);
        match self.form {
            DateForm::IsoT => format!("{date}T{time}"),
            DateForm::Epoch { .. } => date,
            _ => format!("{date} {time}"),
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        let (form, columns, zone) = (self.form, self.columns, self.zone);
        if let DateForm::Epoch { .. } = form {
            return format!("{form:?}");
        }
        let time = match self.half_day {
            HalfDay::No => String::new(),
            half => format!(" {half:?}"),
        };
        format!(
            "{form:?}{time} {columns:?} digits {:?} zone {zone:?}",
            self.digits
        )
    }
}

/// `:05.25` of a time within a minute.
pub fn seconds(us: i64, digits: usize, comma: char) -> String {
    let (whole, fraction) = (us / SECOND, us % SECOND / (SECOND / 10_i64.pow(digits as u32)));
    match digits {
        0 => format!(":{whole:02}"),
        _ => format!(":{whole:02}{comma}{fraction:0digits$}"),
    }
}
