//! Values of tags that campaign.toml or their own kind do not allow.

use super::value;
use crate::campaign_file::nearest;
use ieap_domain::left_out;
use ieap_domain::surroundings;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Issue, Tag};

/// Code of the issue of a sample that campaign.toml does not name.
pub const UNKNOWN_SAMPLE: &str = "unknown-sample";

/// What speaks against a tag that a person states now, while it can still be written otherwise; none where it may be
/// stored. Samples and environments are closed lists of campaign.toml.
pub fn value_objection(tag: &Tag, campaign: &Campaign) -> Option<Issue> {
    let value = match value::checked(tag, campaign.timezone.as_deref()) {
        Ok(value) => value,
        Err(issue) => return Some(issue),
    };
    match tag.key.as_str() {
        keys::SAMPLE => unknown_sample(campaign, &value),
        keys::ENVIRONMENT => unknown_environment(campaign, &value),
        keys::LEAVE_OUT | keys::OPEN_CIRCUIT if left_out::stretches(&value).is_none() => {
            Some(no_stretches(&tag.key, &value))
        }
        _ => None,
    }
}

/// What is said of a text that states no stretches of seconds.
pub fn no_stretches(key: &str, text: &str) -> Issue {
    let message = format!("`{key}` is {text:?}, which is no list of stretches in seconds");
    let mend = format!("write {key} = \"600-1200, 1800-2400\"");
    Issue::warning("tag-unusable", message).at(key).mend(mend)
}

/// What is said of a sample that campaign.toml does not name.
pub(super) fn unknown_sample(campaign: &Campaign, id: &str) -> Option<Issue> {
    if campaign.sample(id).is_some() {
        return None;
    }
    let known: Vec<&str> = campaign.samples.iter().map(|sample| sample.id.as_str()).collect();
    let message = format!("the sample \"{id}\" is not in campaign.toml");
    let mend = match nearest(id, known.iter().copied()) {
        Some(meant) => format!("write \"{meant}\" if that is meant, or add a [[sample]] with that id"),
        None => format!(
            "add a [[sample]] with that id to campaign.toml, or use one of: {}",
            listed(&known)
        ),
    };
    Some(Issue::error(UNKNOWN_SAMPLE, message).at(keys::SAMPLE).mend(mend))
}

/// What is said of an environment that is neither built in nor in campaign.toml.
pub(super) fn unknown_environment(campaign: &Campaign, id: &str) -> Option<Issue> {
    if campaign.environment(id).is_some() || surroundings::kind_of(id).is_some() {
        return None;
    }
    let known: Vec<&str> = campaign
        .environments
        .iter()
        .map(|known| known.id.as_str())
        .collect();
    let message = format!(
        "the environment \"{id}\" is not known; known are {}",
        listed(&known)
    );
    let mend = match meant_environment(id, &known) {
        Some(meant) => format!("write \"{meant}\" if that is meant, or add an [[environment]] with that id"),
        None => "add an [[environment]] with that id to campaign.toml, or use a known one".to_owned(),
    };
    let issue = Issue::warning("unknown-environment", message);
    Some(issue.at(keys::ENVIRONMENT).mend(mend))
}

/// The known environment that a slip made this of. In a word of three letters two changed places are such a slip, for the
/// list is short.
fn meant_environment<'a>(id: &str, known: &[&'a str]) -> Option<&'a str> {
    let letters = |word: &str| {
        let mut letters: Vec<char> = word.to_lowercase().chars().collect();
        letters.sort_unstable();
        letters
    };
    let same_letters = || known.iter().copied().find(|known| letters(known) == letters(id));
    nearest(id, known.iter().copied()).or_else(same_letters)
}

fn listed(ids: &[&str]) -> String {
    match ids {
        [] => "(none yet)".to_owned(),
        ids => ids.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::TagSource;
    use ieap_domain::testing::campaign;

    fn mend(key: &str, value: &str) -> Option<String> {
        let tag = Tag {
            key: key.to_owned(),
            value: value.to_owned(),
            source: TagSource::Hand,
            detail: String::new(),
        };
        value_objection(&tag, &campaign()).map(|issue| format!("{}; {}", issue.message, issue.mend))
    }

    #[test]
    fn what_no_run_can_have_is_told_with_what_was_meant() {
        for (key, value, told) in [
            ("environment", "ari", "\"air\""),
            ("environment", "vacum", "\"vacuum\""),
            ("environment", "steam", "[[environment]]"),
            ("sample", "CNaf-1", "\"CNaf-01\""),
            ("voltage_v", "abc", "not a number"),
            ("voltage_v", "1,2", "decimal point"),
            ("relative_humidity_percent", "330", "0 to 100"),
            ("started_at", "31.12.2026", "not a date"),
            ("leave_out", "abc", "600-1200"),
            ("open_circuit", "120-60", "no list of stretches"),
        ] {
            let said = mend(key, value).unwrap_or_default();
            assert!(said.contains(told), "{key}={value}: {said}");
        }
    }

    #[test]
    fn what_a_run_can_have_passes() {
        for (key, value) in [
            ("environment", "air"),
            ("sample", "CNaf-01"),
            ("voltage_v", "-1.2"),
            ("note", "anything"),
        ] {
            assert_eq!(mend(key, value), None, "{key}={value}");
        }
    }
}
