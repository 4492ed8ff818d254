//! One cell to one number, strictly: the whole cell is a number, or none is taken from it.

/// Decimal sign of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimal {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

impl Decimal {
    fn byte(self) -> u8 {
        match self {
            Decimal::Point => b'.',
            Decimal::Comma => b',',
        }
    }
}

/// What stands in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing, or a spelling of nothing (`NA`, `null`, `--`).
    Empty,
    /// `NaN`, `inf`, or a number too large for a double: written as a number, but none.
    NotFinite,
    /// Anything else.
    Text,
}

/// Reads a cell, which may be padded by blanks or quoted.
pub fn parse(cell: &str, decimal: Decimal) -> Cell {
    let trimmed = match cell.as_bytes() {
        [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() && *first != b'"' => cell,
        _ => unquote(cell),
    };
    if trimmed.is_empty() {
        return Cell::Empty;
    }
    match grammar(trimmed.as_bytes(), decimal.byte()) {
        Some(digits) => match digits.exact() {
            Some(number) => Cell::Number(number),
            None if digits.comma => finite(trimmed.replacen(',', ".", 1).parse()),
            None => finite(trimmed.parse()),
        },
        None => word(trimmed, decimal),
    }
}

/// The cell without surrounding blanks and quotes.
pub fn unquote(cell: &str) -> &str {
    let trimmed = cell.trim();
    match trimmed
        .strip_prefix('"')
        .and_then(|inner| inner.strip_suffix('"'))
    {
        Some(inner) => inner.trim(),
        None => trimmed,
    }
}

fn finite(parsed: Result<f64, std::num::ParseFloatError>) -> Cell {
    match parsed {
        Ok(number) if number.is_finite() => Cell::Number(number),
        Ok(_) => Cell::NotFinite,
        Err(_) => Cell::Text,
    }
}

/// A number as it is written: sign, digits without their decimal sign, power of ten.
#[derive(Debug, Default)]
struct Digits {
    negative: bool,
    /// The digits as a whole number, as far as `count` is small enough for it.
    mantissa: u64,
    /// Digits from the first that is not zero.
    count: usize,
    exponent: i32,
    /// Whether a comma stands in it.
    comma: bool,
}

/// Most digits that a whole number of 64 bits surely holds.
const MOST_DIGITS: usize = 19;

impl Digits {
    /// The double nearest to it, where digits and power of ten are exact in doubles: one rounding then gives it
    /// (W. D. Clinger, How to read floating point numbers accurately, PLDI 1990).
    fn exact(&self) -> Option<f64> {
        const POWERS: [f64; 23] = [
            1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
            1e18, 1e19, 1e20, 1e21, 1e22,
        ];
        if self.count > MOST_DIGITS || self.mantissa > 1 << f64::MANTISSA_DIGITS {
            return None;
        }
        let power = POWERS.get(self.exponent.unsigned_abs() as usize)?;
        let whole = self.mantissa as f64;
        let number = if self.exponent < 0 {
            whole / power
        } else {
            whole * power
        };
        Some(if self.negative { -number } else { number })
    }

    /// Takes the digits at the beginning of `rest`; gives how many.
    fn take(&mut self, rest: &mut &[u8]) -> usize {
        let mut taken = 0;
        while let Some(byte) = rest.get(taken).filter(|byte| byte.is_ascii_digit()) {
            let digit = u64::from(byte - b'0');
            self.count += usize::from(self.count > 0 || digit > 0);
            self.mantissa = self.mantissa.wrapping_mul(10).wrapping_add(digit);
            taken += 1;
        }
        *rest = &rest[taken..];
        taken
    }
}

/// The number that the bytes `[+-] digits [sign digits] [e [+-] digits]` write as a whole. A comma needs a digit
/// behind it, for `5,` is a list and not a number.
fn grammar(bytes: &[u8], sign: u8) -> Option<Digits> {
    let mut digits = Digits::default();
    let mut rest = bytes;
    if let [mark @ (b'+' | b'-'), tail @ ..] = rest {
        digits.negative = *mark == b'-';
        rest = tail;
    }
    let whole = digits.take(&mut rest);
    let mut fraction = 0;
    if let [mark, tail @ ..] = rest
        && *mark == sign
    {
        rest = tail;
        fraction = digits.take(&mut rest);
        digits.comma = sign == b',';
        if digits.comma && fraction == 0 {
            return None;
        }
    }
    if whole + fraction == 0 {
        return None;
    }
    let mut exponent = 0;
    if let [b'e' | b'E', tail @ ..] = rest {
        exponent = power_of_ten(tail)?;
        rest = &[];
    }
    digits.exponent = exponent.saturating_sub(i32::try_from(fraction).unwrap_or(i32::MAX));
    rest.is_empty().then_some(digits)
}

/// The exponent `[+-] digits` as a whole; one of more digits than any double has counts as very large.
fn power_of_ten(bytes: &[u8]) -> Option<i32> {
    let (negative, digits) = match bytes {
        [mark @ (b'+' | b'-'), digits @ ..] => (*mark == b'-', digits),
        digits => (false, digits),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let add = |sum: i32, byte: &u8| sum.saturating_mul(10).saturating_add(i32::from(byte - b'0'));
    let power = digits.iter().fold(0, add);
    Some(if negative { -power } else { power })
}

fn word(text: &str, decimal: Decimal) -> Cell {
    if let Some(positive) = text.strip_prefix('\u{2212}') {
        // The typographic minus that plotting programs write.
        return match parse(positive, decimal) {
            Cell::Number(number) if positive.starts_with(|c: char| c.is_ascii_digit()) => {
                Cell::Number(-number)
            }
            _ => Cell::Text,
        };
    }
    if text.len() > 9 {
        return Cell::Text;
    }
    match text.trim_start_matches(['+', '-']).to_ascii_lowercase().as_str() {
        "nan" | "inf" | "infinity" | "1.#ind" | "1.#inf" | "1.#qnan" | "#num!" | "#div/0!" => Cell::NotFinite,
        "na" | "n/a" | "#n/a" | "null" | "none" | "" => Cell::Empty,
        _ => Cell::Text,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_are_those_of_the_standard_library(
            text in "[-+]?(0{0,3}[0-9]{1,22}(\\.[0-9]{0,22})?|\\.[0-9]{1,22})([eE][-+]?[0-9]{1,3})?",
        ) {
            let expected: f64 = text.parse().unwrap();
            let found = parse(&text, Decimal::Point);
            if expected.is_finite() {
                prop_assert!(matches!(found, Cell::Number(n) if n.to_bits() == expected.to_bits()), "{text}: {found:?}, {expected}");
            } else {
                prop_assert_eq!(found, Cell::NotFinite);
            }
            let comma = text.replace('.', ",");
            if !comma.contains(",e") && !comma.contains(",E") && !comma.ends_with(',') {
                prop_assert_eq!(parse(&comma, Decimal::Comma), found);
            }
        }
    }

    #[test]
    fn numbers_are_read_whole() {
        for (cell, number) in [
            ("1.5e-3", 0.0015),
            ("0.00000E+000", 0.0),
            ("2.854954e-003", 0.002854954),
            (" -12 ", -12.0),
            ("+.5", 0.5),
            ("5.", 5.0),
            ("\"7\"", 7.0),
            ("\u{2212}0.25", -0.25),
        ] {
            assert_eq!(parse(cell, Decimal::Point), Cell::Number(number), "{cell}");
        }
        assert_eq!(parse("-1,5E-003", Decimal::Comma), Cell::Number(-0.0015));
    }

    #[test]
    fn nothing_is_taken_from_a_part_of_a_cell() {
        for cell in [
            "1.2.3",
            "1e",
            "1e+",
            "4.651e+",
            "1,5",
            "0x10",
            "1 2",
            "12a",
            "e5",
            ".",
            "-",
            "+",
            "1_000",
            "\u{2212}",
            "\u{2212}-1",
            "--1",
        ] {
            assert!(!matches!(parse(cell, Decimal::Point), Cell::Number(_)), "{cell}");
        }
        for cell in ["1.5", "5,", ",", "1.234,5", "1,2,3"] {
            assert_eq!(parse(cell, Decimal::Comma), Cell::Text, "{cell}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_apart() {
        for (cell, what) in [
            ("", Cell::Empty),
            ("  ", Cell::Empty),
            ("\"\"", Cell::Empty),
            ("N/A", Cell::Empty),
            ("--", Cell::Empty),
            ("NaN", Cell::NotFinite),
            ("-Inf", Cell::NotFinite),
            ("1e999", Cell::NotFinite),
            ("Logged", Cell::Text),
        ] {
            assert_eq!(parse(cell, Decimal::Point), what, "{cell:?}");
        }
    }
}
