//! Which runs to make next: those that tell apart what the design of a campaign ties together, and those that tell
//! apart causes that explain a group equally well, in one list.
//!
//! A run is judged by what the design would be with it: the same variance inflation that ties covariates says how far
//! a further run would untie them. No value of a parameter is looked at.

pub mod candidates;
pub mod deconfound;
pub mod future;
pub mod list;
pub mod policy;
pub mod proposed;
pub mod ties;
pub mod words;

#[cfg(test)]
mod thesis_tests;

pub use deconfound::{Deconfounding, deconfound};
pub use list::{Expected, PlannedRun, next_runs};
