//! A file of a crate.

/// A file of the crate.
pub(super) struct Part {
    /// Path in the crate, with /.
    pub path: String,
    /// What it is, in words.
    pub name: String,
    pub media_type: &'static str,
    pub bytes: u64,
    pub blake3: String,
}
