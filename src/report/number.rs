//! Numbers as people read them: a value rounded by its uncertainty, powers of ten, SI prefixes, a real minus.
//!
//! Rounding follows the rule of the Particle Data Group (Review of Particle Physics, introduction, 5.3):
//! with the three leading digits of the uncertainty between 100 and 354 it keeps two digits, between 355
//! and 949 one, from 950 it rounds up to 1000 and keeps two. The value is rounded to the same place. So an
//! uncertainty is never rounded by more than a seventh, and no digit is printed that carries no information.

/// Values from this power of ten on, or below its negative counterpart, are printed with a power of ten.
const PLAIN_UP_TO: i32 = 5;
const PLAIN_DOWN_TO: i32 = -2;

/// `value ± standard_error`, both rounded by the uncertainty: `24.62 ± 0.31`, `(9.4 ± 1.2)·10⁻⁵`.
///
/// An uncertainty of zero or one that is no number gives the value alone with three digits.
pub fn measured(value: f64, standard_error: f64) -> String {
    match parts(value, standard_error) {
        (value, None, _) => value,
        (value, Some(error), None) => format!("{value} ± {error}"),
        (value, Some(error), Some(power)) => format!("({value} ± {error}){power}"),
    }
}

/// The same in two pieces, for one above the other: `24.62` and `± 0.31`, `9.4·10⁻⁵` and `± 1.2·10⁻⁵`; the
/// second is empty where there is no uncertainty.
pub fn measured_stacked(value: f64, standard_error: f64) -> (String, String) {
    let (value, error, power) = parts(value, standard_error);
    let power = power.unwrap_or_default();
    let error = error.map(|error| format!("± {error}{power}"));
    (format!("{value}{power}"), error.unwrap_or_default())
}

/// `24.0 to 25.3`, `(9.1 to 9.7)·10⁻⁵`: the ends of a 95 % interval, to the digits that its width carries.
pub fn interval(low: f64, high: f64) -> String {
    // A quarter of a 95 % interval is about one standard error.
    let error = (high - low).abs() / 4.0;
    match (parts(low, error), parts(high, error)) {
        ((low, Some(_), None), (high, Some(_), None)) => format!("{low} to {high}"),
        ((low, Some(_), Some(power)), (high, Some(_), Some(same))) if power == same => {
            format!("({low} to {high}){power}")
        }
        _ => format!("{} to {}", significant(low, 3), significant(high, 3)),
    }
}

/// Value, uncertainty and power of ten, each rounded by the uncertainty.
fn parts(value: f64, standard_error: f64) -> (String, Option<String>, Option<String>) {
    if !value.is_finite() || !standard_error.is_finite() || standard_error <= 0.0 {
        return (significant(value, 3), None, None);
    }
    let place = rounding_place(standard_error);
    let leading = decimal_exponent(value.abs().max(standard_error));
    if (PLAIN_DOWN_TO..PLAIN_UP_TO).contains(&leading) {
        return (
            rounded_at(value, place),
            Some(rounded_at(standard_error, place)),
            None,
        );
    }
    let (mantissa, error) = (scaled(value, -leading), scaled(standard_error, -leading));
    let place = place - leading;
    (
        rounded_at(mantissa, place),
        Some(rounded_at(error, place)),
        Some(power_of_ten(leading)),
    )
}

/// A number with `digits` significant digits: `0.996`, `1.53·10⁶`.
pub fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let leading = exponent_after_rounding(value, digits);
    if (PLAIN_DOWN_TO..PLAIN_UP_TO).contains(&leading) {
        return rounded_at(value, leading - digits + 1);
    }
    let mantissa = rounded_at(scaled(value, -leading), 1 - digits);
    format!("{mantissa}{}", power_of_ten(leading))
}

/// `< 4·10⁻⁵`: an upper bound with at most two digits, rounded up so that it stays a bound.
pub fn upper_bound(bound: f64) -> String {
    format!("< {}", outward(bound, f64::ceil))
}

/// `> 1.2`: a lower bound with at most two digits, rounded down so that it stays a bound.
pub fn lower_bound(bound: f64) -> String {
    format!("> {}", outward(bound, f64::floor))
}

