//! What each source says, before any choice.

use std::path::{Path, PathBuf};

use crate::campaign_file::line_and_column;
use crate::name_pattern::{KnownIds, NameMatch, NamePattern};
use crate::scan::{compared, display_path, parse_display_path};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Issue, Tag, TagSource};

use super::files::{TagFile, TagFiles};
use super::value::shortest;
use super::{OtherName, TagRequest, is_unreadable, stem, tags_of};

/// Table of a tag file that `ieap init` writes what it read of the names of files and folders into.
pub const FROM_NAMES: &str = "from_names";

impl TagFiles {
    /// Why tag files of these data files (relative to the campaign), or statements in them, cannot be read; one issue each.
    pub fn unreadable(&self, data_files: &[PathBuf]) -> Vec<Issue> {
        let mut issues = Vec::new();
        in_tag_files(self, data_files, &[], &mut issues);
        issues.retain(is_unreadable);
        issues
    }
}

/// Tags of every source but the environment's defaults, strongest first, nearest file first.
pub(super) fn stated(request: &TagRequest, issues: &mut Vec<Issue>) -> Vec<Tag> {
    let mut tags = request.hand.to_vec();
    if let Some(held) = request.held {
        let is_known_now = |tag: &&Tag| {
            tag.source == TagSource::Hand
                || tag.source == TagSource::EnvironmentDefault
                || tag.source.is_measured_climate()
        };
        tags.extend(held.iter().filter(|tag| !is_known_now(tag)).cloned());
        tags.extend_from_slice(request.ambient);
        return tags;
    }
    tags.extend(in_tag_files(
        request.tag_files,
        request.data_files,
        request.kept,
        issues,
    ));
    tags.extend_from_slice(request.planned);
    if request.planned.is_empty() {
        let of_sheets = request
            .kept
            .iter()
            .filter(|tag| tag.source == TagSource::RunSheet);
        tags.extend(of_sheets.cloned());
    }
    tags.extend(in_names(request, issues));
    for (key, value, header_name) in request.header {
        let pair = [(key.clone(), value.clone())];
        tags.extend(tags_of(TagSource::Header, header_name, pair));
    }
    if let Some(voltage_v) = request.channel_voltage_v {
        let pair = [(keys::VOLTAGE_V.to_owned(), shortest(voltage_v))];
        tags.extend(tags_of(TagSource::Channel, "nominal level", pair));
    }
    tags.extend_from_slice(request.ambient);
    tags
}

/// Tags of the files that state them, the nearest file first; of a file that is not there what is `kept` of it.
fn in_tag_files(files: &TagFiles, data_files: &[PathBuf], kept: &[Tag], issues: &mut Vec<Issue>) -> Vec<Tag> {
    let (mut tags, mut read) = (Vec::new(), Vec::new());
    for file in data_files {
        for (path, source) in files.of_file(file) {
            // Files of one run share their folders' tags.
            if !read.contains(&path) {
                tags.extend(in_file(files, &path, source, issues).unwrap_or_else(|| {
                    let of_file = |tag: &&Tag| {
                        [source, TagSource::Derived].contains(&tag.source) && is_named_as(&path, &tag.detail)
                    };
                    kept.iter().filter(of_file).cloned().collect()
                }));
                read.push(path);
            }
        }
    }
    tags
}

/// Whether that was a name of a statement, however it was written.
fn is_named_as(path: &Path, shown: &str) -> bool {
    let other = parse_display_path(shown);
    let name = |path: &Path| path.file_name().map(compared);
    path.parent() == other.parent() && name(path) == name(&other)
}

