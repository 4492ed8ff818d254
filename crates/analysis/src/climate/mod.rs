//! The climate beside the samples: clocks, sensors, the as-of join of runs with logs, comparisons, exposure.
//!
//! Everything here is a function of readings and statements; nothing reads files or the database.

pub mod charts;
pub mod checks;
pub mod clock;
pub mod compare;
pub mod exposure;
pub mod humid_air;
pub mod join;
pub mod merge;
pub mod policy;
pub mod sensors;
mod sheet;
pub mod view;

pub use clock::{Clock, on_utc};
pub use join::{NoClimate, Window, statistics};
pub use merge::{Piece, merged};
pub use sensors::{Identity, identity, rank, speaks_for};
