//! Whether a last line without a line end is whole all the same: many programs write none behind the last row.
//!
//! A cut leaves fewer fields, or a last field with fewer characters than it had. A line is whole where neither can be:
//! it has as many fields as the line above, and its last field has an end of its own. What leaves a doubt is no proof,
//! for a cut number is another number.

use super::lines::Line;
use super::number::{self, Cell, Decimal, unquote};
use crate::text::policy::{FEWEST_OF_FORM, LINES_ABOVE_LAST};

/// What shows that the last of `lines`, which has no line end, is whole; none where nothing does.
pub fn sign_of_whole(lines: &[Line<'_>]) -> Option<&'static str> {
    let (last, above) = lines.split_last()?;
    if last.text.ends_with('\r') {
        return Some("half a line end stands behind the last line");
    }
    let mark = mark_of(last.text);
    let fields = |text: &str| text.matches(mark).count();
    let above = above.iter().rev().filter(|line| !line.text.trim().is_empty());
    let above: Vec<&str> = above.take(LINES_ABOVE_LAST).map(|line| line.text).collect();
    let first = match above.first()? {
        // A delimiter behind the last name is no sign of a column.
        names if !holds_number(names, mark) => names.trim_end_matches(mark),
        row => row,
    };
    if fields(first) != fields(last.text) {
        return None;
    }
    let is_row = |text: &&str| fields(text) == fields(last.text) && holds_number(text, mark);
    let rows = above.into_iter().filter(is_row);
    let fields_above: Vec<&str> = rows.map(|row| last_field(row, mark)).collect();
    let field = last_field(last.text, mark);
    let proof = PROOFS.iter().find(|proof| (proof.holds)(field, &fields_above));
    proof.map(|proof| proof.sign)
}

/// What may show that a line is whole.
struct Proof {
    /// Asked of the last field and of those above it.
    holds: fn(&str, &[&str]) -> bool,
    /// What it shows, in words.
    sign: &'static str,
}

const PROOFS: [Proof; 5] = [
    Proof {
        holds: ends_in_mark,
        sign: "a delimiter stands behind the last field, as in all lines above",
    },
    Proof {
        holds: is_quoted,
        sign: "quotes close the last field",
    },
    Proof {
        holds: has_whole_exponent,
        sign: "the exponent of the last number has all its digits",
    },
    Proof {
        holds: has_fixed_decimals,
        sign: "the last number has as many decimals as all above it",
    },
    Proof {
        holds: is_mark_of_fixed_width,
        sign: "the last field is a mark as wide as all above it",
    },
];

/// What stands between the fields. A comma beside tabs or semicolons is a decimal sign.
fn mark_of(text: &str) -> char {
    let held = ['\t', ';', ','].into_iter().find(|mark| text.contains(*mark));
    held.unwrap_or(' ')
}

/// Whether a line is a row and none of names or units.
fn holds_number(text: &str, mark: char) -> bool {
    let is_number = |field: &str| {
        let reads = |decimal| matches!(number::parse(field, decimal), Cell::Number(_));
        reads(Decimal::Point) || reads(Decimal::Comma)
    };
    text.split(mark).any(is_number)
}

fn last_field(text: &str, mark: char) -> &str {
    text.rsplit(mark).next().unwrap_or("").trim()
}

/// Nothing behind the last delimiter, here and above: the field before it is closed.
fn ends_in_mark(field: &str, above: &[&str]) -> bool {
    field.is_empty() && above.len() >= FEWEST_OF_FORM && above.iter().all(|field| field.is_empty())
}

fn is_quoted(field: &str, above: &[&str]) -> bool {
    let closed = |field: &str| field.len() > 2 && unquote(field).len() == field.len() - 2;
    closed(field) && !above.is_empty() && above.iter().all(|field| closed(field))
}

/// Three digits are the most that an exponent has; two are all where those above have two. One may be the first of two.
fn has_whole_exponent(field: &str, above: &[&str]) -> bool {
    let mut found = above.iter().filter_map(|field| exponent_digits(field)).peekable();
    match exponent_digits(field) {
        Some(3) => true,
        Some(2) => found.peek().is_some() && found.all(|digits| digits == 2),
        _ => false,
    }
}

/// Decimals that do not vary, two or more, with a zero among the last ones: a program that leaves zeros out would have
/// left out that one, too.
fn has_fixed_decimals(field: &str, above: &[&str]) -> bool {
    let Some(count) = decimals(field).filter(|count| *count >= 2) else {
        return false;
    };
    above.len() >= FEWEST_OF_FORM
        && above.iter().all(|field| decimals(field) == Some(count))
        && above.iter().any(|field| field.ends_with('0'))
}

/// Signs without a digit, such as the overload letters of Gamry.
fn is_mark_of_fixed_width(field: &str, above: &[&str]) -> bool {
    let is_mark =
        |field: &str| field.len() >= 2 && !field.contains(|c: char| c.is_ascii_digit() || "+-".contains(c));
    let as_wide = |other: &&str| is_mark(other) && other.chars().count() == field.chars().count();
    is_mark(field) && above.len() >= FEWEST_OF_FORM && above.iter().all(as_wide)
}

/// Digits of the exponent of a number such as `-1.5E-003`.
fn exponent_digits(field: &str) -> Option<usize> {
    let (mantissa, exponent) = field.split_once(['e', 'E'])?;
    let digits = exponent.strip_prefix(['+', '-'])?;
    let is_number = mantissa.contains(|c: char| c.is_ascii_digit()) && all_digits(digits);
    is_number.then_some(digits.len())
}

/// Decimals of a number such as `-1.50` or `1,50`.
fn decimals(field: &str) -> Option<usize> {
    let (whole, decimals) = field.trim_start_matches(['+', '-']).split_once(['.', ','])?;
    (all_digits(whole) && all_digits(decimals)).then_some(decimals.len())
}

fn all_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Lines;

    fn is_whole(text: &str) -> bool {
        let lines: Vec<Line<'_>> = Lines::new(text).collect();
        assert!(!lines.last().unwrap().ended, "{text:?}");
        sign_of_whole(&lines).is_some()
    }

    #[test]
    fn last_lines_that_show_their_own_end() {
        for text in [
            "a\tb\n0\t1.5E+000",
            "a\tb\t\n0\t1.5E+000",
            "0\t1.5E-04\n1\t2.25E-04\n2\t1E-05",
            "0;1,50\n1;2,25\n2;3,10\n3;-0,25",
            "0,1.50\n1,2.25\n2,3.10\n3,4.00",
            "0 1.50\n1 2.25\n2 3.10\n3 4.00",
            "0\t1\t\n1\t1\t\n2\t1\t\n3\t41\t",
            "\"0\",\"21.5\"\n\"1\",\"21\"",
            "0\t...\n1\t..a\n2\t...\n3\t...",
            "0,1\r\n1,25\r",
        ] {
            assert!(is_whole(text), "{text:?}");
        }
    }

    #[test]
    fn what_may_be_cut_is_no_whole_line() {
        for text in [
            "a\tb\n0\t1.5E+00",
            "a\tb\tc\n0\t1.5E+000",
            "0,1e-5\n1,2e-6\n2,1e-1",
            "0,1e-012\n1,2e-011\n2,1e-01",
            "0,1.55\n1,2.25\n2,3.15\n3,4.22",
            "0,1.50\n1,2.25\n2,3.10\n3,4.1",
            "0,0.5\n1,1.0\n2,1.5\n3,2.0",
            "0,0\n1,0\n2,0\n3,0",
            "0 1,50\n1 2,25\n2 3,10\n3 4,20",
            "0\t1\t\n1\t1\tx\n2\t1\t\n3\t41\t",
            "\"0\",\"21.5\"\n\"1\",\"2",
            "1.5E+000",
            "0\tREST\n1\tREST\n2\tREST\n3\tRES",
        ] {
            assert!(!is_whole(text), "{text:?}");
        }
    }
}
