//! What decides how a text is read: every number with its unit and where it comes from. Texts of instruments that must be read as
//! they are stand in `tests/formats` (docs/validation/readers.md).

/// Lines that a header may be looked for in. Chosen: data loggers write one or more for each of their channels above it.
pub(crate) const HEADER_WITHIN_LINES: usize = 256;
/// Data lines that delimiter and decimal mark are decided from. Chosen.
pub(crate) const LINES_ASKED: usize = 256;
/// Share of data lines, and of cells of a column, that must obey the reading. Chosen.
pub(crate) const OBEYING_SHARE: f64 = 0.9;

/// Fewest letters of a name that a slip may have been made in. Chosen.
pub(super) const FEWEST_LETTERS: usize = 4;
/// Longest text that may be a unit nobody converts, characters: `mW/(m·K)` has eight.
pub(super) const LONGEST_UNIT: usize = 8;
/// Longest name of a column that is looked into, bytes: beyond it stands a text and no name. Chosen.
pub(crate) const LONGEST_NAME: usize = 400;

/// Lines above the last one that its last field is held against, to see whether it was cut. Chosen.
pub(super) const LINES_ABOVE_LAST: usize = 64;
/// Fewest of them that show a fixed form. Chosen.
pub(super) const FEWEST_OF_FORM: usize = 2;
/// Bytes of a file that recognition looks at. Chosen.
pub const HEAD_BYTES: usize = 64 << 10;
