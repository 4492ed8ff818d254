//! Why a campaign.toml cannot be used.

use std::path::PathBuf;

use crate::name_pattern::PatternError;

/// Why a campaign.toml cannot be used: where, what was found, what is needed, how to mend it.
#[derive(Debug, thiserror::Error)]
pub enum CampaignFileError {
    /// There is no such file.
    #[error("{}: not found; a campaign folder needs it: `ieap init` writes one", path.display())]
    Missing {
        /// The file looked for.
        path: PathBuf,
    },
    /// The operating system refused to read it.
    #[error("{}: cannot be read ({source}); give your user the right to read it", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The bytes are no UTF-8.
    #[error("{}, line {line}: a character is not UTF-8; save the file with the encoding UTF-8", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// Line of the first such byte.
        line: usize,
    },
    /// The text is no TOML.
    #[error("{}, line {line}, column {column}: not TOML: {found}; correct that line (see https://toml.io)", path.display())]
    NotToml {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the TOML reader says.
        found: String,
    },
    /// A value has another type than needed.
    #[error("{}, line {line}, column {column}: {found}; numbers stand without quotes (5.0), texts with quotes (\"CNaf\")", path.display())]
    WrongType {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        found: String,
    },
    /// A needed key is missing or empty.
    #[error("{}, {place}: `{key}` is missing or empty; add {key} = \"...\"", path.display())]
    MissingKey {
        /// The file.
        path: PathBuf,
        /// The table: `[campaign]`, `line 8, [[sample]]`.
        place: String,
        /// The key.
        key: &'static str,
    },
    /// Materials cannot be compared by that.
    #[error("{}: [compare] by = \"{found}\" is none of electrode, membrane, electrolyte", path.display())]
    BadClass {
        /// The file.
        path: PathBuf,
        /// What stands there.
        found: String,
    },
    /// The study asks for what is none of what it may ask for.
    #[error("{}: [study] {key} = [\"{found}\"] is none of {needed}", path.display())]
    BadFactor {
        /// The file.
        path: PathBuf,
        /// The key.
        key: &'static str,
        /// What stands there.
        found: String,
        /// What may stand there.
        needed: String,
    },
    /// Two entries have the same id.
    #[error("{}, {place}: the id \"{id}\" is already taken by an entry above; give each its own id", path.display())]
    DuplicateId {
        /// The file.
        path: PathBuf,
        /// The second entry: `line 14, [[sample]]`.
        place: String,
        /// The id.
        id: String,
    },
    /// A number that cannot be.
    #[error("{}, {place}: {key} = {found} cannot be: {needed} is needed", path.display())]
    NumberOutOfRange {
        /// The file.
        path: PathBuf,
        /// The entry: `line 8, [[sample]] "CNaf-01"`.
        place: String,
        /// The key.
        key: &'static str,
        /// The number found.
        found: f64,
        /// What is needed: `a number above 0`.
        needed: &'static str,
    },
    /// A time zone that the IANA database does not know.
    #[error("{}, [campaign]: the time zone \"{found}\" is not known; write an IANA name such as \"Europe/Tallinn\" or \"UTC\"", path.display())]
    UnknownTimezone {
        /// The file.
        path: PathBuf,
        /// The name found.
        found: String,
    },
    /// An order of dates that is none.
    #[error("{}, [campaign] date_order: \"{found}\" is no order; write \"day-first\", \"month-first\" or \"year-first\"", path.display())]
    BadDateOrder {
        /// The file.
        path: PathBuf,
        /// The text found.
        found: String,
    },
    /// An answer to no question, or none to a question.
    #[error("{}, [answers]: {reason}", path.display())]
    BadAnswer {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A key to group by that is none.
    #[error("{}, [campaign] group_by: \"{found}\": {reason}; write tag keys, such as [\"sample\", \"environment\"]", path.display())]
    BadGroupBy {
        /// The file.
        path: PathBuf,
        /// The key found.
        found: String,
        /// Why it is refused.
        reason: &'static str,
    },
    /// A declared tag that is no key.
    #[error("{}, [tags] extra: \"{found}\" is no tag key, or stands there twice; write lower-case letters, digits and `_`, such as [\"specimen\"]", path.display())]
    BadExtraTag {
        /// The file.
        path: PathBuf,
        /// The key found.
        found: String,
    },
    /// A limit with no side, or with two.
    #[error("{}, {place}: {found} is stated; write one of them, and the other in an entry of its own", path.display())]
    BadLimit {
        /// The file.
        path: PathBuf,
        /// The entry.
        place: String,
        /// What is stated.
        found: &'static str,
    },
    /// What is known of a parameter, stated so that nothing is.
    #[error("{}, {place}: found {found}; needed value, value and a positive standard_error, or low and a higher high", path.display())]
    BadKnown {
        /// The file.
        path: PathBuf,
        /// The entry.
        place: String,
        /// What is stated.
        found: String,
    },
    /// A sample that campaign.toml does not have.
    #[error("{}, {place}: no [[sample]] is called {found:?}; there are {known}", path.display())]
    UnknownSample {
        /// The file.
        path: PathBuf,
        /// The entry.
        place: String,
        /// What is stated.
        found: String,
        /// The samples, with commas.
        known: String,
    },
    /// An offset from UTC that is none.
    #[error("{}, {place}: utc_offset = \"{found}\" is no offset from UTC; write it as \"+02:00\"", path.display())]
    BadOffset {
        /// The file.
        path: PathBuf,
        /// The entry.
        place: String,
        /// The text found.
        found: String,
    },
    /// A name pattern that cannot be used.
    #[error("{}, [runs] name_pattern: {source}", path.display())]
    BadNamePattern {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: PatternError,
    },
    /// A rule for runs in two files that cannot be used.
    #[error("{}, {place}: {reason}; write names of files in the folder of the runs, as current = \"pot/{{run}}.txt\" and bending = \"laser/{{run}}.csv\"", path.display())]
    BadPair {
        /// The file.
        path: PathBuf,
        /// The entry.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// A folder is not one inside the campaign.
    #[error("{}, {key} = \"{found}\": {reason}; name a folder inside the campaign, such as \"data\"", path.display())]
    FolderOutside {
        /// The file.
        path: PathBuf,
        /// The key that names it: `[runs] folder`.
        key: &'static str,
        /// The folder found.
        found: String,
        /// Why it is refused: `it leads out of the campaign`.
        reason: &'static str,
    },
}
