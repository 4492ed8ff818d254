//! Looks at the files of a folder: what each is, what is read of it, and by which profile where no reader knows it.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::pairs::HalfKind;
use crate::domain::{Channel, DateOrder, Issue, Quantity};
use crate::ingest::archive;
use crate::ingest::folder_dates::order_beside;
use crate::ingest::formats::{ReadContext, ReadError};
use crate::ingest::pairs::{half_of, window_s};
use crate::ingest::profiles::{self, Profile};
use crate::ingest::run_sheet::SheetRow;
use crate::ingest::scan::{is_own_product, is_passing_name, states_for};
use crate::ingest::table::start;
use crate::ingest::{Reading, climate_log, drive, run_sheet};
use crate::pipeline::intake::ingest::groups::is_named_as_copy;
use crate::pipeline::intake::ingest::unread::missing_responses;

/// Most files that are looked at.
const MOST_FILES: usize = 10_000;
/// Largest file that is read, bytes.
const LARGEST_BYTES: u64 = 1 << 30;

/// What a file is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Taken {
    /// A run with steps of the voltage, or one whose voltage its tags give.
    Run,
    /// A run without steps, such as a sweep.
    NoSteps,
    /// A climate logger's file.
    Logger,
    /// A modulus log.
    ModulusLog,
    /// A run sheet: a table of runs by the names of their files, with their tags.
    RunSheet,
    /// A sidecar of an instrument, or a file of tags.
    Sidecar,
    /// A picture, a document or a text of people: it stays where it is.
    NoData,
    /// The bytes of another file.
    Copy,
    /// Nothing that is read; it is copied to the runs, where it is listed with its reason.
    NotRead,
    /// Nothing: too large, or it cannot be opened.
    LeftOut,
}

impl Taken {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Taken::Run => "run",
            Taken::NoSteps => "no steps",
            Taken::Logger => "climate log",
            Taken::ModulusLog => "modulus log",
            Taken::RunSheet => "run sheet",
            Taken::Sidecar => "beside a run",
            Taken::NoData => "no data",
            Taken::Copy => "copy of a file",
            Taken::NotRead => "not read",
            Taken::LeftOut => "left out",
        }
    }

    /// The campaign's folder that it is copied to; none where it is not.
    pub fn folder(self) -> Option<&'static str> {
        match self {
            Taken::Run | Taken::NoSteps | Taken::RunSheet | Taken::Sidecar | Taken::Copy | Taken::NotRead => {
                Some("runs")
            }
            Taken::Logger => Some("ambient"),
            Taken::ModulusLog => Some("dma"),
            Taken::NoData | Taken::LeftOut => None,
        }
    }
}

/// A file that was looked at.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Seen {
    /// Its path, relative to the folder, with `/`.
    pub path: String,
    /// What it is taken for.
    pub taken: Taken,
    /// Format, or `profile:ID` for a proposed profile; empty where nothing reads it.
    pub format: String,
    /// What is read of it: each column with its quantity, `Zeit [s] = time`.
    pub columns: Vec<String>,
    /// Whether a voltage can be taken from it.
    pub has_drive: bool,
    /// What it holds, where that is half of a run.
    pub half: Option<HalfKind>,
    /// When it began and ended, s since 1970, as far as its clock tells.
    #[serde(skip)]
    pub window_s: Option<(f64, f64)>,
    /// What stands before a date that is taken as its start although no word says so, and that date.
    #[serde(skip)]
    pub start_words: Option<String>,
    /// See `start_words`.
    #[serde(skip)]
    pub start_raw: Option<String>,
    /// What is to be known of it: why it is not read, columns taken under another name.
    pub issues: Vec<Issue>,
    /// Where it lies.
    #[serde(skip)]
    pub location: PathBuf,
}

/// A profile for files that no reader knows.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ProposedFor {
    /// Id.
    pub id: String,
    /// Names and units of the columns that its files have.
    #[serde(skip)]
    pub header: String,
    /// Text.
    pub text: String,
    /// What has to be filled in before it reads anything; empty where it is usable.
    pub open: Vec<String>,
    /// Files that it was proposed for.
    pub files: Vec<String>,
}

/// What a folder holds.
#[derive(Debug, Default)]
pub struct Looked {
    /// Its files by path.
    pub files: Vec<Seen>,
    /// Proposed profiles.
    pub profiles: Vec<ProposedFor>,
    /// The order of dates that decides where files leave it open, and the file that shows it.
    pub date_order: Option<DateOrder>,
    /// Rows of run sheets.
    pub rows: Vec<SheetRow>,
    /// Whether dates stay open because no file shows their order.
    pub has_open_dates: bool,
}

/// Files below `folder` by path, without hidden ones and what a campaign writes itself.
///
/// # Errors
/// The folder cannot be listed.
pub fn files_below(folder: &Path, without: &Path) -> std::io::Result<Vec<PathBuf>> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(&at)? {
            let entry = entry?;
            let (path, kind) = (entry.path(), entry.file_type()?);
            let relative = path.strip_prefix(folder).unwrap_or(&path);
            if is_passing_name(&entry.file_name()) || is_own_product(relative) || path == without {
                continue;
            }
            match () {
                () if kind.is_dir() => open.push(path),
                () if kind.is_file() => found.push(path),
                () => {}
            }
        }
        if found.len() > MOST_FILES {
            break;
        }
    }
    found.sort();
    found.truncate(MOST_FILES);
    Ok(found)
}

