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
    exact(ValueKind::Humidity, text)
}

/// `--temperature 25C`.
pub fn temperature(text: &str) -> Result<f64, String> {
    exact(ValueKind::Temperature, text)
}

/// `--voltage 2V`.
pub fn voltage(text: &str) -> Result<f64, String> {
    exact(ValueKind::Voltage, text)
}

/// `--onset 1.23V`.
pub fn measured_voltage(text: &str) -> Result<Measured, String> {
    parse(ValueKind::Voltage, text)
}

/// `--max-slope 0.1V/s`.
pub fn voltage_rate(text: &str) -> Result<f64, String> {
    exact(ValueKind::VoltageRate, text)
}

/// `--for 300s`.
pub fn time(text: &str) -> Result<f64, String> {
    exact(ValueKind::Time, text)
}

/// A number of which no error is used: one that is stated is refused, not dropped.
fn exact(kind: ValueKind, text: &str) -> Result<f64, String> {
    let Measured {
        value,
        standard_error,
    } = parse(kind, text)?;
    if standard_error == 0.0 {
        return Ok(value);
    }
    Err("an error is of no use here: leave it out".to_owned())
}

fn parse(kind: ValueKind, text: &str) -> Result<Measured, String> {
    kind.parse(text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_used_or_refused() {
        assert_eq!(voltage("1.2V"), Ok(1.2));
        assert!(voltage("1.2±0.3V").is_err_and(|said| said.contains("leave it out")));
        assert!(humidity("33±2%").is_err() && time("10±1 s").is_err());
        assert!(measured_voltage("1.2±0.3V").is_ok_and(|own| own.standard_error == 0.3));
    }
}
