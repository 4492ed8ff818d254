//! What the words of a file name say: an environment, a voltage, a humidity, a cycle, a sample.

use std::collections::{BTreeMap, BTreeSet};

use super::number::number;
use crate::campaign_file::nearest;
use crate::tags::value::shortest;
use crate::text::dictionary::{HUMIDITY_OF_NAMES, RUN_COUNTERS, is_among};
use crate::text::names::names_of_sheet_column;
use ieap_domain::surroundings;
use ieap_domain::tag::keys;

/// Digits of a number that counts runs, at most; more are a date.
const MOST_DIGITS: usize = 4;

/// One word of a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Word {
    /// The separators before it.
    pub before: String,
    /// The word as the name has it.
    pub text: String,
    /// What it says.
    pub says: Says,
}

/// What a word says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Says {
    /// A tag: its key, the text before the value, the value as written, the text behind it, and what it means.
    Tag {
        key: &'static str,
        prefix: String,
        written: String,
        suffix: String,
        meant: String,
    },
    /// A day, for which there is no tag, or one of several bare numbers: only people know which of them counts runs.
    Untold,
    /// Anything else: the sample, or something that only people know.
    Other,
}

/// The signs between the words of a name: `_` and blanks; `-` where there are neither.
pub(super) fn separators(stem: &str) -> &'static [char] {
    if stem.contains(['_', ' ']) {
        &['_', ' ']
    } else {
        &['-']
    }
}

/// Words that read as surroundings and are none, in small letters: what names of one folder have at one place is one kind of
/// thing, so beside `N1` and `N3` a strip called `N2` is no nitrogen.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NoSurroundings(BTreeSet<String>);

impl NoSurroundings {
    /// Those among the names of the files and folders in one folder, without their endings.
    pub fn among<'n>(stems: impl Iterator<Item = &'n str>) -> NoSurroundings {
        // Signs and count of words tell which names are built alike.
        let mut places: BTreeMap<(String, usize), BTreeSet<String>> = BTreeMap::new();
        let mut families: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
        for stem in stems {
            let words = split(stem);
            let build: String = words.iter().map(|(before, _)| format!("{before}.")).collect();
            for (at, (_, text)) in words.into_iter().enumerate() {
                let lower = text.to_lowercase();
                if let Some((before, number, behind)) = around_number(&lower) {
                    let family = families
                        .entry((before.to_owned(), behind.to_owned()))
                        .or_default();
                    family.insert(number.to_owned());
                }
                places.entry((build.clone(), at)).or_default().insert(lower);
            }
        }
        let is_one_of_family = |word: &String| {
            let family = around_number(word)
                .and_then(|(before, _, behind)| families.get(&(before.to_owned(), behind.to_owned())));
            family.is_some_and(|numbers| numbers.len() > 1)
        };
        let mut found = BTreeSet::new();
        for ((build, _), words) in places {
            let (read, others): (Vec<String>, Vec<String>) =
                words.into_iter().partition(|word| environment(word).is_some());
            // Of a place that holds mostly other things nothing is an environment; names of one word have no places.
            let is_place_of_others = build.len() > 1 && others.len() > read.len();
            found.extend(
                read.into_iter()
                    .filter(|word| is_place_of_others || is_one_of_family(word)),
            );
        }
        NoSurroundings(found)
    }

    /// The environment that the name of a folder among them stands for.
    pub fn environment_of(&self, name: &str) -> Option<String> {
        let lower = name.to_lowercase();
        environment(&lower).filter(|_| !self.0.contains(&lower))
    }

    /// The words of a name of the folder.
    pub(super) fn words(&self, stem: &str) -> Vec<Word> {
        let word = |(before, text): (String, String)| Word {
            says: self.says(&text),
            before,
            text,
        };
        with_one_count(with_number_of_sample(split(stem).into_iter().map(word).collect()))
    }

    fn says(&self, text: &str) -> Says {
        if self.0.contains(&text.to_lowercase()) {
            Says::Other
        } else {
            says(text)
        }
    }
}

