//! How long a tag may be, wherever it is stated.

use ieap_domain::{Issue, Tag};

/// Letters of a key. Chosen: the longest that the program knows has 39.
const LONGEST_KEY: usize = 64;
/// Letters of a value. Chosen: a note of several pages.
const LONGEST_VALUE: usize = 10_000;

/// Code of what is said of a tag that is too long.
pub const TOO_LONG: &str = "tag-too-long";

/// Letters of a key that are shown.
const SHOWN: usize = 20;

/// What is said of a key or a value that is too long; the tag is not used.
pub(super) fn objection(tag: &Tag) -> Option<Issue> {
    of_key(&tag.key).or_else(|| {
        let message = longer(&tag.value, LONGEST_VALUE)?;
        let mend = "write less, or keep the text in a file and its name in the tag";
        Some(Issue::error(TOO_LONG, format!("the value of `{}` {message}", tag.key)).mend(mend))
    })
}

/// The same of a key alone.
pub(super) fn of_key(key: &str) -> Option<Issue> {
    let message = longer(key, LONGEST_KEY)?;
    let begin: String = key.chars().take(SHOWN).collect();
    let message = format!("the tag key `{begin}...` {message}");
    Some(Issue::error(TOO_LONG, message).mend("give the tag a shorter key, such as batch_number"))
}

fn longer(text: &str, longest: usize) -> Option<String> {
    let letters = text.chars().count();
    (letters > longest).then(|| format!("has {letters} letters, and may have {longest}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::TagSource;
    use ieap_domain::tag::keys;

    fn tag(key: usize, value: usize) -> Tag {
        Tag {
            key: "k".repeat(key),
            value: "µ".repeat(value),
            source: TagSource::Sidecar,
            detail: String::new(),
        }
    }

    #[test]
    fn keys_and_values_have_a_length_that_what_is_known_keeps() {
        assert_eq!(objection(&tag(LONGEST_KEY, LONGEST_VALUE)), None);
        let refused = objection(&tag(1_000_000, 1)).unwrap();
        assert_eq!(refused.code, "tag-too-long");
        assert!(refused.message.len() < 100, "{}", refused.message);
        assert!(objection(&tag(1, LONGEST_VALUE + 1)).is_some());
        for key in [&keys::CONDITIONS[..], &keys::RECORD, &keys::OTHERS].concat() {
            assert_eq!(of_key(key), None);
        }
    }
}
