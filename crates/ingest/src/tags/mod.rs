//! Tags of a run: what each source says, which source is chosen, and where sources disagree.

mod agreement;
mod declared;
mod files;
mod length;
mod policy;
mod sources;
mod stated_value;
mod unread_statement;
pub(crate) mod value;

use std::path::{Path, PathBuf};

use ieap_domain::tag::{UNREADABLE, keys};
use ieap_domain::{Campaign, Issue, Tag, TagSource};

use super::name_pattern::environment;
use super::scan::{composed, display_path};

pub use declared::{MISSPELT, TagKey, UNDECLARED, objection, tag_key};

pub use ieap_domain::tag::{MISSING, NAMES_CONTRADICT};

pub use files::TagFiles;
pub use sources::FROM_NAMES;
pub use stated_value::{UNKNOWN_SAMPLE, no_stretches, value_objection};
pub use unread_statement::{UNREAD_STATEMENT, unread_statement};

/// Another name under which the readings of a run lie: what is stated of it is stated of the run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OtherName {
    /// The file of that name, relative to the campaign.
    pub file: PathBuf,
    /// Tags set by hand for it.
    pub hand: Vec<Tag>,
    /// Tags of the run sheets' rows that plan it.
    pub planned: Vec<Tag>,
}

/// Everything that tags of one run can come from.
#[derive(Debug, Clone, Copy)]
pub struct TagRequest<'a> {
    /// The campaign as campaign.toml states it.
    pub campaign: &'a Campaign,
    /// What its tag files hold.
    pub tag_files: &'a TagFiles,
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
    /// What files beside the readings and run sheets stated when the file of the readings was last there: it holds where they
    /// are gone with it. Empty where the file is there.
    pub kept: &'a [Tag],
    /// The tags that the run had, where something that states some of them cannot be read now: they hold in place of what every
    /// source says but people's words and logs. None where all can be read.
    pub held: Option<&'a [Tag]>,
    /// Tags of the file's header: tag key, value, and the header's own name of it.
    pub header: &'a [(String, String, String)],
    /// Nominal level of the voltage channel, V, where the file has one.
    pub channel_voltage_v: Option<f64>,
    /// Whether the file has a voltage channel, of steps or not.
    pub has_voltage: bool,
    /// Other names of the same readings; empty where there are none.
    pub other_names: &'a [OtherName],
    /// Means over the run of its own columns and of ambient logs (sources [`TagSource::Column`], [`TagSource::Ambient`]);
    /// empty where there are none.
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

/// The name of a file without its last extension, as `name_pattern` wants it, letters with their marks composed; bytes that
/// are no UTF-8 match no pattern.
pub fn stem(data_file: &Path) -> String {
    let stem = data_file.file_stem().unwrap_or_default();
    composed(&stem.to_string_lossy())
}

/// Gathers the tags of a run from every source and chooses, for each key, that of the strongest source.
///
/// A value that cannot be used is an issue, and the next source serves. So is a tag file that cannot be read, but the run
/// then waits ([`Resolved::waits`]).
pub fn resolve(request: &TagRequest) -> Resolved {
    let mut issues = Vec::new();
    let own = sources::stated(request, &mut issues);
    let mut offered: Vec<Offered> = own.into_iter().map(|tag| Offered { tag, of: 0 }).collect();
    for (at, tags) in sources::of_other_names(request, &mut issues)
        .into_iter()
        .enumerate()
    {
        offered.extend(tags.into_iter().map(|tag| Offered { tag, of: at + 1 }));
    }
    offered.retain_mut(
        |offered| match value::checked(&offered.tag, request.campaign.timezone.as_deref()) {
            Ok(value) => {
                offered.tag.value = in_words_of_campaign(request.campaign, &offered.tag.key, value);
                true
            }
            Err(issue) => {
                issues.push(issue);
                false
            }
        },
    );
    let all = offered.iter().map(|offered| &offered.tag);
    issues.extend(declared::undeclared(all, &request.campaign.extra_tags));
    // The environment's defaults come last, because the environment itself is a tag.
    let environment = strongest(&offered, keys::ENVIRONMENT).map(|tag| tag.value.clone());
    let defaults = sources::defaults(request.campaign, environment.as_deref());
    offered.extend(defaults.into_iter().map(|tag| Offered { tag, of: 0 }));
    let (tags, disagreements) = choose(request, offered);
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

/// The value as campaign.toml names it: an environment under its id, whatever language its word is of.
fn in_words_of_campaign(campaign: &Campaign, key: &str, value: String) -> String {
    if key != keys::ENVIRONMENT {
        return value;
    }
    let known: Vec<&str> = campaign.environments.iter().map(|e| e.id.as_str()).collect();
    environment(&value, &known).unwrap_or(value)
}

/// A tag and the name of the readings that it is stated of: 0 for the run's own, then the other names in order.
struct Offered {
    tag: Tag,
    of: usize,
}

/// The tag of the strongest source; of several of the same source the first offered.
fn strongest<'a>(offered: &'a [Offered], key: &str) -> Option<&'a Tag> {
    // min_by_key keeps the first of equals.
    let of_key = offered
        .iter()
        .map(|offered| &offered.tag)
        .filter(|tag| tag.key == key);
    of_key.min_by_key(|tag| tag.source)
}

