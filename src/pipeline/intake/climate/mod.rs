//! Climate logs at work: taking them in, joining runs with them, comparing sensors.

mod assess;
mod gather;
mod of_run;
mod probe;
mod shelf;
mod take_in;

pub use assess::assess;
pub use of_run::climate_of;
pub use probe::electrode_courses;
pub use shelf::Shelf;
pub use take_in::{LogSummary, holds_logs, is_below, log_folders, new_log, settle_log};
