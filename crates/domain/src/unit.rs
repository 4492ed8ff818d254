//! Units as files spell them, and their conversion to the canonical unit of a quantity.

use thiserror::Error;

use super::Quantity;
use super::unit_spelling::{known_units, normalise, parse_as};

/// What a unit measures; only units of the same dimension convert into each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Canonical s.
    Time,
    /// Canonical V.
    Voltage,
    /// Canonical A.
    Current,
    /// Canonical A/cm2.
    CurrentDensity,
    /// Canonical 1/cm.
    Curvature,
    /// Canonical mm.
    Length,
    /// Canonical mN.
    Force,
    /// Canonical degrees Celsius.
    Temperature,
    /// Canonical percent.
    Ratio,
    /// Canonical Pa.
    Pressure,
    /// Part of a gas by volume, in ppm.
    GasFraction,
    /// Canonical MPa: moduli.
    Modulus,
    /// Canonical Hz.
    Frequency,
    /// Canonical Ohm.
    Resistance,
    /// Canonical degree.
    Angle,
    /// A pure number, which needs no unit.
    Number,
}

/// Conversion of a reading to the canonical unit: `(value + before) * numerator / denominator + after`.
///
/// Numerator and denominator stand apart so that 0.3 mA becomes the double nearest to 0.0003, not one beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    before: f64,
    numerator: f64,
    denominator: f64,
    after: f64,
}

impl Conversion {
    /// Leaves readings as they are.
    pub const IDENTITY: Conversion = Conversion::scale(1.0, 1.0);

    /// Multiplies by `numerator / denominator`.
    pub const fn scale(numerator: f64, denominator: f64) -> Conversion {
        Conversion {
            before: 0.0,
            numerator,
            denominator,
            after: 0.0,
        }
    }

    /// Adds `before`, then converts as `self` does, then adds `after`.
    pub const fn shifted(self, before: f64, after: f64) -> Conversion {
        Conversion {
            before,
            after,
            ..self
        }
    }

    /// The same with the other sign.
    #[must_use]
    pub const fn negated(self) -> Conversion {
        Conversion {
            numerator: -self.numerator,
            after: -self.after,
            ..self
        }
    }

    /// The reading in the canonical unit.
    pub fn apply(self, value: f64) -> f64 {
        if self == Conversion::IDENTITY {
            return value;
        }
        (value + self.before) * self.numerator / self.denominator + self.after
    }
}

/// Why a unit cannot be used for a quantity.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum UnitError {
    /// Nothing is written where a unit must stand.
    #[error("{quantity} has no unit; known are {known}")]
    Missing {
        /// Label of the quantity.
        quantity: &'static str,
        /// Units that would do.
        known: &'static str,
    },
    /// The spelling is not known.
    #[error("unit \"{found}\" of {quantity} is not known; known are {known}")]
    Unknown {
        /// Label of the quantity.
        quantity: &'static str,
        /// The unit as written.
        found: String,
        /// Units that would do.
        known: &'static str,
    },
    /// The unit measures something else.
    #[error("unit \"{found}\" does not measure {quantity}; known are {known}")]
    WrongDimension {
        /// Label of the quantity.
        quantity: &'static str,
        /// The unit as written.
        found: String,
        /// Units that would do.
        known: &'static str,
    },
}

/// Dimension of the canonical unit of `quantity`; none for flags and for columns that are not interpreted.
pub fn dimension(quantity: Quantity) -> Option<Dimension> {
    Some(match quantity {
        Quantity::Time => Dimension::Time,
        Quantity::Voltage | Quantity::ControlVoltage => Dimension::Voltage,
        Quantity::Current => Dimension::Current,
        Quantity::CurrentDensity => Dimension::CurrentDensity,
        Quantity::Curvature => Dimension::Curvature,
        Quantity::TipDisplacement => Dimension::Length,
        Quantity::BlockingForce => Dimension::Force,
        Quantity::Temperature => Dimension::Temperature,
        Quantity::RelativeHumidity => Dimension::Ratio,
        Quantity::Pressure => Dimension::Pressure,
        Quantity::Oxygen | Quantity::Water => Dimension::GasFraction,
        Quantity::StorageModulus | Quantity::LossModulus | Quantity::ComplexModulus => Dimension::Modulus,
        Quantity::Frequency => Dimension::Frequency,
        Quantity::ImpedanceReal | Quantity::ImpedanceImaginary | Quantity::ImpedanceMagnitude => {
            Dimension::Resistance
        }
        Quantity::ImpedancePhase => Dimension::Angle,
        Quantity::LossFactor => Dimension::Number,
        Quantity::OpenCircuit | Quantity::Other => return None,
    })
}