/// Chosen tags first, then the overruled ones, and an issue for each that disagrees with the chosen one.
fn choose(request: &TagRequest, mut offered: Vec<Offered>) -> (Vec<Tag>, Vec<Issue>) {
    // A stable sort: within a source the run's own name stays first, and its nearer file.
    offered.sort_by_key(|offered| offered.tag.source);
    let (mut chosen, mut overruled): (Vec<Offered>, Vec<Tag>) = (Vec::new(), Vec::new());
    let mut issues = Vec::new();
    for next in offered {
        match chosen.iter_mut().find(|other| other.tag.key == next.tag.key) {
            None => chosen.push(next),
            // The moment says more than the day that it lies in.
            Some(winner) if agreement::lies_in_day(&next.tag, &winner.tag) => {
                overruled.push(std::mem::replace(winner, next).tag);
            }
            Some(winner) => {
                issues.extend(
                    if winner.of == next.of || !is_of_a_name(&winner.tag) || !is_of_a_name(&next.tag) {
                        agreement::disagreement(&winner.tag, &next.tag)
                    } else {
                        let names = (name(request, winner.of), name(request, next.of));
                        agreement::contradiction(&winner.tag, &next.tag, names)
                    },
                );
                overruled.push(next.tag);
            }
        }
    }
    let mut tags: Vec<Tag> = chosen.into_iter().map(|offered| offered.tag).collect();
    tags.append(&mut overruled);
    (tags, issues)
}

/// Whether a tag is stated of a file by its name or place; the others are read from the readings and what lies in the file.
fn is_of_a_name(tag: &Tag) -> bool {
    tag.source <= TagSource::FileName && !tag.source.is_measured_climate()
}

/// The name that a tag is stated of.
fn name(request: &TagRequest, of: usize) -> String {
    let file = match of.checked_sub(1) {
        None => request.data_files.first(),
        Some(at) => request.other_names.get(at).map(|other| &other.file),
    };
    file.map_or_else(String::new, |file| display_path(file))
}

fn check_sample(request: &TagRequest, resolved: &mut Resolved) {
    let unknown = resolved
        .value(keys::SAMPLE)
        .and_then(|id| stated_value::unknown_sample(request.campaign, id));
    if let Some(issue) = unknown {
        resolved.issues.push(issue);
        resolved.missing.push(keys::SAMPLE.to_owned());
    }
}

fn check_environment(request: &TagRequest, resolved: &mut Resolved) {
    let unknown = resolved
        .value(keys::ENVIRONMENT)
        .and_then(|id| stated_value::unknown_environment(request.campaign, id));
    resolved.issues.extend(unknown);
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
        _ if request.has_voltage => (
            "no source gives the step voltage, and none could be taken from the voltage channel",
            "2.5",
            "",
        ),
        _ => (
            "no source gives the step voltage, and the file has no voltage channel",
            "2.5",
            "",
        ),
    };
    let reason = sources::not_in_name(request, key).unwrap_or_else(|| reason.to_owned());
    let mend =
        format!("such as: ieap tag \"{run}\" {key}={value}, or {key} = {quote}{value}{quote} in {run}.toml");
    Issue::error(MISSING, format!("`{key}` is missing: {reason}"))
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
