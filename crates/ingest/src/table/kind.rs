//! What a cell can be, before anything is known of its column.

use crate::formats::stamp::{DateOrder, civil, in_digits};
use crate::table::duration;
use crate::table::numbers::is_readable;
use crate::text::number::{self, unquote};
use crate::text::{Cell, Decimal, Group};

/// The kind of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Nothing, or a word for it: it fits any column.
    Empty,
    /// A number, however its decimals and thousands are marked; `NaN` too.
    Number,
    /// A date with a time of day.
    Moment,
    /// A date alone.
    Date,
    /// A time of day or a duration: `10:00:00`, `0:01.5`, `1d 02:03:04`.
    Clock,
    /// Anything else.
    Word,
}

/// What instruments write for a reading that they could not take.
const GAPS: [&str; 18] = [
    "ovld", "ol", "o.l", "o.l.", "over", "overflow", "overload", "ovrng", "ovr", "+over", "-over", "open",
    "err", "error", "fault", "none", "missing", "bad",
];

/// The kind of a cell, which may be padded or quoted.
pub fn kind(cell: &str) -> Kind {
    let text = unquote(cell);
    if is_gap(text) {
        return Kind::Empty;
    }
    match number::parse(text, Decimal::Point) {
        Cell::Number(_) | Cell::NotFinite => return Kind::Number,
        Cell::Empty => return Kind::Empty,
        Cell::Text => {}
    }
    if !holds_digit(text) {
        return Kind::Word;
    }
    if pattern(text).is_some_and(|found| is_readable(&found)) {
        Kind::Number
    } else if text.contains([';', '|']) {
        // No date and no time of day holds these: that is told soonest where rows are split at another mark than theirs.
        Kind::Word
    } else if is_clock(text) {
        Kind::Clock
    } else if is_moment(text) {
        Kind::Moment
    } else if is_date(text) {
        Kind::Date
    } else {
        Kind::Word
    }
}

/// Whether a text is a date without a time of day.
fn is_date(text: &str) -> bool {
    let noon = format!("{text} 12:00");
    DateOrder::ALL
        .into_iter()
        .any(|order| civil(&noon, order).is_some())
}

fn holds_digit(text: &str) -> bool {
    text.bytes().any(|byte| byte.is_ascii_digit())
}

/// Whether a text is a time of day or a duration, with an offset from UTC or without.
fn is_clock(text: &str) -> bool {
    let bare = crate::formats::climate::moments::with_offset(text).map_or(text, |(bare, _)| bare);
    duration::fields(bare).is_some()
}

/// Whether a cell holds a word or marks in place of a reading.
pub fn is_gap(text: &str) -> bool {
    let marks = |c: char| matches!(c, '-' | '*' | '#' | '?' | '.' | '_');
    // No such word holds a digit, and nearly all cells do.
    text.len() <= 9
        && !holds_digit(text)
        && (!text.is_empty() && text.chars().all(marks) || GAPS.contains(&text.to_lowercase().as_str()))
}

/// Whether a text is a date with a time of day, in any order and with any offset.
pub fn is_moment(text: &str) -> bool {
    let text = &*in_digits(text);
    let date = crate::formats::climate::moments::with_offset(text).map_or(text, |(date, _)| date);
    date.contains([':', 'T', 't', '.', ' ']) && is_moment_in(date, &DateOrder::ALL)
}

/// Whether a text is a date with a time of day in one of these orders.
pub fn is_moment_in(text: &str, orders: &[DateOrder]) -> bool {
    let date = crate::formats::climate::moments::with_offset(text).map_or(text, |(date, _)| date);
    orders.iter().any(|order| civil(date, *order).is_some())
}

/// How a number is written: which marks stand in it, and how many digits between them.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pattern {
    /// Digits before the first mark.
    pub first: usize,
    /// Whether these begin with a zero (`0.400`).
    pub begins_with_zero: bool,
    /// Whether all digits are zeros.
    pub is_zero: bool,
    /// The marks, each with the digits behind it.
    pub marks: Vec<(char, usize)>,
    /// Whether the last digit behind a mark is a zero, which a writer that trims zeros leaves away.
    pub ends_in_zero: bool,
    /// Whether a power of ten follows.
    pub has_exponent: bool,
}

