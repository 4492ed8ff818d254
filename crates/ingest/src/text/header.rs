//! What a column header means: name, unit, quantity and conversion to the canonical unit.

use ieap_domain::Quantity;
use ieap_domain::unit::{self, Conversion, UnitError};

use super::names::{NEGATED, candidates, contained, half_width};
use super::number::unquote;
use crate::text::policy::LONGEST_NAME;

/// What ieap makes of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Meaning {
    /// A quantity in a unit that converts.
    Known {
        /// The quantity.
        quantity: Quantity,
        /// To its canonical unit.
        conversion: Conversion,
    },
    /// The name is that of a quantity, but the unit is missing or does not fit.
    Refused {
        /// The quantity the name speaks of.
        quantity: Quantity,
        /// What is wrong with the unit.
        error: UnitError,
    },
    /// Kept under its own name.
    Other,
}

impl Meaning {
    /// The quantity that can be used; none for refused and uninterpreted columns.
    pub fn quantity(&self) -> Option<Quantity> {
        match self {
            Meaning::Known { quantity, .. } => Some(*quantity),
            _ => None,
        }
    }

    /// To the canonical unit, where the quantity is known.
    pub fn conversion(&self) -> Conversion {
        match self {
            Meaning::Known { conversion, .. } => *conversion,
            _ => Conversion::IDENTITY,
        }
    }

    /// The quantity the name speaks of, whether its unit fits or not.
    pub fn named_quantity(&self) -> Option<Quantity> {
        match self {
            Meaning::Known { quantity, .. } | Meaning::Refused { quantity, .. } => Some(*quantity),
            Meaning::Other => None,
        }
    }
}

/// A column as its header describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// The header's cell as the file has it.
    pub raw_name: String,
    /// The unit in it; empty where there is none.
    pub raw_unit: String,
    /// What it means.
    pub meaning: Meaning,
    /// Where along the strip, mm from the clamp: `voltage_v@12.5`.
    pub position_mm: Option<f64>,
}

impl Header {
    /// Reads a header cell such as `Time (s)`, `I/mA`, `Current [µA]`, `Temp, °C` or `curvature_per_m`.
    pub fn parse(cell: &str) -> Header {
        let raw_name = unquote(cell);
        if raw_name.len() > LONGEST_NAME {
            return Header {
                raw_name: raw_name.to_owned(),
                raw_unit: String::new(),
                meaning: Meaning::Other,
                position_mm: None,
            };
        }
        let half = half_width(raw_name);
        let (measured, position_mm) = placed(&half);
        let (name, unit) = split(measured);
        Header {
            raw_name: raw_name.to_owned(),
            meaning: interpret(&name, &unit),
            raw_unit: unit,
            position_mm,
        }
    }

    /// A header whose unit stands apart, as in a row of its own.
    pub fn with_unit(name: &str, unit: &str) -> Header {
        let (raw_name, raw_unit) = (unquote(name), unquote(unit));
        Header {
            raw_name: raw_name.to_owned(),
            raw_unit: raw_unit.to_owned(),
            meaning: interpret(raw_name, raw_unit),
            position_mm: None,
        }
    }

    /// The header of a column whose cells are durations, s: they have their unit, whatever the name says.
    pub fn of_durations(cell: &str) -> Header {
        let header = Header::parse(cell);
        let meaning = match header.meaning.named_quantity() {
            Some(quantity) if quantity == Quantity::Time => Meaning::Known {
                quantity,
                conversion: Conversion::IDENTITY,
            },
            _ => Meaning::Other,
        };
        Header {
            raw_unit: "s".to_owned(),
            meaning,
            ..header
        }
    }

    /// Whether the whole name is that of a quantity, and not a word in it.
    pub fn is_named_wholly(&self) -> bool {
        let half = half_width(&self.raw_name);
        let (name, _) = split(placed(&half).0);
        !candidates(&name).is_empty()
    }

