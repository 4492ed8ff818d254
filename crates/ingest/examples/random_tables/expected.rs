//! What a right reading of a table holds.

use ieap_domain::Quantity;

use crate::dialect::Dialect;
use crate::table::{Expect, Written};
use crate::times::Times;
use crate::truth::Truth;
use crate::wall::{Wall, Zone};

/// Readings of one quantity by one sensor in one part.
#[derive(Debug, Clone)]
pub struct Series {
    /// Part of the file.
    pub part: usize,
    /// Sensor.
    pub sensor: usize,
    /// Quantity.
    pub quantity: Quantity,
    /// Name of the column.
    pub name: String,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Cells.
    pub cells: Vec<Expect>,
}

/// What a right reading holds.
pub struct Expected {
    /// All series.
    pub series: Vec<Series>,
    /// Number of parts.
    pub parts: usize,
    /// Start, us since 1970 on the file's clock; none where nothing states it.
    pub start_us: Option<i64>,
    /// Offset from UTC that the file states, minutes.
    pub offset_min: Option<i32>,
    /// The preamble states the start without that offset.
    pub is_stamped: bool,
    /// Times may be counted from another zero.
    pub free_offset: bool,
    /// A unit of the last digit of time, s.
    pub digit_s: f64,
    /// Two clocks contradict each other.
    pub contradicts: bool,
}

/// What is right of the written columns.
pub fn expected(truth: &Truth, dialect: &Dialect, times: &Times, all: &[Written]) -> Expected {
    let stamp = dialect.preamble_date.filter(|_| dialect.preamble > 0);
    let stamped = stamp.map(|wall: Wall| wall.written_us(truth.start_us));
    let zone = dialect.clock.wall.map_or(Zone::None, |wall| wall.zone);
    Expected {
        series: all
            .iter()
            .flat_map(|column| series(truth, times, column))
            .collect(),
        parts: if truth.is_log { 1 } else { truth.parts.len() },
        start_us: times.start_us.or(stamped),
        is_stamped: stamped.is_some(),
        offset_min: match zone {
            Zone::None => None,
            Zone::Z => Some(0),
            Zone::Offset(minutes, _) => Some(minutes),
        },
        // A log is timed from its first row.
        free_offset: times.free_offset && !truth.is_log,
        digit_s: times.digit_s,
        // Without a unit an elapsed time says nothing that a date could contradict.
        contradicts: dialect.clock.contradiction.is_some()
            && dialect.units != crate::dialect::UnitPlace::Missing,
    }
}

/// The series of a column: one, or one for each part or for each sensor whose rows alternate.
fn series(truth: &Truth, times: &Times, column: &Written) -> Vec<Series> {
    let Some((quantity, sensor)) = column.quantity else {
        return Vec::new();
    };
    let part_of = |row: usize| truth.parts.iter().filter(|first| **first <= row).count() - 1;
    let groups: Vec<(usize, usize)> = match (&truth.sensor_of_row, truth.is_log) {
        (Some(_), _) => vec![(0, 0), (0, 1)],
        (None, true) => vec![(0, sensor)],
        (None, false) => (0..truth.parts.len()).map(|part| (part, sensor)).collect(),
    };
    let is_of = |row: usize, (part, sensor): (usize, usize)| match &truth.sensor_of_row {
        Some(sensors) => sensors[row] == sensor,
        None => truth.is_log || part_of(row) == part,
    };
    let of = |group: (usize, usize)| {
        let rows: Vec<usize> = (0..truth.time_us.len())
            .filter(|row| is_of(*row, group))
            .collect();
        let restarts = !truth.is_log && times.free_offset;
        let zero_s = if restarts {
            rows.first().map_or(0.0, |row| times.time_s[*row])
        } else {
            0.0
        };
        Series {
            part: group.0,
            sensor: group.1,
            quantity,
            name: column.name.clone(),
            time_s: rows.iter().map(|row| times.time_s[*row] - zero_s).collect(),
            cells: rows.iter().map(|row| column.expect[*row]).collect(),
        }
    };
    groups.into_iter().map(of).collect()
}
