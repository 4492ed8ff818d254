//! Why a file cannot be read: where, what was found, what was needed, how to mend it.

use std::borrow::Cow;

use thiserror::Error;

use crate::table::Question;
use ieap_domain::Issue;

/// Code of the refusal of dates that fit several orders, or none.
pub const AMBIGUOUS_DATES: &str = "ambiguous-dates";
/// Code of what a person is asked.
pub const ASKED: &str = "asked";
/// What every mend is followed by that a profile can take the place of.
const OR_A_PROFILE: &str =
    "; or keep the file and say once how such files are read: `ieap profile FILE` proposes it";

/// A refusal. Texts taken from the file are escaped and shortened: see [`quoted`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ReadError {
    /// The file has no bytes yet.
    #[error("the file is empty (0 bytes)")]
    Empty,
    /// A header was found, but no row of numbers.
    #[error("the file ends after its header, no complete row of numbers follows ({found})")]
    HeaderOnly {
        /// Line of the header, 0 where it is not known.
        line: usize,
        /// What is there.
        found: String,
    },
    /// The file belongs to a run of the instrument's software, but holds no measurement of its own.
    #[error("{kind}: it belongs to a run and holds no readings ({sign})")]
    Sidecar {
        /// What it is, `EC-Lab log`.
        kind: &'static str,
        /// What shows it.
        sign: &'static str,
    },
    /// It is no file of readings, and nobody has to do anything about it.
    #[error("it is {kind}, which is no data ({sign})")]
    NoData {
        /// What it is, `a picture`.
        kind: &'static str,
        /// What shows it.
        sign: &'static str,
    },
    /// The format is known, but no file with this content was ever seen, so nothing is guessed.
    #[error("{what} is not read, for no such file was ever seen: found {found}")]
    NeverSeen {
        /// The part of the format.
        what: &'static str,
        /// What stands in the file, escaped.
        found: String,
    },
    /// The kind of file is known, and there is no reader for it.
    #[error("it is {kind}, which is not read ({sign})")]
    NotRead {
        /// What it is.
        kind: &'static str,
        /// What shows it.
        sign: &'static str,
        /// How to get its readings in.
        mend: &'static str,
    },
    /// The structure of a binary file breaks off or contradicts itself.
    #[error("at byte {offset}: {found}; needed {needed}")]
    Structure {
        /// Where, bytes from the start.
        offset: u64,
        /// What is there.
        found: String,
        /// What must be there.
        needed: &'static str,
    },
    /// No reader knows the file.
    #[error("no known format fits: the file begins with {found}; tried {tried}")]
    UnknownFormat {
        /// First bytes, escaped.
        found: String,
        /// Ids of the formats tried, with what each missed.
        tried: String,
        /// Whether it holds a table that a profile could describe.
        is_table: bool,
    },
    /// Two readers fit about equally well.
    #[error("more than one format fits: {candidates}")]
    AmbiguousFormat {
        /// Candidates with their scores and reasons.
        candidates: String,
    },
    /// Something can be read in several ways, and nothing in the file tells which is right.
    #[error("{0}")]
    Asked(Question),
    /// Columns can be separated in two ways, or in none.
    #[error("delimiter and decimal sign cannot be decided: {found}")]
    AmbiguousNumbers {
        /// Line that shows it.
        line: usize,
        /// The readings.
        found: String,
        /// What would decide it.
        mend: &'static str,
    },
    /// The names of the header are known, and no delimiter and decimal sign makes numbers of the rows below.
    #[error("no row of readings is found: {found}")]
    NoReading {
        /// Line of the names.
        header: usize,
        /// First line of rows.
        line: usize,
        /// What stands there.
        found: String,
        /// What would make it readable.
        mend: &'static str,
    },
    /// Dates can be read in two orders, or in none.
    #[error("the dates of column {column} cannot be decided: {found}")]
    AmbiguousDates {
        /// Line of the first date.
        line: usize,
        /// Name of the column.
        column: String,
        /// The readings.
        found: String,
        /// The first date.
        first: String,
    },
    /// No line names columns ieap knows.
    #[error("no header row names a time column; the first line is {found}")]
    NoHeader {
        /// First line that is no comment.
        line: usize,
        /// That line.
        found: String,
    },
    /// A frequency beside what are not the parts of an impedance.
    #[error(
        "{found} names a frequency and no impedance beside it: a spectrum needs its real and imaginary part, or its magnitude and phase, each with its unit"
    )]
    NoImpedance {
        /// Line of the header.
        line: usize,
        /// That line.
        found: String,
    },
    /// A column that is needed cannot be used.
    #[error("column {column} cannot be used: {reason}")]
    Column {
        /// Line of the header or of the first bad cell.
        line: usize,
        /// Column number from 1.
        index: usize,
        /// Name of the column.
        column: String,
        /// Why.
        reason: String,
    },
    /// There is time, but nothing that responds.
    #[error("no current, curvature, tip displacement or modulus among the columns {found}")]
    NoResponse {
        /// Line of the header.
        line: usize,
        /// The columns with the reason where one was refused.
        found: String,
    },
    /// No variables of a file of many make a run.
    #[error("no variables make a run: {found}")]
    NoRunAmong {
        /// What was tried, with the reasons.
        found: String,
    },
    /// A workbook holds formulas in place of readings, and no program has computed them.
    #[error(
        "{count} cells hold formulas without a value, the first in column {column}: no program has computed them"
    )]
    Formulas {
        /// Row of the first.
        line: usize,
        /// Its column from 1.
        column: usize,
        /// How many.
        count: usize,
    },
    /// Too many rows do not advance in time.
    #[error("time does not increase in {count} of {rows} rows, first at {first}")]
    TimeOrder {
        /// Line of the first such row.
        line: usize,
        /// Number of such rows.
        count: usize,
        /// Number of rows.
        rows: usize,
        /// The first such time with the one before it.
        first: String,
    },
    /// Too many rows have another number of fields than the header.
    #[error("{count} of {rows} rows do not have the {needed} fields of the header, the first has {found}")]
    Ragged {
        /// Line of the first such row.
        line: usize,
        /// Number of such rows.
        count: usize,
        /// Number of rows.
        rows: usize,
        /// Fields of the first such row.
        found: usize,
        /// Fields of the header.
        needed: usize,
    },
    /// A container (zip, compound file) is damaged.
    #[error("the {kind} is damaged: {found}")]
    BrokenContainer {
        /// `spreadsheet (zip archive)`, ...
        kind: &'static str,
        /// What the reader of the container says.
        found: String,
    },
    /// A file, or what it unpacks to, is larger than is safe to hold in memory.
    #[error("{what} holds {found} bytes, more than the limit of {limit}")]
    TooLarge {
        /// The part that is too large.
        what: String,
        /// Size found so far, bytes.
        found: u64,
        /// Limit, bytes.
        limit: u64,
    },
    /// A workbook holds more of something than any measurement needs, and than can be held.
    #[error("the workbook holds {found} {what}; at most {most} are read")]
    TooMany {
        /// What, in the plural.
        what: String,
        /// How many were counted.
        found: u64,
        /// How many are read.
        most: u64,
    },
    /// A spreadsheet places a cell so far out that no measurement can fill the sheet.
    #[error("sheet \"{sheet}\" has a cell in row {row}, column {column}; at most {limit} cells are read")]
    SheetTooWide {
        /// Name of the sheet.
        sheet: String,
        /// Row from 1.
        row: u64,
        /// Column from 1.
        column: u64,
        /// Limit on rows times columns.
        limit: u64,
    },
}

