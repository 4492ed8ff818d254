//! Tags of a run: what each source says, which source is chosen, and where sources disagree.

mod agreement;
mod sources;
mod value;

use std::path::{Path, PathBuf};

use crate::domain::tag::{UNREADABLE, keys};
use crate::domain::{Campaign, Issue, Tag, TagSource};

use super::campaign_file::nearest;
use super::scan::display_path;

pub use sources::{tag_files_for, tag_sources_digest, unreadable};

/// Everything that tags of one run can come from.
#[derive(Debug, Clone, Copy)]
pub struct TagRequest<'a> {
    /// The campaign as campaign.toml states it.
    pub campaign: &'a Campaign,
    /// Its folder.
    pub folder: &'a Path,
    /// The run's files relative to the campaign, the one that names the run first.
    pub data_files: &'a [PathBuf],
    /// The first file's name without what is no part of the run's name: what `name_pattern` is matched to.
    pub stem: &'a str,
    /// Pattern that reads tags from file names of this kind of measurement.
    pub name_pattern: Option<&'a str>,
    /// Keys without which nothing can be made of the measurement.
    pub needed: &'a [&'a str],
    /// Tags set by hand (source [`TagSource::Hand`]), the newest of each key first.
    pub hand: &'a [Tag],
    /// Tags of the run sheets' rows that plan this file (source [`TagSource::RunSheet`]); empty where none does.
    pub planned: &'a [Tag],
    /// Tags of the file's header: tag key, value, and the header's own name of it.
    pub header: &'a [(String, String, String)],
    /// Nominal level of the voltage channel, V, where the file has one.
    pub channel_voltage_v: Option<f64>,
    /// Means of ambient logs over the run (source [`TagSource::Ambient`]); empty where there are none.
    pub ambient: &'a [Tag],
}

/// The tags of one run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Resolved {
    /// Every usable tag of every source: the chosen one of each key first, in the order of
    /// [`TagSource`], then the overruled ones.
    pub tags: Vec<Tag>,
    /// Disagreements, values that cannot be used, unknown samples and environments, missing tags.
    pub issues: Vec<Issue>,
    /// Those of the needed keys that the run lacks. An issue `tag-missing`,
    /// or `unknown-sample`, says why and how to mend it.
    pub missing: Vec<String>,
}

impl Resolved {
    /// The chosen value of a key.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.tags
            .iter()
            .find(|tag| tag.key == key)
            .map(|tag| tag.value.as_str())
    }

    /// Whether the run waits: a needed tag is missing, or something that states its tags cannot be read.
    pub fn waits(&self) -> bool {
        !self.missing.is_empty() || self.issues.iter().any(is_unreadable)
    }
}

/// Whether an issue says that something which states tags cannot be read.
pub fn is_unreadable(issue: &Issue) -> bool {
    UNREADABLE.contains(&issue.code.as_str())
}

/// The name of a file without its last extension, as `name_pattern` wants it; bytes that are no UTF-8 match
/// no pattern.
pub fn stem(data_file: &Path) -> String {
    let stem = data_file.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Gathers the tags of a run from every source and chooses, for each key, that of the strongest source.
///
/// A value that cannot be used is an issue, and the next source serves. So is a tag file that cannot be read, but the run
/// then waits ([`Resolved::waits`]).
pub fn resolve(request: &TagRequest) -> Resolved {
    let mut issues = Vec::new();
    let mut offered = sources::stated(request, &mut issues);
    offered.retain_mut(
        |tag| match value::checked(tag, request.campaign.timezone.as_deref()) {
            Ok(value) => {
                tag.value = value;
                true
            }
            Err(issue) => {
                issues.push(issue);
                false
            }
        },
    );
    // The environment's defaults come last, because the environment itself is a tag.
    let environment = strongest(&offered, keys::ENVIRONMENT).map(|tag| tag.value.clone());
    offered.extend(sources::defaults(request.campaign, environment.as_deref()));
    let (tags, disagreements) = choose(offered);
    issues.extend(disagreements);
    let mut resolved = Resolved {
        tags,
        issues,
        missing: Vec::new(),
    };
    check_sample(request, &mut resolved);
    check_environment(request, &mut resolved);
    for &key in request.needed {
        if resolved.value(key).is_none() {
            resolved.issues.push(missing_tag(request, key));
            resolved.missing.push(key.to_owned());
        }
    }
    resolved
}

/// The tag of the strongest source; of several of the same source the first offered.
fn strongest<'a>(offered: &'a [Tag], key: &str) -> Option<&'a Tag> {
    // min_by_key keeps the first of equals.
    offered
        .iter()
        .filter(|tag| tag.key == key)
        .min_by_key(|tag| tag.source)
}

