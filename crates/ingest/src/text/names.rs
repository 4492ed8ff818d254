//! Names of columns held against the dictionary.
//!
//! A name is known as a whole; or, where its unit is one of the quantity, by a name that is contained in it (`OUT1 変位(mm)`,
//! `Sample Temp. [°C]`). A name that is not known is a column of its own; a profile says what it is
//! (`ieap profile FILE --column NAME=QUANTITY`).

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::LazyLock;

use super::dictionary::{
    DEW_POINTS, ELAPSED, QUANTITIES, ROLE_PARTS, ROLES, Role, SHEET_COLUMNS, TIMES, is_among,
};
use super::header::Header;
use crate::text::policy::LONGEST_NAME;
use ieap_domain::{Quantity, surroundings, unit};

/// What PalmSens writes before the name of a negated column.
pub(super) const NEGATED: &str = "neg. ";

/// Every known name of a column that a slip may lead to: one stroke more or less is another quantity.
pub(super) fn known_names() -> impl Iterator<Item = &'static str> {
    let names = QUANTITIES.iter().flat_map(|(_, names)| names.split(';'));
    names.filter(|name| !name.ends_with(['\'', '"', '\u{2032}', '\u{2033}']))
}

/// Names of one quantity.
pub fn names_of(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    let own = QUANTITIES
        .iter()
        .filter(move |(quantities, _)| quantities[0] == quantity);
    own.flat_map(|(_, names)| names.split(';'))
}

/// A text with half-width letters, digits and marks for full-width ones.
pub fn half_width(text: &str) -> Cow<'_, str> {
    const FULL: std::ops::RangeInclusive<char> = '\u{ff01}'..='\u{ff5e}';
    if text.is_ascii() || !text.contains(|c| FULL.contains(&c) || c == '\u{3000}') {
        return Cow::Borrowed(text);
    }
    let half = |c: char| match c {
        '\u{3000}' => ' ',
        c if FULL.contains(&c) => char::from_u32(c as u32 - 0xfee0).unwrap_or(c),
        c => c,
    };
    Cow::Owned(text.chars().map(half).collect())
}

/// `102 <current>` without the number of the input, as data loggers of Keysight name their columns.
fn without_channel(name: &str) -> &str {
    let label = name
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit())
        .trim_start();
    if label.starts_with('<') && label.ends_with('>') {
        label
    } else {
        name.trim()
    }
}

/// A name as the dictionary writes it.
fn plain(name: &str) -> String {
    let plain: String = without_channel(&half_width(name))
        .trim_start_matches('<')
        .trim_end_matches('>')
        .chars()
        .map(|c| if matches!(c, '_' | '-') { ' ' } else { c })
        .flat_map(char::to_lowercase)
        .collect();
    // Quotes for primes, doubled where the cell was quoted.
    let plain = plain
        .replace("\"\"", "\"")
        .replace('\u{201d}', "\"")
        .replace('\u{2019}', "'")
        .replace('\u{2212}', "");
    let plain = plain.strip_prefix(NEGATED).unwrap_or(&plain);
    let words: Vec<&str> = plain.split_whitespace().collect();
    words.join(" ")
}

/// Quantities that a whole name may stand for, the likeliest first; none for names that are not known.
pub(super) fn candidates(name: &str) -> &'static [Quantity] {
    static WHOLE: LazyLock<HashMap<&str, &[Quantity]>> = LazyLock::new(|| {
        let all = QUANTITIES
            .iter()
            .flat_map(|(quantities, names)| names.split(';').map(move |name| (name, *quantities)));
        all.collect()
    });
    WHOLE.get(plain(name).as_str()).copied().unwrap_or(&[])
}

/// Whether a text is written without blanks between words.
fn is_unspaced(text: &str) -> bool {
    text.chars().all(|c| c > '\u{2e80}')
}

/// Whether a name in the dictionary's form holds a word of it: as whole words, or as a part where words have no blanks between
/// them.
fn holds(plain: &str, word: &str) -> bool {
    let bounds = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric() || (c > '\u{2e80}'));
    let is_whole = |(at, _): (usize, &str)| {
        let (before, after) = (&plain[..at], &plain[at + word.len()..]);
        bounds(before.chars().next_back())
            && bounds(after.chars().next())
            && !after.starts_with(['\'', '"', '\u{2032}', '\u{2033}'])
    };
    if is_unspaced(word) {
        plain.contains(word)
    } else {
        plain.match_indices(word).any(is_whole)
    }
}

/// Whether a cell may hold a word. Most cells of most files are numbers, with a letter for their power of ten.
fn is_worded(cell: &str) -> bool {
    cell.chars().filter(|c| c.is_alphabetic()).nth(1).is_some()
}

