//! Values of tags: one spelling for each number and moment, and a reason where a value cannot be used.

use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};

use super::length;
use crate::scan::composed;
use ieap_domain::number::exact;
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Tag};

/// Why a value cannot be used, and how to mend it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Why.
    pub reason: &'static str,
    /// How to mend it.
    pub mend: &'static str,
}

/// The value as it is stored, or the issue that says why it cannot be used. `timezone` gives the offset of a
/// start that states none.
pub(super) fn checked(tag: &Tag, timezone: Option<&str>) -> Result<String, Issue> {
    match length::objection(tag) {
        Some(issue) => Err(issue),
        None => usable(&tag.key, &tag.value, timezone).map_err(|fault| unusable(tag, fault)),
    }
}

/// The value of that key as it is stored.
///
/// # Errors
/// Why no run can have it.
pub(crate) fn usable(key: &str, value: &str, timezone: Option<&str>) -> Result<String, Fault> {
    let text = value.trim();
    if text.is_empty() {
        return Err(Fault {
            reason: "it is empty",
            mend: "write a value, or take the line away",
        });
    }
    match key {
        keys::STARTED_AT => start(text, timezone),
        key if keys::NUMERIC.contains(&key) => number(key, text),
        _ => Ok(composed(text)),
    }
}

/// A number in the shortest form that reads back the same.
pub(crate) fn shortest(number: f64) -> String {
    // Minus zero is zero to whoever reads it.
    let plain = format!("{}", number + 0.0);
    let scientific = exact(number + 0.0);
    // 101325 stays as people write it; only what would be a row of zeros is written with an exponent.
    if plain.len() > 12 && scientific.len() < plain.len() {
        scientific
    } else {
        plain
    }
}

fn number(key: &str, text: &str) -> Result<String, Fault> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    let Some(number) = number else {
        return Err(Fault {
            reason: "it is not a number",
            mend: "write a number with a decimal point and without a unit, such as 2.5",
        });
    };
    let (possible, needed) = match key {
        keys::RELATIVE_HUMIDITY_PERCENT => (
            (0.0..=100.0).contains(&number),
            "a number from 0 to 100 is needed",
        ),
        keys::TEMPERATURE_C => (number > -273.15, "a number above -273.15 is needed"),
        keys::PRESSURE_PA | keys::REST_BEFORE_S => (number >= 0.0, "a number not below 0 is needed"),
        keys::CYCLE => (number >= 0.0 && number.fract() == 0.0, "a whole number is needed"),
        _ => (true, ""),
    };
    if possible {
        Ok(shortest(number))
    } else {
        Err(Fault {
            reason: needed,
            mend: "correct it",
        })
    }
}

/// RFC 3339 with the offset as stated, or with that of the campaign's time zone; a day stays a day.
fn start(text: &str, timezone: Option<&str>) -> Result<String, Fault> {
    if let Ok(moment) = text.parse::<Timestamp>() {
        return Ok(moment_with_offset(text).unwrap_or_else(|| moment.to_string()));
    }
    if let Some(day) = day(text) {
        return Ok(day);
    }
    // jiff reads an hour alone as a time of day.
    let local = text.parse::<DateTime>().ok().filter(|_| text.contains(':'));
    let Some(local) = local else {
        return Err(Fault {
            reason: "it is not a date",
            mend: "write date and time as 2026-11-20T10:00:00+02:00, or the day as 2026-11-20",
        });
    };
    let without = |reason| Fault {
        reason,
        mend: "state the offset, such as 2026-11-20T10:00:00+02:00, or `timezone` in campaign.toml",
    };
    let zone = timezone.and_then(|name| TimeZone::get(name).ok());
    let zone = zone.ok_or(without("it has no offset, and campaign.toml has no `timezone`"))?;
    match zone.to_ambiguous_zoned(local).unambiguous() {
        Ok(moment) => Ok(rfc_3339(&moment)),
        Err(_) => Err(without(
            "at that change of the clocks this time came twice or never",
        )),
    }
}

/// The day that a text states, where it states no time of day: `2026-11-20`.
pub(super) fn day(text: &str) -> Option<String> {
    let parser = jiff::fmt::temporal::DateTimeParser::new();
    let pieces = parser.parse_pieces(text).ok()?;
    pieces.time().is_none().then(|| pieces.date().to_string())
}