    /// The same, kept under its own name where what it measures is none of these.
    pub fn keeping(self, is_kept: impl Fn(Quantity) -> bool) -> Header {
        match self.meaning.quantity() {
            Some(quantity) if is_kept(quantity) => self,
            _ => Header {
                meaning: Meaning::Other,
                ..self
            },
        }
    }

    /// A column kept under its own name, with the unit that stands in it.
    pub fn other(cell: &str) -> Header {
        Header {
            meaning: Meaning::Other,
            ..Header::parse(cell)
        }
    }
}

/// What a mechanical analyser measures of a strip: its forces and displacements are not those of an actuator.
pub fn is_of_analyser(quantity: Quantity) -> bool {
    use Quantity::{Frequency, LossFactor, RelativeHumidity};
    is_of_any_analyser(quantity)
        || quantity.is_modulus()
        || matches!(quantity, LossFactor | Frequency | RelativeHumidity)
}

/// What every thermal analyser measures as others do.
pub fn is_of_any_analyser(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Time | Quantity::Temperature)
}

/// Takes a phase for a column of its own where no impedance stands beside it: a modulus has one, too.
pub fn leave_lone_phases(meanings: &mut [Meaning]) {
    let is_impedance = |meaning: &Meaning| {
        matches!(
            meaning.named_quantity(),
            Some(Quantity::ImpedanceReal | Quantity::ImpedanceImaginary | Quantity::ImpedanceMagnitude)
        )
    };
    if meanings.iter().any(is_impedance) {
        return;
    }
    let is_phase = |meaning: &&mut Meaning| meaning.named_quantity() == Some(Quantity::ImpedancePhase);
    meanings
        .iter_mut()
        .filter(is_phase)
        .for_each(|phase| *phase = Meaning::Other);
}

/// The cell without `@<mm>` at its end, and that position.
fn placed(cell: &str) -> (&str, Option<f64>) {
    let Some((name, place)) = cell.rsplit_once('@') else {
        return (cell, None);
    };
    let millimetres = place.trim().trim_end_matches("mm").trim().parse::<f64>();
    match millimetres {
        Ok(position_mm) if position_mm.is_finite() && position_mm >= 0.0 => {
            (name.trim_end(), Some(position_mm))
        }
        _ => (cell, None),
    }
}

/// Name and unit of a header cell; the unit is empty where there is none.
fn split(cell: &str) -> (String, String) {
    let pair = |name: &str, unit: &str| {
        (
            name.trim().trim_end_matches(',').to_owned(),
            unit.trim().to_owned(),
        )
    };
    const BRACKETS: [(char, char); 3] = [('(', ')'), ('[', ']'), ('{', '}')];
    let (cell, _) = without_description(cell);
    for (open, close) in BRACKETS {
        if cell.ends_with(close)
            && let Some(at) = opening(cell, open, close)
            && at > 0
        {
            return pair(&cell[..at], &cell[at + 1..cell.len() - 1]);
        }
    }
    // `Time(s) CH0`: the input behind the unit.
    for (open, close) in BRACKETS {
        if let Some((name, rest)) = cell.split_once(open)
            && let Some((unit, label)) = rest.split_once(close)
            && unit::is_known(unit)
            && !candidates(name).is_empty()
            && is_channel(label)
        {
            return pair(name, unit);
        }
    }
    // `%rF`, `% HR`: the unit first.
    if let Some(name) = cell
        .strip_prefix('%')
        .filter(|name| candidates(name).contains(&Quantity::RelativeHumidity))
    {
        return pair(name, "%");
    }
    if let Some((name, unit)) = cell.split_once('/').filter(|(name, _)| !name.trim().is_empty()) {
        return if is_channel(unit) {
            pair(cell, "")
        } else {
            pair(name, unit)
        };
    }
    if let Some((name, unit)) = cell.rsplit_once(',').filter(|(name, _)| !name.trim().is_empty()) {
        return pair(name, unit);
    }
    suffix(cell).unwrap_or_else(|| pair(cell, ""))
}

