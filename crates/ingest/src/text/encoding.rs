//! Bytes to text: byte order mark, then UTF-16 that every second byte shows, then strict UTF-8, then Windows-1252. No byte is ever dropped.
//!
//! Statistical guessing is left out on purpose: on instrument text with a few `°` or `µ` it takes
//! Windows-1252 for Big5.

use std::borrow::Cow;

use super::{Line, Lines};
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Text of a file with the encoding it was found in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded<'a> {
    /// The text without its byte order mark.
    pub text: Cow<'a, str>,
    /// `utf-8`, `utf-16le`, `utf-16be` or `windows-1252`.
    pub encoding: &'static str,
    /// Whether code units stood in it that mean nothing; each is shown as U+FFFD.
    pub has_replacements: bool,
}

impl Decoded<'_> {
    /// Its lines.
    pub fn lines(&self) -> Vec<Line<'_>> {
        Lines::new(&self.text).collect()
    }
}

/// Decodes the bytes of a text file.
pub fn decode(bytes: &[u8]) -> Decoded<'_> {
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => utf_8(rest),
        [0xFF, 0xFE, rest @ ..] => utf_16(rest, UTF_16LE, "utf-16le"),
        [0xFE, 0xFF, rest @ ..] => utf_16(rest, UTF_16BE, "utf-16be"),
        _ if is_utf_16_without_mark(bytes) => utf_16(bytes, UTF_16LE, "utf-16le"),
        _ => utf_8(bytes),
    }
}

/// Whether every second byte of the beginning is zero and no other, as in Latin text of Windows in UTF-16.
fn is_utf_16_without_mark(bytes: &[u8]) -> bool {
    const LOOKED_AT: usize = 128;
    let head = &bytes[..bytes.len().min(LOOKED_AT) & !1];
    head.len() >= 8 && head.chunks_exact(2).all(|unit| unit[0] != 0 && unit[1] == 0)
}

/// Strict UTF-8; a character that is cut off by the end of the file is no sign of another encoding, its line
/// is incomplete in any case.
fn utf_8(bytes: &[u8]) -> Decoded<'_> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Decoded {
            text: Cow::Borrowed(text),
            encoding: "utf-8",
            has_replacements: false,
        },
        Err(error) if error.error_len().is_none() && !bytes[..error.valid_up_to()].is_ascii() => Decoded {
            text: String::from_utf8_lossy(bytes),
            encoding: "utf-8",
            has_replacements: true,
        },
        Err(_) => Decoded {
            text: WINDOWS_1252.decode_without_bom_handling(bytes).0,
            encoding: "windows-1252",
            has_replacements: false,
        },
    }
}

fn utf_16<'a>(bytes: &'a [u8], encoding: &'static Encoding, name: &'static str) -> Decoded<'a> {
    let (text, has_replacements) = encoding.decode_without_bom_handling(bytes);
    Decoded {
        text,
        encoding: name,
        has_replacements,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf_16_bytes(text: &str, order: fn(u16) -> [u8; 2]) -> Vec<u8> {
        "\u{feff}"
            .encode_utf16()
            .chain(text.encode_utf16())
            .flat_map(order)
            .collect()
    }

    #[test]
    fn twins_in_every_encoding_read_the_same() {
        let text = "Current (\u{b5}A)\n1\n";
        for (bytes, encoding) in [
            (text.as_bytes().to_vec(), "utf-8"),
            ([b"\xEF\xBB\xBF", text.as_bytes()].concat(), "utf-8"),
            (utf_16_bytes(text, u16::to_le_bytes), "utf-16le"),
            (utf_16_bytes(text, u16::to_be_bytes), "utf-16be"),
            (utf_16_bytes(text, u16::to_le_bytes).split_off(2), "utf-16le"),
            (b"Current (\xB5A)\n1\n".to_vec(), "windows-1252"),
        ] {
            let decoded = decode(&bytes);
            assert_eq!((&*decoded.text, decoded.encoding), (text, encoding));
            assert!(!decoded.has_replacements);
        }
    }

    #[test]
    fn every_byte_of_windows_1252_is_kept() {
        let bytes: Vec<u8> = (1..=255).collect();
        let decoded = decode(&bytes);
        assert_eq!(decoded.encoding, "windows-1252");
        assert_eq!(decoded.text.chars().count(), bytes.len());
    }

    #[test]
    fn a_cut_character_or_code_unit_is_shown() {
        assert!(decode("\u{b5}\n\u{b5}".as_bytes().split_last().unwrap().1).has_replacements);
        assert!(decode(b"\xFF\xFEa\0\n").has_replacements);
    }
}
