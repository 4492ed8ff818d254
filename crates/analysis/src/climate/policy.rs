//! What decides in the climate of runs: what is wrong with a sensor, and when two sensors or their clocks differ. Every number
//! with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted; `cargo test -p ieap-analysis --lib climate::` holds an example of
//! each fault.

use std::ops::{Range, RangeInclusive};

/// Share of readings of a humidity that equal the temperature from which it is a copy. Chosen.
pub const COPY_SHARE: f64 = 0.95;
/// Fewest readings that show anything. Chosen.
pub const FEWEST_READINGS: usize = 10;
/// A humidity that is one number for that long while the temperature moves is that of a stuck sensor, s: a day. Chosen.
pub const STUCK_HUMIDITY_S: f64 = 86_400.0;
/// The same of a temperature, s: a room held at one temperature is nothing special; a week is. Chosen.
pub const STUCK_TEMPERATURE_S: f64 = 604_800.0;
/// Different numbers of the other quantity that show that the air changed meanwhile. Chosen.
pub const MOVED: usize = 5;
/// Share of readings at the least or the greatest of all from which they are the end of the sensor's range. Chosen.
pub const END_SHARE: f64 = 0.4;
/// Humidities within which a number that comes often is a steady climate and no end, percent. Chosen.
pub const BETWEEN_ENDS: Range<f64> = 20.0..90.0;
/// Fewest readings at one end that are called so. Chosen.
pub const FEWEST_AT_END: usize = 100;
/// Readings of air temperature that can be, °C. Chosen.
pub const POSSIBLE_C: RangeInclusive<f64> = -60.0..=120.0;

/// Length of a bin over which sensors are averaged before they are compared, s: the interval of most loggers.
pub const BIN_S: f64 = 600.0;
/// Bins that both must have for a comparison: an hour. Chosen.
pub const FEWEST_COMMON: usize = 6;
/// Bins that both must have for a comparison of clocks: half a day. Chosen.
pub const FEWEST_FOR_CLOCKS: usize = 72;
/// Most bins that clocks are compared over, the last ones: a month. Chosen.
pub const MOST_FOR_CLOCKS: usize = 4464;
/// Largest shift of clocks that is looked for, half hours: 14 h, the largest offset of a time zone.
pub const LARGEST_SHIFT: i64 = 28;
/// Share of the scatter of the difference that may be left at the shift of a clock that is off. Chosen.
pub const SCATTER_LEFT: f64 = 0.5;
/// The same, as a share of the variation of the air: a third. Chosen.
pub const OF_VARIATION: f64 = 0.34;
