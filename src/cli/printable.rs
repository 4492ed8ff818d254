//! Text from files and names, safe to print on a terminal.

use std::borrow::Cow;

/// `text` with control characters (but line ends and tabs) and direction marks written as `\u{..}`, so that a
/// file name or a header can neither move the cursor nor disguise itself.
pub fn printable(text: &str) -> Cow<'_, str> {
    let hidden = |c: char| {
        (c.is_control() && c != '\n' && c != '\t')
            || ('\u{202a}'..='\u{202e}').contains(&c)
            || ('\u{2066}'..='\u{2069}').contains(&c)
    };
    if !text.chars().any(hidden) {
        return Cow::Borrowed(text);
    }
    let show = |c: char| {
        if hidden(c) {
            c.escape_unicode().to_string()
        } else {
            c.to_string()
        }
    };
    Cow::Owned(text.chars().map(show).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_shown_and_plain_text_is_left() {
        assert_eq!(printable("a\u{1b}[31mred"), "a\\u{1b}[31mred");
        assert_eq!(printable("abc\u{202e}txt"), "abc\\u{202e}txt");
        assert!(matches!(printable("µA, 2.5 V\n"), Cow::Borrowed(_)));
    }
}
