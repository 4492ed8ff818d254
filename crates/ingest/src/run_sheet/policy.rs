//! What run sheets are read by.

/// Largest sheet, bytes: some thousand runs.
pub const LARGEST_BYTES: u64 = 1 << 20;
/// Columns that speak to people and are no tags.
pub const SAID: [&str; 5] = ["order", "drive", "splits", "why", WITH];
/// The column of the other file of a run in two.
pub const WITH: &str = "with";
/// What may stand between cells of a text.
pub const DELIMITERS: [u8; 3] = [b',', b';', b'\t'];
/// Rows above the names that are looked through.
pub const MOST_TITLES: usize = 30;
/// Rows and columns beyond which nothing is looked for.
pub const MOST_ROWS: usize = 10_000;
pub const MOST_COLUMNS: usize = 256;
/// Share of the cells of a column that must be of one kind, and fewest of them, before they say what the column states whatever its
/// name is. Chosen.
pub const MOSTLY: f64 = 0.8;
/// See [`MOSTLY`].
pub const FEWEST_CELLS: usize = 2;
