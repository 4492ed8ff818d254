//! Samples whose names are words for surroundings in other folders: `N2` beside `N1`, `Ar` beside `B`.

use ieap_ingest::name_pattern::{NoSurroundings, propose, tags_of_name};

use super::{Came, count};

#[test]
fn samples_in_families_are_no_surroundings_and_surroundings_stay() {
    count("names", 100, |dice| {
        let letter = dice.pick(&["N", "n", "O", "P", "S", "K"]);
        let lead = dice.pick(&["", "CP-", "x"]);
        let samples: Vec<String> = (1..=dice.whole(3, 5))
            .map(|k| format!("{lead}{letter}{k}"))
            .collect();
        let airs = dice.pick(&[&["air", "N2"][..], &["vacuum", "Ar"], &["空气", "氮气"], &[]]);
        let airs = if letter.eq_ignore_ascii_case("n") && airs.contains(&"N2") {
            &["air", "argon"]
        } else {
            airs
        };
        let mark = dice.pick(&["_", "-", " "]);
        let mut names = Vec::new();
        for sample in &samples {
            for k in 0..dice.whole(2, 4) {
                let mut parts = vec![sample.clone()];
                if !airs.is_empty() {
                    parts.push(dice.pick(airs).to_owned());
                }
                parts.push(format!("{:02}", k + 1));
                names.push((sample.clone(), parts));
            }
        }
        let stems: Vec<String> = names.iter().map(|(_, parts)| parts.join(mark)).collect();
        let stems: Vec<&str> = stems.iter().map(String::as_str).collect();
        let none = NoSurroundings::among(stems.iter().copied());
        let mut wrong = Vec::new();
        for ((sample, parts), stem) in names.iter().zip(&stems) {
            let tags = tags_of_name(stem, &none);
            let of = |key: &str| {
                tags.iter()
                    .find(|(known, _)| known == key)
                    .map(|(_, value)| value.as_str())
            };
            let is_right = (of("sample") == Some(sample.as_str()) || mark == "-" && lead == "CP-")
                && of("environment").is_some() == (parts.len() == 3);
            if !is_right {
                wrong.push(format!("{stem}: {tags:?}"));
            }
        }
        let pattern = propose(&stems, &none).map_or(String::new(), |found| found.pattern);
        if pattern.contains("{environment}") == airs.is_empty() {
            wrong.push(format!("{pattern} of {stems:?}"));
        }
        match wrong.first() {
            None => (Came::Right, String::new()),
            Some(first) => (Came::Wrong, first.clone()),
        }
    });
}
