//! Text from files and names as it may be shown: nothing in it stays unseen, and no spreadsheet takes it for a formula.
//!
//! One list of characters holds for pages, tables, terminals and JSON. What stands for a character differs: pages and tables
//! have a sign of their own for it, a terminal and JSON have an escape.

use std::borrow::Cow;

/// Signs by which spreadsheets take a cell for a formula, with the full-width forms that some read alike.
const FORMULA_SIGNS: [char; 8] = ['=', '+', '-', '@', '＝', '＋', '－', '＠'];
/// Signs after which a spreadsheet may begin a cell, whatever parts the cells of the file: where the decimal sign is a comma,
/// a semicolon does.
const CELL_ENDS: [char; 3] = [';', '\n', '\t'];
/// What makes a cell text.
const TEXT_MARK: char = '\'';

/// Whether nobody would see a character, or it would move or reorder what others show: controls, zero-width characters,
/// marks of direction, tags, byte order marks. Line feeds and tabs are none.
pub fn is_unseen(character: char) -> bool {
    let is_control = character.is_control() && !matches!(character, '\n' | '\t');
    is_control
        || matches!(
            character,
            '\u{61c}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{2069}'
                | '\u{feff}'
                | '\u{fffe}'
                | '\u{ffff}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

/// What stands for an unseen character on pages and in tables: its control picture (`ESC` is `␛`), else its code point;
/// none for a character that can be seen.
pub fn stand_in(character: char) -> Option<String> {
    match character {
        '\u{7f}' => Some("␡".to_owned()),
        seen if !is_unseen(seen) => None,
        '\u{0}'..='\u{1f}' => char::from_u32(0x2400 + character as u32).map(String::from),
        other => Some(format!("⟨U+{:04X}⟩", other as u32)),
    }
}

/// `text` with everything visible and nothing escaped: for formats that have escapes of their own. Line breaks and tabs
/// become blanks, so that it stays one line.
pub fn one_line(text: &str) -> String {
    visible(text).replace(['\n', '\t'], " ")
}

/// `text` with a sign for every unseen character.
fn visible(text: &str) -> Cow<'_, str> {
    replaced(text, is_unseen, |character| {
        stand_in(character).unwrap_or_default()
    })
}

/// `text` as a cell of a CSV file: unseen characters have a sign, and what a spreadsheet would take for a formula has an
/// apostrophe before it. A number is none. [`from_csv_text`] takes the apostrophes off again.
pub fn csv_text(text: &str) -> Cow<'_, str> {
    let visible = visible(text);
    let calculates = pieces(&visible).any(|(piece, _)| is_formula(piece));
    if !calculates {
        return visible;
    }
    let marked = |(piece, end): (&str, &str)| {
        if is_formula(piece) {
            format!("{TEXT_MARK}{piece}{end}")
        } else {
            format!("{piece}{end}")
        }
    };
    Cow::Owned(pieces(&visible).map(marked).collect())
}

/// A cell that [`csv_text`] wrote, without the apostrophes that it put there.
pub fn from_csv_text(cell: &str) -> String {
    let unmarked = |(piece, end): (&str, &str)| {
        let rest = piece.strip_prefix(TEXT_MARK).filter(|rest| is_formula(rest));
        format!("{}{end}", rest.unwrap_or(piece))
    };
    pieces(cell).map(unmarked).collect()
}

/// Parts of a text that may come to stand at the beginning of a cell, each with the sign that ends it.
fn pieces(text: &str) -> impl Iterator<Item = (&str, &str)> {
    text.split_inclusive(CELL_ENDS).map(|piece| {
        let bare = piece.strip_suffix(CELL_ENDS).unwrap_or(piece);
        (bare, &piece[bare.len()..])
    })
}

/// Whether a spreadsheet would calculate: numbers with a sign are no formulas.
fn is_formula(piece: &str) -> bool {
    let bare = piece.trim();
    bare.starts_with(FORMULA_SIGNS) && !is_number(bare)
}

/// Digits with a sign, a decimal point and an exponent where needed.
fn is_number(text: &str) -> bool {
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '+' | '-');
    text.chars().all(of_number) && text.parse::<f64>().is_ok()
}

/// JSON text with escapes for unseen characters, which stand in its strings only: the same document, safe to print.
pub fn json_text(json: &str) -> Cow<'_, str> {
    let escaped = |character: char| {
        let mut units = [0; 2];
        let units = character.encode_utf16(&mut units);
        units.iter().map(|unit| format!("\\u{unit:04x}")).collect()
    };
    replaced(json, is_unseen, escaped)
}

/// `text` with something else in place of some characters.
pub fn replaced(text: &str, which: fn(char) -> bool, by: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(which) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if which(character) {
            out.push_str(&by(character))
        } else {
            out.push(character)
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_spreadsheet_would_calculate_is_text_and_numbers_stay_numbers() {
        for (text, cell) in [
            ("=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("+1+1", "'+1+1"),
            ("-2+3", "'-2+3"),
            ("  =1+1", "'  =1+1"),
            ("\t=1+1", "\t'=1+1"),
            ("＝1+1", "'＝1+1"),
            ("-inf", "'-inf"),
            // A spreadsheet that parts cells by semicolons, and lines within a cell.
            ("wet; =1+1", "wet;' =1+1"),
            ("wet\n=1+1", "wet\n'=1+1"),
            ("-2.5", "-2.5"),
            ("+1e-3", "+1e-3"),
            ("-2.5; -3", "-2.5; -3"),
            ("CNaf-01", "CNaf-01"),
            ("a = b", "a = b"),
            ("", ""),
        ] {
            assert_eq!(csv_text(text), cell);
            assert_eq!(from_csv_text(cell), text, "{cell}");
        }
        assert_eq!(csv_text("a\u{1b}[31m\u{202e}b\r"), "a␛[31m⟨U+202E⟩b␍");
    }

    #[test]
    fn every_mark_of_direction_is_unseen_and_letters_are_not() {
        let marks =
            "\u{61c}\u{200e}\u{200f}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}";
        assert!(marks.chars().all(is_unseen));
        assert!("µA Ω 中 é א\n\t".chars().all(|letter| !is_unseen(letter)));
    }

    #[test]
    fn json_stays_the_same_document() {
        let json = "{\"note\": \"a\u{202e}b\u{7f}\u{e0041}\"}\n";
        assert_eq!(
            json_text(json),
            "{\"note\": \"a\\u202eb\\u007f\\udb40\\udc41\"}\n"
        );
    }
}
