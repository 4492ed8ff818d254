//! Numbers as people read them: a value rounded by its uncertainty, powers of ten, SI prefixes, a real minus.
//!
//! Rounding follows the rule of the Particle Data Group (Review of Particle Physics, introduction, 5.3):
//! with the three leading digits of the uncertainty between 100 and 354 it keeps two digits, between 355
//! and 949 one, from 950 it rounds up to 1000 and keeps two. The value is rounded to the same place. So an
//! uncertainty is never rounded by more than a seventh, and no digit is printed that carries no information.
//!
//! Every `f64` can be printed, with any uncertainty: rounding ends in whole units of the last place, whose digits are
//! then set with a point or zeros, so that nothing is scaled back to a number that may not exist.

pub mod estimates;
mod machine;
pub mod probabilities;
pub mod seconds;

pub use machine::{digits, exact, scientific, to_digits};

/// Values from this power of ten on, or below its negative counterpart, are printed with a power of ten.
const PLAIN_UP_TO: i32 = 5;
const PLAIN_DOWN_TO: i32 = -2;
/// An uncertainty below this part of its value is not told: a number of 64 bits (2^-52 of itself) does not move by it.
const LEAST_UNCERTAINTY: f64 = f64::EPSILON;
/// Most significant digits asked for: what a number of 64 bits carries.
const MOST_DIGITS: i32 = 17;
/// Most decimals printed; beyond them a number of 64 bits is 0.
const MOST_DECIMALS: usize = 324;

/// A number in pieces, for writers with a notation of their own: digits with a real minus, the uncertainty at the
/// same place, and the power of ten that both share.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rounded {
    /// Digits of the value: `24.62`, `9.4`.
    pub value: String,
    /// Digits of the uncertainty, with as many decimals as the value; none where there is no uncertainty.
    pub error: Option<String>,
    /// Power of ten of both; none where the digits stand for themselves.
    pub exponent: Option<i32>,
}

impl Rounded {
    /// `24.62 ± 0.31`, `(9.4 ± 1.2)·10⁻⁵`
    pub fn text(&self) -> String {
        match (&self.error, self.power()) {
            (None, power) => format!("{}{power}", self.value),
            (Some(error), power) if power.is_empty() => format!("{} ± {error}", self.value),
            (Some(error), power) => format!("({} ± {error}){power}", self.value),
        }
    }

    /// The value alone: `9.4·10⁻⁵`
    pub fn value_text(&self) -> String {
        format!("{}{}", self.value, self.power())
    }

    /// Value, and `± 1.2·10⁻⁵` to stand below it; the second is empty where there is no uncertainty.
    pub fn stacked(&self) -> (String, String) {
        let error = self.error.as_ref();
        let error = error.map(|error| format!("± {error}{}", self.power()));
        (self.value_text(), error.unwrap_or_default())
    }

    /// `24.62(31)`: the uncertainty in units of the last digit, with a minus that machines read.
    pub fn concise(&self) -> String {
        let value = self.value.replace('−', "-");
        match &self.error {
            Some(error) => format!("{value}({})", error.replace('.', "").trim_start_matches('0')),
            None => value,
        }
    }

    /// Whether the digits are a number: what is not finite is printed as a dash.
    pub fn is_number(&self) -> bool {
        self.value
            .chars()
            .all(|c| c.is_ascii_digit() || c == '.' || c == '−')
    }

    /// `·10⁻⁵`, or nothing.
    fn power(&self) -> String {
        self.exponent.map(power_of_ten).unwrap_or_default()
    }
}

/// A value and its standard error, both rounded by the error. An error of zero, one that the value does not move by, or
/// one that is no number gives the value alone with three digits.
pub fn rounded(value: f64, standard_error: f64) -> Rounded {
    let is_told = standard_error > 0.0 && standard_error >= LEAST_UNCERTAINTY * value.abs();
    if !value.is_finite() || !standard_error.is_finite() || !is_told {
        return rounded_to(value, 3);
    }
    let place = rounding_place(standard_error);
    let leading = decimal_exponent(value.abs().max(standard_error));
    if (PLAIN_DOWN_TO..PLAIN_UP_TO).contains(&leading) {
        return Rounded {
            value: rounded_at(value, place),
            error: Some(rounded_at(standard_error, place)),
            exponent: None,
        };
    }
    let place = place - leading;
    Rounded {
        value: rounded_at(scaled(value, -leading), place),
        error: Some(rounded_at(scaled(standard_error, -leading), place)),
        exponent: Some(leading),
    }
}

/// A number with `digits` significant digits, in pieces.
pub fn rounded_to(value: f64, digits: i32) -> Rounded {
    let alone = |value: String| Rounded {
        value,
        error: None,
        exponent: None,
    };
    if !value.is_finite() {
        return alone(NO_NUMBER.to_owned());
    }
    if value == 0.0 {
        return alone("0".to_owned());
    }
    let digits = digits.clamp(1, MOST_DIGITS);
    let leading = exponent_after_rounding(value, digits);
    if (PLAIN_DOWN_TO..PLAIN_UP_TO).contains(&leading) {
        return alone(rounded_at(value, leading - digits + 1));
    }
    Rounded {
        exponent: Some(leading),
        ..alone(rounded_at(scaled(value, -leading), 1 - digits))
    }
}

