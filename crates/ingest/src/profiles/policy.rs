//! What decides between profiles and readers of vendors, and what is guessed of a table: every number with where it comes from.

/// Score of a profile whose statements all hold: below a vendor's certain mark, above a guess.
pub(super) const FITS: f64 = 0.8;
/// Score of a profile that goes before the vendors' formats: above a certain mark with its extension.
pub(super) const OVER_VENDOR: f64 = 1.5;
/// Most that a generic format scores beside a profile that fits: less by the lead that the best must have.
pub(super) const GENERIC_BESIDE: f64 = 0.6;
/// Rows from which a profile is guessed. Chosen.
pub(super) const ROWS_ASKED: usize = 400;