/// Chosen tags first, then the overruled ones, and an issue for each that disagrees with the chosen one.
fn choose(mut offered: Vec<Tag>) -> (Vec<Tag>, Vec<Issue>) {
    // A stable sort: within a source, the nearer file stays first.
    offered.sort_by_key(|tag| tag.source);
    let (mut chosen, mut overruled): (Vec<Tag>, Vec<Tag>) = (Vec::new(), Vec::new());
    let mut issues = Vec::new();
    for tag in offered {
        match chosen.iter().find(|other| other.key == tag.key) {
            None => chosen.push(tag),
            Some(winner) => {
                issues.extend(agreement::disagreement(winner, &tag));
                overruled.push(tag);
            }
        }
    }
    chosen.append(&mut overruled);
    (chosen, issues)
}

fn check_sample(request: &TagRequest, resolved: &mut Resolved) {
    let Some(sample) = resolved.value(keys::SAMPLE) else {
        return;
    };
    if request.campaign.sample(sample).is_some() {
        return;
    }
    let known: Vec<&str> = request
        .campaign
        .samples
        .iter()
        .map(|sample| sample.id.as_str())
        .collect();
    let message = format!("the sample \"{sample}\" is not in campaign.toml");
    let mend = match nearest(sample, known.iter().copied()) {
        Some(meant) => format!("write \"{meant}\" if that is meant, or add a [[sample]] with that id"),
        None => format!(
            "add a [[sample]] with that id to campaign.toml, or use one of: {}",
            listed(&known)
        ),
    };
    let issue = Issue::error("unknown-sample", message)
        .at(keys::SAMPLE)
        .mend(mend);
    resolved.issues.push(issue);
    resolved.missing.push(keys::SAMPLE.to_owned());
}

fn check_environment(request: &TagRequest, resolved: &mut Resolved) {
    let Some(environment) = resolved.value(keys::ENVIRONMENT) else {
        return;
    };
    if request.campaign.environment(environment).is_some() {
        return;
    }
    let known: Vec<&str> = request
        .campaign
        .environments
        .iter()
        .map(|known| known.id.as_str())
        .collect();
    let message = format!(
        "the environment \"{environment}\" is not known; known are {}",
        listed(&known)
    );
    let mend = match nearest(environment, known.iter().copied()) {
        Some(meant) => format!("write \"{meant}\" if that is meant, or add an [[environment]] with that id"),
        None => "add an [[environment]] with that id to campaign.toml, or use a known one".to_owned(),
    };
    let issue = Issue::warning("unknown-environment", message);
    resolved.issues.push(issue.at(keys::ENVIRONMENT).mend(mend));
}

fn listed(ids: &[&str]) -> String {
    match ids {
        [] => "(none yet)".to_owned(),
        ids => ids.join(", "),
    }
}

fn missing_tag(request: &TagRequest, key: &str) -> Issue {
    let run = request
        .data_files
        .first()
        .map(|file| display_path(file))
        .unwrap_or_default();
    let first_sample = request
        .campaign
        .samples
        .first()
        .map_or("CNaf-01", |sample| &sample.id);
    let (reason, value, quote) = match key {
        keys::SAMPLE => ("no source says which sample was measured", first_sample, "\""),
        keys::ENVIRONMENT => ("no source says in which environment it was measured", "air", "\""),
        _ => (
            "no source gives the step voltage, and the file has no voltage channel",
            "2.5",
            "",
        ),
    };
    let mend =
        format!("such as: ieap tag \"{run}\" {key}={value}, or {key} = {quote}{value}{quote} in {run}.toml");
    Issue::error("tag-missing", format!("`{key}` is missing: {reason}"))
        .at(key)
        .mend(mend)
}

/// Tags of one source from pairs of key and value.
fn tags_of(source: TagSource, detail: &str, pairs: impl IntoIterator<Item = (String, String)>) -> Vec<Tag> {
    let tag = |(key, value)| Tag {
        key,
        value,
        source,
        detail: detail.to_owned(),
    };
    pairs.into_iter().map(tag).collect()
}

#[cfg(test)]
mod tests;
