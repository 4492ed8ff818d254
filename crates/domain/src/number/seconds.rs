//! Times in words, with the digits that they need: records last from microseconds to months.

use super::{fixed, plain, significant};

/// A time without its unit: whole from 10 s on, else with two significant digits; `600`, `1.5`, `0.052`, `5.2·10⁻⁶`.
pub fn seconds(time_s: f64) -> String {
    written(time_s, decimals(time_s))
}

/// A stretch of time, its ends told apart: `0.052 to 0.061 s`, `3600.01 to 3600.02 s`.
pub fn span(from_s: f64, to_s: f64) -> String {
    let text = |more: i32| {
        (
            written(from_s, decimals(from_s) + more),
            written(to_s, decimals(to_s) + more),
        )
    };
    let is_told = |(from, to): &(String, String)| from != to || from_s == to_s;
    // A number of 64 bits has no more than 17 digits.
    let ends = (0..17).map(text).find(is_told).unwrap_or_else(|| text(0));
    format!("{} to {} s", ends.0, ends.1)
}

/// A length of time in the unit that suits it, without its small change: `40 s`, `25 min`, `3.5 h`, `12 d`.
pub fn duration(seconds: f64) -> String {
    let with = |number: f64, unit: &str| {
        let tenths = if number < 10.0 { 10.0 } else { 1.0 };
        format!("{} {unit}", plain((tenths * number).round() / tenths))
    };
    match seconds {
        s if s < 90.0 => format!("{} s", plain(s.round())),
        s if s < 5400.0 => with(s / 60.0, "min"),
        s if s < 172_800.0 => with(s / 3600.0, "h"),
        s => with(s / 86_400.0, "d"),
    }
}

/// Decimals of a time that keep two significant digits below 10 s.
fn decimals(time_s: f64) -> i32 {
    let magnitude = time_s.abs();
    if magnitude > 0.0 && magnitude < 10.0 {
        1 - magnitude.log10().floor() as i32
    } else {
        0
    }
}

/// Below this a time is written with a power of ten, s.
const SHORT_S: f64 = 1e-3;

fn written(time_s: f64, decimals: i32) -> String {
    if time_s != 0.0 && time_s.abs() < SHORT_S {
        let leading = time_s.abs().log10().floor() as i32;
        return significant(time_s, decimals + leading + 1);
    }
    let text = fixed(time_s, decimals.max(0) as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn times_have_the_digits_that_they_need() {
        let said = [0.0, 600.0, 12.4, 1.5, 1.0, 0.052, 0.001, 5.2e-6, -0.25].map(seconds);
        assert_eq!(
            said,
            [
                "0",
                "600",
                "12",
                "1.5",
                "1",
                "0.052",
                "0.001",
                "5.2·10⁻⁶",
                "−0.25"
            ]
        );
        assert_eq!(span(0.0, 0.0), "0 to 0 s");
        assert_eq!(span(0.0012, 0.0048), "0.0012 to 0.0048 s");
        assert_eq!(span(0.05, 600.0), "0.05 to 600 s");
        assert_eq!(span(3600.01, 3600.02), "3600.01 to 3600.02 s");
        assert_eq!(span(1e-6, 1.2e-6), "1.0·10⁻⁶ to 1.2·10⁻⁶ s");
    }

    #[test]
    fn durations_are_told_in_the_unit_that_suits() {
        let said = [0.2, 40.0, 1500.0, 12_600.0, 1_036_800.0].map(duration);
        assert_eq!(said, ["0 s", "40 s", "25 min", "3.5 h", "12 d"]);
    }

    proptest! {
        #[test]
        fn ends_that_differ_are_told_apart(from_s in any::<f64>(), share in 1e-12..1.0f64) {
            let to_s = from_s * (1.0 + share);
            prop_assume!(from_s.is_finite() && to_s.is_finite() && from_s != to_s);
            let said = span(from_s, to_s);
            let (from, to) = said.trim_end_matches(" s").split_once(" to ").unwrap();
            prop_assert_ne!(from, to);
        }
    }
}