/// Conversion from `unit`, as a file spells it, to the canonical unit of `quantity`.
///
/// # Errors
/// The unit is missing, not known, or measures something else. Flags and uninterpreted columns convert with
/// any unit, unchanged.
pub fn conversion(quantity: Quantity, unit: &str) -> Result<Conversion, UnitError> {
    let Some(wanted) = dimension(quantity) else {
        return Ok(Conversion::IDENTITY);
    };
    let (label, known) = (quantity.label(), known_units(wanted));
    let spelled = normalise(unit);
    if wanted != Dimension::Number && matches!(spelled.as_str(), "" | "-") {
        return Err(UnitError::Missing {
            quantity: label,
            known,
        });
    }
    let found = unit.trim().escape_debug().to_string();
    match parse_as(&spelled, wanted) {
        Some(conversion) => Ok(conversion),
        None if is_known(&spelled) => Err(UnitError::WrongDimension {
            quantity: label,
            found,
            known,
        }),
        None => Err(UnitError::Unknown {
            quantity: label,
            found,
            known,
        }),
    }
}

/// Whether the spelling is that of any unit ieap converts.
pub fn is_known(unit: &str) -> bool {
    let spelled = normalise(unit);
    Quantity::ALL
        .into_iter()
        .filter_map(dimension)
        .any(|dimension| parse_as(&spelled, dimension).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn convert(quantity: Quantity, unit: &str, value: f64) -> f64 {
        conversion(quantity, unit)
            .unwrap_or_else(|error| panic!("{unit}: {error}"))
            .apply(value)
    }

    #[test]
    fn spellings_convert_to_the_canonical_unit() {
        for (quantity, unit, value, canonical) in [
            (Quantity::Time, "ms", 250.0, 0.25),
            (Quantity::Time, "min", 1.5, 90.0),
            (Quantity::Time, "Seconds", 2.0, 2.0),
            (Quantity::Current, "mA", 0.3, 0.0003),
            (Quantity::Current, "\u{b5}A", 1.0, 1e-6),
            (Quantity::Current, "\u{3bc}A", 1.0, 1e-6),
            (Quantity::Current, "uA", 7.0, 7e-6),
            (Quantity::Voltage, "V vs. Ref.", -0.4, -0.4),
            (Quantity::Voltage, "mV", 1500.0, 1.5),
            (Quantity::Curvature, "1/m", 50.0, 0.5),
            (Quantity::Curvature, "1/mm", 0.05, 0.5),
            (Quantity::Curvature, "m^-1", 50.0, 0.5),
            (Quantity::Curvature, "cm\u{207b}\u{b9}", 0.5, 0.5),
            (Quantity::TipDisplacement, "\u{b5}m", 1500.0, 1.5),
            (Quantity::TipDisplacement, "m", 0.002, 2.0),
            (Quantity::BlockingForce, "N", 0.002, 2.0),
            (Quantity::Temperature, "(*F)", 212.0, 100.0),
            (Quantity::Temperature, "deg C", 21.0, 21.0),
            (Quantity::Temperature, "K", 273.15, 0.0),
            (Quantity::RelativeHumidity, "%RH", 34.0, 34.0),
            (Quantity::RelativeHumidity, "[%rF]", 34.0, 34.0),
            (Quantity::RelativeHumidity, "% r. F.", 34.0, 34.0),
            (Quantity::Pressure, "mbar", 1013.25, 101_325.0),
            (Quantity::Oxygen, "ppmv", 0.8, 0.8),
            (Quantity::Water, "ppb", 500.0, 0.5),
            (Quantity::Pressure, "Torr", 760.0, 101_325.0),
            (Quantity::StorageModulus, "GPa", 0.46, 460.0),
            (Quantity::LossModulus, "Pa", 5e6, 5.0),
            (Quantity::ComplexModulus, "N/mm\u{b2}", 55.0, 55.0),
            (Quantity::LossFactor, "-", 0.08, 0.08),
            (Quantity::LossFactor, "", 0.08, 0.08),
            (Quantity::Frequency, "mHz", 500.0, 0.5),
        ] {
            assert_eq!(convert(quantity, unit, value), canonical, "{unit}");
        }
    }

    #[test]
    fn every_offered_unit_is_accepted() {
        for quantity in Quantity::ALL {
            let Some(dimension) = dimension(quantity) else {
                continue;
            };
            for unit in known_units(dimension).split(", ") {
                assert!(
                    conversion(quantity, unit).is_ok(),
                    "{unit} of {}",
                    quantity.label()
                );
            }
            assert_eq!(conversion(quantity, quantity.unit()), Ok(Conversion::IDENTITY));
        }
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let missing = conversion(Quantity::Time, " ").unwrap_err();
        assert_eq!(
            missing.to_string(),
            "Time has no unit; known are s, ms, us, min, h, d"
        );
        let unknown = conversion(Quantity::Current, "MA\u{7}").unwrap_err();
        assert!(
            unknown
                .to_string()
                .starts_with(r#"unit "MA\u{7}" of Current is not known"#),
            "{unknown}"
        );
        let wrong = conversion(Quantity::Current, "V").unwrap_err();
        assert!(matches!(wrong, UnitError::WrongDimension { .. }));
    }

    #[test]
    fn current_densities_and_mega_are_refused() {
        for unit in ["A/cm2", "mA/cm^2", "MA", "mAh"] {
            assert!(conversion(Quantity::Current, unit).is_err(), "{unit}");
        }
    }
}
