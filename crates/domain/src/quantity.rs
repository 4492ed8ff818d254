//! Physical quantities a run table can hold, each with its one canonical unit.

use serde::{Deserialize, Serialize};

/// What a column of a run table measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Time since the voltage step, s.
    Time,
    /// Voltage across the electrodes, V.
    Voltage,
    /// Voltage that the source was told to apply, V: the drive, where a file states it beside what was measured.
    ControlVoltage,
    /// Current into the sample, A.
    Current,
    /// Current into the sample over its active area, A/cm2.
    CurrentDensity,
    /// Bending curvature, 1/cm.
    Curvature,
    /// Transverse tip displacement, mm.
    TipDisplacement,
    /// Blocking force, mN (millinewton).
    BlockingForce,
    /// 1 where the circuit is open, 0 where it is closed.
    OpenCircuit,
    /// Temperature beside the sample, degrees Celsius.
    Temperature,
    /// Relative humidity beside the sample, percent.
    RelativeHumidity,
    /// Pressure around the sample, Pa.
    Pressure,
    /// Oxygen in the gas around the sample, ppm by volume.
    Oxygen,
    /// Water in the gas around the sample, ppm by volume.
    Water,
    /// Storage modulus E', MPa.
    StorageModulus,
    /// Loss modulus E'', MPa.
    LossModulus,
    /// Magnitude of the complex modulus |E*|, MPa.
    ComplexModulus,
    /// Loss factor tan delta = E''/E', a pure number.
    LossFactor,
    /// Frequency of the oscillation, Hz.
    Frequency,
    /// Real part of the impedance, Ohm.
    ImpedanceReal,
    /// Imaginary part of the impedance, Ohm: negative where it is capacitive.
    ImpedanceImaginary,
    /// Magnitude of the impedance, Ohm.
    ImpedanceMagnitude,
    /// Phase of the impedance, degrees: negative where it is capacitive.
    ImpedancePhase,
    /// A column that is kept under its own name and not interpreted.
    Other,
}

impl Quantity {
    /// Every quantity, in the order in which tables list them.
    pub const ALL: [Quantity; 24] = [
        Quantity::Time,
        Quantity::Voltage,
        Quantity::ControlVoltage,
        Quantity::Current,
        Quantity::CurrentDensity,
        Quantity::Curvature,
        Quantity::TipDisplacement,
        Quantity::BlockingForce,
        Quantity::OpenCircuit,
        Quantity::Temperature,
        Quantity::RelativeHumidity,
        Quantity::Pressure,
        Quantity::Oxygen,
        Quantity::Water,
        Quantity::StorageModulus,
        Quantity::LossModulus,
        Quantity::ComplexModulus,
        Quantity::LossFactor,
        Quantity::Frequency,
        Quantity::ImpedanceReal,
        Quantity::ImpedanceImaginary,
        Quantity::ImpedanceMagnitude,
        Quantity::ImpedancePhase,
        Quantity::Other,
    ];