/// A cell and what a logger's software appends to it: serial numbers (`Temp, °C (LGR S/N: 1, SEN S/N: 2)`), or nothing in
/// brackets.
pub(crate) fn without_description(cell: &str) -> (&str, &str) {
    let is_none = |at: &usize| cell[*at..].contains("S/N:") || cell[*at..].trim_end() == "()";
    let at = cell.rfind('(').filter(is_none);
    let (name, description) = cell.split_at(at.unwrap_or(cell.len()));
    (name.trim_end().trim_end_matches(','), description)
}

/// Whether what stands behind a stroke is an input of a device, as in `Dev0/Ai0`: a short word with a number.
fn is_channel(text: &str) -> bool {
    const INPUTS: [&str; 8] = ["ai", "ao", "di", "do", "ch", "ctr", "port", "line"];
    let path = text.trim().to_ascii_lowercase();
    let first = path.split('/').next().unwrap_or("");
    let word = first.trim_end_matches(|c: char| c.is_ascii_digit());
    word.len() < first.len() && INPUTS.contains(&word)
}

/// Where the bracket opens that the last character closes.
fn opening(cell: &str, open: char, close: char) -> Option<usize> {
    let mut depth = 0usize;
    for (at, c) in cell.char_indices().rev() {
        if c == close {
            depth += 1;
        } else if c == open {
            depth -= 1;
            if depth == 0 {
                return Some(at);
            }
        }
    }
    None
}

/// `curvature_per_m`, `Time s`, `Zeit in s`: a quantity's name, then a unit.
fn suffix(cell: &str) -> Option<(String, String)> {
    let cuts = cell.char_indices().filter(|(_, c)| matches!(c, '_' | ' '));
    for (at, _) in cuts {
        let (name, unit) = (&cell[..at], &cell[at + 1..]);
        let unit = unit.strip_prefix("in ").unwrap_or(unit);
        for &quantity in candidates(name) {
            if let Some(unit) = spelled_unit(quantity, unit) {
                return Some((name.to_owned(), unit));
            }
        }
    }
    None
}

/// The unit in the spelling that [`unit::conversion`] knows: names in lower case lose the case of their unit.
pub(crate) fn spelled_unit(quantity: Quantity, suffix: &str) -> Option<String> {
    unit::dimension(quantity)?;
    let proper = match (quantity, suffix.to_ascii_lowercase().as_str()) {
        (Quantity::Time, "s") => "s",
        (Quantity::Time, "ms") => "ms",
        (Quantity::Time, "min") => "min",
        (Quantity::Time, "h") => "h",
        (Quantity::Current, "a") => "A",
        (Quantity::Current, "ma") => "mA",
        (Quantity::Current, "ua") => "uA",
        (Quantity::Current, "na") => "nA",
        (Quantity::Current, "pa") => "pA",
        (Quantity::Voltage | Quantity::ControlVoltage, "v") => "V",
        (Quantity::Voltage | Quantity::ControlVoltage, "mv") => "mV",
        (Quantity::Voltage | Quantity::ControlVoltage, "uv") => "uV",
        (Quantity::BlockingForce, "n") => "N",
        (Quantity::BlockingForce, "mn") => "mN",
        (Quantity::BlockingForce, "un") => "uN",
        (Quantity::Temperature, "c") => "°C",
        (Quantity::Temperature, "k") => "K",
        (Quantity::Temperature, "f") => "°F",
        (Quantity::Pressure, "pa") => "Pa",
        (Quantity::Pressure, "hpa") => "hPa",
        (Quantity::Pressure, "kpa") => "kPa",
        (Quantity::Pressure, "mbar") => "mbar",
        (Quantity::Pressure, "bar") => "bar",
        (Quantity::Oxygen | Quantity::Water, "ppm") => "ppm",
        (Quantity::Oxygen | Quantity::Water, "ppb") => "ppb",
        (Quantity::RelativeHumidity, "percent") => "%",
        (Quantity::StorageModulus | Quantity::LossModulus | Quantity::ComplexModulus, modulus) => {
            match modulus {
                "mpa" => "MPa",
                "gpa" => "GPa",
                "kpa" => "kPa",
                "pa" => "Pa",
                _ => suffix,
            }
        }
        (Quantity::Frequency, "hz") => "Hz",
        (
            Quantity::ImpedanceReal | Quantity::ImpedanceImaginary | Quantity::ImpedanceMagnitude,
            resistance,
        ) => match resistance {
            "ohm" | "ohms" => "Ohm",
            "kohm" => "kOhm",
            _ => suffix,
        },
        (Quantity::CurrentDensity, "a_per_cm2" | "a_cm2") => "A/cm2",
        (Quantity::CurrentDensity, "ma_per_cm2" | "ma_cm2") => "mA/cm2",
        (Quantity::CurrentDensity, "ua_per_cm2" | "ua_cm2") => "uA/cm2",
        (Quantity::Curvature, "per_cm" | "per cm") => "1/cm",
        (Quantity::Curvature, "per_m" | "per m") => "1/m",
        (Quantity::Curvature, "per_mm" | "per mm") => "1/mm",
        _ => suffix,
    };
    unit::conversion(quantity, proper)
        .is_ok()
        .then(|| proper.to_owned())
}