/// Looks at every file.
pub fn look(folder: &Path, paths: &[PathBuf]) -> Looked {
    let mut looked = Looked::default();
    let mut usable: Vec<Profile> = Vec::new();
    let mut in_order: Vec<&PathBuf> = paths.iter().collect();
    // A copy comes after what it is of.
    in_order.sort_by_key(|path| is_named_as_copy(&path.to_string_lossy()));
    let mut known: HashMap<String, String> = HashMap::new();
    for path in in_order {
        let shown = path.strip_prefix(folder).unwrap_or(path);
        let shown = shown.to_string_lossy().replace('\\', "/");
        let mut seen = one(path, shown, &mut usable, &mut looked);
        if seen.taken == Taken::Run
            && let Ok(bytes) = fs::read(path)
        {
            match known.entry(archive::hash(&bytes)) {
                Entry::Occupied(first) => {
                    let issue = Issue::note("same-bytes", format!("it has the bytes of {}", first.get()));
                    seen = Seen {
                        taken: Taken::Copy,
                        half: None,
                        issues: vec![issue],
                        ..seen
                    };
                }
                Entry::Vacant(place) => {
                    place.insert(seen.path.clone());
                }
            }
        }
        looked.files.push(seen);
    }
    looked.files.sort_by(|a, b| a.path.cmp(&b.path));
    looked
}

fn one(path: &Path, shown: String, usable: &mut Vec<Profile>, looked: &mut Looked) -> Seen {
    let name = path.file_name().unwrap_or_default();
    let seen = |taken| Seen {
        path: shown.clone(),
        taken,
        format: String::new(),
        columns: Vec::new(),
        has_drive: false,
        half: None,
        window_s: None,
        start_words: None,
        start_raw: None,
        issues: Vec::new(),
        location: path.to_owned(),
    };
    let bytes = match fs::metadata(path) {
        Ok(found) if found.len() > LARGEST_BYTES => None,
        _ => fs::read(path).ok(),
    };
    let Some(bytes) = bytes else {
        let issue = Issue::error("not-read", "it is too large, or cannot be opened");
        return Seen {
            issues: vec![issue],
            ..seen(Taken::LeftOut)
        };
    };
    let name = name.to_string_lossy();
    // Frames of a strip lie in a folder of their own, which is one run.
    if shown
        .split('/')
        .rev()
        .skip(1)
        .any(|folder| folder.ends_with(".frames"))
    {
        return seen(Taken::Sidecar);
    }
    if path.file_name().and_then(states_for).is_some() {
        return seen(Taken::Sidecar);
    }
    if run_sheet::is_sheet(&name, &bytes) {
        return sheet(seen(Taken::RunSheet), &bytes, looked);
    }
    match read(path, &name, &bytes, usable, looked) {
        Ok((reading, format)) => of_reading(seen(Taken::Run), &reading, format),
        Err(ReadError::NoData { .. }) => seen(Taken::NoData),
        Err(error) if error.is_sidecar() => seen(Taken::Sidecar),
        // A proposal would take one of the answers without asking.
        Err(error @ ReadError::Asked(_)) => Seen {
            issues: vec![error.issue()],
            ..seen(Taken::NotRead)
        },
        Err(error) => {
            let open = propose(&name, &shown, &bytes, usable, looked);
            if let Some(profile) = usable.last().filter(|_| open == Some(true))
                && let Ok(reading) = profile.read(&bytes, &ReadContext::default())
            {
                let format = format!("profile:{}", profile.id);
                return of_reading(seen(Taken::Run), &reading, format);
            }
            Seen {
                issues: vec![error.issue()],
                ..seen(Taken::NotRead)
            }
        }
    }
}

/// A run sheet, whose rows are remembered.
fn sheet(seen: Seen, bytes: &[u8], looked: &mut Looked) -> Seen {
    let issue = match run_sheet::read(bytes) {
        Ok(rows) => {
            let note = run_sheet::note(bytes, rows.len());
            looked.rows.extend(rows);
            note
        }
        Err(issue) => issue,
    };
    Seen {
        issues: vec![issue],
        ..seen
    }
}

/// Reads a file; where its dates leave their order open, that of other files of its folder is taken and remembered.
fn read(
    path: &Path,
    name: &str,
    bytes: &[u8],
    usable: &[Profile],
    looked: &mut Looked,
) -> Result<(Reading, String), ReadError> {
    let read_as = |date_order| {
        let context = ReadContext {
            date_order,
            ..ReadContext::default()
        };
        let (reading, profile) = profiles::read(usable, name, bytes, &context)?;
        let format = profile.map_or(reading.format.to_owned(), |profile| {
            format!("profile:{}", profile.id)
        });
        Ok::<_, ReadError>((reading, format))
    };
    match read_as(None) {
        Err(ReadError::AmbiguousDates { first, .. }) => {
            let order = looked.date_order.or_else(|| order_beside(path, &first));
            looked.date_order = order;
            let read = read_as(order);
            looked.has_open_dates |= read.is_err();
            read
        }
        read => read,
    }
}

