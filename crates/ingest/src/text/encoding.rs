//! Bytes to text: byte order mark, then UTF-16 that its zero bytes show, then strict UTF-8, then an encoding of one language
//! group. No byte is ever dropped.
//!
//! Which of the latter it is the dictionary of names and units is asked first: the right encoding makes words of it. A detector that
//! knows only letters takes the `°` of Windows-1252 for Big5; it decides where the dictionary cannot.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::names::speaks;
use super::{Line, Lines};
use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{
    BIG5, EUC_JP, EUC_KR, Encoding, GBK, KOI8_R, SHIFT_JIS, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1251,
    WINDOWS_1252, WINDOWS_1253, WINDOWS_1254, WINDOWS_1257,
};

/// Text of a file with the encoding it was found in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded<'a> {
    /// The text without its byte order mark.
    pub text: Cow<'a, str>,
    /// `utf-8`, `utf-16le`, `utf-16be`, or the name of another one as standards write it.
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
        _ => match utf_16_without_mark(bytes) {
            Some((encoding, name)) => utf_16(bytes, encoding, name),
            None => utf_8(bytes),
        },
    }
}

/// The order of bytes of UTF-16 without a mark: digits and line ends have a zero on one side, hardly anything has one on the other,
/// and all of it is text.
fn utf_16_without_mark(bytes: &[u8]) -> Option<(&'static Encoding, &'static str)> {
    const LOOKED_AT: usize = 4096;
    /// Share of units that are of ASCII in a table of numbers, whatever language its names are in. Chosen.
    const LEAST_ASCII: f64 = 0.2;
    /// How many times fewer zeros stand on the other side. Chosen.
    const FEWER: usize = 10;
    let head = &bytes[..bytes.len().min(LOOKED_AT) & !1];
    let zeros = |side: usize| head.chunks_exact(2).filter(|unit| unit[side] == 0).count();
    let is_text = |encoding: &'static Encoding| {
        let text = encoding.decode_without_bom_handling_and_without_replacement(head);
        text.is_some_and(|text| {
            let is_plain = |c: char| !c.is_control() || matches!(c, '\t' | '\r' | '\n');
            text.chars().all(is_plain) && (text.contains('\n') || head.len() < LOOKED_AT)
        })
    };
    let is_one = |side: usize, encoding| {
        let (own, other) = (zeros(side), zeros(1 - side));
        // The sign for one, U+4E00, has its zero on the other side.
        FEWER * other <= own && own as f64 >= LEAST_ASCII * (head.len() / 2) as f64 && is_text(encoding)
    };
    if head.len() < 8 {
        None
    } else if is_one(1, UTF_16LE) {
        Some((UTF_16LE, "utf-16le"))
    } else {
        is_one(0, UTF_16BE).then_some((UTF_16BE, "utf-16be"))
    }
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
        Err(_) => {
            let encoding = detected(bytes);
            let (text, has_replacements) = encoding.decode_without_bom_handling(bytes);
            Decoded {
                text,
                encoding: encoding.name(),
                has_replacements,
            }
        }
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

/// Encodings that are tried, the usual one first.
const TRIED: [&Encoding; 12] = [
    WINDOWS_1252,
    SHIFT_JIS,
    EUC_JP,
    GBK,
    BIG5,
    EUC_KR,
    WINDOWS_1250,
    WINDOWS_1251,
    KOI8_R,
    WINDOWS_1257,
    WINDOWS_1253,
    WINDOWS_1254,
];
/// Bytes of a file that are asked: the head that recognition sees, so that all who ask find the same.
const BYTES_ASKED: usize = super::policy::HEAD_BYTES;
/// Different words that are asked. Chosen.
const WORDS_ASKED: usize = 256;

