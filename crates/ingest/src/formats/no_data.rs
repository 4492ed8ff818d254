//! Files that lie beside runs and are no data: pictures, documents, notes in words. Nobody has to do anything about them.

use super::error::ReadError;
use super::format::FileHead;

/// A text of people: notes and programs. A table of another name may be a failed export, which somebody must hear of.
const OF_PEOPLE: [&str; 14] = [
    "", "txt", "md", "rst", "tex", "rtf", "py", "m", "r", "sh", "bat", "ini", "yaml", "yml",
];

/// What a file is that is no data; none for any other.
pub(super) fn check(head: &FileHead<'_>) -> Result<(), ReadError> {
    let is_prose = OF_PEOPLE.contains(&head.extension().as_str()) && is_prose(head);
    match picture_or_document(head.bytes) {
        Some((kind, sign)) => Err(ReadError::NoData { kind, sign }),
        None if is_prose => Err(ReadError::NoData {
            kind: "a text",
            sign: "no two of its lines hold numbers",
        }),
        None => Ok(()),
    }
}

fn picture_or_document(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let begins = |with: &[u8]| bytes.starts_with(with);
    Some(match bytes {
        _ if begins(b"%PDF") => ("a PDF document", "it begins with %PDF"),
        _ if begins(b"\xff\xd8\xff") => ("a picture", "it begins as JPEG does"),
        _ if begins(b"\x89PNG\r\n\x1a\n") => ("a picture", "it begins as PNG does"),
        _ if begins(b"GIF8") => ("a picture", "it begins with GIF8"),
        _ if begins(b"II*\0") || begins(b"MM\0*") => ("a picture", "it begins as TIFF does"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
            ("a picture", "it begins as WebP does")
        }
        [_, _, _, _, rest @ ..] if rest.starts_with(b"ftyphei") => ("a picture", "it begins as HEIC does"),
        [b'P', b'K', 3, 4, ..] if holds(bytes, b"word/") => ("a Word document", "a zip archive of word/"),
        [b'P', b'K', 3, 4, ..] if holds(bytes, b"ppt/") => ("slides", "a zip archive of ppt/"),
        _ => return None,
    })
}

fn holds(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

/// Whether a text has words, and no two lines of numbers as every table has.
fn is_prose(head: &FileHead<'_>) -> bool {
    let Some(text) = head.text().filter(|text| !text.contains('\0')) else {
        return false;
    };
    // A number, a date or a time of day; the mark of a list stands beside a word.
    let is_number = |field: &&str| {
        field
            .trim_start_matches(['-', '+', '.', '"'])
            .starts_with(|c: char| c.is_ascii_digit())
    };
    let of_numbers = |line: &&str| {
        let fields: Vec<&str> = line
            .split([' ', '\t', ';', '|', ','])
            .filter(|field| !field.is_empty())
            .collect();
        2 * fields.iter().filter(|field| is_number(field)).count() > fields.len()
    };
    text.contains(char::is_alphabetic) && text.lines().filter(of_numbers).nth(1).is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recognise;

    fn of(name: &str, bytes: &[u8]) -> Result<&'static str, &'static str> {
        let found = recognise(&FileHead::of(name, bytes));
        found.map(|(format, _)| format.id()).map_err(|error| error.code())
    }

    #[test]
    fn notes_programs_pictures_and_documents_are_no_data() {
        let (notes, _, _) = encoding_rs::SHIFT_JIS.encode("測定メモ：湿度が高い。\n明日もう一度測る。\n");
        for (name, bytes) in [
            (
                "notes.txt",
                "Mounted anew.\nThe laser stands 2 mm to the left, 45 % RH at 12:30.\n".as_bytes(),
            ),
            ("memo.txt", &notes),
            ("README.md", b"# Runs\n\n1. dry\n2. humid\n"),
            ("fit.py", b"import os\nfor k in range(3):\n    print(k, 2.0)\n"),
            ("strip.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0"),
            ("manual.txt", b"%PDF-1.4\n"),
        ] {
            assert_eq!(of(name, bytes), Err("no-data"), "{name}");
        }
    }

    #[test]
    fn what_has_lines_of_numbers_or_the_name_of_a_table_is_somebody_s_question() {
        for (name, bytes) in [
            ("run.txt", "words of a header\n1 2\n3 4\n".as_bytes()),
            ("run.txt", b"alpha\n1.5\n2.5\n"),
            ("run.csv", b"some words\nand more\n"),
            ("run.bin", b"\x01\x02words"),
        ] {
            assert_ne!(of(name, bytes), Err("no-data"), "{name}");
        }
    }
}
