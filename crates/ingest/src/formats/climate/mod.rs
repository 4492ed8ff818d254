//! Loggers of temperature and humidity: HOBOware and HOBOmobile, Campbell TOA5, PicoLog, and plain tables with dates.
//!
//! Their time is wall-clock time: rows are timed in seconds from the first row, whose moment is the reading's start.
//! They are no step responses. Tables of other loggers, in texts and workbooks, are read by [`table`].

pub mod hobo;
pub mod meaning;
pub mod moments;
pub mod picolog;
pub mod table;
pub mod toa5;

pub use hobo::Hobo;
pub use picolog::Picolog;
pub use table::ClimateTable;
pub use toa5::Toa5;
