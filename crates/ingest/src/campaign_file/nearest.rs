//! The known word nearest to a misspelt one.

/// The word of `known` that a slip of the keyboard turned into `word`: at most two letters changed, added or
/// lost, and no more than a third of the word. Letter case and `-` for `_` do not count.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let word = plain(word);
    let allowed = (word.chars().count() / 3).min(2);
    known
        .into_iter()
        .map(|candidate| (strsim::levenshtein(&word, &plain(candidate)), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_found_and_another_word_is_not() {
        let known = ["length_mm", "width_mm", "id"];
        assert_eq!(nearest("lenght_mm", known), Some("length_mm"));
        assert_eq!(nearest("Width-mm", known), Some("width_mm"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("ix", known), None);
    }
}
