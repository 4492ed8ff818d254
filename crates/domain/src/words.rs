//! Words that every sentence needs: how many of something, and things in a row.

/// Nouns that take more than an `s` where there are several.
const IRREGULAR: [(&str, &str); 3] = [
    ("analysis", "analyses"),
    ("diagnosis", "diagnoses"),
    ("spectrum", "spectra"),
];

/// `1 run`, `3 runs`, `2 modulus analyses`.
pub fn counted(count: usize, noun: &str) -> String {
    if count == 1 {
        return format!("1 {noun}");
    }
    let irregular = IRREGULAR
        .iter()
        .find_map(|(one, several)| Some((noun.strip_suffix(one)?, several)));
    match irregular {
        Some((before, several)) => format!("{count} {before}{several}"),
        None => format!("{count} {noun}s"),
    }
}

/// `two`, up to ten; `11`.
pub fn numeral(count: usize) -> String {
    const WORDS: [&str; 11] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    ];
    WORDS
        .get(count)
        .map_or_else(|| count.to_string(), |word| (*word).to_owned())
}

/// `a`, `a and b`, `a, b and c`.
pub fn in_a_row<T: AsRef<str>>(words: &[T]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The same with a large first letter.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_of_something_are_counted_as_english_does() {
        assert_eq!(counted(0, "run"), "0 runs");
        assert_eq!(counted(1, "spectrum"), "1 spectrum");
        assert_eq!(counted(2, "spectrum"), "2 spectra");
        assert_eq!(counted(5, "modulus analysis"), "5 modulus analyses");
        assert_eq!([2, 11].map(numeral), ["two", "11"]);
    }

    #[test]
    fn things_stand_in_a_row() {
        assert_eq!(in_a_row::<&str>(&[]), "");
        assert_eq!(in_a_row(&["a"]), "a");
        assert_eq!(in_a_row(&["a", "b", "c"]), "a, b and c");
        assert_eq!(capital("ähnlich"), "Ähnlich");
    }
}
