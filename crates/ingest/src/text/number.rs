//! One cell to one number, strictly: the whole cell is a number, or none is taken from it.

/// Decimal sign of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimal {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

/// What may stand between groups of three digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// `9,400`
    Comma,
    /// `9.400`
    Point,
    /// `9'400`, with a straight or a typographic apostrophe.
    Apostrophe,
    /// `9 400`, with a blank, a no-break or a thin space.
    Space,
}

impl Group {
    /// The mark that a character is; none for others.
    pub fn of(c: char) -> Option<Group> {
        match c {
            ',' => Some(Group::Comma),
            '.' => Some(Group::Point),
            '\'' | '\u{2019}' => Some(Group::Apostrophe),
            ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' => Some(Group::Space),
            _ => None,
        }
    }

    /// The mark in words.
    pub fn label(self) -> &'static str {
        match self {
            Group::Comma => "comma",
            Group::Point => "point",
            Group::Apostrophe => "apostrophe",
            Group::Space => "blank",
        }
    }
}

/// How the numbers of a table are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberForm {
    /// Decimal sign.
    pub decimal: Decimal,
    /// Mark between thousands; none where there is none.
    pub group: Option<Group>,
}

impl From<Decimal> for NumberForm {
    fn from(decimal: Decimal) -> NumberForm {
        NumberForm { decimal, group: None }
    }
}

/// As [`parse`], where marks may stand between thousands.
pub fn parse_in(cell: &str, form: NumberForm) -> Cell {
    match (parse(cell, form.decimal), form.group) {
        (Cell::Text, Some(group)) => match ungrouped(unquote(cell), form.decimal, group) {
            Some(plain) => parse(&plain, form.decimal),
            None => Cell::Text,
        },
        (cell, _) => cell,
    }
}

/// The number without the marks between its thousands: groups of three digits behind one to three that begin with none
/// but a digit above zero.
fn ungrouped(text: &str, decimal: Decimal, group: Group) -> Option<String> {
    let is_mark = |c: char| Group::of(c) == Some(group);
    let bare = text.trim_start_matches(['+', '-', '\u{2212}']);
    let end = bare.find(|c: char| !c.is_ascii_digit() && !is_mark(c));
    let (whole, rest) = bare.split_at(end.unwrap_or(bare.len()));
    if !rest.is_empty() && !rest.starts_with(char::from(decimal.byte())) {
        return None;
    }
    let mut groups = whole.split(is_mark);
    let first = groups.next()?;
    let is_first = (1..=3).contains(&first.len()) && !first.starts_with('0');
    let others: Vec<&str> = groups.collect();
    if !is_first || others.is_empty() || others.iter().any(|digits| digits.len() != 3) {
        return None;
    }
    let sign = &text[..text.len() - bare.len()];
    Some(format!("{sign}{first}{}{rest}", others.concat()))
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
    let trimmed = unquote(cell);
    if trimmed.is_empty() {
        return Cell::Empty;
    }
    match grammar(trimmed.as_bytes(), decimal.byte()) {
        Some(digits) => match digits.exact() {
            Some(number) => Cell::Number(number),
            None => finite(trimmed.replacen(',', ".", 1).replace(['d', 'D'], "e").parse()),
        },
        None => word(trimmed, decimal),
    }
}

/// The cell without surrounding blanks and quotes.
pub fn unquote(cell: &str) -> &str {
    // Nearly all cells are bare.
    if let [first, .., last] = cell.as_bytes()
        && first.is_ascii_graphic()
        && last.is_ascii_graphic()
        && *first != b'"'
    {
        return cell;
    }
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
        while taken < rest.len() && rest[taken].is_ascii_digit() {
            let digit = u64::from(rest[taken] - b'0');
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
        if sign == b',' && fraction == 0 {
            return None;
        }
    }
    if whole + fraction == 0 {
        return None;
    }
    let mut exponent = 0;
    // Fortran writes a D before the power of ten of a double.
    if let [b'e' | b'E' | b'd' | b'D', tail @ ..] = rest {
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
    if !text.is_ascii() && text.contains('\u{2212}') {
        // The typographic minus that plotting programs write, before the number and in its power of ten.
        return match parse(&text.replace('\u{2212}', "-"), decimal) {
            number @ Cell::Number(_) => number,
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
            ("\u{2212}2.5e\u{2212}03", -0.0025),
            ("1.5D-03", 0.0015),
            ("1.23456789012345678901D+02", 123.456_789_012_345_68),
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
            "1D",
            "D3",
        ] {
            assert!(!matches!(parse(cell, Decimal::Point), Cell::Number(_)), "{cell}");
        }
        for cell in ["1.5", "5,", ",", "1.234,5", "1,2,3"] {
            assert_eq!(parse(cell, Decimal::Comma), Cell::Text, "{cell}");
        }
    }

    #[test]
    fn thousands_are_marked_in_groups_of_three() {
        let form = |decimal, group| NumberForm {
            decimal,
            group: Some(group),
        };
        for (cell, decimal, group, number) in [
            ("9,400", Decimal::Point, Group::Comma, 9400.0),
            ("-9,400.25", Decimal::Point, Group::Comma, -9400.25),
            ("1.234.567,5", Decimal::Comma, Group::Point, 1_234_567.5),
            ("1'006.4", Decimal::Point, Group::Apostrophe, 1006.4),
            ("12\u{202f}345,5", Decimal::Comma, Group::Space, 12345.5),
            ("945", Decimal::Point, Group::Comma, 945.0),
        ] {
            assert_eq!(
                parse_in(cell, form(decimal, group)),
                Cell::Number(number),
                "{cell}"
            );
        }
        for cell in [
            "0,400", "9,40", "9,4000", "1234,567", ",400", "9,", "9,400,5", "9,400e3",
        ] {
            assert_eq!(
                parse_in(cell, form(Decimal::Point, Group::Comma)),
                Cell::Text,
                "{cell}"
            );
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
