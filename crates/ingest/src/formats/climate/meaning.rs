//! What a logger's column measures of the air, and with which of its sensors: `2_DHT22_RH`, `Outside Ave. (C)`,
//! `MET_CS215_AirTemperature_degC_Avg`, `Temp, °F (LGR S/N: 1, SEN S/N: 2)`.

use crate::text::dictionary::{CHAMBER, HUMIDITY, PLAIN, Role, TEMPERATURE, is_among};
use crate::text::header::{self, Header, spelled_unit};
use crate::text::names::{half_width, names_of, role, says_measured};
use crate::text::policy::LONGEST_NAME;
use ieap_domain::Quantity;
use ieap_domain::unit::{self, Conversion};

/// A column of air temperature or relative humidity, or of a chamber's pressure, oxygen or water.
#[derive(Debug, Clone, PartialEq)]
pub struct ClimateColumn {
    /// What is measured.
    pub quantity: Quantity,
    /// To the canonical unit.
    pub conversion: Conversion,
    /// Whether the file names the unit; else °C or percent is assumed.
    pub unit_is_stated: bool,
    /// Serial number of the sensor, or of the logger, where the column's name states it.
    pub serial: Option<String>,
    /// What is left of the name and tells this sensor from others of the same logger: `2_DHT22`, `Outside`.
    pub part: String,
    /// Whether it is a mean over the logger's interval rather than a last or single reading.
    pub is_mean: bool,
}

/// What a column measures, from its name and unit as the file has them; none where it is no climate of the air.
pub fn climate_column(raw_name: &str, raw_unit: &str) -> Option<ClimateColumn> {
    (role(without_description(raw_name).0) == Role::Measured).then(|| spoken_of(raw_name, raw_unit))?
}

/// What the name and unit of a column speak of, whether it was measured or asked for.
pub fn spoken_of(raw_name: &str, raw_unit: &str) -> Option<ClimateColumn> {
    if raw_name.len() > LONGEST_NAME {
        return None;
    }
    let half = half_width(raw_name);
    let (described, serial, label) = without_description(&half);
    let unit = match raw_unit {
        "" => trailing_unit(described).unwrap_or_else(|| unit_in(described)),
        unit => unit.to_owned(),
    };
    let named = without_unit(described, &unit);
    let words = words(named);
    let lower_words: Vec<String> = words.iter().map(|word| word.to_lowercase()).collect();
    // A whole name goes before the words of it: `rF` is no degree Fahrenheit.
    let whole = Header::parse(named.trim()).meaning.named_quantity();
    let is_humidity =
        whole == Some(Quantity::RelativeHumidity) || lower_words.iter().any(|word| says_humidity(word));
    let is_temperature =
        whole != Some(Quantity::RelativeHumidity) && lower_words.iter().any(|word| says_temperature(word));
    let of_chamber = (!is_humidity && !is_temperature)
        .then(|| of_chamber(&lower_words))
        .flatten();
    let unit = if unit.is_empty() {
        lower_words
            .iter()
            .find_map(|word| match of_chamber {
                Some(_) => chamber_unit_word(word),
                None => unit_word(word),
            })
            .unwrap_or("")
            .to_owned()
    } else {
        unit
    };
    let quantity = match (is_humidity, is_temperature) {
        (true, _) => Quantity::RelativeHumidity,
        (false, true) => Quantity::Temperature,
        // These have no unit of their own that could be assumed.
        (false, false) if of_chamber.is_some_and(|quantity| unit::conversion(quantity, &unit).is_ok()) => {
            of_chamber?
        }
        // A sensor's name alone, with a unit that only one of the two has.
        (false, false) if !unit.is_empty() && unit::conversion(Quantity::Temperature, &unit).is_ok() => {
            Quantity::Temperature
        }
        _ => return None,
    };
    // The letter `T` alone stands for several things.
    let is_letter_alone = lower_words.iter().any(|word| word == "t") && quantity == Quantity::Temperature;
    let conversion = match unit.is_empty() {
        true if is_letter_alone => return None,
        true => Conversion::IDENTITY,
        false => unit::conversion(quantity, &unit).ok()?,
    };
    let tells_apart = |word: &String| {
        let lower = word.to_lowercase();
        let number = lower.strip_prefix(plain(&lower)).unwrap_or("");
        let is_of_chamber =
            self::of_chamber(std::slice::from_ref(&lower)).is_some() || chamber_unit_word(&lower).is_some();
        if of_chamber.is_some() && is_of_chamber {
            return None;
        }
        if says_humidity(&lower) || says_temperature(&lower) {
            (!number.is_empty()).then(|| number.to_owned())
        } else {
            (!is_among(PLAIN, &lower) && !says_measured(&lower)).then(|| word.clone())
        }
    };
    let part: Vec<String> = words.iter().filter_map(tells_apart).chain(label).collect();
    Some(ClimateColumn {
        quantity,
        conversion,
        unit_is_stated: !unit.is_empty(),
        serial,
        part: part.join("_"),
        is_mean: lower_words
            .iter()
            .any(|word| ["avg", "ave", "average", "mean"].contains(&word.as_str())),
    })
}

