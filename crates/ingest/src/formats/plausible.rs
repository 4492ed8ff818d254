//! Numbers that are no measurements, and ranges that a bench for ionic actuators can plausibly measure: these are a flag for a
//! wrong unit, never a correction.

use super::cells::CellTable;
use super::error::quoted;
use super::time_axis::TimeAxis;
use crate::formats::policy::OVERFLOW_FROM;
use crate::text::header::Header;
use ieap_domain::number::exact;
use ieap_domain::{Issue, Quantity};

/// Whether a number cannot be a reading of that quantity: instruments write 9.9E37 and the like where they could not measure,
/// loggers -999; nothing is colder than absolute zero, and no air holds more water than fog. `raw` is as the file has it, `value` in
/// the canonical unit.
pub fn is_impossible(quantity: Quantity, raw: f64, value: f64) -> bool {
    /// Relative humidities that a sensor can read, %: it is some percent off where the air is saturated, and about its noise below
    /// zero in dry gas, where leaving that half of the readings out would raise their mean.
    const HUMIDITY_PERCENT: std::ops::RangeInclusive<f64> = -2.0..=105.0;
    const ABSOLUTE_ZERO_C: f64 = -273.15;
    /// A gauge of a vacuum may be off by less, Pa.
    const LEAST_PRESSURE_PA: f64 = -500.0;
    let of_quantity = match quantity {
        Quantity::RelativeHumidity => value.is_finite() && !HUMIDITY_PERCENT.contains(&value),
        Quantity::Pressure => value < LEAST_PRESSURE_PA,
        Quantity::Temperature => value < ABSOLUTE_ZERO_C,
        _ => false,
    };
    raw.abs() >= OVERFLOW_FROM || of_quantity
}

/// Readings that no actuator gives, such as a current in mA under a header that says A: flagged, never corrected.
///
/// `is_of_strip` says whether the table holds a response of an actuator; a furnace is hotter than a strip can be.
pub fn implausible(
    quantity: Quantity,
    header: &Header,
    values: &[f64],
    rows: &[u32],
    axis: &TimeAxis,
    cells: &CellTable,
    is_of_strip: bool,
) -> Option<Issue> {
    let (low, high) = plausible(quantity)?;
    if quantity == Quantity::Temperature && !is_of_strip {
        return None;
    }
    let outside = |value: &&f64| **value < low || **value > high;
    let first = values.iter().position(|value| outside(&value))?;
    let count = values.iter().filter(outside).count();
    let line = cells.line_of_row[axis.rows[rows[first] as usize] as usize];
    let unit = quantity.unit();
    let message = format!(
        "{count} of {} readings of {} lie outside {low} to {high} {unit}, first {} {unit}",
        values.len(),
        quoted(&header.raw_name),
        number(values[first])
    );
    let mend = "check the unit in the header";
    Some(
        Issue::warning("suspicious-range", message)
            .at(format!("line {line}"))
            .mend(mend),
    )
}

/// A number in words: as long as a number is, and with a power of ten where its digits would fill a line.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-6..1e12).contains(&value.abs()) {
        value.to_string()
    } else {
        exact(value)
    }
}

/// Smallest and largest plausible reading, in canonical units.
pub(super) fn plausible(quantity: Quantity) -> Option<(f64, f64)> {
    Some(match quantity {
        Quantity::Voltage | Quantity::ControlVoltage => (-50.0, 50.0),
        Quantity::Current => (-1.0, 1.0),
        Quantity::CurrentDensity => (-1.0, 1.0),
        Quantity::Curvature => (-50.0, 50.0),
        Quantity::TipDisplacement => (-1e3, 1e3),
        Quantity::BlockingForce => (-1e5, 1e5),
        Quantity::OpenCircuit => (0.0, 1.0),
        Quantity::Temperature => (-80.0, 400.0),
        Quantity::RelativeHumidity => (-2.0, 105.0),
        Quantity::Pressure => (-1.0, 1e7),
        Quantity::Oxygen | Quantity::Water => (-10.0, 1e6),
        // From a soft gel to a thousand times steel; below zero is noise or a sign error.
        Quantity::StorageModulus | Quantity::LossModulus | Quantity::ComplexModulus => (0.0, 1e6),
        Quantity::LossFactor => (-0.1, 100.0),
        Quantity::Frequency => (0.0, 1e8),
        Quantity::ImpedancePhase => (-360.0, 360.0),
        Quantity::ImpedanceReal | Quantity::ImpedanceImaginary | Quantity::ImpedanceMagnitude => return None,
        Quantity::Time | Quantity::Other => return None,
    })
}