/// Fewest letters of a name that may stand in another: letters and abbreviations stand in too many. Chosen.
const FEWEST_CONTAINED: usize = 4;
/// What may stand in a longer name although it has fewer letters, and names that may stand for other things there.
const SHORT_CONTAINED: &str = "rh;temp;temp.;e';e\";e'';e′;e″";
const NOT_CONTAINED: &str =
    "force;kraft;elapsed;x axis;phase;water;oxygen;volt;curr;working electrode;open circuit";

/// The quantity that a longer name speaks of whose unit is stated: the one of which a name is contained in it and whose unit it is.
/// None where it says two, or that it is no measurement.
pub(super) fn contained(name: &str, unit: &str) -> Option<Quantity> {
    if !is_worded(name) {
        return None;
    }
    let plain = plain(name);
    // A unit of its own in it says that the other is wrong.
    let in_brackets = |text: &&str| unit::is_known(text.split([')', ']', '}']).next().unwrap_or(""));
    if name.split(['(', '[', '{']).skip(1).any(|text| in_brackets(&text)) {
        return None;
    }
    // `Step time` is another time than `Time`.
    let is_time = |word: &str| candidates(word).first() == Some(&Quantity::Time);
    let may_stand = |word: &str| {
        let letters = word.chars().count();
        let is_long = if is_unspaced(word) {
            letters > 1
        } else {
            letters >= FEWEST_CONTAINED && !is_among(NOT_CONTAINED, word) && !is_time(word)
        };
        is_long || is_among(SHORT_CONTAINED, word)
    };
    let stands = |word: &&str| holds(&plain, word) && may_stand(word);
    let longest = |names: &'static str| names.split(';').filter(stands).max_by_key(|word| word.len());
    let found: Vec<(Quantity, &str)> = (QUANTITIES.iter())
        .filter_map(|(quantities, names)| Some((quantities[0], longest(names)?)))
        .collect();
    // A current density is no current.
    let is_part = |word: &str| {
        found
            .iter()
            .any(|(_, longer)| *longer != word && longer.contains(word))
    };
    let mut fitting = (found.iter())
        .filter(|(quantity, word)| !is_part(word) && unit::conversion(*quantity, unit).is_ok())
        .map(|(quantity, _)| *quantity);
    let quantity = fitting.next()?;
    let is_one = fitting.next().is_none();
    match role(name) {
        Role::Measured if is_one => Some(quantity),
        Role::Commanded if is_one && quantity == Quantity::Voltage => Some(Quantity::ControlVoltage),
        _ => None,
    }
}

/// What a column is, by the words of its name.
pub fn role(name: &str) -> Role {
    let lower = half_width(name).to_lowercase();
    let words = words_of(name);
    let says = |(_, known): &&(Role, &str)| {
        known.split(';').any(|known| {
            words.iter().any(|word| word == known)
                || (!known.is_ascii() && lower.contains(known))
                || (is_among(ROLE_PARTS, known) && lower.contains(known))
        })
    };
    ROLES.iter().find(says).map_or(Role::Measured, |(role, _)| *role)
}

/// Whether a word in small letters says that a column is measured.
pub fn says_measured(word: &str) -> bool {
    ROLES
        .iter()
        .any(|(role, words)| *role == Role::Measured && is_among(words, word))
}

/// The words of a name in small letters: split at marks, and before a capital after a small letter.
pub(crate) fn words_of(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in half_width(name).chars() {
        let starts = !before.is_alphanumeric() || (before.is_lowercase() && c.is_uppercase());
        match words.last_mut() {
            Some(word) if c.is_alphanumeric() && !starts => word.extend(c.to_lowercase()),
            _ if c.is_alphanumeric() => words.push(c.to_lowercase().collect()),
            _ => {}
        }
        before = c;
    }
    words
}

/// Whether a name is that of a dew point, which is no temperature of the air.
pub fn names_dew_point(name: &str) -> bool {
    let lower = name.to_lowercase();
    role(name) == Role::Derived && DEW_POINTS.split(';').any(|word| lower.contains(word))
}

/// Whether a name in small letters is that of a time which counts from the start of something.
pub fn counts_from_a_start(lower: &str) -> bool {
    ELAPSED.split(';').any(|word| lower.contains(word))
}