/// A bound with at most two digits, rounded up where it is an upper one and down where it is a lower one, so that
/// it stays a bound.
pub fn rounded_bound(bound: f64, is_upper: bool) -> Rounded {
    outward(bound, if is_upper { f64::ceil } else { f64::floor })
}

/// `value ± standard_error`, both rounded by the uncertainty: `24.62 ± 0.31`, `(9.4 ± 1.2)·10⁻⁵`.
///
/// An uncertainty of zero or one that is no number gives the value alone with three digits.
pub fn measured(value: f64, standard_error: f64) -> String {
    rounded(value, standard_error).text()
}

/// The same in two pieces, for one above the other: `24.62` and `± 0.31`, `9.4·10⁻⁵` and `± 1.2·10⁻⁵`; the
/// second is empty where there is no uncertainty.
pub fn measured_stacked(value: f64, standard_error: f64) -> (String, String) {
    rounded(value, standard_error).stacked()
}

/// `24.0 to 25.3`, `(9.1 to 9.7)·10⁻⁵`: the ends of a 95 % interval, to the digits that its width carries.
pub fn interval(low: f64, high: f64) -> String {
    // A quarter of a 95 % interval is about one standard error.
    let error = (high - low).abs() / 4.0;
    let (from, to) = (rounded(low, error), rounded(high, error));
    match (
        from.error.is_some() && to.error.is_some(),
        from.exponent,
        to.exponent,
    ) {
        (true, None, None) => format!("{} to {}", from.value, to.value),
        (true, Some(power), Some(same)) if power == same => {
            format!("({} to {}){}", from.value, to.value, power_of_ten(power))
        }
        _ => format!("{} to {}", significant(low, 3), significant(high, 3)),
    }
}

/// Decimals of a score: those of one table stand below each other.
const SCORE_DECIMALS: usize = 4;

/// `0.9961`, always with four decimals; below 1 it never pretends to be 1.
pub fn score(value: f64) -> String {
    let least_step = 10f64.powi(-(SCORE_DECIMALS as i32));
    match value.is_finite() && value.abs() < 1000.0 {
        true if (1e-9..least_step).contains(&(1.0 - value)) => fixed(1.0 - least_step, SCORE_DECIMALS),
        true => fixed(value, SCORE_DECIMALS),
        false => significant(value, 3),
    }
}

/// A number with `digits` significant digits: `0.996`, `1.53·10⁶`.
pub fn significant(value: f64, digits: i32) -> String {
    rounded_to(value, digits).value_text()
}

/// `< 4·10⁻⁵`: an upper bound with at most two digits, rounded up so that it stays a bound.
pub fn upper_bound(bound: f64) -> String {
    format!("< {}", rounded_bound(bound, true).value_text())
}

/// `> 1.2`: a lower bound with at most two digits, rounded down so that it stays a bound.
pub fn lower_bound(bound: f64) -> String {
    format!("> {}", rounded_bound(bound, false).value_text())
}

/// A fixed number of decimals with a real minus; a zero has no sign, and what is no number is a dash.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return NO_NUMBER.to_owned();
    }
    let decimals = decimals.min(MOST_DECIMALS);
    signed(&format!("{value:.decimals$}"))
}

/// The same with a sign before what is above zero too: `+3`, `−3`, `0`.
pub fn with_sign(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    let is_above = value > 0.0 && text.contains(|c| matches!(c, '1'..='9'));
    if is_above { format!("+{text}") } else { text }
}

/// A share of one as a percentage: 0.123 is `12.3 %` with one decimal.
pub fn percent(share: f64, decimals: usize) -> String {
    format!("{} %", fixed(100.0 * share, decimals))
}

/// Stands for what is no number.
const NO_NUMBER: &str = "–";

/// A text of digits with a real minus; a zero has no sign.
fn signed(text: &str) -> String {
    let unsigned = text.trim_start_matches('-');
    let is_zero = unsigned.chars().all(|c| c == '0' || c == '.');
    if text.starts_with('-') && !is_zero {
        format!("−{unsigned}")
    } else {
        unsigned.to_owned()
    }
}

/// The shortest text that reads back the same, with a real minus: for tags and settings that carry no error.
pub fn plain(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e6).contains(&magnitude) {
        return significant(value, 4);
    }
    format!("{value}").replace('-', "−")
}

/// `·10⁻⁵`
pub fn power_of_ten(exponent: i32) -> String {
    format!("·10{}", superscript(exponent))
}

/// `⁻⁵`
pub fn superscript(number: i32) -> String {
    let digit = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' | '4'..='9' => char::from_u32(0x2070 + (c as u32 - '0' as u32)).unwrap_or(c),
        other => other,
    };
    number.to_string().chars().map(digit).collect()
}

