//! Values as people type them, with unit and error: `1.2mm`, `1.2±0.05 mm`, `0.4 %`, `2 V`.

use thiserror::Error;

use super::Quantity;
use super::unit::conversion;

/// A value with its standard error, both in the canonical unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Value.
    pub value: f64,
    /// Standard error; zero where none is stated.
    pub standard_error: f64,
}

impl Measured {
    /// A value that is taken as exact.
    pub const fn exact(value: f64) -> Measured {
        Measured {
            value,
            standard_error: 0.0,
        }
    }

    /// The standard error as a share of the value.
    pub fn relative_error(&self) -> f64 {
        self.standard_error / self.value
    }
}

/// What a typed value is of; this says its units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// Canonical mm.
    Length,
    /// Canonical 1/cm.
    Curvature,
    /// Canonical rad.
    Angle,
    /// Canonical 1: a share.
    Strain,
    /// Canonical mN mm.
    Moment,
    /// Canonical uJ, which is mN mm.
    Energy,
    /// Canonical MPa.
    Modulus,
    /// Canonical s.
    Time,
    /// Canonical V.
    Voltage,
    /// Canonical V/s.
    VoltageRate,
    /// Canonical percent relative humidity.
    Humidity,
    /// Canonical °C.
    Temperature,
}

impl ValueKind {
    /// Units that are read, for messages; a bare number is in the first.
    pub fn units(self) -> &'static str {
        match self {
            ValueKind::Length => "mm, cm, um, m",
            ValueKind::Curvature => "/cm, /mm, /m",
            ValueKind::Angle => "rad, deg",
            ValueKind::Strain => "1 (a share), %, ppm",
            ValueKind::Moment => "mNmm, uNm, Nm",
            ValueKind::Energy => "uJ, nJ, mJ, J",
            ValueKind::Modulus => "MPa, GPa, Pa",
            ValueKind::Time => "s, min, h",
            ValueKind::Voltage => "V, mV",
            ValueKind::VoltageRate => "V/s, mV/s",
            ValueKind::Humidity => "%",
            ValueKind::Temperature => "C, °C, K",
        }
    }

    /// A number in `unit` as one in the canonical unit; none where the unit is not one of them.
    fn canonical(self, number: f64, unit: &str) -> Option<f64> {
        let of_quantity = |quantity| conversion(quantity, unit).ok().map(|found| found.apply(number));
        let bare: String = unit
            .chars()
            .filter(|c| !c.is_whitespace() && *c != '\u{b7}' && *c != '*')
            .map(|c| if matches!(c, '\u{b5}' | '\u{3bc}') { 'u' } else { c })
            .collect();
        let times = match (self, bare.as_str()) {
            (_, "") => 1.0,
            (ValueKind::Length, _) => return of_quantity(Quantity::TipDisplacement),
            (ValueKind::Curvature, _) => return of_quantity(Quantity::Curvature),
            (ValueKind::Modulus, _) => return of_quantity(Quantity::ComplexModulus),
            (ValueKind::Time, _) => return of_quantity(Quantity::Time),
            (ValueKind::Voltage, _) => return of_quantity(Quantity::Voltage),
            (ValueKind::Temperature, _) => return of_quantity(Quantity::Temperature),
            (ValueKind::Angle, "rad") | (ValueKind::Strain, "1") => 1.0,
            (ValueKind::Angle, "deg" | "°") => std::f64::consts::PI / 180.0,
            (ValueKind::Strain, "%" | "percent") => 1e-2,
            (ValueKind::Strain, "ppm") => 1e-6,
            (ValueKind::Moment, "mNmm" | "uNm") | (ValueKind::Energy, "uJ" | "mNmm") => 1.0,
            (ValueKind::Moment, "Nm") | (ValueKind::Energy, "J") => 1e6,
            (ValueKind::Moment, "mNm") | (ValueKind::Energy, "mJ") => 1e3,
            (ValueKind::Moment, "nNm") | (ValueKind::Energy, "nJ") => 1e-3,
            (ValueKind::VoltageRate, "V/s") => 1.0,
            (ValueKind::VoltageRate, "mV/s") => 1e-3,
            (ValueKind::Humidity, "%" | "%RH") => 1.0,
            _ => return None,
        };
        Some(number * times)
    }

    /// Reads `1.2mm`, `1.2 ± 0.05 mm` or `1.2+-0.05mm`; `1.2` is in the canonical unit.
    ///
    /// # Errors
    /// There is no finite number, or the unit is another one.
    pub fn parse(self, text: &str) -> Result<Measured, TypedValueError> {
        let refused = || TypedValueError {
            found: text.to_owned(),
            units: self.units(),
        };
        let (value, rest) = number(text).ok_or_else(refused)?;
        let error = ["±", "+/-", "+-"].iter().find_map(|sign| rest.strip_prefix(sign));
        let (standard_error, unit) = match error {
            Some(error) => number(error).ok_or_else(refused)?,
            None => (0.0, rest),
        };
        let canonical = |number| self.canonical(number, unit).ok_or_else(refused);
        Ok(Measured {
            value: canonical(value)?,
            // As a difference: scales of temperature have zeros of their own.
            standard_error: (canonical(standard_error)? - canonical(0.0)?).abs(),
        })
    }
}

