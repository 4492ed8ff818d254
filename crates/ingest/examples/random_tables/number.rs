//! Numbers as they are written, and the value that is left of them.

use crate::dialect::{Dialect, Numbers};

/// The text of `value` with so many decimals and digits, and the number that it says.
pub fn written(value: f64, decimals: usize, digits: usize, dialect: &Dialect) -> (String, f64) {
    let plain = match dialect.numbers {
        Numbers::Fixed => format!("{value:.decimals$}"),
        Numbers::Significant => significant(value, digits),
        Numbers::Scientific | Numbers::Fortran => scientific(value, digits),
    };
    let said = plain.parse().unwrap_or(f64::NAN);
    (local(&plain, dialect), said)
}

/// A whole number, `9400`.
pub fn whole(value: i64, dialect: &Dialect) -> String {
    local(&value.to_string(), dialect)
}

fn significant(value: f64, digits: usize) -> String {
    let power = if value == 0.0 {
        0.0
    } else {
        value.abs().log10().floor()
    };
    if !(-5.0..9.0).contains(&power) {
        return scientific(value, digits);
    }
    let decimals = (digits as f64 - 1.0 - power).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// `1.2E-03`: two digits of the exponent at least.
fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}E{sign}{:02}", exponent.abs())
}

/// A number with point and `E` in the marks of the dialect.
pub fn local(plain: &str, dialect: &Dialect) -> String {
    let negative = plain.starts_with('-');
    let bare = plain.trim_start_matches('-');
    let end = bare.find(['.', 'E']).unwrap_or(bare.len());
    let (whole, rest) = bare.split_at(end);
    let whole = dialect
        .thousands
        .map_or(whole.to_owned(), |mark| grouped(whole, mark));
    let rest = rest.replace('.', &dialect.decimal.to_string());
    let rest = if dialect.numbers == Numbers::Fortran {
        rest.replace('E', "D")
    } else {
        rest
    };
    let rest = rest
        .replace("E-", &format!("E{}", dialect.minus))
        .replace("D-", &format!("D{}", dialect.minus));
    let sign = match (negative, dialect.plus) {
        (true, _) => dialect.minus.to_string(),
        (false, true) => "+".to_owned(),
        (false, false) => String::new(),
    };
    format!("{sign}{whole}{rest}")
}

fn grouped(whole: &str, mark: char) -> String {
    let mut text = String::new();
    for (index, digit) in whole.chars().enumerate() {
        if index > 0 && (whole.len() - index).is_multiple_of(3) {
            text.push(mark);
        }
        text.push(digit);
    }
    text
}
