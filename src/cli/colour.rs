//! Colour for people: only where it is asked for or a person looks on, and never against NO_COLOR (<https://no-color.org>).

use std::borrow::Cow;
use std::ffi::OsString;

use clap::{ColorChoice, ValueEnum};

/// What is coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// An error: bold red.
    Error,
    /// A warning: bold yellow.
    Warning,
    /// A line that heads others: bold.
    Heading,
}

impl Ink {
    /// Parameters of the sequence "select graphic rendition" (ECMA-48).
    fn code(self) -> &'static str {
        match self {
            Ink::Error => "1;31",
            Ink::Warning => "1;33",
            Ink::Heading => "1",
        }
    }
}

/// What `--color` says, before the command line is understood: help and wrong usage are coloured by it too.
pub fn asked(arguments: impl IntoIterator<Item = OsString>) -> ColorChoice {
    let words: Vec<String> = arguments
        .into_iter()
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let after = words
        .windows(2)
        .filter(|pair| pair[0] == "--color")
        .map(|pair| pair[1].as_str());
    let joined = words.iter().filter_map(|word| word.strip_prefix("--color="));
    let said = after
        .chain(joined)
        .last()
        .and_then(|said| ColorChoice::from_str(said, false).ok());
    said.unwrap_or(ColorChoice::Auto)
}

/// Whether a stream is coloured.
pub fn is_wanted(choice: ColorChoice, is_terminal: bool) -> bool {
    let says_no = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_some_and(|kind| kind == "dumb");
    match choice {
        ColorChoice::Always => true,
        ColorChoice::Never => false,
        ColorChoice::Auto => is_terminal && !is_dumb && !says_no("NO_COLOR"),
    }
}

/// `text` in that ink.
pub fn painted(text: &str, ink: Ink, is_wanted: bool) -> Cow<'_, str> {
    if is_wanted {
        format!("\u{1b}[{}m{text}\u{1b}[0m", ink.code()).into()
    } else {
        text.into()
    }
}

/// `text` with its first word in ink where that is `error:` or `warning:`.
pub fn first_word(text: &str, is_wanted: bool) -> Cow<'_, str> {
    let inks = [("error:", Ink::Error), ("warning:", Ink::Warning)];
    let found = inks
        .into_iter()
        .find_map(|(word, ink)| Some((word, ink, text.strip_prefix(word)?)));
    match found {
        Some((word, ink, rest)) if is_wanted => format!("{}{rest}", painted(word, ink, true)).into(),
        _ => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_word_on_colour_counts() {
        let of = |words: &[&str]| asked(words.iter().map(OsString::from));
        assert_eq!(of(&["ieap", "run"]), ColorChoice::Auto);
        assert_eq!(of(&["ieap", "--color", "never", "run"]), ColorChoice::Never);
        assert_eq!(
            of(&["ieap", "--color=never", "--color=always"]),
            ColorChoice::Always
        );
        assert_eq!(
            of(&["ieap", "--color=red"]),
            ColorChoice::Auto,
            "clap refuses it later"
        );
    }

    #[test]
    fn only_the_first_word_is_coloured_and_only_where_wanted() {
        assert_eq!(
            first_word("error: no file", true),
            "\u{1b}[1;31merror:\u{1b}[0m no file"
        );
        assert_eq!(first_word("error: no file", false), "error: no file");
        assert_eq!(first_word("no error: here", true), "no error: here");
        assert!(is_wanted(ColorChoice::Always, false) && !is_wanted(ColorChoice::Never, true));
        assert!(!is_wanted(ColorChoice::Auto, false));
    }
}
