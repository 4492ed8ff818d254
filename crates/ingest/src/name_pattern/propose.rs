//! Proposes a name pattern for files that have none: the one that explains the most of their names.

use std::collections::{BTreeMap, BTreeSet};

use super::words::{NoSurroundings, Says, Word};
use super::{IGNORED, KnownIds, NameMatch, NamePattern};
use ieap_domain::campaign::BUILT_IN_ENVIRONMENTS;
use ieap_domain::tag::keys;

/// A pattern with what it explains.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct ProposedPattern {
    /// The pattern.
    pub pattern: String,
    /// How many of the names it reads as their words say.
    pub explains: usize,
    /// How many names there are.
    pub names: usize,
    /// Words that it ignores (`{_}`), as they stand in the first names: only people know what they mean.
    pub ignored: Vec<String>,
}

/// What a name of a folder says, by tag key; values as tags have them. The first word that says nothing else is the sample.
pub fn tags_of_name(stem: &str, none: &NoSurroundings) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for word in none.words(stem) {
        let (key, value) = match word.says {
            Says::Tag { key, meant, .. } => (key, meant),
            Says::Other => (keys::SAMPLE, word.text),
            Says::Untold => continue,
        };
        if found.iter().all(|(known, _)| known != key) {
            found.push((key.to_owned(), value));
        }
    }
    found
}

/// The pattern that explains the most of these names; none where no two are alike, or none says anything.
pub fn propose(stems: &[&str], none: &NoSurroundings) -> Option<ProposedPattern> {
    let mut shapes: BTreeMap<String, Vec<Vec<Word>>> = BTreeMap::new();
    for stem in stems.iter().filter(|stem| !stem.contains(['{', '}'])) {
        let words = none.words(stem);
        shapes.entry(shape(&words)).or_default().push(words);
    }
    let candidates = shapes.into_values().filter_map(|names| pattern_of(&names));
    let judged = candidates.filter_map(|(text, ignored)| {
        let pattern = NamePattern::compile(&text).ok()?;
        let explains = stems
            .iter()
            .filter(|stem| explained(&pattern, stem, none))
            .count();
        let tags = pattern.keys().count();
        Some((
            (explains, tags),
            ProposedPattern {
                pattern: text,
                explains,
                names: stems.len(),
                ignored,
            },
        ))
    });
    let best = judged.max_by_key(|(rank, _)| *rank)?.1;
    (best.explains > 0).then_some(best)
}

/// Whether the pattern reads of a name what its words say.
pub fn explained(pattern: &NamePattern, stem: &str, none: &NoSurroundings) -> bool {
    let known = KnownIds {
        samples: &[],
        environments: &BUILT_IN_ENVIRONMENTS,
    };
    let NameMatch::One(read) = pattern.match_stem(stem, known) else {
        return false;
    };
    let of = |key: &str| {
        read.iter()
            .find(|(known, _)| known == key)
            .map(|(_, value)| value.as_str())
    };
    tags_of_name(stem, none)
        .iter()
        .all(|(key, value)| match key.as_str() {
            // A word that is the same in all names stands in the pattern as it is.
            keys::SAMPLE => of(key).is_none_or(|read| read == value),
            key => of(key).is_some_and(|read| is_same(read, value)),
        })
}

/// Whether two texts are one, or one number.
fn is_same(a: &str, b: &str) -> bool {
    let number = |text: &str| text.parse::<f64>().ok();
    a == b || number(a).is_some_and(|a| number(b) == Some(a))
}

/// The kinds of words with what stands between them: names of one shape have one pattern.
fn shape(words: &[Word]) -> String {
    let of = |word: &Word| match &word.says {
        Says::Tag { key, .. } => format!("{}{{{key}}}", word.before),
        Says::Untold => format!("{}{{untold}}", word.before),
        Says::Other => format!("{}{{}}", word.before),
    };
    words.iter().map(of).collect()
}