/// The encoding under which the most words are known; of several the detector's, else the usual one. What stands behind a NUL byte
/// is no text of these.
fn detected(bytes: &[u8]) -> &'static Encoding {
    let head = &bytes[..bytes.len().min(BYTES_ASKED)];
    let head = head.split(|byte| *byte == 0).next().unwrap_or(head);
    let words = foreign_words(head);
    let known = |encoding: &'static Encoding| {
        let texts: Option<Vec<Cow<'_, str>>> = (words.iter())
            .map(|word| encoding.decode_without_bom_handling_and_without_replacement(word))
            .collect();
        Some((encoding, texts?.iter().filter(|text| speaks(text)).count()))
    };
    let counts: Vec<(&Encoding, usize)> = TRIED.into_iter().filter_map(known).collect();
    let most = counts.iter().map(|(_, count)| *count).max().unwrap_or(0);
    let mut best = counts
        .iter()
        .filter(|(_, count)| *count == most)
        .map(|(encoding, _)| *encoding);
    let usual = best.clone().next().unwrap_or(WINDOWS_1252);
    // A sign of a unit is no letter of a language.
    if words
        .iter()
        .all(|word| word.iter().filter(|byte| !byte.is_ascii()).count() < 2)
    {
        return usual;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(head, true);
    let guess = detector.guess(None, Utf8Detection::Deny);
    best.find(|encoding| *encoding == guess).unwrap_or(usual)
}

/// The different words of a text that are not all of ASCII. Delimiters, digits and blanks are no part of a character in the
/// encodings that are tried; the last word may be cut.
fn foreign_words(head: &[u8]) -> BTreeSet<&[u8]> {
    let mut words: Vec<&[u8]> = head.split(|byte| *byte < 0x40 && !b"/%".contains(byte)).collect();
    if words.len() > 1 && head.len() == BYTES_ASKED {
        words.pop();
    }
    words
        .into_iter()
        .filter(|word| !word.is_ascii())
        .take(WORDS_ASKED)
        .collect()
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
    fn a_tail_of_zero_bytes_hides_no_encoding() {
        let (bytes, _, _) = GBK.encode("传感器,温度 [K],相对湿度 [% RH]\n1,328.92,50.589\n");
        let decoded = [bytes.as_ref(), &[0; 40]].concat();
        assert_eq!(decode(&decoded).encoding, "GBK");
    }

    #[test]
    fn every_byte_of_windows_1252_is_kept() {
        let bytes: Vec<u8> = (1..=255).collect();
        let decoded = decode(&bytes);
        assert_eq!(decoded.encoding, "windows-1252");
        assert_eq!(decoded.text.chars().count(), bytes.len());
    }

    #[test]
    fn words_of_the_dictionary_show_the_encoding() {
        for (encoding, text) in [
            (SHIFT_JIS, "経過時間[秒],電圧[V],電流[mA]\n0,0,1\n"),
            (
                SHIFT_JIS,
                "日時,温度(℃),湿度(%)\n2026/03/19 午前11:40:00,21.00,45.0\n",
            ),
            (EUC_JP, "時間(s),電圧(V),電流(mA)\n0,0,1\n"),
            (GBK, "时间(s),电压(V),电流(mA)\n0,0,1\n"),
            (BIG5, "時間(秒),電壓(V),電流(mA)\n0,0,1\n"),
            (EUC_KR, "시간(s),전압(V),전류(mA)\n0,0,1\n"),
            (
                WINDOWS_1250,
                "Czas [s];Napi\u{119}cie [V];Pr\u{105}d [mA]\n0;0;1\n",
            ),
            (WINDOWS_1251, "Время (с);Напряжение (В);Ток (мА)\n0;0;1\n"),
            (KOI8_R, "Время (с);Напряжение (В);Ток (мА)\n0;0;1\n"),
            (
                WINDOWS_1252,
                "Zeit (s);Kr\u{fc}mmung (1/m);Temp (\u{b0}C)\n0;0;1\n",
            ),
            (WINDOWS_1252, "Sample;Current (\u{b5}A)\n0;0\n"),
            (WINDOWS_1252, "\u{d8} 12 \u{b1} 0,1\nt/s;T/\u{b0}C\n0;0\n"),
        ] {
            let (bytes, _, is_lossy) = encoding.encode(text);
            let decoded = decode(&bytes);
            assert!(
                !is_lossy && decoded.text == text,
                "{text}: {} {}",
                decoded.encoding,
                decoded.text
            );
        }
        let text = "Zeit (s),Strom (\u{b5}A)\n0,1\n";
        let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(decode(&bytes).encoding, "utf-16be");
    }

    #[test]
    fn a_cut_character_or_code_unit_is_shown() {
        assert!(decode("\u{b5}\n\u{b5}".as_bytes().split_last().unwrap().1).has_replacements);
        assert!(decode(b"\xFF\xFEa\0\n").has_replacements);
    }
}
