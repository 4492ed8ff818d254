//! Paths as text that people can read, that holds no control characters, and that reads back the same.

use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};

/// A relative path as text: `/` between the parts, bytes that are no UTF-8 as `\xff`, control characters and
/// signs that turn the writing direction as `\u{7}`, a backslash as `\\`.
pub fn display_path(path: &Path) -> String {
    let mut text = String::new();
    for component in path.components() {
        let part = match component {
            Component::Normal(part) => part,
            Component::ParentDir => OsStr::new(".."),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => continue,
        };
        if !text.is_empty() {
            text.push('/');
        }
        escape_into(part, &mut text);
    }
    text
}

/// The path that [`display_path`] made `text` of.
pub fn parse_display_path(text: &str) -> PathBuf {
    text.split('/').map(unescape).collect()
}

fn escape_into(part: &OsStr, text: &mut String) {
    for chunk in part.as_encoded_bytes().utf8_chunks() {
        for sign in chunk.valid().chars() {
            match sign {
                '\\' => text.push_str("\\\\"),
                _ if sign.is_control() || turns_direction(sign) => {
                    text.push_str(&format!("\\u{{{:x}}}", u32::from(sign)));
                }
                _ => text.push(sign),
            }
        }
        for byte in chunk.invalid() {
            text.push_str(&format!("\\x{byte:02x}"));
        }
    }
}

/// Whether a sign changes the direction in which text after it is shown: `gnp.exe` must not look like `exe.png`.
fn turns_direction(sign: char) -> bool {
    matches!(sign, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn unescape(part: &str) -> OsString {
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part;
    while let Some(at) = rest.find('\\') {
        bytes.extend_from_slice(&rest.as_bytes()[..at]);
        rest = &rest[at..];
        let (taken, meant) = escape_at(rest);
        bytes.extend_from_slice(&meant);
        rest = &rest[taken..];
    }
    bytes.extend_from_slice(rest.as_bytes());
    os_string(bytes)
}

/// Length of the escape that `text` starts with, and the bytes it means; a lone backslash means itself.
fn escape_at(text: &str) -> (usize, Vec<u8>) {
    if text.starts_with("\\\\") {
        return (2, vec![b'\\']);
    }
    if let Some(byte) = text
        .strip_prefix("\\x")
        .and_then(|rest| rest.get(..2))
        .and_then(|digits| u8::from_str_radix(digits, 16).ok())
    {
        return (4, vec![byte]);
    }
    let sign = text.strip_prefix("\\u{").and_then(|rest| {
        let digits = &rest[..rest.find('}')?];
        let sign = char::from_u32(u32::from_str_radix(digits, 16).ok()?)?;
        Some((digits.len() + 4, sign.to_string().into_bytes()))
    });
    sign.unwrap_or((1, vec![b'\\']))
}

#[cfg(unix)]
fn os_string(bytes: Vec<u8>) -> OsString {
    use std::os::unix::ffi::OsStringExt;
    OsString::from_vec(bytes)
}

#[cfg(not(unix))]
fn os_string(bytes: Vec<u8>) -> OsString {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::ffi::OsStringExt;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn odd_names_are_shown_plainly() {
        for (name, shown) in [
            (&b"runs/a.csv"[..], "runs/a.csv"),
            (b"./runs//a.csv", "runs/a.csv"),
            (b"runs/\xff\xfe.csv", "runs/\\xff\\xfe.csv"),
            (b"a\\b", "a\\\\b"),
            (b"bell\x07\n", "bell\\u{7}\\u{a}"),
            ("\u{202e}gpj.dta".as_bytes(), "\\u{202e}gpj.dta"),
            ("µ 🙂 .csv ".as_bytes(), "µ 🙂 .csv "),
        ] {
            let path = PathBuf::from(OsString::from_vec(name.to_vec()));
            assert_eq!(display_path(&path), shown);
        }
    }

    #[test]
    fn a_lone_backslash_typed_by_hand_means_itself() {
        assert_eq!(
            parse_display_path("a\\q\\xzz\\u{110000}"),
            PathBuf::from("a\\q\\xzz\\u{110000}")
        );
    }

    proptest! {
        #[test]
        fn every_name_reads_back(name in proptest::collection::vec(1u8..=255, 1..40)) {
            let name: Vec<u8> = name.into_iter().map(|byte| if byte == b'/' { b'\\' } else { byte }).collect();
            prop_assume!(name != b"." && name != b"..");
            let path = Path::new("runs").join(OsString::from_vec(name));
            let shown = display_path(&path);
            prop_assert!(!shown.chars().any(char::is_control));
            prop_assert_eq!(parse_display_path(&shown), path);
        }
    }
}
