//! Rounding on examples and as properties.

use super::*;
use proptest::prelude::*;

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
    assert_eq!(
        [3.2, -3.2, 0.2, -0.2].map(|value| with_sign(value, 0)),
        ["+3", "−3", "0", "0"]
    );
    assert_eq!(percent(0.1234, 1), "12.3 %");
}

#[test]
fn a_score_never_pretends_to_be_one() {
    assert_eq!(score(0.9961), "0.9961");
    assert_eq!(score(0.99984), "0.9998");
    assert_eq!(score(0.999_999_7), "0.9999");
    assert_eq!(score(1.0), "1.0000");
    assert_eq!(score(-3.2), "−3.2000");
}

/// A number and a positive error of any size that the number moves by.
fn number_and_error() -> impl Strategy<Value = (f64, f64)> {
    (-1.0..1.0f64, -9..9i32, 0.1..1.0f64, -9..9i32)
        .prop_map(|(value, power, error, of_error)| (value * 10f64.powi(power), error * 10f64.powi(of_error)))
        .prop_filter("the number moves by it", |(value, error)| {
            *error >= LEAST_UNCERTAINTY * value.abs()
        })
}

/// Any number of 64 bits: subnormal ones, the largest, and those that are no numbers.
fn any_number() -> impl Strategy<Value = f64> {
    let ends = vec![
        0.0,
        -0.0,
        5e-324,
        1e-320,
        -1e-308,
        1e308,
        f64::MAX,
        f64::MIN,
        f64::INFINITY,
        f64::NAN,
    ];
    prop_oneof![4 => any::<f64>(), 1 => prop::sample::select(ends)]
}

#[test]
fn the_ends_of_what_a_number_can_be_are_printed() {
    assert_eq!(significant(5e-324, 3), "4.94·10⁻³²⁴");
    assert_eq!(significant(f64::MAX, 3), "1.80·10³⁰⁸");
    assert_eq!(significant(1.0, i32::MAX), "1.0000000000000000");
    assert_eq!(measured(1e-320, 5e-321), "(1.0 ± 0.5)·10⁻³²⁰");
    assert_eq!(measured(1e308, 2e307), "(1.00 ± 0.20)·10³⁰⁸");
    assert_eq!(upper_bound(f64::MAX), "< 1.8·10³⁰⁸");
    assert_eq!(lower_bound(5e-324), "> 4.9·10⁻³²⁴");
    assert_eq!(with_unit(1e-300, "A"), "1.00·10⁻²⁸⁸ pA");
    assert_eq!(fixed(f64::NAN, 2), "–");
}

#[test]
fn an_uncertainty_that_the_value_does_not_move_by_is_not_told() {
    assert_eq!(measured(2.0, 1e-300), "2.00");
    assert_eq!(measured(1e300, 1e-300), "1.00·10³⁰⁰");
    // One that is larger than the value by any factor is.
    assert_eq!(measured(1e-300, 250.0), "0 ± 250");
    assert_eq!(measured(2.0, 1e300), "(0.0 ± 1.0)·10³⁰⁰");
}

#[test]
fn concise_uncertainties_are_in_units_of_the_last_digit() {
    let concise = |value, error| rounded(value, error).concise();
    assert_eq!(concise(24.6183, 0.3142), "24.62(31)");
    assert_eq!(concise(1533.7, 214.0), "1530(210)");
    assert_eq!(concise(9.43e-5, 1.2e-5), "9.4(12)");
    assert_eq!(concise(-0.0391, 0.0012), "-0.0391(12)");
    assert_eq!(concise(1.0, 0.95), "1.0(10)");
}

/// The number that was printed, and one unit of its last digit.
fn read_back(digits: &str, exponent: Option<i32>) -> (f64, f64) {
    let power = exponent.unwrap_or(0);
    let plain = digits.replace('−', "-");
    let decimals = plain
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len() as i32);
    (
        format!("{plain}e{power}").parse().expect("a number"),
        10f64.powi(power - decimals),
    )
}

/// The longest text that one number may take: digits of 64 bits, a sign, a point, zeros of a plain number, a power of ten.
const LONGEST: usize = 40;

proptest! {
    #[test]
    fn any_number_is_printed_shortly(a in any_number(), b in any_number(), digits in any::<i32>()) {
        let short = |text: &str| text.chars().count() <= 2 * LONGEST;
        let (above, below) = measured_stacked(a, b.abs());
        let all = [
            measured(a, b), measured(a, b.abs()), above, below, interval(a, b), score(a), significant(a, digits),
            upper_bound(a), lower_bound(a), plain(a), with_unit(a, "A"), rounded(a, b.abs()).concise(),
        ];
        for text in all {
            prop_assert!(short(&text), "{text}");
            prop_assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
        }
    }

    #[test]
    fn any_number_reads_back_as_printed(value in any_number(), digits in 1..13i32) {
        let shown = rounded_to(value, digits);
        if value.is_finite() {
            let plain = shown.value.replace('−', "-");
            // Read as text: the rounded number may lie beyond the largest.
            let read: f64 = format!("{plain}e{}", shown.exponent.unwrap_or(0)).parse().expect("a number");
            let near = 0.51 * 10f64.powi(1 - digits);
            prop_assert!(read.is_infinite() || (read - value).abs() <= near * value.abs() + 5e-324, "{shown:?}");
        } else {
            prop_assert!(!shown.is_number());
        }
    }

    #[test]
    fn any_decimals_are_printed(value in any_number(), decimals in any::<usize>()) {
        prop_assert!(!fixed(value, decimals).is_empty());
    }

    #[test]
    fn a_rounded_value_is_within_half_a_last_digit((value, error) in number_and_error()) {
        let shown = rounded(value, error);
        let (read, last) = read_back(&shown.value, shown.exponent);
        // The last digit kept of an error of 355 or more stands in a place of its own.
        let place = last.max(10f64.powi(rounding_place(error)));
        prop_assert!((read - value).abs() <= 0.5 * place * (1.0 + 1e-9) + 1e-12 * value.abs(), "{shown:?}");
        let (read, _) = read_back(shown.error.as_deref().expect("an error"), shown.exponent);
        prop_assert!((read / error - 1.0).abs() <= 0.15, "{shown:?}: error moved by more than a seventh");
    }

    #[test]
    fn value_and_error_have_the_same_decimals((value, error) in number_and_error()) {
        let shown = rounded(value, error);
        let decimals = |digits: &str| digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        prop_assert_eq!(decimals(&shown.value), decimals(shown.error.as_deref().unwrap_or("")));
    }

    #[test]
    fn what_is_rounded_stays_so((value, error) in number_and_error()) {
        let shown = rounded(value, error);
        let read = read_back(&shown.value, shown.exponent).0;
        let read_error = read_back(shown.error.as_deref().unwrap_or("0"), shown.exponent).0;
        // The power of ten may be another where rounding carries over; the number is the same.
        let again = rounded(read, read_error);
        prop_assert!((read_back(&again.value, again.exponent).0 - read).abs() <= 1e-9 * read.abs().max(read_error));
    }

    #[test]
    fn a_bound_stays_a_bound(bound in 1e-12..1e12f64) {
        let upper = rounded_bound(bound, true);
        let lower = rounded_bound(bound, false);
        let slack = 1e-8 * bound;
        prop_assert!(read_back(&upper.value, upper.exponent).0 >= bound - slack);
        prop_assert!(read_back(&lower.value, lower.exponent).0 <= bound + slack);
    }
}
