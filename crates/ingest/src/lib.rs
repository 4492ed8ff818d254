//! From files to runs: formats, tags, archive, scanner and watcher.

pub mod archive;
pub mod arrays;
pub mod being_read;
pub mod campaign_file;
pub mod climate_log;
pub mod clocks;
pub mod derived;
pub mod drive;
pub mod filesystem;
pub mod folder_dates;
pub mod formats;
pub mod frames;
pub mod name_pattern;
pub mod named_columns;
pub mod pairs;
pub mod parquet_rows;
mod probe_log;
pub mod profiles;
pub mod reading;
pub mod run_sheet;
pub mod same_readings;
pub mod scan;
pub mod table;
pub mod tags;
pub mod text;
pub mod watch;

pub use reading::{ColumnSummary, Reading, RunTable, StartedAt, Timestamp};