/// Whether a name is that of a time, a date or both.
pub fn names_time(name: &str) -> bool {
    if name.len() > LONGEST_NAME {
        return false;
    }
    let lower = name.to_lowercase();
    // Words stand inside others (`temps` in `tempsensor`): only those count that German and English compose of them.
    let parts = || lower.split(|c: char| !c.is_alphanumeric());
    let has_word = |word: &str| match word {
        "time" | "zeit" | "date" | "datum" => {
            parts().any(|part| part.starts_with(word) || part.ends_with(word))
        }
        word if word.is_ascii() => parts().any(|part| part == word),
        word => lower.contains(word),
    };
    is_unit_of_time(name)
        || Header::parse(name).meaning.named_quantity() == Some(Quantity::Time)
        || TIMES.split(';').any(has_word)
}

/// Whether a column is headed by a unit of time alone: `s`, `min`. A letter in upper case stands for something else.
pub fn is_unit_of_time(name: &str) -> bool {
    matches!(name.trim(), "s" | "ms" | "us" | "min" | "h")
}

/// Names of a column of run sheets.
pub(crate) fn names_of_sheet_column(key: &str) -> &'static str {
    SHEET_COLUMNS
        .iter()
        .find(|(known, _)| *known == key)
        .map_or("", |(_, names)| names)
}

/// The column of a run sheet that a name is: as a whole, or by a word in it where it states no unit.
pub(crate) fn sheet_column(name: &str) -> Option<&'static str> {
    if !is_worded(name) {
        return None;
    }
    let lower = half_width(name.trim()).to_lowercase().replace(['\n', '\r'], " ");
    let find = |is: &dyn Fn(&str) -> bool| {
        let column = SHEET_COLUMNS
            .iter()
            .find(|(key, names)| *key == lower || names.split(';').any(is));
        column.map(|(key, _)| *key)
    };
    let is_long =
        |known: &str| known.chars().count() >= if is_unspaced(known) { 2 } else { FEWEST_CONTAINED };
    find(&|known| known == lower).or_else(|| {
        let has_unit = !Header::parse(name).raw_unit.is_empty();
        let plain = plain(name);
        find(&|known| !has_unit && is_long(known) && holds(&plain, known))
    })
}

/// Whether a text that is not all of ASCII holds a word or unit of the dictionary: what shows that it was decoded rightly.
pub(super) fn speaks(text: &str) -> bool {
    /// Words of dates and half-days, in one letter each.
    const OF_DATES: &str = "年;月;日;時;分;秒;午前;午後;上午;下午;오전;오후";
    let lower = half_width(text).to_lowercase();
    let names = QUANTITIES
        .iter()
        .flat_map(|(_, names)| names.split(';'))
        .chain(SHEET_COLUMNS.iter().flat_map(|(_, names)| names.split(';')));
    let more = ROLES.iter().flat_map(|(_, words)| words.split(';'));
    let words = names
        .chain(more)
        .chain(TIMES.split(';'))
        .chain(surroundings::words());
    let mut long = words.filter(|word| !word.is_ascii() && word.chars().count() > 1);
    unit::is_known(text) || is_among(OF_DATES, text) || long.any(|word| lower.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_role_is_said_by_a_word_of_the_name() {
        for (name, expected) in [
            ("Temperature set (°C)", Role::Commanded),
            ("Humidity alarm (%)", Role::Limit),
            ("設定温度(℃)", Role::Commanded),
            ("Td (°C)", Role::Derived),
            ("Actual temp. (°C)", Role::Measured),
            ("Humidity (%)", Role::Measured),
            ("Asset temperature", Role::Measured),
        ] {
            assert_eq!(role(name), expected, "{name}");
        }
    }

    #[test]
    fn a_longer_name_says_its_quantity_where_its_unit_fits() {
        for (name, unit, expected) in [
            ("OUT1 変位", "mm", Some(Quantity::TipDisplacement)),
            ("Sample Temp.", "°C", Some(Quantity::Temperature)),
            ("貯蔵弾性率 E'", "MPa", Some(Quantity::StorageModulus)),
            ("損失弾性率 E\"", "MPa", Some(Quantity::LossModulus)),
            ("設定電圧", "V", Some(Quantity::ControlVoltage)),
            ("Cell current density", "mA/cm2", Some(Quantity::CurrentDensity)),
            ("Current range", "mA", None),
            ("Dew point temperature", "°C", None),
            ("Current of laser", "V", None),
            ("Distance1", "mm", None),
        ] {
            assert_eq!(contained(name, unit), expected, "{name}");
        }
    }

    #[test]
    fn columns_of_sheets_are_known_by_a_word() {
        for (name, expected) in [
            ("LabVIEWファイル", Some("file")),
            ("試料", Some("sample")),
            ("雰囲気", Some("environment")),
            ("Sample name", Some("sample")),
            ("Sample rate (Hz)", None),
            ("電圧(V)", None),
        ] {
            assert_eq!(sheet_column(name), expected, "{name}");
        }
    }
}
