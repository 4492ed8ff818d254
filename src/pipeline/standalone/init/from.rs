//! Proposes a campaign for a folder of files as people have them, and makes it where that is wanted.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::look::{ProposedFor, Seen, Taken, files_below, look};
use super::plan::{NamedSample, PlannedFile, plan};
use super::text::campaign_text;
use super::{MAKING, make_folders};
use crate::domain::DateOrder;
use crate::domain::pairs::{HalfKind, LoneHalf, Pair};
use crate::domain::tag::keys;
use crate::ingest::campaign_file;
use crate::ingest::formats::error::ASKED;
use crate::ingest::name_pattern::ProposedPattern;
use crate::ingest::profiles;
use crate::ingest::tags::FROM_NAMES;
use crate::pipeline::infra::mends::together;
use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::{PipelineError, failed};

/// The verb `init --from`.
#[derive(Debug, Clone)]
pub struct InitFrom {
    /// The campaign folder to make.
    pub campaign: PathBuf,
    /// The folder with the files; it is never changed.
    pub from: PathBuf,
    /// Whether the campaign is made, or only shown.
    pub write: bool,
}

/// What is proposed for a folder.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Proposed {
    /// Its files with what each becomes.
    pub files: Vec<PlannedFile>,
    /// Files that are two of a run: the run has the name of the first.
    pub pairs: Vec<Pair>,
    /// Files that hold half of a run and whose partner is not among them.
    pub lone_halves: Vec<LoneHalf>,
    /// Samples that names of files speak of; their sizes are not known.
    pub samples: Vec<NamedSample>,
    /// The pattern that explains the most names of runs.
    pub name_pattern: Option<ProposedPattern>,
    /// Order of dates that files show where others leave it open.
    pub date_order: Option<DateOrder>,
    /// Profiles for files that no reader knows.
    pub profiles: Vec<ProposedFor>,
    /// What only a person can fill in before everything usable is fitted.
    pub fill_in: Vec<String>,
    /// Text of the campaign.toml.
    pub campaign_toml: String,
    /// Whether the campaign was made.
    pub written: bool,
}

impl InitFrom {
    /// Looks at every file and proposes; makes the campaign where that is wanted. Files are copied, never moved.
    ///
    /// # Errors
    /// The folder cannot be listed, is the campaign itself, or holds nothing; the campaign is there already, or cannot
    /// be written.
    pub fn run(&self) -> Result<Proposed, PipelineError> {
        let from = fs::canonicalize(&self.from).map_err(|error| PipelineError::BadArgument {
            what: "--from",
            found: format!("{} ({error})", self.from.display()),
            needed: "a folder with files of instruments".to_owned(),
        })?;
        let campaign =
            std::path::absolute(&self.campaign).map_err(failed(&self.campaign, "finding the campaign"))?;
        let campaign = fs::canonicalize(&campaign).unwrap_or(campaign);
        if campaign == from {
            return Err(PipelineError::BadArgument {
                what: "--from",
                found: format!("{}, which is the campaign itself", self.from.display()),
                needed: "a folder to make the campaign in beside it: `ieap init NEW-FOLDER --from FOLDER`"
                    .to_owned(),
            });
        }
        let file = campaign.join(campaign_file::FILE_NAME);
        if file.exists() {
            return Err(PipelineError::FileExists { path: file });
        }
        let paths = files_below(&from, &campaign).map_err(failed(&from, "listing the files"))?;
        if paths.is_empty() {
            return Err(PipelineError::BadArgument {
                what: "--from",
                found: format!("{}, which holds no file", self.from.display()),
                needed: "a folder with files of instruments".to_owned(),
            });
        }
        let looked = look(&from, &paths);
        let planned = plan(&looked);
        let id = campaign
            .file_name()
            .map_or("campaign".into(), |name| name.to_string_lossy());
        let system = jiff::tz::TimeZone::system();
        let zone = system.iana_name().filter(|name| *name != "Etc/Unknown");
        let shown = self.from.display().to_string();
        let mut proposed = Proposed {
            campaign_toml: campaign_text(&id, &shown, zone, &looked, &planned),
            fill_in: Vec::new(),
            files: planned.files,
            pairs: planned.pairs,
            lone_halves: planned.lone,
            samples: planned.samples,
            name_pattern: planned.pattern,
            date_order: looked.date_order,
            profiles: looked.profiles,
            written: false,
        };
        proposed.fill_in = fill_in(&proposed, looked.has_open_dates, zone.is_none());
        if self.write {
            write(&campaign, &proposed)?;
            proposed.written = true;
        }
        Ok(proposed)
    }
}

