//! What run sheets are read by.

/// Largest sheet, bytes: some thousand runs.
pub const LARGEST_BYTES: u64 = 1 << 20;
/// Columns that speak to people and are no tags.
pub const SAID: [&str; 5] = ["order", "drive", "splits", "why", WITH];
/// The column of the other file of a run in two.
pub const WITH: &str = "with";
/// What may stand between cells of a text.
pub const DELIMITERS: [u8; 3] = [b',', b';', b'\t'];
