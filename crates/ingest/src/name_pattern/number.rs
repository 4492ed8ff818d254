//! Numbers as names of files spell them.

use crate::text::dictionary::{HUMIDITY_OF_NAMES, is_among};
use ieap_domain::tag::keys;

/// Signs before a number; a `-` in a name is often a separator, so that people write letters. The longer spellings first.
const SIGNS: [(&str, f64); 9] = [
    ("minus", -1.0),
    ("plus", 1.0),
    ("neg", -1.0),
    ("pos", 1.0),
    ("-", -1.0),
    ("−", -1.0),
    ("+", 1.0),
    ("m", -1.0),
    ("p", 1.0),
];

/// Units that may stand behind the number of a key.
fn units(key: &str) -> &'static str {
    match key {
        keys::VOLTAGE_V => "v;volt;volts",
        keys::RELATIVE_HUMIDITY_PERCENT => HUMIDITY_OF_NAMES,
        keys::TEMPERATURE_C => "c;degc;°c",
        keys::REST_BEFORE_S => "s",
        _ => "",
    }
}

/// Of a voltage in millivolts; a lone m is the prefix of a V that stands behind the placeholder.
const MILLIVOLTS: [&str; 2] = ["mv", "m"];

/// The number that a text stands for under that key: `2.5`, `+2`, `m2` (minus two), `2V0`, `2,0V`, `-2000mV`, `35%`.
pub(crate) fn number(key: &str, text: &str) -> Option<f64> {
    let lower = text.to_lowercase();
    let is_signed = matches!(key, keys::VOLTAGE_V | keys::TEMPERATURE_C) || lower.starts_with('-');
    let signed = SIGNS
        .iter()
        .find_map(|(sign, factor)| Some((lower.strip_prefix(sign)?, *factor)));
    let (rest, sign) = signed.filter(|_| is_signed).unwrap_or((&lower, 1.0));
    let (whole, rest) = digits(rest)?;
    let fraction = |mark: char| {
        let behind = rest.strip_prefix(mark)?;
        digits(behind)
    };
    let marks: &[char] = if key == keys::VOLTAGE_V {
        &['.', ',', 'p', 'v']
    } else {
        &['.', ',', 'p']
    };
    let (written, unit) = match marks.iter().find_map(|mark| fraction(*mark)) {
        Some((fraction, rest)) => (format!("{whole}.{fraction}"), rest),
        None => (whole.to_owned(), rest),
    };
    let exponent = match unit {
        unit if key == keys::VOLTAGE_V && MILLIVOLTS.contains(&unit) => "e-3",
        unit if unit.is_empty() || is_among(units(key), unit) => "",
        _ => return None,
    };
    Some(sign * (written + exponent).parse::<f64>().ok()?)
}

/// The digits that a text begins with, at least one, and what stands behind them.
fn digits(text: &str) -> Option<(&str, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    (end > 0).then(|| text.split_at(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them_in_names() {
        for (text, volts) in [
            ("2", Some(2.0)),
            ("+2", Some(2.0)),
            ("p2", Some(2.0)),
            ("m2", Some(-2.0)),
            ("minus2V", Some(-2.0)),
            ("-0.7", Some(-0.7)),
            ("2V0", Some(2.0)),
            ("m2V5", Some(-2.5)),
            ("2p5V", Some(2.5)),
            ("2,0V", Some(2.0)),
            ("-2000mV", Some(-2.0)),
            ("1200m", Some(1.2)),
            ("1 V", None),
            ("2.", None),
            ("2..5", None),
            ("V", None),
            ("2A", None),
            ("", None),
        ] {
            assert_eq!(number(keys::VOLTAGE_V, text), volts, "{text}");
        }
        for (text, percent) in [
            ("35%", Some(35.0)),
            ("34rh", Some(34.0)),
            ("m34", None),
            ("2V0", None),
        ] {
            assert_eq!(number(keys::RELATIVE_HUMIDITY_PERCENT, text), percent, "{text}");
        }
    }
}