impl ReadError {
    /// A header in that line, and what follows in place of a row of numbers.
    pub fn header_only(line: usize, found: impl Into<String>) -> ReadError {
        let found = found.into();
        ReadError::HeaderOnly { line, found }
    }

    /// Stable slug for scripts to count by.
    pub fn code(&self) -> &'static str {
        match self {
            ReadError::Empty => "empty-file",
            ReadError::HeaderOnly { .. } => "header-only",
            ReadError::Sidecar { .. } => "sidecar",
            ReadError::NoData { .. } => "no-data",
            ReadError::NeverSeen { .. } => "never-seen",
            ReadError::NotRead { .. } => "not-read-kind",
            ReadError::Structure { .. } => "broken-structure",
            ReadError::UnknownFormat { .. } => "unknown-format",
            ReadError::AmbiguousFormat { .. } => "ambiguous-format",
            ReadError::Asked(_) => ASKED,
            ReadError::AmbiguousNumbers { .. } | ReadError::NoReading { .. } => "ambiguous-numbers",
            ReadError::AmbiguousDates { .. } => AMBIGUOUS_DATES,
            ReadError::NoHeader { .. } => "no-header",
            ReadError::NoImpedance { .. } => "spectrum-columns",
            ReadError::Column { .. } => "column-unusable",
            ReadError::NoResponse { .. } => "no-response",
            ReadError::NoRunAmong { .. } => "no-run-among-variables",
            ReadError::Formulas { .. } => "formulas-without-values",
            ReadError::TimeOrder { .. } => "time-order",
            ReadError::Ragged { .. } => "ragged-rows",
            ReadError::BrokenContainer { .. } => "broken-container",
            ReadError::TooLarge { .. } | ReadError::TooMany { .. } | ReadError::SheetTooWide { .. } => {
                "too-large"
            }
        }
    }

    /// Whether the file may become readable by growing: it waits and is not refused.
    pub fn is_pending(&self) -> bool {
        matches!(self, ReadError::Empty | ReadError::HeaderOnly { .. })
    }

    /// Whether the file lies beside runs without holding one, and nothing is to be done: it is no refusal.
    pub fn is_sidecar(&self) -> bool {
        matches!(self, ReadError::Sidecar { .. } | ReadError::NoData { .. })
    }

    /// Line and column; empty where the whole file is meant.
    pub fn place(&self) -> String {
        match self {
            ReadError::Structure { offset, .. } => format!("byte {offset}"),
            ReadError::Asked(question) if question.line > 0 => format!("line {}", question.line),
            ReadError::Column { line: 0, index, .. } => format!("column {index}"),
            ReadError::Column { line, index, .. } => format!("line {line}, column {index}"),
            ReadError::HeaderOnly { line, .. }
            | ReadError::AmbiguousNumbers { line, .. }
            | ReadError::NoReading { line, .. }
            | ReadError::AmbiguousDates { line, .. }
            | ReadError::NoHeader { line, .. }
            | ReadError::NoImpedance { line, .. }
            | ReadError::NoResponse { line, .. }
            | ReadError::Formulas { line, .. }
            | ReadError::TimeOrder { line, .. }
            | ReadError::Ragged { line, .. }
                if *line > 0 =>
            {
                format!("line {line}")
            }
            _ => String::new(),
        }
    }

    /// What would make the file readable.
    pub fn mend(&self) -> Cow<'static, str> {
        Cow::Borrowed(match self {
            ReadError::Asked(question) => return Cow::Owned(question.mend()),
            ReadError::Empty | ReadError::HeaderOnly { .. } => {
                "wait until the instrument has written the file; it is looked at again when it changes"
            }
            ReadError::Sidecar { .. } => "nothing; keep it beside the run's file",
            ReadError::NoData { .. } => "nothing; it may stay where it is",
            ReadError::NotRead { mend, .. } => mend,
            ReadError::NeverSeen { .. } => {
                "export the run as text from the instrument's software, or as a plain table with units in its header"
            }
            ReadError::Structure { .. } => "copy the file again from the instrument's computer",
            ReadError::UnknownFormat { .. } => {
                "export the run as one of the formats of `ieap list formats`, for instance a plain table with the header \
                 time_s,voltage_v,current_a,curvature_per_cm"
            }
            ReadError::AmbiguousFormat { .. } => {
                "rename the columns as `ieap list formats` shows, or export anew"
            }
            ReadError::AmbiguousNumbers { mend, .. } | ReadError::NoReading { mend, .. } => mend,
            ReadError::AmbiguousDates { .. } => {
                "state date_order = \"day-first\" (or month-first, year-first) in campaign.toml, [campaign], or `order` in a \
                 profile (`ieap profile FILE`); or keep it beside a file whose dates show the order; or export with dates \
                 written year first, in four digits"
            }
            ReadError::NoHeader { .. } => {
                "let the first line that is no # comment name the columns with their units: Time (s), Current (mA)"
            }
            ReadError::NoImpedance { .. } => {
                "name the columns frequency_hz, impedance_real_ohm, impedance_imaginary_ohm, or frequency_hz, \
                 impedance_magnitude_ohm, impedance_phase_degree"
            }
            ReadError::Column { .. } => {
                "write the unit into the header, as in Time (s), and only numbers below it"
            }
            ReadError::NoResponse { .. } => {
                "name the response with its unit: Current (mA), curvature_per_cm, Displacement (mm) or storage_modulus_mpa; \
                 or say what a column is: ieap profile FILE --column \"NAME=tip_displacement,mm\" --write displacement"
            }
            ReadError::NoRunAmong { .. } => {
                "save vectors of one length whose names hold their units, such as time_s, voltage_V, current_mA: \
                 save('run.mat', 'time_s', 'voltage_V', 'current_mA', '-v7')"
            }
            ReadError::Formulas { .. } => {
                "open the workbook in a spreadsheet program and save it, or export the sheet as CSV"
            }
            ReadError::TimeOrder { .. } => {
                "export the time with more digits and the rows in the order in which they were taken"
            }
            ReadError::Ragged { .. } => "export anew; every row needs as many fields as the header",
            ReadError::BrokenContainer { .. } => {
                "copy the file again from the instrument's computer, or save it anew from the spreadsheet program"
            }
            ReadError::TooLarge { .. } | ReadError::TooMany { .. } | ReadError::SheetTooWide { .. } => {
                "save only the sheet or the columns of the run, or export it as CSV; what is packed, put there unpacked"
            }
        })
    }

    /// Whether a profile can say what the file does not: where its table stands, its columns, units, signs and dates.
    pub fn is_mended_by_profile(&self) -> bool {
        match self {
            ReadError::UnknownFormat { is_table, .. } => *is_table,
            ReadError::AmbiguousFormat { .. }
            | ReadError::AmbiguousNumbers { .. }
            | ReadError::NoReading { .. }
            | ReadError::AmbiguousDates { .. }
            | ReadError::NoHeader { .. }
            | ReadError::NoImpedance { .. }
            | ReadError::Column { .. }
            | ReadError::NoResponse { .. } => true,
            _ => false,
        }
    }

    /// The refusal as an issue of the file; a sidecar is only noted.
    pub fn issue(&self) -> Issue {
        if self.is_sidecar() {
            return Issue::note(self.code(), self.to_string());
        }
        let is_advised = self.mend().contains("ieap profile");
        let mend = if self.is_mended_by_profile() && !is_advised {
            format!("{}{OR_A_PROFILE}", self.mend())
        } else {
            self.mend().into_owned()
        };
        Issue::error(self.code(), self.to_string())
            .at(self.place())
            .mend(mend)
    }
}