/// The pattern of a number that is written with any marks; none for other texts.
pub fn pattern(text: &str) -> Option<Pattern> {
    let mut found = Pattern::default();
    found.take(text)?;
    Some(found)
}

impl Pattern {
    /// Becomes the pattern of a number, as [`pattern`] gives it; nothing is allocated where it had as many marks before.
    pub fn take(&mut self, text: &str) -> Option<()> {
        let body = text.trim_start_matches(['+', '-', '\u{2212}']);
        if text[..text.len() - body.len()].chars().count() > 1 {
            return None;
        }
        let mut marks = std::mem::take(&mut self.marks);
        marks.clear();
        *self = Pattern {
            begins_with_zero: body.starts_with('0'),
            is_zero: true,
            marks,
            ..Pattern::default()
        };
        let bytes = body.as_bytes();
        let (mut any, mut at) = (false, 0);
        while at < bytes.len() {
            match bytes[at] {
                b'0'..=b'9' => {
                    let start = at;
                    while at < bytes.len() && bytes[at].is_ascii_digit() {
                        self.is_zero &= bytes[at] == b'0';
                        at += 1;
                    }
                    any = true;
                    match self.marks.last_mut() {
                        Some((_, count)) => *count += at - start,
                        None => self.first += at - start,
                    }
                }
                b'e' | b'E' | b'd' | b'D' => {
                    let power = body[at + 1..].trim_start_matches(['+', '-', '\u{2212}']);
                    if power.is_empty() || !power.bytes().all(|byte| byte.is_ascii_digit()) {
                        return None;
                    }
                    self.has_exponent = true;
                    break;
                }
                byte => {
                    let mark = if byte.is_ascii() {
                        char::from(byte)
                    } else {
                        body[at..].chars().next()?
                    };
                    // Two marks do not stand side by side.
                    if self.marks.last().is_some_and(|(_, count)| *count == 0) {
                        return None;
                    }
                    Group::of(mark)?;
                    self.marks.push((canonical(mark), 0));
                    at += mark.len_utf8();
                }
            }
        }
        self.ends_in_zero = !self.marks.is_empty() && bytes[..at].ends_with(b"0");
        (any && (self.first > 0 || self.marks.len() == 1)).then_some(())
    }
}

/// One character for all marks of a group.
fn canonical(mark: char) -> char {
    match Group::of(mark) {
        Some(Group::Apostrophe) => '\'',
        Some(Group::Space) => ' ',
        _ => mark,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_instruments_and_loggers_are_told_apart() {
        for (cell, expected) in [
            ("", Kind::Empty),
            ("OVLD", Kind::Empty),
            ("---.-", Kind::Empty),
            ("-1.5E-03", Kind::Number),
            ("1'006.4", Kind::Number),
            ("9,400", Kind::Number),
            ("\u{2212}2.5", Kind::Number),
            ("1.5D+01", Kind::Number),
            ("20260319", Kind::Number),
            ("2026-03-19 14:00:00.5", Kind::Moment),
            ("2026-03-19T14:00:00+0200", Kind::Moment),
            ("23:00:00 28/Mar/2026", Kind::Moment),
            ("28.03.2026 23:00", Kind::Moment),
            ("28.03.2026", Kind::Date),
            ("3/28/26", Kind::Date),
            ("10:00:00", Kind::Clock),
            ("10:00 PM", Kind::Clock),
            ("0:01", Kind::Clock),
            ("27:00:00", Kind::Clock),
            ("1d 02:03:04", Kind::Clock),
            ("1.02:03:04.5", Kind::Clock),
            ("Box 1", Kind::Word),
            ("Voltage (V)", Kind::Word),
            ("CH-1[V]", Kind::Word),
        ] {
            assert_eq!(kind(cell), expected, "{cell}");
        }
    }
}