/// Tags that are stated of each other name of the readings; a tags.toml that stands above both names says nothing new.
pub(super) fn of_other_names(request: &TagRequest, issues: &mut Vec<Issue>) -> Vec<Vec<Tag>> {
    let own = request
        .data_files
        .iter()
        .flat_map(|file| request.tag_files.of_file(file));
    let mut read: Vec<PathBuf> = own.map(|(path, _)| path).collect();
    let mut of_name = |other: &OtherName| {
        let mut tags = other.hand.clone();
        // What else was stated of it is among what is held.
        if request.held.is_some() {
            return tags;
        }
        for (path, source) in request.tag_files.of_file(&other.file) {
            if !read.contains(&path) {
                tags.extend(in_file(request.tag_files, &path, source, issues).unwrap_or_default());
                read.push(path);
            }
        }
        tags.extend_from_slice(&other.planned);
        tags.extend(in_name(request, &stem(&other.file), issues));
        tags
    };
    request.other_names.iter().map(&mut of_name).collect()
}

/// What campaign.toml says of the environment where nothing was measured.
pub(super) fn defaults(campaign: &Campaign, environment: Option<&str>) -> Vec<Tag> {
    let Some(environment) = environment.and_then(|id| campaign.environment(id)) else {
        return Vec::new();
    };
    let stated = [
        (
            keys::RELATIVE_HUMIDITY_PERCENT,
            environment.relative_humidity_percent,
        ),
        (keys::TEMPERATURE_C, environment.temperature_c),
        (keys::PRESSURE_PA, environment.pressure_pa),
    ];
    let pairs = stated
        .into_iter()
        .filter_map(|(key, value)| Some((key.to_owned(), shortest(value?))));
    tags_of(TagSource::EnvironmentDefault, &environment.id, pairs)
}

/// What a tag file states; none where it is not there.
fn in_file(
    files: &TagFiles,
    relative: &Path,
    source: TagSource,
    issues: &mut Vec<Issue>,
) -> Option<Vec<Tag>> {
    let shown = display_path(relative);
    let bytes = match files.file(relative) {
        TagFile::There(bytes) => bytes,
        TagFile::Absent => return None,
        TagFile::Unreadable(_, error) => {
            let issue = Issue::error("tag-file-unreadable", format!("it cannot be read: {error}"));
            issues.push(
                issue
                    .at(shown)
                    .mend("make it a text file of tags that your user may read"),
            );
            return Some(Vec::new());
        }
    };
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes)).into_owned();
    if std::str::from_utf8(&bytes).is_err() {
        let issue = Issue::error("tag-file-unreadable", "it cannot be read: it is not UTF-8");
        issues.push(issue.at(shown).mend("save it with the encoding UTF-8"));
        return Some(Vec::new());
    }
    let table = match toml::from_str::<toml::Table>(&text) {
        Ok(table) => table,
        Err(error) => {
            issues.push(not_toml(&shown, &text, &error));
            return Some(Vec::new());
        }
    };
    let mut pairs = Vec::new();
    let mut derived = Vec::new();
    for (key, value) in table {
        match (flat(&key, &value), value) {
            (Some(text), _) => pairs.push((key, text)),
            (None, toml::Value::Table(table)) if key == FROM_NAMES => {
                let texts = table
                    .into_iter()
                    .filter_map(|(key, value)| Some((flat(&key, &value)?, key)));
                derived.extend(texts.map(|(text, key)| (key, text)));
            }
            (None, value) => issues.push(not_flat(&shown, &key, value.type_str())),
        }
    }
    let mut tags = tags_of(source, &shown, pairs);
    tags.extend(tags_of(TagSource::Derived, &shown, derived));
    Some(tags)
}

/// The text of a value that a tag can have.
fn flat(key: &str, value: &toml::Value) -> Option<String> {
    match value {
        toml::Value::String(text) => Some(text.clone()),
        toml::Value::Integer(number) => Some(number.to_string()),
        toml::Value::Float(number) => Some(shortest(*number)),
        toml::Value::Boolean(truth) => Some(truth.to_string()),
        toml::Value::Datetime(moment) => Some(moment.to_string()),
        toml::Value::Array(_) if [keys::OPEN_CIRCUIT, keys::LEAVE_OUT].contains(&key) => {
            Some(value.to_string())
        }
        toml::Value::Array(_) | toml::Value::Table(_) => None,
    }
}