/// What only a person can fill in, each said once for all files that wait for it.
fn fill_in(proposed: &Proposed, has_open_dates: bool, no_zone: bool) -> Vec<String> {
    let mut open = Vec::new();
    let ids: Vec<&str> = proposed.samples.iter().map(|sample| sample.id.as_str()).collect();
    match ids.as_slice() {
        [] => open.push("campaign.toml: a [[sample]] with id, material, length_mm and width_mm".to_owned()),
        ids => open.push(format!(
            "campaign.toml: length_mm and width_mm of {}",
            ids.join(", ")
        )),
    }
    for key in [keys::SAMPLE, keys::ENVIRONMENT, keys::VOLTAGE_V] {
        let lacking = proposed.files.iter().filter(|file| file.missing.contains(&key));
        let lacking: Vec<&str> = lacking.map(|file| file.seen.path.as_str()).collect();
        if let [first, rest @ ..] = lacking.as_slice() {
            let more = match rest.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            open.push(format!(
                "the tag {key} of {first}{more}: in runs/tags.toml for all, in a file's own .toml, or with `ieap tag`"
            ));
        }
    }
    open.extend(lone_halves(&proposed.lone_halves));
    open.extend(starts_to_confirm(&proposed.files));
    if has_open_dates && proposed.date_order.is_none() {
        open.push("campaign.toml: date_order, for dates that fit two orders".to_owned());
    }
    let asked = |seen: &Seen| seen.issues.iter().find(|issue| issue.code == ASKED).cloned();
    let questions =
        (proposed.files.iter()).filter_map(|file| Some((file.seen.path.as_str(), vec![asked(&file.seen)?])));
    for question in together(questions) {
        let files = question.paths.len();
        open.extend(question.issues.iter().map(|issue| {
            format!(
                "{files} file(s), first {}: {}; {}",
                question.paths[0], issue.message, issue.mend
            )
        }));
    }
    if no_zone {
        open.push("campaign.toml: timezone".to_owned());
    }
    let drafts = proposed
        .profiles
        .iter()
        .filter(|profile| !profile.open.is_empty());
    open.extend(drafts.map(|profile| {
        format!(
            "profiles/{id}.toml.draft, for {}: {}; then call it {id}.toml",
            profile.files.join(", "),
            profile.open.join("; "),
            id = profile.id
        )
    }));
    open
}

/// Halves without a partner, those that hold the same in one line.
fn lone_halves(halves: &[LoneHalf]) -> Vec<String> {
    let line = |kind: HalfKind| {
        let mut own = halves.iter().filter(|half| half.holds == kind);
        let (count, first) = (own.clone().count(), own.next()?);
        let holds = kind.label();
        Some(match count {
            1 => format!(
                "{} is half of a run ({holds}) and waits for {}",
                first.path, first.waits_for
            ),
            count => format!(
                "{count} files are halves of runs ({holds}), first {}, which waits for {}: a [[pair]] of campaign.toml or a run \
                 sheet with both names in one row says which belong together",
                first.path, first.waits_for
            ),
        })
    };
    [HalfKind::Electrical, HalfKind::Bending]
        .into_iter()
        .filter_map(line)
        .collect()
}

/// Starts that no word names, one question for all files whose line begins alike.
fn starts_to_confirm(files: &[PlannedFile]) -> Vec<String> {
    let mut by_words: BTreeMap<&str, Vec<&PlannedFile>> = BTreeMap::new();
    for file in files {
        if let Some(words) = file.seen.start_words.as_deref() {
            by_words.entry(words).or_default().push(file);
        }
    }
    let line = |(words, files): (&str, Vec<&PlannedFile>)| {
        let raw = files[0].seen.start_raw.as_deref().unwrap_or("");
        format!(
            "{} file(s), first {}: {words} {raw} is taken as the start; if it is another moment, tag the runs with started_at",
            files.len(),
            files[0].seen.path
        )
    };
    by_words.into_iter().map(line).collect()
}

