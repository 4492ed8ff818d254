//! Loggers of temperature and humidity: HOBOware and HOBOmobile, Campbell TOA5, PicoLog.
//!
//! Their time is wall-clock time: rows are timed in seconds from the first row, whose moment is the reading's start.
//! They are no step responses.

pub mod hobo;
pub mod picolog;
pub mod toa5;
pub mod wall_clock;

pub use hobo::Hobo;
pub use picolog::Picolog;
pub use toa5::Toa5;