/// A value that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "found {found:?}; needed a number with a decimal point and its unit, such as 1.2 or 1.2±0.1 followed by one of {units}; \
     without a unit it is in the first of these"
)]
pub struct TypedValueError {
    found: String,
    units: &'static str,
}

/// The longest finite number that the text begins with, and what follows it.
fn number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let ends = text.char_indices().map(|(at, _)| at).skip(1).chain([text.len()]);
    let mut found = None;
    for end in ends {
        if let Ok(number) = text[..end].parse::<f64>()
            && number.is_finite()
        {
            found = Some((number, text[end..].trim()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_error_and_unit_are_read_in_every_spelling() {
        for (kind, text, value, standard_error) in [
            (ValueKind::Length, "5mm", 5.0, 0.0),
            (ValueKind::Length, "0.5 ± 0.01 cm", 5.0, 0.1),
            (ValueKind::Length, "220+-5um", 0.22, 0.005),
            (ValueKind::Curvature, "0.5/cm", 0.5, 0.0),
            (ValueKind::Curvature, "50 1/m", 0.5, 0.0),
            (ValueKind::Angle, "180deg", std::f64::consts::PI, 0.0),
            (ValueKind::Strain, "0.4%", 0.004, 0.0),
            (ValueKind::Strain, "-4e-3", -0.004, 0.0),
            (ValueKind::Moment, "2e-3 mN m", 2.0, 0.0),
            (ValueKind::Energy, "3 µJ", 3.0, 0.0),
            (ValueKind::Modulus, "0.46GPa", 460.0, 0.0),
            (ValueKind::Time, "5 min", 300.0, 0.0),
            (ValueKind::VoltageRate, "10mV/s", 0.01, 0.0),
            (ValueKind::Humidity, "34", 34.0, 0.0),
            (ValueKind::Voltage, "1.2", 1.2, 0.0),
            (ValueKind::Length, "5±0.1", 5.0, 0.1),
            (ValueKind::Temperature, "25", 25.0, 0.0),
            (ValueKind::Temperature, "25°C", 25.0, 0.0),
            (ValueKind::Temperature, "298.15 ± 0.5 K", 25.0, 0.5),
        ] {
            let found = kind.parse(text).unwrap();
            assert!((found.value - value).abs() < 1e-12, "{text}: {found:?}");
            assert!((found.standard_error - standard_error).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn what_is_no_number_or_has_another_unit_is_refused() {
        for (kind, text) in [
            (ValueKind::Length, "5V"),
            (ValueKind::Length, "1,2mm"),
            (ValueKind::Length, "inf mm"),
            (ValueKind::Length, "mm"),
            (ValueKind::Length, "5±mm"),
            (ValueKind::Voltage, ""),
        ] {
            let error = kind.parse(text).unwrap_err().to_string();
            assert!(error.contains(kind.units()), "{text}: {error}");
        }
    }
}
