//! Which tag keys are known: those with a meaning, those that campaign.toml declares, and slips of either.

use std::collections::BTreeSet;

use super::length;
use crate::campaign_file::nearest;
use crate::text::header::Header;
use ieap_domain::tag::keys;
use ieap_domain::{Issue, Quantity, Tag, TagSource};

/// Other words for keys with a meaning, which neither their letters nor a quantity leads to.
const OTHER_WORDS: [(&str, &str); 14] = [
    ("exclude", keys::LEAVE_OUT),
    ("excluded", keys::LEAVE_OUT),
    ("skip", keys::LEAVE_OUT),
    ("ignore", keys::LEAVE_OUT),
    ("strip", keys::SAMPLE),
    ("atmosphere", keys::ENVIRONMENT),
    ("gas", keys::ENVIRONMENT),
    ("date", keys::STARTED_AT),
    ("datetime", keys::STARTED_AT),
    ("user", keys::OPERATOR),
    ("device", keys::INSTRUMENT),
    ("comment", keys::NOTE),
    ("remark", keys::NOTE),
    ("feuchte", keys::RELATIVE_HUMIDITY_PERCENT),
];

/// What is known of a tag key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TagKey {
    /// It has a meaning of its own.
    Known,
    /// campaign.toml declares it, `[tags] extra`.
    Declared,
    /// It is neither, and one that is was probably meant.
    Near(String),
    /// It is neither, and no other was meant.
    Unknown,
}

/// What is known of `key`; `extra` are the keys that campaign.toml declares.
pub fn tag_key(key: &str, extra: &[String]) -> TagKey {
    if has_meaning(key) {
        return TagKey::Known;
    }
    if extra.iter().any(|declared| declared == key) {
        return TagKey::Declared;
    }
    let known = || {
        keys::CONDITIONS
            .into_iter()
            .chain(keys::RECORD)
            .chain(keys::OTHERS)
    };
    let plain = key.to_lowercase().replace('-', "_");
    let by_word = OTHER_WORDS.iter().find(|(word, _)| *word == plain);
    by_word
        .map(|(_, meant)| *meant)
        .or_else(|| nearest(key, known().chain(extra.iter().map(String::as_str))))
        .or_else(|| known().find(|known| is_part(&plain, known)))
        .or_else(|| of_quantity(key, known()))
        .map_or(TagKey::Unknown, |meant| TagKey::Near(meant.to_owned()))
}

fn has_meaning(key: &str) -> bool {
    let names_column = key
        .strip_suffix(keys::COLUMN)
        .is_some_and(|quantity| Quantity::from_key(quantity).is_some());
    names_column
        || keys::CONDITIONS.contains(&key)
        || keys::RECORD.contains(&key)
        || keys::OTHERS.contains(&key)
}

/// Whether every word of `key` is one of the known key's, or a slip of one: `humidity`, `rest_before`, `humidty`.
fn is_part(key: &str, known: &str) -> bool {
    let is_meant = |word: &str, other: &str| word == other || nearest(word, [other]).is_some();
    key.chars().count() > 2
        && key
            .split('_')
            .all(|word| known.split('_').any(|other| is_meant(word, other)))
}

/// The tag of the quantity that the key speaks of in another spelling or unit: `rh`, `voltage_mv`.
fn of_quantity<'k>(key: &str, mut known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    let quantity = Header::parse(key).meaning.named_quantity()?;
    known.find(|known| *known == quantity.column())
}

/// Code of the issue of a key that is probably a slip.
pub const MISSPELT: &str = "tag-key-misspelt";
/// Code of the issue of any other key that campaign.toml does not declare.
pub const UNDECLARED: &str = "tag-undeclared";

/// What is wrong with a key, and how to mend it; none where it may be used.
pub fn objection(key: &str, extra: &[String]) -> Option<Issue> {
    if let Some(issue) = length::of_key(key) {
        return Some(issue);
    }
    let declare = format!("declare it in campaign.toml: [tags] extra = [\"{key}\"]");
    match tag_key(key, extra) {
        TagKey::Known | TagKey::Declared => None,
        TagKey::Near(meant) => Some(
            Issue::warning(MISSPELT, format!("`{key}` is no tag that ieap knows"))
                .mend(format!("write `{meant}` if that is meant; if not, {declare}")),
        ),
        TagKey::Unknown => {
            Some(Issue::warning(UNDECLARED, format!("the tag `{key}` is not declared")).mend(declare))
        }
    }
}

/// One issue for each key that a person stated and that is neither known nor declared. The tag itself is kept.
pub(super) fn undeclared<'a>(offered: impl Iterator<Item = &'a Tag>, extra: &[String]) -> Vec<Issue> {
    use TagSource as From;
    let mut seen = BTreeSet::new();
    let stated = offered.filter(|tag| {
        let by_a_person = [
            From::Hand,
            From::Sidecar,
            From::Folder,
            From::RunSheet,
            From::FileName,
        ];
        by_a_person.contains(&tag.source)
    });
    stated
        .filter(|tag| seen.insert(tag.key.as_str()))
        .filter_map(|tag| {
            let mut issue = objection(&tag.key, extra)?;
            issue.message += ": it is kept under its own name, and nothing is asked of it";
            Some(issue.at(format!("{}, {}", tag.detail, tag.key)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_other_words_and_parts_of_keys_lead_to_the_key_that_is_meant() {
        for (key, meant) in [
            ("relative_humdity_percent", "relative_humidity_percent"),
            ("enviroment", "environment"),
            ("humidity", "relative_humidity_percent"),
            ("humidty", "relative_humidity_percent"),
            ("relative_humidity", "relative_humidity_percent"),
            ("rh", "relative_humidity_percent"),
            ("voltage", "voltage_v"),
            ("voltage_mv", "voltage_v"),
            ("temperature_k", "temperature_c"),
            ("rest_before", "rest_before_s"),
            ("exclude", "leave_out"),
            ("operater", "operator"),
            ("specimn", "specimen"),
        ] {
            let found = tag_key(key, &["specimen".to_owned()]);
            assert_eq!(found, TagKey::Near(meant.to_owned()), "{key}");
        }
    }

    #[test]
    fn known_and_declared_keys_pass_and_others_wait_for_a_declaration() {
        let extra = ["humidity".to_owned()];
        for key in [
            "sample",
            "note",
            "leave_out",
            "planned",
            "calibration",
            "exposure_h",
            "storage_modulus_column",
        ] {
            assert_eq!(tag_key(key, &[]), TagKey::Known, "{key}");
        }
        assert_eq!(tag_key("humidity", &extra), TagKey::Declared);
        for key in ["specimen", "pre_charge_s", "laboratory", "batch_no", "s"] {
            assert_eq!(tag_key(key, &[]), TagKey::Unknown, "{key}");
        }
    }
}