/// The pattern of names of one shape, with the words that it ignores: the first other word is the sample, one that is the
/// same in several names stands as it is, and of the others only people know what they mean.
fn pattern_of(names: &[Vec<Word>]) -> Option<(String, Vec<String>)> {
    let first = names.first()?;
    let (mut text, mut ignored, mut used) = (String::new(), Vec::new(), BTreeSet::new());
    for (at, word) in first.iter().enumerate() {
        text += &word.before;
        let column = || names.iter().map(|name| &name[at]);
        match &word.says {
            Says::Tag { key, .. } if used.insert(*key) => {
                let (prefix, suffix) = around(column());
                text += &format!("{prefix}{{{key}}}{suffix}");
            }
            Says::Other if used.insert(keys::SAMPLE) => text += &format!("{{{}}}", keys::SAMPLE),
            _ if names.len() > 1 && column().all(|other| other.text == word.text) => text += &word.text,
            _ => {
                text += &format!("{{{IGNORED}}}");
                ignored.push(word.text.clone());
            }
        }
    }
    // A number of a record alone tells nothing of the run.
    let tells = [keys::SAMPLE, keys::ENVIRONMENT, keys::VOLTAGE_V];
    tells
        .iter()
        .any(|key| used.contains(key))
        .then_some((text, ignored))
}

/// What stands around the value in all these words; nothing where they differ, for then it is part of its spelling.
fn around<'a>(mut column: impl Iterator<Item = &'a Word>) -> (&'a str, &'a str) {
    let of = |word: &'a Word| match &word.says {
        Says::Tag { prefix, suffix, .. } => (prefix.as_str(), suffix.as_str()),
        _ => ("", ""),
    };
    let first = column.next().map_or(("", ""), of);
    if column.all(|word| of(word) == first) {
        first
    } else {
        ("", "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn propose(stems: &[&str]) -> Option<ProposedPattern> {
        super::propose(stems, &NoSurroundings::among(stems.iter().copied()))
    }

    #[test]
    fn the_pattern_that_explains_the_most_names_is_proposed() {
        let stems = [
            "CNaf-01_air_rh34_2.5V_1",
            "CNaf-01_air_rh34_2.0V_2",
            "CNaf-02_inert_rh0_2.0V_1",
            "CNaf-02_vaccum_rh0_2.0V_1",
            "CV_CNaf-01",
        ];
        let found = propose(&stems).unwrap();
        assert_eq!(
            found.pattern,
            "{sample}_{environment}_rh{relative_humidity_percent}_{voltage_v}V_{cycle}"
        );
        assert_eq!((found.explains, found.names), (3, 5));
        assert!(found.ignored.is_empty());
        let slip = tags_of_name("CNaf-02_vaccum_rh0_2.0V_1", &NoSurroundings::default());
        assert!(
            slip.contains(&("environment".to_owned(), "vacuum".to_owned())),
            "{slip:?}"
        );
    }

    #[test]
    fn other_words_stand_as_they_are_or_are_ignored() {
        let found = propose(&["S1_IEAP_anna_2V", "S2_IEAP_ben_2V"]).unwrap();
        assert_eq!(found.pattern, "{sample}_IEAP_{_}_{voltage_v}V");
        assert_eq!(found.ignored, ["anna"]);
        assert_eq!(found.explains, 2);
        let days = propose(&["S1_2026-03-02_air", "S1_2026-03-03_air"]).unwrap();
        assert_eq!(days.pattern, "{sample}_{_}_{environment}");
        assert_eq!(days.explains, 2);
        // Which of two bare numbers counts runs, and what the other one is, a name does not say.
        let two = propose(&["S1_air_40_2V_1", "S1_air_80_2V_3"]).unwrap();
        assert_eq!(two.pattern, "{sample}_{environment}_{_}_{voltage_v}V_{_}");
        assert_eq!(two.ignored, ["40", "1"]);
        assert_eq!(propose(&["20260302"]), None);
        assert_eq!(propose(&["0001", "0002"]), None);
    }

    #[test]
    fn signs_and_spellings_of_a_voltage_are_one_pattern() {
        for (stems, pattern) in [
            (
                &["S1_vide_+2V", "S1_vide_-2V", "S1_argon_+1V"],
                "{sample}_{environment}_{voltage_v}V",
            ),
            (
                &["S1_vide_m2V", "S1_Luft_p2V", "S1_vide_1V0"],
                "{sample}_{environment}_{voltage_v}",
            ),
            (
                &["S1_õhk_-2000mV", "S1_vaakum_2,0V", "S1_argoon_+1,5V"],
                "{sample}_{environment}_{voltage_v}",
            ),
        ] {
            let found = propose(stems).unwrap();
            assert_eq!((found.pattern.as_str(), found.explains), (pattern, 3));
        }
    }
}
