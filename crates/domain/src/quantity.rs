//! Physical quantities a run table can hold, each with its one canonical unit.

use crate::string_enum;

string_enum! {
    /// What a column of a run table measures.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Quantity {
        /// Time since the voltage step, s.
        Time = "time" => "Time",
        /// Voltage across the electrodes, V.
        Voltage = "voltage" => "Voltage",
        /// Voltage that the source was told to apply, V: the drive, where a file states it beside what was measured.
        ControlVoltage = "control_voltage" => "Control voltage",
        /// Current into the sample, A.
        Current = "current" => "Current",
        /// Current into the sample over its active area, A/cm2.
        CurrentDensity = "current_density" => "Current density",
        /// Bending curvature, 1/cm.
        Curvature = "curvature" => "Curvature",
        /// Transverse tip displacement, mm.
        TipDisplacement = "tip_displacement" => "Tip displacement",
        /// Blocking force, mN (millinewton).
        BlockingForce = "blocking_force" => "Blocking force",
        /// 1 where the circuit is open, 0 where it is closed.
        OpenCircuit = "open_circuit" => "Open circuit",
        /// Temperature beside the sample, degrees Celsius.
        Temperature = "temperature" => "Temperature",
        /// Relative humidity beside the sample, percent.
        RelativeHumidity = "relative_humidity" => "Relative humidity",
        /// Pressure around the sample, Pa.
        Pressure = "pressure" => "Pressure",
        /// Oxygen in the gas around the sample, ppm by volume.
        Oxygen = "oxygen" => "Oxygen",
        /// Water in the gas around the sample, ppm by volume.
        Water = "water" => "Water",
        /// Storage modulus E', MPa.
        StorageModulus = "storage_modulus" => "Storage modulus",
        /// Loss modulus E'', MPa.
        LossModulus = "loss_modulus" => "Loss modulus",
        /// Magnitude of the complex modulus |E*|, MPa.
        ComplexModulus = "complex_modulus" => "Complex modulus",
        /// Loss factor tan delta = E''/E', a pure number.
        LossFactor = "loss_factor" => "Loss factor",
        /// Frequency of the oscillation, Hz.
        Frequency = "frequency" => "Frequency",
        /// Real part of the impedance, Ohm.
        ImpedanceReal = "impedance_real" => "Real part of the impedance",
        /// Imaginary part of the impedance, Ohm: negative where it is capacitive.
        ImpedanceImaginary = "impedance_imaginary" => "Imaginary part of the impedance",
        /// Magnitude of the impedance, Ohm.
        ImpedanceMagnitude = "impedance_magnitude" => "Magnitude of the impedance",
        /// Phase of the impedance, degrees: negative where it is capacitive.
        ImpedancePhase = "impedance_phase" => "Phase of the impedance",
        /// A column that is kept under its own name and not interpreted.
        Other = "other" => "Other",
    }
}

impl Quantity {
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
