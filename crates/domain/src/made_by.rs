//! The program that made a result.

use std::borrow::Cow;

/// Which program made a result. No hash of what a result depends on holds it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MadeBy {
    /// Its version.
    pub version: Cow<'static, str>,
    /// The commit that it was built from, with `+modified` where its sources were others; `unknown` where nothing told.
    pub built_from: Cow<'static, str>,
}

impl MadeBy {
    /// A program of that version, built from that commit.
    pub fn new(version: impl Into<Cow<'static, str>>, built_from: impl Into<Cow<'static, str>>) -> MadeBy {
        MadeBy {
            version: version.into(),
            built_from: built_from.into(),
        }
    }
}
