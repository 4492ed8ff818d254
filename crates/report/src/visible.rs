//! Text from files as it may stand on a page: nothing in it is markup, and nothing in it stays unseen.

use std::io::{self, Write};

use ieap_domain::safe_text::stand_in;

pub use ieap_domain::safe_text::one_line;

/// Writes `text` for HTML or SVG, element content and quoted attributes alike.
///
/// Markup characters become entities. Control characters become their control pictures (`ESC` is `␛`), and
/// characters that reorder or hide text show as their code point, so that a name cannot pose as another.
///
/// # Errors
/// Those of the writer.
pub fn write_escaped(text: &str, out: &mut dyn Write) -> io::Result<()> {
    let mut plain_from = 0;
    for (at, character) in text.char_indices() {
        let Some(shown) = replacement(character) else {
            continue;
        };
        out.write_all(&text.as_bytes()[plain_from..at])?;
        out.write_all(shown.as_bytes())?;
        plain_from = at + character.len_utf8();
    }
    out.write_all(&text.as_bytes()[plain_from..])
}

/// `text` escaped as by [`write_escaped`].
pub fn escaped(text: &str) -> String {
    text.chars()
        .fold(String::with_capacity(text.len()), |mut out, character| {
            match replacement(character) {
                Some(shown) => out.push_str(&shown),
                None => out.push(character),
            }
            out
        })
}

/// `text` escaped as by [`write_escaped`], with the index c, which few fonts have as a letter, as a lowered one, and what is to
/// be typed, between back quotes, as code.
pub fn indexed(text: &str) -> String {
    let text = escaped(text).replace('\u{a700}', "<sub>c</sub>");
    let parts: Vec<&str> = text.split('`').collect();
    match parts.len() % 2 {
        1 => {
            let part = |(at, part): (usize, &&str)| match at % 2 {
                1 => format!("<code>{part}</code>"),
                _ => (*part).to_owned(),
            };
            parts.iter().enumerate().map(part).collect()
        }
        _ => text,
    }
}

/// What stands for a character that cannot stand for itself in markup.
fn replacement(character: char) -> Option<String> {
    let entity = match character {
        '&' => "&amp;",
        '<' => "&lt;",
        '>' => "&gt;",
        '"' => "&quot;",
        '\'' => "&#39;",
        other => return stand_in(other),
    };
    Some(entity.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_controls_and_reordering_are_shown_as_text() {
        let shown = escaped("<b a=\"x\" b='y'>&\u{1b}[31m\u{202e}\u{7f}\r\nµ");
        assert_eq!(
            shown,
            "&lt;b a=&quot;x&quot; b=&#39;y&#39;&gt;&amp;␛[31m⟨U+202E⟩␡␍\nµ"
        );
    }

    #[test]
    fn what_is_typed_is_code() {
        assert_eq!(indexed("run `ieap <run>`."), "run <code>ieap &lt;run&gt;</code>.");
        assert_eq!(indexed("a`b"), "a`b");
    }

    #[test]
    fn both_ways_to_escape_agree() {
        for text in ["", "plain", "<script>alert('1')</script>", "é\u{0}\u{85}ü"] {
            let mut written = Vec::new();
            write_escaped(text, &mut written).unwrap();
            assert_eq!(String::from_utf8(written).unwrap(), escaped(text));
        }
    }
}
