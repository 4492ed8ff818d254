//! Times of day and durations: `10:00:00`, `0:01.5`, `27:00:00`, `1d 02:03:04`, `1.02:03:04`, `2 days, 3:04:05`.

use crate::formats::stamp::in_digits;
use crate::text::number::unquote;

/// What the two fields of a time such as `0:42` are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TwoFields {
    /// Minutes and seconds.
    MinutesSeconds,
    /// Hours and minutes.
    HoursMinutes,
}

impl TwoFields {
    /// Both.
    pub const ALL: [TwoFields; 2] = [TwoFields::MinutesSeconds, TwoFields::HoursMinutes];

    /// As people write it, and as the answer to a question names it.
    pub fn word(self) -> &'static str {
        match self {
            TwoFields::MinutesSeconds => "mm:ss",
            TwoFields::HoursMinutes => "hh:mm",
        }
    }

    /// That a name states, as in `Elapsed time (mm:ss)`.
    pub fn stated_in(name: &str) -> Option<TwoFields> {
        let lower = name.to_lowercase();
        let holds = |forms: &[&str]| forms.iter().any(|form| lower.contains(form));
        if holds(&["h:mm:ss", "h:m:s"]) {
            None
        } else if holds(&["mm:ss", "m:ss", "min:s"]) {
            Some(TwoFields::MinutesSeconds)
        } else if holds(&["hh:mm", "h:mm", "h:min"]) {
            Some(TwoFields::HoursMinutes)
        } else {
            None
        }
    }
}

/// The parts of such a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fields {
    negative: bool,
    days: f64,
    /// Numbers between colons, the last with its fraction.
    parts: [f64; 3],
    /// How many of them there are.
    pub count: usize,
    /// Whether the last has a fraction.
    pub has_fraction: bool,
    /// Whether it says AM or PM, so that it is a time of day.
    pub is_of_day: bool,
    /// Whether it counts days, so that it is none.
    pub counts_days: bool,
}

/// The parts of a text that is a time and nothing else.
pub fn fields(text: &str) -> Option<Fields> {
    let text = in_digits(unquote(text));
    let (negative, text) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, &*text),
    };
    let first_colon = text.find(':')?;
    let (days, clock) = with_days(text, first_colon)?;
    let upper = clock.to_ascii_uppercase();
    let (digits, half) = match (upper.strip_suffix("AM"), upper.strip_suffix("PM")) {
        (Some(digits), _) => (digits.trim(), Some(0.0)),
        (_, Some(digits)) => (digits.trim(), Some(12.0)),
        _ => (upper.as_str(), None),
    };
    let mut found = Fields {
        negative,
        days,
        parts: [0.0; 3],
        count: 0,
        has_fraction: false,
        is_of_day: half.is_some(),
        counts_days: clock.len() < text.len(),
    };
    let mut pieces: Vec<&str> = digits.split(':').collect();
    // `10:00:00:250` ends in milliseconds.
    let milliseconds = match pieces.as_slice() {
        [_, _, _, last] if last.len() == 3 => pieces.pop(),
        _ => None,
    };
    if !(2..=3).contains(&pieces.len()) {
        return None;
    }
    for (index, piece) in pieces.iter().enumerate() {
        let is_last = index + 1 == pieces.len();
        let (whole, fraction) = piece.split_once(['.', ',']).unwrap_or((piece, ""));
        let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        let is_too_long = index > 0 && whole.len() != 2;
        if whole.is_empty() || !all_digits(whole) || !all_digits(fraction) || is_too_long || whole.len() > 7 {
            return None;
        }
        if (piece.contains(['.', ',']) && (!is_last || fraction.is_empty())) || (index > 0 && *whole > *"59")
        {
            return None;
        }
        found.parts[index] = format!("{whole}.{fraction}0").parse().ok()?;
        found.has_fraction |= !fraction.is_empty();
    }
    found.count = pieces.len();
    if let Some(digits) = milliseconds {
        found.parts[2] += digits.parse::<f64>().ok()? / 1000.0;
        found.has_fraction = true;
    }
    if let Some(half) = half {
        if !(0.0..13.0).contains(&found.parts[0]) {
            return None;
        }
        found.parts[0] = found.parts[0] % 12.0 + half;
    }
    Some(found)
}

/// Days before the time, and the time: `1d 02:03:04`, `1 day, 2:03:04`, `1.02:03:04`, `1 02:03:04`.
fn with_days(text: &str, first_colon: usize) -> Option<(f64, &str)> {
    let head = &text[..first_colon];
    let Some(cut) = head.rfind(|c: char| !c.is_ascii_digit()) else {
        return Some((0.0, text));
    };
    let cut_after = cut + head[cut..].chars().next()?.len_utf8();
    let word = head[..cut_after].trim_end_matches([' ', ',', '.', 'T']);
    let end = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
    let (number, unit) = word.split_at(end);
    let is_day = ["", "d", "day", "days", "tage", "tag", "j", "jours", "jour"]
        .contains(&unit.trim().to_lowercase().as_str());
    (is_day && number.len() <= 4).then_some((number.parse().ok()?, &text[cut_after..]))
}

impl Fields {
    /// Seconds; two fields are what `two` says.
    pub fn seconds(&self, two: TwoFields) -> f64 {
        let [a, b, c] = self.parts;
        let of_day = match (self.count, two) {
            (2, TwoFields::MinutesSeconds) => 60.0 * a + b,
            (2, TwoFields::HoursMinutes) => 3600.0 * a + 60.0 * b,
            _ => 3600.0 * a + 60.0 * b + c,
        };
        let seconds = 86_400.0 * self.days + of_day;
        if self.negative { -seconds } else { seconds }
    }

    /// Whether it may be a time of day: within one day, and nothing but that.
    pub fn fits_a_day(&self) -> bool {
        !self.negative && !self.counts_days && self.parts[0] < 24.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read_to_their_last_digit() {
        let seconds = |text: &str| fields(text).map(|found| found.seconds(TwoFields::MinutesSeconds));
        for (text, expected) in [
            ("00:42.5", Some(42.5)),
            ("2:01", Some(121.0)),
            ("23:59:50.0000000", Some(86390.0)),
            ("24:00:32", Some(86432.0)),
            ("1.00:00:32.5", Some(86432.5)),
            ("1d 02:03:04", Some(93784.0)),
            ("1 day, 2:03:04", Some(93784.0)),
            ("1 02:03:04", Some(93784.0)),
            ("-00:00:02", Some(-2.0)),
            ("10:00:00:250", Some(36000.25)),
            ("12:30:00 AM", Some(1800.0)),
            ("1:2:3", None),
            ("10:61", None),
            ("2026-03-19 14:00", None),
            ("a 10:00", None),
            ("\u{2077} note: 10", None),
        ] {
            assert_eq!(seconds(text), expected, "{text}");
        }
        let half = fields("1:30").unwrap();
        assert_eq!(half.seconds(TwoFields::HoursMinutes), 5400.0);
    }

    #[test]
    fn names_state_the_form() {
        assert_eq!(
            TwoFields::stated_in("Elapsed time (mm:ss)"),
            Some(TwoFields::MinutesSeconds)
        );
        assert_eq!(
            TwoFields::stated_in("Zeit [hh:mm]"),
            Some(TwoFields::HoursMinutes)
        );
        assert_eq!(TwoFields::stated_in("t (hh:mm:ss)"), None);
    }
}