    /// Stored name: `current`, `tip_displacement`, ...
    pub fn key(self) -> &'static str {
        match self {
            Quantity::Time => "time",
            Quantity::Voltage => "voltage",
            Quantity::ControlVoltage => "control_voltage",
            Quantity::Current => "current",
            Quantity::CurrentDensity => "current_density",
            Quantity::Curvature => "curvature",
            Quantity::TipDisplacement => "tip_displacement",
            Quantity::BlockingForce => "blocking_force",
            Quantity::OpenCircuit => "open_circuit",
            Quantity::Temperature => "temperature",
            Quantity::RelativeHumidity => "relative_humidity",
            Quantity::Pressure => "pressure",
            Quantity::Oxygen => "oxygen",
            Quantity::Water => "water",
            Quantity::StorageModulus => "storage_modulus",
            Quantity::LossModulus => "loss_modulus",
            Quantity::ComplexModulus => "complex_modulus",
            Quantity::LossFactor => "loss_factor",
            Quantity::Frequency => "frequency",
            Quantity::ImpedanceReal => "impedance_real",
            Quantity::ImpedanceImaginary => "impedance_imaginary",
            Quantity::ImpedanceMagnitude => "impedance_magnitude",
            Quantity::ImpedancePhase => "impedance_phase",
            Quantity::Other => "other",
        }
    }

    /// The quantity stored under `key`.
    pub fn from_key(key: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|quantity| quantity.key() == key)
    }

    /// Canonical unit as printed: `A`, `1/cm`, ...; empty where there is none.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Voltage | Quantity::ControlVoltage => "V",
            Quantity::Current => "A",
            Quantity::CurrentDensity => "A/cm2",
            Quantity::Curvature => "1/cm",
            Quantity::TipDisplacement => "mm",
            Quantity::BlockingForce => "mN",
            Quantity::Temperature => "°C",
            Quantity::RelativeHumidity => "%",
            Quantity::Pressure => "Pa",
            Quantity::Oxygen | Quantity::Water => "ppm",
            Quantity::StorageModulus | Quantity::LossModulus | Quantity::ComplexModulus => "MPa",
            Quantity::Frequency => "Hz",
            Quantity::ImpedanceReal | Quantity::ImpedanceImaginary | Quantity::ImpedanceMagnitude => "Ohm",
            Quantity::ImpedancePhase => "degree",
            Quantity::OpenCircuit | Quantity::LossFactor | Quantity::Other => "",
        }
    }

    /// Name of the canonical column: the quantity with its unit, `current_a`.
    pub fn column(self) -> &'static str {
        match self {
            Quantity::Time => "time_s",
            Quantity::Voltage => "voltage_v",
            Quantity::ControlVoltage => "control_voltage_v",
            Quantity::Current => "current_a",
            Quantity::CurrentDensity => "current_density_a_per_cm2",
            Quantity::Curvature => "curvature_per_cm",
            Quantity::TipDisplacement => "tip_displacement_mm",
            Quantity::BlockingForce => "blocking_force_mn",
            Quantity::OpenCircuit => "open_circuit",
            Quantity::Temperature => "temperature_c",
            Quantity::RelativeHumidity => "relative_humidity_percent",
            Quantity::Pressure => "pressure_pa",
            Quantity::Oxygen => "oxygen_ppm",
            Quantity::Water => "water_ppm",
            Quantity::StorageModulus => "storage_modulus_mpa",
            Quantity::LossModulus => "loss_modulus_mpa",
            Quantity::ComplexModulus => "complex_modulus_mpa",
            Quantity::LossFactor => "loss_factor",
            Quantity::Frequency => "frequency_hz",
            Quantity::ImpedanceReal => "impedance_real_ohm",
            Quantity::ImpedanceImaginary => "impedance_imaginary_ohm",
            Quantity::ImpedanceMagnitude => "impedance_magnitude_ohm",
            Quantity::ImpedancePhase => "impedance_phase_degree",
            Quantity::Other => "",
        }
    }

    /// The name a person reads on an axis: `Current`, `Tip displacement`.
    pub fn label(self) -> &'static str {
        match self {
            Quantity::Time => "Time",
            Quantity::Voltage => "Voltage",
            Quantity::ControlVoltage => "Control voltage",
            Quantity::Current => "Current",
            Quantity::CurrentDensity => "Current density",
            Quantity::Curvature => "Curvature",
            Quantity::TipDisplacement => "Tip displacement",
            Quantity::BlockingForce => "Blocking force",
            Quantity::OpenCircuit => "Open circuit",
            Quantity::Temperature => "Temperature",
            Quantity::RelativeHumidity => "Relative humidity",
            Quantity::Pressure => "Pressure",
            Quantity::Oxygen => "Oxygen",
            Quantity::Water => "Water",
            Quantity::StorageModulus => "Storage modulus",
            Quantity::LossModulus => "Loss modulus",
            Quantity::ComplexModulus => "Complex modulus",
            Quantity::LossFactor => "Loss factor",
            Quantity::Frequency => "Frequency",
            Quantity::ImpedanceReal => "Real part of the impedance",
            Quantity::ImpedanceImaginary => "Imaginary part of the impedance",
            Quantity::ImpedanceMagnitude => "Magnitude of the impedance",
            Quantity::ImpedancePhase => "Phase of the impedance",
            Quantity::Other => "Other",
        }
    }

    /// Whether the quantity is a response that a run needs at least one of.
    pub fn is_response(self) -> bool {
        matches!(
            self,
            Quantity::Current | Quantity::CurrentDensity | Quantity::Curvature | Quantity::TipDisplacement
        )
    }

    /// Whether it is a part of an impedance, which together with a frequency makes a spectrum.
    pub fn is_impedance(self) -> bool {
        matches!(
            self,
            Quantity::ImpedanceReal
                | Quantity::ImpedanceImaginary
                | Quantity::ImpedanceMagnitude
                | Quantity::ImpedancePhase
        )
    }

    /// Whether a modulus log can be analysed with it: a modulus by itself.
    pub fn is_modulus(self) -> bool {
        matches!(
            self,
            Quantity::StorageModulus | Quantity::LossModulus | Quantity::ComplexModulus
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique_and_read_back() {
        for quantity in Quantity::ALL {
            assert_eq!(Quantity::from_key(quantity.key()), Some(quantity));
        }
    }
}