/// What a cell speaks of that names the quantity of the value beside it, or its unit alone: `temperature_c`, `%RH`, `C`.
pub fn of_label(cell: &str) -> Option<ClimateColumn> {
    climate_column(cell, "")
        .or_else(|| climate_column("temperature", cell))
        .filter(|column| column.unit_is_stated)
}

/// A word without the number behind it.
fn plain(word: &str) -> &str {
    word.trim_end_matches(|c: char| c.is_ascii_digit())
}

fn says(quantity: Quantity, short: &str, word: &str) -> bool {
    is_among(short, plain(word)) || names_of(quantity).any(|name| is_name(name, plain(word)))
}

/// Whether a word in small letters is humidity.
fn says_humidity(word: &str) -> bool {
    says(Quantity::RelativeHumidity, HUMIDITY, word)
}

/// Whether a word in small letters is temperature.
fn says_temperature(word: &str) -> bool {
    says(Quantity::Temperature, TEMPERATURE, word)
}

/// The unit that is the last word of a name whose other words say what it measures: `inside Pressione hPa`, `outside T K`.
fn trailing_unit(described: &str) -> Option<String> {
    let (head, last) = described.trim().rsplit_once([' ', '_'])?;
    let lower: Vec<String> = words(head).iter().map(|word| word.to_lowercase()).collect();
    let quantity = if lower.iter().any(|word| says_humidity(word)) {
        Quantity::RelativeHumidity
    } else if lower.iter().any(|word| says_temperature(word)) {
        Quantity::Temperature
    } else {
        of_chamber(&lower)?
    };
    spelled_unit(quantity, last)
}

/// The unit in a name: behind it, or in brackets anywhere in it (`RH (%) c:3`, `Humidity (RH(%))`).
fn unit_in(described: &str) -> String {
    let behind = Header::parse(described).raw_unit;
    if !behind.is_empty() && unit::is_known(&behind) {
        return behind;
    }
    let in_brackets = described
        .split(['(', '['])
        .skip(1)
        .filter_map(|rest| rest.split([')', ']']).next());
    let known = in_brackets.map(str::trim).find(|text| unit::is_known(text));
    known.map_or(behind, str::to_owned)
}

/// Whether a word is a name, or holds one that is written without blanks between words.
fn is_name(name: &str, word: &str) -> bool {
    name == word || (name.chars().all(|c| c > '\u{2e80}') && word.contains(name))
}

/// What a chamber's gauge or analyser measures, by a word of its column.
fn of_chamber(lower_words: &[String]) -> Option<Quantity> {
    let is_named = |(words, quantity): &&(&str, Quantity)| {
        let is = |word: &String| is_among(words, word) || names_of(*quantity).any(|name| is_name(name, word));
        lower_words.iter().any(is)
    };
    let found = CHAMBER.iter().find(is_named);
    found.map(|(_, quantity)| *quantity)
}