/// Quantity of a name with its unit. A letter such as `V` or `T` stands for several things, so a unit of
/// another kind makes it a column of its own; a full name with a wrong unit is refused.
fn interpret(name: &str, unit: &str) -> Meaning {
    let mut refused = None;
    let whole = candidates(name);
    if whole.is_empty() && !unit.is_empty() {
        let known = contained(name, unit)
            .and_then(|quantity| Some((quantity, unit::conversion(quantity, unit).ok()?)));
        return known.map_or(Meaning::Other, |(quantity, conversion)| Meaning::Known {
            quantity,
            conversion,
        });
    }
    for &quantity in whole {
        match unit::conversion(quantity, unit) {
            Ok(conversion) => {
                let conversion = if is_negative(quantity, name) {
                    conversion.negated()
                } else {
                    conversion
                };
                return Meaning::Known { quantity, conversion };
            }
            Err(error) => refused = refused.or(Some((quantity, error))),
        }
    }
    match refused {
        Some((_, UnitError::WrongDimension { .. })) if name.trim().chars().count() == 1 => Meaning::Other,
        // `Z` and `Phase` are an impedance with its unit only, `f` a frequency and the x-axis of a picture a time.
        Some((Quantity::ImpedanceMagnitude | Quantity::ImpedancePhase, _)) => Meaning::Other,
        Some(_) if matches!(name.trim(), "f" | "F" | "x-axis") => Meaning::Other,
        Some((quantity, error)) => Meaning::Refused { quantity, error },
        None => Meaning::Other,
    }
}

