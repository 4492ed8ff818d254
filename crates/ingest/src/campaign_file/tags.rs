//! What campaign.toml says of tags: free ones that it declares, and keys that it uses.

use std::collections::BTreeSet;

use super::check::Checker;
use super::error::CampaignFileError as Error;
use crate::name_pattern::NamePattern;
use crate::tags::objection;
use ieap_domain::{Campaign, Issue};

impl Checker<'_> {
    /// Declared keys, each once.
    pub(super) fn extra_tags(&self, keys: Vec<String>) -> Result<Vec<String>, Error> {
        let of_key = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let mut seen = BTreeSet::new();
        let bad = keys
            .iter()
            .find(|key| key.is_empty() || !key.chars().all(of_key) || !seen.insert(key.as_str()));
        match bad {
            Some(found) => Err(Error::BadExtraTag {
                path: self.path.into(),
                found: found.clone(),
            }),
            None => Ok(keys),
        }
    }
}

/// Keys in name patterns, `group_by` and the monitored condition that are neither known nor declared.
pub(super) fn undeclared_keys(campaign: &Campaign) -> Vec<Issue> {
    let in_pattern = |pattern: &Option<String>| -> Vec<String> {
        let compiled = pattern.as_deref().map(NamePattern::compile);
        let compiled = compiled.and_then(Result::ok);
        compiled.map_or(Vec::new(), |pattern| pattern.keys().map(str::to_owned).collect())
    };
    let reference = campaign.monitoring.reference.iter();
    let used = [
        ("[runs] name_pattern", in_pattern(&campaign.name_pattern)),
        ("[dma] name_pattern", in_pattern(&campaign.dma_name_pattern)),
        (
            "[impedance] name_pattern",
            in_pattern(&campaign.impedance_name_pattern),
        ),
        ("[campaign] group_by", campaign.group_by.clone()),
        (
            "[monitoring] reference",
            reference.map(|(key, _)| key.clone()).collect(),
        ),
    ];
    let issue = |place: &str, key: &String| Some(objection(key, &campaign.extra_tags)?.at(place));
    used.iter()
        .flat_map(|(place, keys)| keys.iter().filter_map(move |key| issue(place, key)))
        .collect()
}
