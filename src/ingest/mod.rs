//! From files to runs: formats, tags, archive, scanner and watcher.

pub mod drive;
pub mod reading;

pub use reading::{Reading, RunTable, StartedAt, Timestamp};