/// Whether the column holds the number with the other sign: `-Z''`, `-I`, `neg. Phase`.
fn is_negative(quantity: Quantity, name: &str) -> bool {
    let name = name.trim().to_ascii_lowercase();
    let signed = matches!(quantity, Quantity::ImpedanceImaginary | Quantity::ImpedancePhase);
    let minus = name
        .strip_prefix(['-', '\u{2212}'])
        .is_some_and(|rest| !rest.starts_with(' '));
    minus || (signed && name.starts_with(NEGATED))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_the_field_are_known() {
        for (cell, quantity, unit) in [
            ("time_s", Quantity::Time, "s"),
            ("Time (s)", Quantity::Time, "s"),
            ("t/ms", Quantity::Time, "ms"),
            ("Test Time / s", Quantity::Time, "s"),
            ("\"Time [min]\"", Quantity::Time, "min"),
            ("T (\u{b0}C)", Quantity::Temperature, "\u{b0}C"),
            ("voltage_v", Quantity::Voltage, "V"),
            ("U/V", Quantity::Voltage, "V"),
            ("Potential (V)", Quantity::Voltage, "V"),
            ("WE(1).Potential (V)", Quantity::Voltage, "V"),
            ("Ewe/V", Quantity::Voltage, "V"),
            ("Potential applied (V)", Quantity::ControlVoltage, "V"),
            ("E Applied(V)", Quantity::ControlVoltage, "V"),
            ("applied_voltage_mv", Quantity::ControlVoltage, "mV"),
            ("current_a", Quantity::Current, "A"),
            ("current_ua", Quantity::Current, "uA"),
            ("I/mA", Quantity::Current, "mA"),
            ("<I>/mA", Quantity::Current, "mA"),
            ("Current [\u{b5}A]", Quantity::Current, "\u{b5}A"),
            ("Current (uA)", Quantity::Current, "uA"),
            ("curvature_per_cm", Quantity::Curvature, "1/cm"),
            ("curvature_per_m", Quantity::Curvature, "1/m"),
            ("kappa (1/m)", Quantity::Curvature, "1/m"),
            ("Curvature / 1/m", Quantity::Curvature, "1/m"),
            ("tip_displacement_mm", Quantity::TipDisplacement, "mm"),
            ("Displacement (mm)", Quantity::TipDisplacement, "mm"),
            ("blocking_force_mn", Quantity::BlockingForce, "mN"),
            ("open_circuit", Quantity::OpenCircuit, ""),
            ("temperature_c", Quantity::Temperature, "\u{b0}C"),
            ("Temp, (*F)", Quantity::Temperature, "*F"),
            ("Temp, \u{b0}F", Quantity::Temperature, "\u{b0}F"),
            ("RH, %", Quantity::RelativeHumidity, "%"),
            ("RH, %()", Quantity::RelativeHumidity, "%"),
            (
                "Temperature, \u{b0}F (LGR S/N: 12, SEN S/N: 34)",
                Quantity::Temperature,
                "\u{b0}F",
            ),
            ("relative_humidity_percent", Quantity::RelativeHumidity, "%"),
            ("pressure_pa", Quantity::Pressure, "Pa"),
            ("oxygen_ppm", Quantity::Oxygen, "ppm"),
            ("water_ppm", Quantity::Water, "ppm"),
            ("storage_modulus_mpa", Quantity::StorageModulus, "MPa"),
            ("Storage modulus (GPa)", Quantity::StorageModulus, "GPa"),
            ("E'/MPa", Quantity::StorageModulus, "MPa"),
            ("E'' (MPa)", Quantity::LossModulus, "MPa"),
            ("E\" (MPa)", Quantity::LossModulus, "MPa"),
            ("\"E\"\"/MPa\"", Quantity::LossModulus, "MPa"),
            ("|E*| [MPa]", Quantity::ComplexModulus, "MPa"),
            ("tan delta", Quantity::LossFactor, ""),
            ("loss_factor", Quantity::LossFactor, ""),
            ("Kr\u{fc}mmung [1/m]", Quantity::Curvature, "1/m"),
            ("Strom/mA", Quantity::Current, "mA"),
            ("Zeit in s", Quantity::Time, "s"),
            ("Strom in mA", Quantity::Current, "mA"),
            ("Spannung (V)", Quantity::Voltage, "V"),
            ("Auslenkung [mm]", Quantity::TipDisplacement, "mm"),
            ("current density (mA/cm2)", Quantity::CurrentDensity, "mA/cm2"),
            ("Stromdichte [A/m\u{b2}]", Quantity::CurrentDensity, "A/m\u{b2}"),
            ("I (mA/cm2)", Quantity::CurrentDensity, "mA/cm2"),
            ("j / mA cm-2", Quantity::CurrentDensity, "mA cm-2"),
            ("current_density_ma_cm2", Quantity::CurrentDensity, "mA/cm2"),
            ("frequency_hz", Quantity::Frequency, "Hz"),
            ("Frequency (rad/s)", Quantity::Frequency, "rad/s"),
            ("freq / Hz", Quantity::Frequency, "Hz"),
            ("f (Hz)", Quantity::Frequency, "Hz"),
            ("x-axis (second)", Quantity::Time, "second"),
            ("102 <current> (ADC)", Quantity::Current, "ADC"),
            ("Z' (\u{3a9})", Quantity::ImpedanceReal, "\u{3a9}"),
            ("-Z'' (\u{3a9})", Quantity::ImpedanceImaginary, "\u{3a9}"),
            ("Z\"/ohm", Quantity::ImpedanceImaginary, "ohm"),
            ("-Im(Z)/Ohm", Quantity::ImpedanceImaginary, "Ohm"),
            ("z_imaginary_ohm", Quantity::ImpedanceImaginary, "Ohm"),
            ("|Z|/kOhm", Quantity::ImpedanceMagnitude, "kOhm"),
            ("-Phase (\u{b0})", Quantity::ImpedancePhase, "\u{b0}"),
            ("neg. Phase / \u{b0}", Quantity::ImpedancePhase, "\u{b0}"),
        ] {
            let header = Header::parse(cell);
            assert_eq!(header.meaning.quantity(), Some(quantity), "{cell}: {header:?}");
            assert_eq!(header.raw_unit, unit, "{cell}");
        }
    }

    #[test]
    fn canonical_columns_are_read_as_themselves() {
        for quantity in Quantity::ALL
            .into_iter()
            .filter(|quantity| *quantity != Quantity::Other)
        {
            let header = Header::parse(quantity.column());
            assert_eq!(header.raw_name, quantity.column());
            assert_eq!(header.raw_unit, quantity.unit());
            assert_eq!(
                header.meaning,
                Meaning::Known {
                    quantity,
                    conversion: Conversion::IDENTITY
                }
            );
        }
    }

    #[test]
    fn a_minus_before_a_part_of_an_impedance_turns_its_sign() {
        for (cell, expected) in [
            ("-Z'' (kOhm)", -2000.0),
            ("Z'' (kOhm)", 2000.0),
            ("\u{2212}Im(Z)/Ohm", -2.0),
            ("neg. Phase / deg", -2.0),
            ("Re(Z)/Ohm", 2.0),
        ] {
            let Meaning::Known { conversion, .. } = Header::parse(cell).meaning else {
                panic!("{cell} is not known");
            };
            assert_eq!(conversion.apply(2.0), expected, "{cell}");
        }
        for cell in ["Phase", "Z (mm)", "phase (min)", "z"] {
            assert_eq!(Header::parse(cell).meaning, Meaning::Other, "{cell}");
        }
    }

    #[test]
    fn a_quantity_without_a_unit_that_fits_is_refused() {
        for cell in ["Time", "current", "Current (mA/kg)", "I (MA)", "Voltage (s)", "t"] {
            assert!(
                matches!(Header::parse(cell).meaning, Meaning::Refused { .. }),
                "{cell}"
            );
        }
    }

    #[test]
    fn a_text_too_long_for_a_name_is_not_looked_into() {
        let long = format!("time {}(s)", "x ".repeat(LONGEST_NAME));
        let header = Header::parse(&long);
        assert_eq!((header.meaning, header.raw_name), (Meaning::Other, long));
    }

    #[test]
    fn other_columns_keep_their_names() {
        for cell in [
            "Index",
            "Dev0/Ai0",
            "cDAQ1Mod2/ai3",
            "Current range",
            "Distance1 (mm)",
            "F (g)",
            "f",
            "x-axis (mm)",
            "V (m)",
            "Q+",
            "",
            "/s",
            "(s)",
            "time stamp",
        ] {
            let header = Header::parse(cell);
            assert_eq!((header.meaning, header.raw_name.as_str()), (Meaning::Other, cell));
        }
    }
}