fn not_toml(shown: &str, text: &str, error: &toml::de::Error) -> Issue {
    let (line, column) = line_and_column(text, error.span().map_or(0, |span| span.start));
    let message = format!(
        "it cannot be read: line {line}, column {column} is not TOML: {}",
        error.message()
    );
    let mend = "correct that line: key = value, texts in quotes (\"air\"), numbers with a point (2.5)";
    Issue::error("tag-file-not-toml", message)
        .at(format!("{shown}, line {line}, column {column}"))
        .mend(mend)
}

fn not_flat(shown: &str, key: &str, found: &str) -> Issue {
    let message = format!("`{key}` cannot be read: a {found} was found, one value is needed");
    Issue::error("tag-not-flat", message)
        .at(format!("{shown}, {key}"))
        .mend("write one line `key = value` for each tag, without [tables]")
}

/// Tags that the name of the run says, else those of its other files.
fn in_names(request: &TagRequest, issues: &mut Vec<Issue>) -> Vec<Tag> {
    // Of one file the caller knows the name.
    let others = request
        .data_files
        .iter()
        .skip_while(|_| request.data_files.len() < 2);
    let others = others.map(|file| stem(file));
    let mut stems: Vec<String> = std::iter::once(request.stem.to_owned()).chain(others).collect();
    stems.dedup();
    let mut tags = stems.iter().map(|stem| in_name(request, stem, issues));
    tags.find(|tags| !tags.is_empty()).unwrap_or_default()
}

fn in_name(request: &TagRequest, stem: &str, issues: &mut Vec<Issue>) -> Vec<Tag> {
    let Some(text) = request.name_pattern else {
        return Vec::new();
    };
    let pattern = match NamePattern::compile(text) {
        Ok(pattern) => pattern,
        Err(error) => {
            issues.push(Issue::warning(
                "name-pattern-bad",
                format!("name_pattern is not used: {error}"),
            ));
            return Vec::new();
        }
    };
    let (samples, environments) = known_ids(request.campaign);
    let known = KnownIds {
        samples: &samples,
        environments: &environments,
    };
    let pairs = match pattern.match_stem(stem, known) {
        NameMatch::None => return Vec::new(),
        NameMatch::One(pairs) => pairs,
        NameMatch::Several { agreed, open } => {
            issues.extend(open.iter().map(|open| open_in_name(stem, open)));
            agreed
        }
    };
    tags_of(TagSource::FileName, stem, pairs)
}

fn known_ids(campaign: &Campaign) -> (Vec<&str>, Vec<&str>) {
    let samples = campaign.samples.iter().map(|s| s.id.as_str());
    let environments = campaign.environments.iter().map(|e| e.id.as_str());
    (samples.collect(), environments.collect())
}

/// Why the pattern gives no tag of this name, where it has that key: where the name leaves it.
pub(super) fn not_in_name(request: &TagRequest, key: &str) -> Option<String> {
    let pattern = NamePattern::compile(request.name_pattern?).ok()?;
    pattern.keys().find(|known| *known == key)?;
    let (samples, environments) = known_ids(request.campaign);
    let known = KnownIds {
        samples: &samples,
        environments: &environments,
    };
    if pattern.match_stem(request.stem, known) != NameMatch::None {
        return None;
    }
    let found = pattern.mismatch(request.stem, KnownIds::default());
    // Without the name itself, so that it is told once for all names that leave the pattern there.
    Some(format!(
        "name_pattern does not read the name, for it wants {} where the name says something else (`ieap status --files` shows where)",
        found.wanted
    ))
}

fn open_in_name(stem: &str, (key, first, second): &(String, String, String)) -> Issue {
    let message =
        format!("the file name \"{stem}\" gives `{key}` as \"{first}\" or as \"{second}\": not used");
    Issue::warning("name-ambiguous", message)
        .at(key)
        .mend("rename the file, or write the tag into its sidecar")
}