/// Text of a file as messages may show it: in quotes, control characters escaped, long text shortened.
pub fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    let start: String = text.chars().take(SHOWN).collect();
    let more = if text.chars().nth(SHOWN).is_some() {
        "\u{2026}"
    } else {
        ""
    };
    format!("\"{}{more}\"", escaped(&start))
}

/// Text with its control characters and double quotes escaped.
pub fn escaped(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\'' => shown.push(c),
            _ => shown.extend(c.escape_debug()),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_never_reach_a_message() {
        assert_eq!(quoted("a\u{1b}[31m\n\"\u{202e}"), r#""a\u{1b}[31m\n\"\u{202e}""#);
        assert_eq!(quoted(&"x".repeat(61)).chars().count(), 63);
    }

    #[test]
    fn an_issue_says_where_and_how_to_mend() {
        let error = ReadError::Column {
            line: 1,
            index: 2,
            column: quoted("Time"),
            reason: "no unit".to_owned(),
        };
        let issue = error.issue();
        assert_eq!(
            (issue.code.as_str(), issue.place.as_str()),
            ("column-unusable", "line 1, column 2")
        );
        assert!(!issue.mend.is_empty() && !error.is_pending() && ReadError::Empty.is_pending());
        assert!(issue.mend.contains("ieap profile FILE"));
        assert!(!ReadError::Empty.issue().mend.contains("profile"));
    }
}
