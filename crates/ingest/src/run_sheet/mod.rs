//! Run sheets: tables of planned runs that lie among the runs. A file that is saved under a planned name gets the tags
//! of its row.
//!
//! A sheet is a delimited text (`,`, `;` or tab) or a workbook of at most 1 MiB, known by its name, `run-sheet.csv` or
//! `*.run-sheet.csv`, by its columns `planned` and `file`, or by a column of files beside one of samples, environments,
//! voltages or humidities, in the laboratory's language. It speaks for files anywhere in the campaign's runs.

mod laboratory;
mod policy;
mod read;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use crate::being_read::BeingRead;
use crate::formats::recognition::{self, FileHead};
use crate::scan::{SeenFile, composed, parse_display_path};
use crate::text::decode;
use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_domain::{Issue, Tag, TagSource};
use ieap_system::fs;

use policy::LARGEST_BYTES;
pub use read::{COLUMNS, read};

/// Bytes at the start of a file in which the names of its columns are looked for.
const HEAD_BYTES: usize = 4096;
/// Code of the issue that says that a file is a sheet.
pub const IS_SHEET: &str = "run-sheet";
/// Code of the issue that says that a sheet cannot be used.
pub const IS_DAMAGED: &str = "run-sheet-damaged";

/// One planned run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetRow {
    /// Planned id, `P01`.
    pub planned: String,
    /// Name of the run's file without its ending.
    pub file: String,
    /// Line in the sheet, from 1.
    pub line: usize,
    /// Tags that the row states, [`keys::PLANNED`] first; empty cells state nothing.
    pub tags: Vec<(String, String)>,
    /// Cells that speak to people, by column.
    pub said: Vec<(String, String)>,
}

impl SheetRow {
    /// What the row states of a tag.
    pub fn tag(&self, key: &str) -> Option<&str> {
        let mut tags = self.tags.iter();
        tags.find(|(known, _)| known == key)
            .map(|(_, value)| value.as_str())
    }

    /// What the row says in a column for people.
    pub fn said(&self, column: &str) -> &str {
        let mut said = self.said.iter();
        said.find(|(known, _)| known == column)
            .map_or("", |(_, text)| text)
    }
}

/// The rows of one sheet.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunSheet {
    /// Path relative to the campaign, as the scan displays it.
    pub path: String,
    /// Planned runs in the order of the sheet.
    pub rows: Vec<SheetRow>,
}

/// The run sheets of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunSheets {
    /// Sheets in the order of their paths.
    pub sheets: Vec<RunSheet>,
    /// Sheets that cannot be used now, by path: what they stated before stays.
    pub damaged: BTreeMap<String, DamagedSheet>,
}

/// A sheet that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DamagedSheet {
    /// Why.
    pub issue: Issue,
    /// Its text; none where it has none, or is not to be had.
    text: Option<String>,
}

impl DamagedSheet {
    fn new(bytes: &[u8], issue: Issue) -> DamagedSheet {
        let own = || decode(bytes).text.into_owned();
        let text = laboratory::rewritten(bytes).map(|sheet| sheet.text);
        let text = (bytes.len() as u64 <= LARGEST_BYTES).then(|| text.unwrap_or_else(own));
        DamagedSheet {
            issue,
            text: text
                .filter(|text| !text.contains('\0'))
                .map(|text| composed(&text)),
        }
    }

    /// Whether it may plan a file of that name (without its ending): one that it does not name it does not plan.
    fn may_plan(&self, stem: &str) -> bool {
        self.text.as_ref().is_none_or(|text| text.contains(stem))
    }
}

/// The names of two files of one run, of each row that has two.
pub fn pairs_of<'r>(rows: impl IntoIterator<Item = &'r SheetRow>) -> Vec<(String, String)> {
    let rows = rows.into_iter().filter(|row| !row.said(policy::WITH).is_empty());
    rows.map(|row| (row.file.clone(), row.said(policy::WITH).to_owned()))
        .collect()
}

impl RunSheets {
    /// The names of two files of one run, by the sheets' rows.
    pub fn pairs(&self) -> Vec<(String, String)> {
        pairs_of(self.sheets.iter().flat_map(|sheet| &sheet.rows))
    }