/// The name without what HOBO software appends, with the serial number and label in it.
fn without_description(raw_name: &str) -> (&str, Option<String>, Option<String>) {
    let (name, description) = header::without_description(raw_name);
    let after = |mark: &str| {
        let (_, rest) = description.split_once(mark)?;
        let end = rest.find([',', ')']).unwrap_or(rest.len());
        Some(rest[..end].trim().to_owned()).filter(|text| !text.is_empty())
    };
    let serial = after("SEN S/N:").or_else(|| after("LGR S/N:"));
    // The sensor's own name before the quantity (`GCap. RH`) says nothing beside a serial number.
    (name.trim_start(), serial, after("LBL:"))
}

/// The name without the unit behind it.
fn without_unit<'a>(name: &'a str, unit: &str) -> &'a str {
    let cut = name.rfind(unit).filter(|_| !unit.is_empty());
    // `T` is a unit's letter as well as a name's: a unit stands behind a mark.
    match cut.filter(|&at| name[..at].ends_with(['(', '[', '/', ',', ' ', '_'])) {
        Some(at) => &name[..at],
        None => name,
    }
}

/// Words of a name: split at marks, before a capital after a small letter, and between a number and what it measures.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        // One small letter is a part of what follows: `hPa`, `rF`.
        let is_long = words.last().is_some_and(|word| word.chars().count() > 1);
        let starts = !before.is_alphanumeric() || (before.is_lowercase() && c.is_uppercase() && is_long);
        match words.last_mut() {
            Some(word) if c.is_alphanumeric() && !starts => word.push(c),
            _ if c.is_alphanumeric() => words.push(c.to_string()),
            _ => {}
        }
        before = c;
    }
    words.into_iter().flat_map(parted).collect()
}

/// `AM2320RH` is the humidity of an AM2320.
fn parted(word: String) -> Vec<String> {
    let digits = word.rfind(|c: char| c.is_ascii_digit());
    match digits.map(|at| word.split_at(at + 1)) {
        Some((name, measured)) if ["rh", "ta", "temp", "hum"].contains(&measured.to_lowercase().as_str()) => {
            vec![name.to_owned(), measured.to_owned()]
        }
        _ => vec![word],
    }
}

/// Units of what is measured in chambers, as a word of a name.
fn chamber_unit_word(word: &str) -> Option<&'static str> {
    match word {
        "ppm" => Some("ppm"),
        "ppb" => Some("ppb"),
        "pa" => Some("Pa"),
        "hpa" => Some("hPa"),
        "kpa" => Some("kPa"),
        "mbar" => Some("mbar"),
        "bar" => Some("bar"),
        _ => None,
    }
}

