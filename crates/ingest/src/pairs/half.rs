//! A file that holds half of a run.

use ieap_domain::pairs::HalfKind;

/// A file that holds half of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Half {
    /// Its path relative to the campaign, with `/`.
    pub path: String,
    /// What it holds.
    pub kind: HalfKind,
    /// When it began and ended, s since 1970, as far as its clock tells: of two files without a zone both are read as UTC.
    pub window_s: Option<(f64, f64)>,
}