/// A fixed number of decimals with a real minus; a zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let unsigned = text.trim_start_matches('-');
    let is_zero = unsigned.chars().all(|c| c == '0' || c == '.');
    match text.starts_with('-') && !is_zero {
        true => format!("−{unsigned}"),
        false => unsigned.to_owned(),
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
    match unit.is_empty() {
        true => number,
        false => format!("{number} {}{unit}", prefix.symbol),
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
    let text = format!("{:.*e}", (digits - 1).max(0) as usize, value.abs());
    text.rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// `value` rounded at 10^place and printed without digits beyond it.
fn rounded_at(value: f64, place: i32) -> String {
    // Rounded in units of the place, half away from zero: 0.95 is 1.0, though its binary form lies below.
    let in_places = scaled(value, -place).round();
    fixed(scaled(in_places, place), (-place).max(0) as usize)
}

/// `value` times 10^power; dividing by a positive power keeps decimal fractions exact where it can.
fn scaled(value: f64, power: i32) -> f64 {
    match power < 0 {
        true => value / 10f64.powi(-power),
        false => value * 10f64.powi(power),
    }
}

/// Two digits, rounded away from what is excluded; a trailing zero after the point is dropped.
fn outward(bound: f64, round: fn(f64) -> f64) -> String {
    if !bound.is_finite() || bound == 0.0 {
        return fixed(bound, 0);
    }
    let place = decimal_exponent(bound.abs()) - 1;
    let in_places = scaled(bound, -place);
    // A bound that already has two digits must not move to the next because of its binary representation.
    let nearest = in_places.round();
    let kept = match (in_places - nearest).abs() < 1e-9 * nearest.abs() {
        true => nearest,
        false => round(in_places),
    };
    let kept = scaled(kept, place);
    let text = significant(kept, 2);
    let (mantissa, rest) = text.split_at(text.find('·').unwrap_or(text.len()));
    let mantissa = match mantissa.contains('.') && mantissa.ends_with('0') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    format!("{mantissa}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_is_rounded_by_its_uncertainty() {
        assert_eq!(measured(24.6183, 0.3142), "24.62 ± 0.31");
        assert_eq!(measured(24.6183, 0.358), "24.6 ± 0.4");
        assert_eq!(measured(24.6183, 0.0962), "24.62 ± 0.10");
        assert_eq!(measured(1533.7, 214.0), "1530 ± 210");
        assert_eq!(measured(1533.7, 0.0), "1530");
        assert_eq!(measured(0.0391, 0.0012), "0.0391 ± 0.0012");
        assert_eq!(measured(-2.5, 0.11), "−2.50 ± 0.11");
    }

    #[test]
    fn small_and_large_values_share_one_power_of_ten() {
        assert_eq!(measured(9.43e-5, 1.2e-6), "(9.43 ± 0.12)·10⁻⁵");
        assert_eq!(measured(9.43e-5, 1.2e-5), "(9.4 ± 1.2)·10⁻⁵");
        assert_eq!(measured(1.234567e7, 1.1e4), "(1.2346 ± 0.0011)·10⁷");
        // The uncertainty is larger than the value: the power is the uncertainty's.
        assert_eq!(measured(2e-6, 1.1e-5), "(0.2 ± 1.1)·10⁻⁵");
    }

    #[test]
    fn the_three_ranges_of_the_rounding_rule() {
        let last_digit = |error: f64| rounding_place(error);
        assert_eq!((last_digit(0.100), last_digit(0.354)), (-2, -2));
        assert_eq!((last_digit(0.355), last_digit(0.949)), (-1, -1));
        assert_eq!(measured(1.0, 0.95), "1.0 ± 1.0");
        assert_eq!(measured(1.0, 9.6), "1 ± 10");
    }

    #[test]
    fn significant_digits() {
        assert_eq!(significant(0.99649, 3), "0.996");
        assert_eq!(significant(0.99961, 3), "1.00");
        assert_eq!(significant(99_960.0, 3), "1.00·10⁵");
        assert_eq!(significant(1.5e6, 3), "1.50·10⁶");
        assert_eq!(significant(-9.4e-5, 2), "−9.4·10⁻⁵");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "–");
    }

    #[test]
    fn intervals_show_their_width_and_pieces_stack() {
        assert_eq!(interval(12.271, 12.349), "12.271 to 12.349");
        assert_eq!(interval(796.2, 1040.7), "800 to 1040");
        assert_eq!(interval(1.794e-4, 1.814e-4), "(1.794 to 1.814)·10⁻⁴");
        assert_eq!(interval(9.0e-5, 2.0e-4), "9.00·10⁻⁵ to 2.00·10⁻⁴");
        assert_eq!(
            measured_stacked(24.618, 0.31),
            ("24.62".to_owned(), "± 0.31".to_owned())
        );
        assert_eq!(
            measured_stacked(9.4e-5, 1.2e-5),
            ("9.4·10⁻⁵".to_owned(), "± 1.2·10⁻⁵".to_owned())
        );
        assert_eq!(measured_stacked(9.4, 0.0), ("9.40".to_owned(), String::new()));
    }

    #[test]
    fn bounds_are_rounded_outward() {
        assert_eq!(upper_bound(4e-5), "< 4·10⁻⁵");
        assert_eq!(upper_bound(3.61e-5), "< 3.7·10⁻⁵");
        assert_eq!(lower_bound(123.0), "> 120");
        assert_eq!(lower_bound(0.0399), "> 0.039");
        assert_eq!(upper_bound(9.91), "< 10");
    }

    #[test]
    fn prefixes_keep_numbers_between_one_and_a_thousand() {
        assert_eq!(si_prefix(1.2e-3).symbol, "m");
        assert_eq!(si_prefix(9.99e-4).symbol, "µ");
        assert_eq!(si_prefix(1000.0).symbol, "k");
        assert_eq!(si_prefix(0.0).symbol, "");
        assert_eq!(si_prefix(1e-30).symbol, "p");
        assert_eq!(with_unit(1.2e-3, "A"), "1.20 mA");
    }

    #[test]
    fn minus_is_a_minus_and_zero_has_no_sign() {
        assert_eq!(fixed(-0.7, 2), "−0.70");
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(plain(-0.7), "−0.7");
        assert_eq!(superscript(-12), "⁻¹²");
    }
}
