//! Names of what the program puts into a campaign folder.

/// Folder of the report inside a campaign.
pub const REPORT_FOLDER: &str = "report";
/// Says what a report was made from, so that an unchanged one is not made again. One with faults says it beside them.
pub(crate) const STAMP: &str = ".made-from";
/// What a fault of the program left out of the report; there where something is.
pub(crate) const FAULTS: &str = ".faults.json";
/// Values that a report was made from, kept for the next one ([`crate::analysis::cache`]).
pub(crate) const KEPT_VALUES: &str = ".values";