/// An SI prefix: `factor` times a number in the base unit is the number in the prefixed unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prefix {
    /// Multiplier of the base-unit number.
    pub factor: f64,
    /// Symbol before the unit, empty for the base unit.
    pub symbol: &'static str,
}

/// The prefix with which `largest` (the largest magnitude shown) lies between 1 and 1000.
pub fn si_prefix(largest: f64) -> Prefix {
    const PREFIXES: [(i32, &str); 9] = [
        (-12, "p"),
        (-9, "n"),
        (-6, "µ"),
        (-3, "m"),
        (0, ""),
        (3, "k"),
        (6, "M"),
        (9, "G"),
        (12, "T"),
    ];
    let base = Prefix {
        factor: 1.0,
        symbol: "",
    };
    if !largest.is_finite() || largest == 0.0 {
        return base;
    }
    let wanted = decimal_exponent(largest.abs()).div_euclid(3) * 3;
    let exponent = wanted.clamp(-12, 12);
    PREFIXES
        .iter()
        .find(|(power, _)| *power == exponent)
        .map_or(base, |&(power, symbol)| Prefix {
            factor: 10f64.powi(-power),
            symbol,
        })
}

/// A number with its prefixed unit and three digits: `1.20 mA`.
pub fn with_unit(value: f64, unit: &str) -> String {
    let prefix = si_prefix(value);
    let number = significant(value * prefix.factor, 3);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {}{unit}", prefix.symbol)
    }
}

/// Power of ten of the leading digit.
pub fn decimal_exponent(magnitude: f64) -> i32 {
    // `{:e}` is exact where log10 may round 1e-5 or 1000 to the wrong side.
    let text = format!("{magnitude:e}");
    text.rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// Power of ten of the last digit kept of an uncertainty.
fn rounding_place(standard_error: f64) -> i32 {
    let leading = decimal_exponent(standard_error);
    let three_digits = scaled(standard_error, 2 - leading).round() as i32;
    match three_digits {
        ..=354 => leading - 1,
        _ => leading,
    }
}

fn exponent_after_rounding(value: f64, digits: i32) -> i32 {
    let text = format!("{:.*e}", (digits - 1) as usize, value.abs());
    text.rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// `value` rounded at 10^place and printed without digits beyond it.
fn rounded_at(value: f64, place: i32) -> String {
    // Rounded in units of the place, half away from zero: 0.95 is 1.0, though its binary form lies below.
    in_places(scaled(value, -place).round(), place)
}

/// Below it a whole number is one in 64 bits too.
const LARGEST_WHOLE: f64 = u64::MAX as f64;

/// A whole number of units of 10^place, as digits: 95 units of 10^-2 are `0.95`, of 10^1 `950`.
fn in_places(units: f64, place: i32) -> String {
    // A whole number as one: as a number with a fraction of nothing it is written digit by digit, at ten times the cost.
    let digits = if units.abs() < LARGEST_WHOLE {
        (units.abs() as u64).to_string()
    } else {
        format!("{:.0}", units.abs())
    };
    let sign = if units < 0.0 { "-" } else { "" };
    let decimals = place.min(0).unsigned_abs() as usize;
    if decimals == 0 {
        let zeros = if units == 0.0 { 0 } else { place as usize };
        return signed(&format!("{sign}{digits}{}", "0".repeat(zeros)));
    }
    let digits = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    signed(&format!("{sign}{whole}.{fraction}"))
}

/// `value` times 10^power; dividing by a positive power keeps decimal fractions exact where it can. In steps, for
/// 10^±324 is no number while 5·10^-324 times it is.
fn scaled(value: f64, power: i32) -> f64 {
    const STEP: i32 = 300;
    let mut value = value;
    let mut left = power;
    while left < -STEP {
        value /= 10f64.powi(STEP);
        left += STEP;
    }
    while left > STEP {
        value *= 10f64.powi(STEP);
        left -= STEP;
    }
    if left < 0 {
        value / 10f64.powi(-left)
    } else {
        value * 10f64.powi(left)
    }
}

/// Two digits, rounded away from what is excluded; a trailing zero after the point is dropped.
fn outward(bound: f64, round: fn(f64) -> f64) -> Rounded {
    if !bound.is_finite() || bound == 0.0 {
        return rounded_to(bound, 1);
    }
    let place = decimal_exponent(bound.abs()) - 1;
    let in_places_of = scaled(bound, -place);
    // A bound that already has two digits must not move to the next because of its binary representation.
    let nearest = in_places_of.round();
    let kept = if (in_places_of - nearest).abs() < 1e-9 * nearest.abs() {
        nearest
    } else {
        round(in_places_of)
    };
    // 99.5 of a place became 100.
    let leading = place + if kept.abs() >= 100.0 { 2 } else { 1 };
    let is_plain = (PLAIN_DOWN_TO..PLAIN_UP_TO).contains(&leading);
    let value = in_places(kept, if is_plain { place } else { place - leading });
    Rounded {
        value: if value.contains('.') {
            value.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            value
        },
        error: None,
        exponent: (!is_plain).then_some(leading),
    }
}

#[cfg(test)]
mod tests;
