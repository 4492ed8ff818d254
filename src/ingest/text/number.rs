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
    let trimmed = unquote(cell);
    if trimmed.is_empty() {
        return Cell::Empty;
    }
    match grammar(trimmed.as_bytes(), decimal.byte()) {
        Some(false) => finite(trimmed.parse()),
        Some(true) => finite(trimmed.replacen(',', ".", 1).parse()),
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

/// Whether the bytes are `[+-] digits [sign digits] [e [+-] digits]` as a whole, and whether a comma stands in
/// them. A comma needs a digit behind it, for `5,` is a list and not a number.
fn grammar(bytes: &[u8], sign: u8) -> Option<bool> {
    let mut rest = bytes;
    if let [b'+' | b'-', tail @ ..] = rest {
        rest = tail;
    }
    let whole = digits(&mut rest);
    let mut fraction = 0;
    let mut comma = false;
    if let [mark, tail @ ..] = rest
        && *mark == sign
    {
        rest = tail;
        fraction = digits(&mut rest);
        comma = sign == b',';
        if comma && fraction == 0 {
            return None;
        }
    }
    if whole + fraction == 0 {
        return None;
    }
    if let [b'e' | b'E', tail @ ..] = rest {
        rest = tail;
        if let [b'+' | b'-', tail @ ..] = rest {
            rest = tail;
        }
        if digits(&mut rest) == 0 {
            return None;
        }
    }
    rest.is_empty().then_some(comma)
}

fn digits(rest: &mut &[u8]) -> usize {
    let count = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    *rest = &rest[count..];
    count
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
    use super::*;

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