/// The words of a name with the signs before each. A `-` behind another one that a digit follows is a sign.
fn split(stem: &str) -> Vec<(String, String)> {
    let separators = separators(stem);
    let (mut words, mut before, mut text) = (Vec::new(), String::new(), String::new());
    let mut signs = stem.chars().peekable();
    while let Some(c) = signs.next() {
        let is_minus = c == '-' && before.ends_with('-') && signs.peek().is_some_and(char::is_ascii_digit);
        if !separators.contains(&c) || (text.is_empty() && is_minus) {
            text.push(c);
            continue;
        }
        if !text.is_empty() {
            words.push((std::mem::take(&mut before), std::mem::take(&mut text)));
        }
        before.push(c);
    }
    if !text.is_empty() {
        words.push((before, text));
    }
    words
}

/// The words of a name as what they mean, `voltage_v=2` or `cnaf`, between signs of any kind: two names of one run share
/// them, whatever their spelling.
pub fn parts_of_name(stem: &str, none: &NoSurroundings) -> Vec<String> {
    let letters: Vec<char> = stem.chars().collect();
    let is_digit = |at: Option<usize>| {
        at.and_then(|at| letters.get(at))
            .is_some_and(char::is_ascii_digit)
    };
    let mut words = vec![String::new()];
    for (at, &c) in letters.iter().enumerate() {
        let starts = words.last().is_some_and(String::is_empty);
        let is_sign = c == '-' && starts && is_digit(Some(at + 1));
        let is_point = c == '.' && is_digit(at.checked_sub(1)) && is_digit(Some(at + 1));
        match words.last_mut() {
            Some(word) if !matches!(c, '_' | '-' | ' ' | '.') || is_sign || is_point => word.push(c),
            _ => words.push(String::new()),
        }
    }
    words.retain(|word| !word.is_empty());
    let meant = |word: String| match none.says(&word) {
        Says::Tag { key, meant, .. } => match meant.parse::<f64>() {
            Ok(number) => format!("{key}={}", shortest(number)),
            Err(_) => format!("{key}={meant}"),
        },
        Says::Untold | Says::Other => word.to_lowercase(),
    };
    words.into_iter().map(meant).collect()
}

/// A bare number right behind the first other word, which has none itself, is the sample's where more stands behind it:
/// `CNaf_01_air`.
fn with_number_of_sample(mut words: Vec<Word>) -> Vec<Word> {
    let Some(at) = words.iter().position(|word| word.says == Says::Other) else {
        return words;
    };
    let is_number = |word: &Word| word.text.bytes().all(|byte| byte.is_ascii_digit());
    let has_number = words[at].text.contains(|c: char| c.is_ascii_digit());
    if !has_number && at + 2 < words.len() && is_number(&words[at + 1]) && words[at + 1].says != Says::Untold
    {
        let number = words.remove(at + 1);
        words[at].text += &(number.before + &number.text);
    }
    words
}

/// Of several bare numbers none is known to count runs: `CNaf-01_air_40_2V_1`.
fn with_one_count(mut words: Vec<Word>) -> Vec<Word> {
    let is_bare = |word: &&mut Word| matches!(&word.says, Says::Tag { key: keys::CYCLE, prefix, .. } if prefix.is_empty());
    if words.iter_mut().filter(is_bare).count() > 1 {
        for word in words.iter_mut().filter(is_bare) {
            word.says = Says::Untold;
        }
    }
    words
}

fn says(text: &str) -> Says {
    let lower = text.to_lowercase();
    if let Some(environment) = environment(&lower) {
        return tag(keys::ENVIRONMENT, "", text, "", &environment);
    }
    if is_day(text) {
        return Says::Untold;
    }
    // Only a voltage has a sign, or its unit for a decimal point.
    let is_voltage = lower.contains('v') || text.starts_with(['+', '-', '−']);
    let spelt = || Some(shortest(number(keys::VOLTAGE_V, text).filter(|_| is_voltage)?));
    let Some((prefix, written, suffix)) = around_number(text) else {
        return match spelt() {
            Some(meant) => tag(keys::VOLTAGE_V, "", text, "", &meant),
            None => Says::Other,
        };
    };
    let meant = written.replace(',', ".");
    let (before, behind) = (prefix.to_lowercase(), suffix.to_lowercase());
    let is_whole = written.bytes().all(|byte| byte.is_ascii_digit());
    match (before.as_str(), behind.as_str()) {
        ("" | "u" | "e" | "v" | "+", "v" | "volt") => tag(
            keys::VOLTAGE_V,
            prefix.trim_end_matches('+'),
            written,
            suffix,
            &meant,
        ),
        (before, behind)
            if (is_among(HUMIDITY_OF_NAMES, before) && (behind.is_empty() || behind == "%"))
                || (before.is_empty() && is_among(HUMIDITY_OF_NAMES, behind)) =>
        {
            tag(keys::RELATIVE_HUMIDITY_PERCENT, prefix, written, suffix, &meant)
        }
        ("" | "t", "c" | "degc" | "°c") => tag(keys::TEMPERATURE_C, prefix, written, suffix, &meant),
        (before, "") if is_whole && written.len() <= MOST_DIGITS && counts_runs(before) => {
            tag(keys::CYCLE, prefix, written, suffix, &meant)
        }
        _ => match spelt() {
            Some(meant) => tag(keys::VOLTAGE_V, "", text, "", &meant),
            None => Says::Other,
        },
    }
}