/// Makes the campaign; campaign.toml comes last, so that what is not whole is none.
fn write(campaign: &Path, proposed: &Proposed) -> Result<(), PipelineError> {
    let mut texts: BTreeMap<PathBuf, String> = BTreeMap::new();
    for (to, beside) in stated(proposed) {
        let lines = beside.iter().map(|(key, value)| line(key, value));
        let text = format!(
            "# By `ieap init`. A line above [{FROM_NAMES}], as in a file of your own, is your word and counts before run sheets.\n\
             [{FROM_NAMES}]\n{}",
            lines.collect::<String>()
        );
        texts.insert(campaign.join(to), text);
    }
    for profile in &proposed.profiles {
        let ending = if profile.open.is_empty() {
            "toml"
        } else {
            "toml.draft"
        };
        let path = campaign
            .join(profiles::FOLDER)
            .join(format!("{}.{ending}", profile.id));
        texts.insert(path, profile.text.clone());
    }
    let copies = proposed.files.iter().filter_map(|file| {
        let to = campaign.join(file.to.as_ref()?);
        Some((file.seen.location.as_path(), to))
    });
    let copies: Vec<(&Path, PathBuf)> = copies.collect();
    let taken = copies
        .iter()
        .map(|(_, to)| to)
        .chain(texts.keys())
        .find(|path| path.exists());
    if let Some(path) = taken {
        return Err(PipelineError::FileExists { path: path.clone() });
    }
    make_folders(campaign)?;
    for (location, to) in &copies {
        make_parent(to)?;
        fs::copy(location, to).map_err(failed(to, "copying a file"))?;
    }
    for (path, text) in &texts {
        make_parent(path)?;
        put_bytes(path, false, text.as_bytes())?;
    }
    let file = campaign.join(campaign_file::FILE_NAME);
    put_bytes(&file, false, proposed.campaign_toml.as_bytes())
}

/// Tags by key.
type Tags = BTreeMap<String, String>;

/// Tags that the pattern does not give, by the file that states them: a tags.toml where all runs of a folder have the same,
/// else one beside each run.
fn stated(proposed: &Proposed) -> BTreeMap<String, Tags> {
    let folder = |to: &str| to.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
    let mut folders: BTreeMap<String, Vec<(&String, &Tags)>> = BTreeMap::new();
    for file in proposed.files.iter().filter(|file| file.seen.taken == Taken::Run) {
        if let Some(to) = &file.to {
            folders.entry(folder(to)).or_default().push((to, &file.beside));
        }
    }
    let logs = proposed.files.iter().filter(|file| file.seen.taken != Taken::Run);
    let mut texts: BTreeMap<String, Tags> = logs
        .filter_map(|file| Some((format!("{}.toml", file.to.as_ref()?), file.beside.clone())))
        .collect();
    let is_there = |path: &String| proposed.files.iter().any(|file| file.to.as_ref() == Some(path));
    for (folder, files) in folders {
        let of_folder = format!("{folder}/tags.toml");
        let alike = files.iter().all(|(_, beside)| *beside == files[0].1);
        if alike && files.len() > 1 && !is_there(&of_folder) {
            texts.insert(of_folder, files[0].1.clone());
        } else {
            texts.extend(
                files
                    .into_iter()
                    .map(|(to, beside)| (format!("{to}.toml"), beside.clone())),
            );
        }
    }
    texts.retain(|_, beside| !beside.is_empty());
    texts
}

fn make_parent(path: &Path) -> Result<(), PipelineError> {
    let parent = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(failed(parent, MAKING))
}

/// A line of a sidecar: numbers as numbers.
fn line(key: &str, value: &str) -> String {
    let number = keys::NUMERIC
        .contains(&key)
        .then(|| value.parse::<f64>().ok())
        .flatten();
    match number {
        Some(number) => format!("{key} = {number}\n"),
        None => format!("{key} = {}\n", toml::Value::String(value.to_owned())),
    }
}

impl Proposed {
    /// How many files are taken for that.
    pub fn count(&self, taken: Taken) -> usize {
        self.files.iter().filter(|file| file.seen.taken == taken).count()
    }
}
