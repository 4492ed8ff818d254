//! Climate logs at work: taking them in, joining runs with them, comparing sensors.

mod asked;
pub mod assess;
mod covering;
mod gather;
mod moisture;
mod numbers;
mod of_run;
mod probe;
mod remarks;
mod shelf;
mod take_in;

pub use asked::{Asked, Start};
pub use assess::assess;
pub use of_run::{VERSION, climate_of};
pub use probe::electrode_courses;
pub use shelf::Shelf;
pub use take_in::{LogSummary, holds_logs, is_below, log_folders, new_log, settle_log};