fn of_reading(seen: Seen, reading: &Reading, format: String) -> Seen {
    let channels = || reading.tables.iter().flat_map(|table| &table.channels);
    let is_log = climate_log::log(reading, &seen.path).is_ok();
    let responds = channels().any(|channel| channel.is_response());
    let has_modulus = channels().any(|channel| channel.quantity.is_modulus() && !channel.is_empty());
    let found = reading
        .tables
        .iter()
        .map(|table| drive::find(&table.channels, table.time_zero_is_step, None, &[]));
    let (mut has_drive, mut is_sweep) = (false, false);
    for found in found {
        has_drive |= found.drive.is_some();
        is_sweep |= found.issues.iter().any(|issue| issue.code == drive::NO_STEPS);
    }
    let taken = match () {
        () if responds && (is_sweep || !reading.is_step_response) => Taken::NoSteps,
        () if responds => Taken::Run,
        () if has_modulus => Taken::ModulusLog,
        () if is_log => Taken::Logger,
        () => Taken::NotRead,
    };
    let columns = reading.tables.iter().flat_map(|table| table.columns());
    let columns = columns
        .filter(|column| column.quantity != Quantity::Other)
        .map(|column| format!("{} = {}", column.name, column.quantity.label().to_lowercase()));
    let worth = reading
        .issues
        .iter()
        .filter(|issue| issue.code.starts_with("column-"));
    let all: Vec<Channel> = channels().cloned().collect();
    let unread = match taken {
        Taken::Run => missing_responses(&all, &seen.path),
        _ => Vec::new(),
    };
    let times = all
        .iter()
        .filter_map(|c| c.time_s.first().copied().zip(c.time_s.last().copied()));
    let times = times.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let window = reading.started_at.as_ref().zip(times);
    let unnamed = reading.started_at.as_ref().and_then(|start| {
        let words = start.basis.strip_prefix(start::ONLY_DATE)?;
        let words = words.split_once("\", ").map_or(words, |(words, _)| words);
        Some((format!("{}\"", words.trim_end_matches('"')), start.raw.clone()))
    });
    Seen {
        half: half_of(all.iter().map(|channel| channel.quantity)).filter(|_| taken == Taken::Run),
        // Of two files without a zone both count as if they had the same.
        window_s: window.and_then(|(stamp, times)| window_s(stamp, times, 0.0)),
        start_words: unnamed.as_ref().map(|(words, _)| words.clone()),
        start_raw: unnamed.map(|(_, raw)| raw),
        taken,
        format,
        columns: columns.collect(),
        has_drive,
        issues: worth.cloned().chain(unread).collect(),
        ..seen
    }
}

/// Proposes a profile for a file that no reader knows; tells whether it can be used as it is. One whose file shows too
/// little is kept with what is open.
fn propose(
    name: &str,
    shown: &str,
    bytes: &[u8],
    usable: &mut Vec<Profile>,
    looked: &mut Looked,
) -> Option<bool> {
    let proposal = profiles::propose(name, bytes, &[]).ok()?;
    // Files of one header have one profile: of two that fit a file neither would read it.
    let known = looked
        .profiles
        .iter_mut()
        .find(|known| known.header == proposal.header);
    if let Some(known) = known {
        known.files.push(shown.to_owned());
        return Some(false);
    }
    let id = free_id(name, &looked.profiles);
    let parsed = profiles::from_text(Path::new(&format!("{id}.toml")), &proposal.text).ok();
    let reads = parsed.filter(|profile| profile.read(bytes, &ReadContext::default()).is_ok());
    let is_usable = proposal.open.is_empty() && reads.is_some();
    let is_table_of_run = !proposal.open.is_empty() || reads.is_some();
    if is_table_of_run {
        looked.profiles.push(ProposedFor {
            id,
            header: proposal.header,
            text: proposal.text,
            open: proposal.open,
            files: vec![shown.to_owned()],
        });
    }
    usable.extend(reads.filter(|_| is_usable));
    Some(is_usable)
}

/// An id from the file's name that no other profile has.
fn free_id(name: &str, taken: &[ProposedFor]) -> String {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let plain: String = stem
        .to_lowercase()
        .chars()
        .map(|c| {
            if c.is_ascii_lowercase() || c.is_ascii_digit() {
                c
            } else {
                '-'
            }
        })
        .take(40)
        .collect();
    let base = plain.trim_matches('-').to_owned();
    let base = if base.is_empty() {
        "profile".to_owned()
    } else {
        base
    };
    let is_free = |id: &String| taken.iter().all(|known| known.id != *id);
    let numbered = (2..).map(|number| format!("{base}-{number}"));
    std::iter::once(base.clone())
        .chain(numbered)
        .find(is_free)
        .unwrap_or(base)
}
