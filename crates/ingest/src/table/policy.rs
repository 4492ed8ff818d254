//! What decides how a table is read: every number with its unit and where it comes from. The inputs that must be read as they
//! are stand in `tests/it/reading_cases.rs`, random ones in `examples/random_tables` (docs/validation/readers.md).

use std::ops::RangeInclusive;

/// Moments since 1970 that a logger of our time can write, s: 1990 to 2055. What counts from 1904 is larger then.
pub(super) const OUR_TIME_S: RangeInclusive<f64> = 631_152_000.0..=2_713_996_799.0;

/// The latest moment that a count alone shows, without a date beside it: 2029, s since 1970. Chosen: what this version reads was
/// measured before.
pub(super) const LATEST_WITHOUT_WITNESS_S: f64 = 1_861_920_000.0;
/// How far a date above a table may be from the first of the moments that it is a witness of, s: two days, for zones and for a
/// head that was written before.
pub(super) const WITNESS_WITHIN_S: f64 = 172_800.0;

/// Years from here on are those of records that come in now: of a date with a year of two digits, one that reads day first in such a
/// year and year first before it is day first. Chosen.
pub(super) const RECENT_YEAR: i16 = 2015;

/// Share by which an elapsed time and the dates beside it may differ and still be the same. Chosen: clocks of two chips drift by
/// less; units differ by 60 and more.
pub(super) const CLOCKS_AGREE_SHARE: f64 = 0.02;
/// How many times its last digit a record must last before dates are a witness of a unit. Chosen.
pub(super) const CLOCK_RESOLUTIONS: f64 = 5.0;

/// Sizes of counters that wrap: 16, 24, 31 and 32 bits.
pub(super) const COUNTERS: [f64; 4] = [65_536.0, 16_777_216.0, 2_147_483_648.0, 4_294_967_296.0];
/// Rows that count on from where a clock went back to, before it is a clock that starts anew and no glitch. Chosen.
pub(super) const RESTART_ROWS: usize = 3;
/// Share by which steps of a clock may differ and still be regular. Chosen.
pub(super) const REGULAR_WITHIN: f64 = 0.02;

/// Numbers that can be a temperature of a room's air in °C only, where a file names no unit: in °F it would freeze, in K no sensor
/// works. Freezing is 32 °F.
pub(crate) const AIR_IN_CELSIUS: RangeInclusive<f64> = 0.0..=32.0;
/// A humidity above this is no fraction: the air is saturated at 1. A sensor may read some percent above it. Chosen.
pub(crate) const LARGEST_FRACTION: f64 = 1.05;

/// How many times smoother readings must be within the rows of each word than from row to row, before the words are sensors.
/// Chosen.
pub(crate) const SMOOTHER_WITHIN: f64 = 3.0;

/// Most columns of a table. Chosen: sheets of multiplexers have some hundred.
pub(super) const MOST_COLUMNS: usize = 2000;

/// Rows that are asked how their numbers are written before the rest is read; the rest is asked too where it does not fit.
pub(super) const ROWS_ASKED: usize = 20_000;
