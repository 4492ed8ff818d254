//! Text from files and names, safe to print on a terminal.

use std::borrow::Cow;

use crate::domain::safe_text::{is_unseen, replaced};

/// `text` with control characters (but line ends and tabs) and direction marks written as `\u{..}`, so that a
/// file name or a header can neither move the cursor nor disguise itself.
pub fn printable(text: &str) -> Cow<'_, str> {
    replaced(text, is_unseen, |character| {
        character.escape_unicode().to_string()
    })
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
