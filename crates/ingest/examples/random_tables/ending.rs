//! The end of a table, and its bytes.

use crate::dialect::{Dialect, Encoding};
use crate::dice::Dice;
use crate::table::{Expect, Written};
use crate::write::line;

/// All lines as a text, its end cut where the dialect cuts it.
pub fn ended(
    dice: &mut Dice,
    mut lines: Vec<String>,
    dialect: &Dialect,
    all: &mut [Written],
    last: usize,
) -> String {
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    if dialect.cut
        && let Some(line) = lines.last_mut()
    {
        *line = cut(dice, line, dialect, all, last);
        return lines.join(dialect.line_end);
    }
    let mut text = lines.join(dialect.line_end);
    if !dialect.open_end {
        text.push_str(dialect.line_end);
    }
    text
}

/// The last line, cut within or behind one of its cells; what is left in doubt by it is not expected.
fn cut(dice: &mut Dice, text: &str, dialect: &Dialect, all: &mut [Written], row: usize) -> String {
    // The last cell is cut only as a whole: what is left of it would look like a number of its own.
    let kept = dice.whole(0, all.len() as i64 - 1) as usize;
    let cells: Vec<String> = all[..kept]
        .iter()
        .map(|column| column.cells[row].clone())
        .collect();
    let whole = line(
        &cells,
        &Dialect {
            trailing: false,
            ..dialect.clone()
        },
    );
    let rest = text.strip_prefix(&whole).unwrap_or("");
    let next = all[kept].cells[row].chars().count();
    let shown = if kept + 1 < all.len() && next > 1 {
        dice.whole(0, next as i64 - 1)
    } else {
        0
    } as usize;
    let cuts_time = all[kept..].iter().any(|column| column.is_time);
    for (index, column) in all.iter_mut().enumerate() {
        if let Some(Expect::Reading(value)) = column.expect.get(row).copied() {
            column.expect[row] = match index {
                _ if cuts_time => Expect::Gap,
                index if index < kept => Expect::Reading(value),
                index if index == kept && shown > 0 => Expect::Optional(value),
                _ => Expect::Gap,
            };
        }
    }
    whole + &rest.chars().take(shown).collect::<String>()
}

/// Text as bytes.
pub fn encoded(text: &str, dialect: &Dialect) -> Vec<u8> {
    let tail = vec![0; dialect.nul_tail];
    let mut bytes = match dialect.encoding {
        Encoding::Utf8 => text.as_bytes().to_vec(),
        Encoding::Utf8Bom => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        Encoding::Utf16Le => [0xfeff]
            .into_iter()
            .chain(text.encode_utf16())
            .flat_map(u16::to_le_bytes)
            .collect(),
        Encoding::Utf16Be => [0xfeff]
            .into_iter()
            .chain(text.encode_utf16())
            .flat_map(u16::to_be_bytes)
            .collect(),
        Encoding::Windows1252 => in_bytes(text, encoding_rs::WINDOWS_1252),
        Encoding::Other(encoding) => in_bytes(text, encoding),
    };
    bytes.extend(tail);
    bytes
}

/// In UTF-8 where that encoding lacks a letter.
fn in_bytes(text: &str, encoding: &'static encoding_rs::Encoding) -> Vec<u8> {
    let (bytes, _, is_lossy) = encoding.encode(text);
    if is_lossy {
        text.as_bytes().to_vec()
    } else {
        bytes.into_owned()
    }
}
