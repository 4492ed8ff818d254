//! From files to runs: formats, tags, archive, scanner and watcher.

pub mod formats;
pub mod reading;
pub mod text;

pub use reading::{ColumnSummary, Reading, RunTable, StartedAt, Timestamp};