    /// Reads the sheets at these paths; one that cannot be read is among the damaged.
    pub fn load<'a>(campaign: &Path, paths: impl IntoIterator<Item = &'a str>) -> RunSheets {
        let mut sheets = RunSheets::default();
        let paths: BTreeSet<&str> = paths.into_iter().collect();
        for path in paths {
            let found = fs::read_stated(campaign, campaign.join(parse_display_path(path)));
            let outcome = match found {
                Ok(bytes) => read(&bytes).map_err(|issue| DamagedSheet::new(&bytes, issue)),
                Err(error) => Err(not_there_to_read(&error)),
            };
            match outcome {
                Ok(rows) => sheets.sheets.push(RunSheet {
                    path: path.to_owned(),
                    rows,
                }),
                Err(damaged) => {
                    sheets.damaged.insert(path.to_owned(), damaged);
                }
            }
        }
        sheets
    }

    /// Rows with the name of their file, by the sheet that they stand on.
    pub fn rows_of<'a>(&'a self, stem: &'a str) -> impl Iterator<Item = (&'a RunSheet, &'a SheetRow)> {
        let of_sheet = |sheet: &'a RunSheet| sheet.rows.iter().map(move |row| (sheet, row));
        let rows = self.sheets.iter().flat_map(of_sheet);
        rows.filter(move |(_, row)| row.file == stem)
    }

    /// Tags of the file of that name (without its ending), those of the first sheet first.
    pub fn tags_of(&self, stem: &str) -> Vec<Tag> {
        let of_row = |(sheet, row): (&RunSheet, &SheetRow)| -> Vec<Tag> {
            let tag = |(key, value): &(String, String)| Tag {
                key: key.clone(),
                value: value.clone(),
                source: TagSource::RunSheet,
                detail: format!("{}, {}", sheet.path, row.planned),
            };
            row.tags.iter().map(tag).collect()
        };
        self.rows_of(stem).flat_map(of_row).collect()
    }

    /// Whether a tag comes from a sheet that cannot be used now.
    pub fn is_from_damaged(&self, tag: &Tag) -> bool {
        tag.source == TagSource::RunSheet
            && tag
                .detail
                .rsplit_once(", ")
                .is_some_and(|(path, _)| self.damaged.contains_key(path))
    }

    /// Why it is not known whether sheets plan the file of that name (without its ending): the sheets that cannot be used
    /// now and may name it.
    pub fn doubts(&self, stem: &str) -> Vec<Issue> {
        let of = |(path, sheet): (&String, &DamagedSheet)| Issue {
            place: path.clone(),
            ..sheet.issue.clone()
        };
        let doubtful = self.damaged.iter().filter(|(_, sheet)| sheet.may_plan(stem));
        doubtful.map(of).collect()
    }
}

/// A sheet that the system does not give.
fn not_there_to_read(error: &std::io::Error) -> DamagedSheet {
    let issue = Issue::error(IS_DAMAGED, format!("the run sheet cannot be read: {error}"));
    DamagedSheet {
        issue: issue.mend("give your user the right to read it, or check the disk"),
        text: None,
    }
}

/// Whether a file of that name and content is a run sheet.
pub fn is_sheet(name: &str, bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    // `End Of File` is a logger's column of events.
    let is_laboratory =
        || laboratory::rewritten(head).is_some() && !recognition::is_of_instrument(&FileHead::of(name, head));
    has_name(name)
        || (may_be(name) && (read::names_columns(head) || is_laboratory()))
        || (laboratory::may_be_workbook(name) && laboratory::rewritten(bytes).is_some())
}

/// The sheets among the files of a scan: those that are known as such, and of `fresh` files those whose name or first
/// lines say so.
pub fn among<'a>(
    campaign: &Path,
    files: &'a [Arc<SeenFile>],
    known: &BTreeSet<&str>,
    fresh: &BTreeSet<&str>,
) -> Vec<&'a str> {
    let being_read = BeingRead::of(campaign);
    let is_one = |file: &&Arc<SeenFile>| {
        let name = file.display.rsplit('/').next().unwrap_or(&file.display);
        if fresh.contains(file.display.as_str()) {
            has_name(name) || starts_as_one(campaign, &being_read, file, name)
        } else {
            known.contains(file.display.as_str())
        }
    };
    let sheets = files.iter().filter(is_one);
    sheets.map(|file| file.display.as_str()).collect()
}

/// Whether the name of a file says that it is a run sheet, whatever it holds.
pub fn is_named_as_one(path: &str) -> bool {
    has_name(path.rsplit('/').next().unwrap_or(path))
}

fn has_name(name: &str) -> bool {
    let name = name.to_lowercase();
    name == "run-sheet.csv" || name.ends_with(".run-sheet.csv")
}

fn may_be(name: &str) -> bool {
    let name = name.to_lowercase();
    [".csv", ".tsv", ".txt"].iter().any(|end| name.ends_with(end))
}

fn starts_as_one(campaign: &Path, being_read: &BeingRead, file: &SeenFile, name: &str) -> bool {
    let is_workbook = laboratory::may_be_workbook(name);
    if file.size_bytes > LARGEST_BYTES || !(is_workbook || may_be(name)) {
        return false;
    }
    let wanted = if is_workbook {
        LARGEST_BYTES
    } else {
        HEAD_BYTES as u64
    };
    let mut head = Vec::new();
    let opened = fs::File::open_stated(campaign, file.location(campaign));
    let read = opened.and_then(|opened| opened.take(wanted).read_to_end(&mut head));
    // One that ended the program is no sheet, and is refused where it would be read as a run.
    read.is_ok() && being_read.begin(file).is_ok_and(|_mark| is_sheet(name, &head))
}

/// The note that a file is a sheet, with what of it is not used.
pub fn note(bytes: &[u8], rows: usize) -> Issue {
    let mut message = format!(
        "a run sheet of {}: it tags files of these names and is no run itself",
        counted(rows, "planned run")
    );
    if let Some(own) = laboratory::rewritten(bytes) {
        if !own.unused.is_empty() {
            message += &format!("; not used: {}", own.unused.join(", "));
        }
        if own.nameless > 0 {
            message += &format!("; {} without the name of a file", counted(own.nameless, "row"));
        }
    }
    Issue::note(IS_SHEET, message)
}

/// Whether the value of a column must be a number.
fn is_numeric(column: &str) -> bool {
    keys::NUMERIC.contains(&column)
}
