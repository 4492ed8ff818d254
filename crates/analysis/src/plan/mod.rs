//! Which runs to make next: those that tell apart what changed together in the design of a study, and those that tell
//! apart causes that explain a group equally well, in one list.

pub mod list;
pub mod proposed;
pub mod untie;
pub mod view;
pub mod words;

pub use list::{PlannedRun, next_runs};