/// The text in one spelling, where it states a numeric offset.
fn moment_with_offset(text: &str) -> Option<String> {
    let pieces = jiff::fmt::temporal::DateTimeParser::new()
        .parse_pieces(text)
        .ok()?;
    let offset = pieces
        .to_numeric_offset()
        .filter(|_| !text.ends_with(['Z', 'z']))?;
    let moment = text.parse::<Timestamp>().ok()?;
    Some(rfc_3339(&moment.to_zoned(TimeZone::fixed(offset))))
}

fn rfc_3339(moment: &Zoned) -> String {
    moment
        .timestamp()
        .display_with_offset(moment.offset())
        .to_string()
}

fn unusable(tag: &Tag, fault: Fault) -> Issue {
    let origin = if tag.detail.is_empty() {
        String::new()
    } else {
        format!(": {}", tag.detail)
    };
    let message = format!(
        "`{} = {}` ({}{origin}) is not used: {}",
        tag.key,
        tag.value,
        tag.source.label(),
        fault.reason
    );
    Issue::warning("tag-unusable", message)
        .at(&tag.key)
        .mend(fault.mend)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use ieap_domain::TagSource;

    fn check(key: &str, value: &str, timezone: Option<&str>) -> Result<String, String> {
        let tag = Tag {
            key: key.to_owned(),
            value: value.to_owned(),
            source: TagSource::Sidecar,
            detail: "runs/a.csv.toml".to_owned(),
        };
        checked(&tag, timezone).map_err(|issue| issue.message)
    }

    #[test]
    fn numbers_have_one_spelling_and_must_be_possible() {
        for (key, text, expected) in [
            ("voltage_v", "2.50", Some("2.5")),
            ("voltage_v", " -0.70 ", Some("-0.7")),
            ("voltage_v", "-0.0", Some("0")),
            ("voltage_v", "2,5", None),
            ("voltage_v", "2.5 V", None),
            ("voltage_v", "nan", None),
            ("voltage_v", "inf", None),
            ("voltage_v", "", None),
            ("relative_humidity_percent", "05", Some("5")),
            ("relative_humidity_percent", "101", None),
            ("relative_humidity_percent", "-1", None),
            ("temperature_c", "-300", None),
            ("pressure_pa", "101325.0", Some("101325")),
            ("pressure_pa", "1e-6", Some("0.000001")),
            ("pressure_pa", "2.5e-13", Some("2.5e-13")),
            ("cycle", "003", Some("3")),
            ("cycle", "1.5", None),
            ("rest_before_s", "-1", None),
            ("free", " 2.50 ", Some("2.50")),
        ] {
            assert_eq!(check(key, text, None).ok().as_deref(), expected, "{key} {text}");
        }
        let said = check("voltage_v", "2,5", None).unwrap_err();
        assert_eq!(
            said,
            "`voltage_v = 2,5` (sidecar: runs/a.csv.toml) is not used: it is not a number"
        );
    }

    #[test]
    fn starts_get_the_offset_of_the_campaign() {
        let tallinn = Some("Europe/Tallinn");
        for (text, timezone, expected) in [
            ("2026-11-20T10:00:00Z", None, Some("2026-11-20T10:00:00Z")),
            (
                "2026-11-20T10:00:00+02:00",
                None,
                Some("2026-11-20T10:00:00+02:00"),
            ),
            (
                "2026-11-20 10:00:00+02:00",
                None,
                Some("2026-11-20T10:00:00+02:00"),
            ),
            ("2026-11-20T10:00:00", tallinn, Some("2026-11-20T10:00:00+02:00")),
            ("2026-07-20T10:00", tallinn, Some("2026-07-20T10:00:00+03:00")),
            ("2026-11-20T10:00:00", None, None),
            ("2026-10-25T03:30:00", tallinn, None), // came twice
            ("2026-03-29T03:30:00", tallinn, None), // never came
            ("2026-11-20", tallinn, Some("2026-11-20")),
            ("2026-11-31", tallinn, None),
            ("20.11.2026 10:00", tallinn, None),
        ] {
            assert_eq!(
                check("started_at", text, timezone).ok().as_deref(),
                expected,
                "{text}"
            );
        }
    }

    proptest! {
        #[test]
        fn the_shortest_text_reads_back(number in proptest::num::f64::NORMAL) {
            prop_assert_eq!(shortest(number).parse::<f64>().unwrap(), number);
        }
    }
}