fn unit_word(word: &str) -> Option<&'static str> {
    match word {
        "percent" | "pct" => Some("%"),
        "degc" | "c" | "celsius" | "airtc" => Some("°C"),
        "degf" | "f" => Some("°F"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, unit: &str) -> Option<(&'static str, String, Option<String>)> {
        climate_column(name, unit).map(|column| (column.quantity.column(), column.part, column.serial))
    }

    #[test]
    fn names_of_real_loggers() {
        let (rh, t) = ("relative_humidity_percent", "temperature_c");
        for (name, unit, quantity, part, serial) in [
            ("Temperature (ºC)", "", t, "", None),
            ("Relative Humidity (%)", "", rh, "", None),
            ("Celsius(°C)", "", t, "", None),
            ("Humidity(%rh)", "", rh, "", None),
            ("AM2320_Ta", "", t, "AM2320", None),
            ("AM2320RH", "", rh, "AM2320", None),
            ("1_DHT22_Ta", "", t, "1_DHT22", None),
            ("1_DHT22_RH", "", rh, "1_DHT22", None),
            ("MET_CS215_AirTemperature_degC_Avg", "degC", t, "MET_CS215", None),
            ("MET_CS215_RelHumidity_percent_Avg", "%", rh, "MET_CS215", None),
            ("AirTC_Avg", "Deg C", t, "", None),
            ("1_HTU21D_RH", "", rh, "1_HTU21D", None),
            ("RH", "%", rh, "", None),
            ("RH2", "", rh, "2", None),
            ("H08 Temp., °F (LGR S/N: 274341)", "°F", t, "H08", Some("274341")),
            ("GCap. RH, % (LGR S/N: 274341)", "%", rh, "GCap", Some("274341")),
            (
                "Temp, °C (LGR S/N: 2, SEN S/N: 3, LBL: 25)",
                "°C",
                t,
                "25",
                Some("3"),
            ),
            ("Outside Ave. (C)", "C", t, "Outside", None),
            ("Inside_Nafion_TCK02 Last (C)", "", t, "Inside_Nafion_TCK02", None),
            ("Luftfeuchte [%]", "", rh, "", None),
            ("relative_humidity_percent", "", rh, "", None),
            ("temperature_c", "", t, "", None),
            ("Temp, (*F)", "", t, "", None),
        ] {
            assert_eq!(
                read(name, unit),
                Some((quantity, part.to_owned(), serial.map(str::to_owned))),
                "{name}"
            );
        }
    }

    #[test]
    fn gauges_and_analysers_of_chambers() {
        let (o2, h2o, p) = ("oxygen_ppm", "water_ppm", "pressure_pa");
        for (name, unit, quantity, part) in [
            ("O2 (ppm)", "", o2, ""),
            ("Oxygen [ppm]", "", o2, ""),
            ("H2O, ppm", "ppm", h2o, ""),
            ("water_ppm", "", h2o, ""),
            ("Pressure (mbar)", "", p, ""),
            ("Pressure [Pa]", "", p, ""),
            ("pressure_pa", "", p, ""),
            ("Box 2 O2 (ppm)", "", o2, "Box_2"),
        ] {
            let expected = Some((quantity, part.to_owned(), None));
            assert_eq!(read(name, unit), expected, "{name}");
        }
        let bar = climate_column("Pressure (mbar)", "").unwrap();
        assert!((bar.conversion.apply(0.5) - 50.0).abs() < 1e-9 && bar.unit_is_stated);
        for name in ["O2", "Pressure", "O2 (%)", "CO2 (ppm)"] {
            assert_eq!(read(name, ""), None, "{name}");
        }
    }

    #[test]
    fn other_columns_are_no_climate() {
        for (name, unit) in [
            ("Dew Point (ºC)", ""),
            ("DewPt, °F (LGR S/N: 1)", "°F"),
            ("PTemp_C", "Deg C"),
            ("BattV", "Volts"),
            ("Batt, %", ""),
            ("Outside Min. (C)", "C"),
            ("1_BME680_P", ""),
            ("1_BME680_q", ""),
            ("1_MCP9808", ""),
            ("MET_CS107_SoilT05cm_degC_Avg", "degC"),
            ("Intensity, Lux()", "Lux"),
            ("RECORD", "RN"),
            ("Coupler Attached", ""),
            ("MET_CS215_MixingRatio_gKg_Avg", "g/kg"),
            ("time_s", "s"),
            ("current_a", "A"),
            ("T (s)", "s"),
            ("T", ""),
        ] {
            assert_eq!(read(name, unit), None, "{name}");
        }
    }

    #[test]
    fn units_are_converted_or_said_to_be_assumed() {
        let column = climate_column("Temp, °F (LGR S/N: 1)", "°F").unwrap();
        assert!((column.conversion.apply(212.0) - 100.0).abs() < 1e-12 && column.unit_is_stated);
        assert!(!climate_column("1_DHT22_RH", "").unwrap().unit_is_stated);
        assert!(climate_column("Outside Ave. (C)", "C").unwrap().is_mean);
    }
}