/// Whether a word in small letters names a number that counts runs.
fn counts_runs(word: &str) -> bool {
    is_among(RUN_COUNTERS, word) || is_among(names_of_sheet_column(keys::CYCLE), word)
}

fn tag(key: &'static str, prefix: &str, written: &str, suffix: &str, meant: &str) -> Says {
    Says::Tag {
        key,
        prefix: prefix.to_owned(),
        written: written.to_owned(),
        suffix: suffix.to_owned(),
        meant: meant.to_owned(),
    }
}

/// The environment that a word stands for, a slip of the keyboard allowed for in longer ones.
fn environment(lower: &str) -> Option<String> {
    let slip = || {
        let long = surroundings::words().filter(|word| word.chars().count() > 2);
        let letters = lower.chars().count() > 3 && lower.chars().all(char::is_alphabetic);
        letters.then(|| nearest(lower, long)).flatten()
    };
    surroundings::id_of_word(lower).or_else(|| surroundings::id_of_word(slip()?))
}

/// Eight digits, or a date with `-` or `.`.
fn is_day(text: &str) -> bool {
    let digits = text.bytes().filter(u8::is_ascii_digit).count();
    let marks = text.bytes().filter(|byte| matches!(byte, b'-' | b'.')).count();
    let whole = text.len() == digits + marks;
    whole && ((digits == 8 && (marks == 0 || marks == 2)) || (digits == 6 && marks == 2))
}

/// Text before, number, text behind: `rh`, `34`, ``.
fn around_number(text: &str) -> Option<(&str, &str, &str)> {
    let start = text.find(|c: char| c.is_ascii_digit())?;
    let start = if text[..start].ends_with('-') {
        start - 1
    } else {
        start
    };
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',');
    let length = text[start..].trim_start_matches('-').find(|c| !of_number(c));
    let sign = usize::from(text[start..].starts_with('-'));
    let end = length.map_or(text.len(), |length| start + sign + length);
    let number = text[start..end].trim_end_matches(['.', ',']);
    let end = start + number.len();
    let is_number = number.replace(',', ".").parse::<f64>().is_ok();
    (is_number && !text[end..].contains(|c: char| c.is_ascii_digit()))
        .then(|| (&text[..start], number, &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_names_as_people_give_them() {
        let said = |stem: &str| -> Vec<String> {
            let shown = |word: Word| match word.says {
                Says::Tag { key, meant, .. } => format!("{key}={meant}"),
                Says::Untold => "untold".to_owned(),
                Says::Other => word.text,
            };
            let none = NoSurroundings::default();
            none.words(stem).into_iter().map(shown).collect()
        };
        for (stem, expected) in [
            (
                "CNaf-01_air_rh34_2.5V_1",
                vec![
                    "CNaf-01",
                    "environment=air",
                    "relative_humidity_percent=34",
                    "voltage_v=2.5",
                    "cycle=1",
                ],
            ),
            (
                "CNaf_01_Luft_35%_-2,5V_run03",
                vec![
                    "CNaf_01",
                    "environment=air",
                    "relative_humidity_percent=35",
                    "voltage_v=-2.5",
                    "cycle=03",
                ],
            ),
            (
                "CPvf vaccum 2V",
                vec!["CPvf", "environment=vacuum", "voltage_v=2"],
            ),
            (
                "S1-air-2.0V-20260302",
                vec!["S1", "environment=air", "voltage_v=2.0", "untold"],
            ),
            ("CV_sweep_S2", vec!["CV", "sweep", "S2"]),
            ("2026-03-02_logger", vec!["untold", "logger"]),
            ("22degC_S3_7", vec!["temperature_c=22", "S3", "cycle=7"]),
        ] {
            assert_eq!(said(stem), expected, "{stem}");
        }
    }
}
