//! Values with units on the command line.

use crate::domain::typed_value::{Measured, ValueKind};

/// `--length 5mm`.
pub fn length(text: &str) -> Result<Measured, String> {
    parse(ValueKind::Length, text)
}

/// `--modulus 460MPa`.
pub fn modulus(text: &str) -> Result<Measured, String> {
    parse(ValueKind::Modulus, text)
}

/// `--elongation 0.2%`.
pub fn strain(text: &str) -> Result<Measured, String> {
    parse(ValueKind::Strain, text)
}

/// `--rh 34%`, or without the sign.
pub fn humidity(text: &str) -> Result<f64, String> {
    parse(ValueKind::Humidity, text).map(|measured| measured.value)
}

/// `--temperature 25C`.
pub fn temperature(text: &str) -> Result<f64, String> {
    parse(ValueKind::Temperature, text).map(|measured| measured.value)
}

/// `--voltage 2V`.
pub fn voltage(text: &str) -> Result<f64, String> {
    measured_voltage(text).map(|measured| measured.value)
}

/// `--onset 1.23V`.
pub fn measured_voltage(text: &str) -> Result<Measured, String> {
    parse(ValueKind::Voltage, text)
}

/// `--max-slope 0.1V/s`.
pub fn voltage_rate(text: &str) -> Result<f64, String> {
    parse(ValueKind::VoltageRate, text).map(|measured| measured.value)
}

/// `--for 300s`.
pub fn time(text: &str) -> Result<f64, String> {
    parse(ValueKind::Time, text).map(|measured| measured.value)
}

fn parse(kind: ValueKind, text: &str) -> Result<Measured, String> {
    kind.parse(text).map_err(|error| error.to_string())
}
