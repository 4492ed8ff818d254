//! From what a reader made of a logger's file to its series: one for each sensor and quantity.

use jiff::civil::DateTime;

use super::formats::climate::meaning::{ClimateColumn, climate_column};
use super::formats::error::quoted;
use super::formats::no_reading;
use super::formats::plausible::is_impossible;
use super::formats::probe_table;
use super::{Reading, RunTable, probe_log};
use ieap_domain::{Channel, ClimateQuantity, Issue, LogReadings};
use ieap_numerics::robust::median_step;

/// A logger's file.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// Date of the first row as the file has it.
    pub started_raw: String,
    /// The same, s since 1970-01-01T00:00 on the file's own clock.
    pub clock_start_s: f64,
    /// Offset of that clock from UTC where the file states it.
    pub clock_offset: Option<String>,
    /// Where the clock was set back: time since the first row and by how much, s.
    pub clock_set_back: Vec<(f64, f64)>,
    /// Its series, in the order of the columns.
    pub series: Vec<Series>,
    /// What to know of them.
    pub issues: Vec<Issue>,
}

/// Readings of one quantity by one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The sensor: serial number or name, with the part of the logger behind `/`.
    pub sensor: String,
    /// What is measured.
    pub quantity: ClimateQuantity,
    /// Name of the column.
    pub raw_name: String,
    /// Unit of the column.
    pub raw_unit: String,
    /// Time between most readings, s; 0 with fewer than two.
    pub interval_s: f64,
    /// Readings, timed from the first row.
    pub readings: LogReadings,
    is_mean: bool,
}

/// The series of a reading; `path` names the sensor where the file does not.
///
/// # Errors
/// No date, or no column of temperature or humidity: the issue says what is needed.
pub fn log(reading: &Reading, path: &str) -> Result<Log, Issue> {
    let start = reading
        .started_at
        .as_ref()
        .and_then(|start| Some((start, start.moment()?.parse::<DateTime>().ok()?)));
    let timed: Vec<&RunTable> = reading
        .tables
        .iter()
        .filter(|table| table.time_column.is_some())
        .collect();
    let (Some((start, local)), [table, ..]) = (start, timed.as_slice()) else {
        let message = format!(
            "the file ({}) holds no dates, so its readings cannot be placed in time",
            reading.format
        );
        return Err(Issue::error("log-without-dates", message)
            .mend("export the log with a column of dates and times beside temperature, humidity, pressure, oxygen or water"));
    };
    let local_s = local
        .to_zoned(jiff::tz::TimeZone::UTC)
        .map(|utc| utc.timestamp().as_millisecond());
    let with_series = |series: Vec<Series>, issues: Vec<Issue>| Log {
        started_raw: start.raw.clone(),
        clock_start_s: local_s.unwrap_or(0) as f64 / 1000.0,
        clock_offset: start.offset.clone(),
        clock_set_back: table.clock_set_back.clone(),
        series,
        issues,
    };
    if reading.format == probe_table::ID {
        let (series, issues) = probe_log::series(reading);
        return Ok(with_series(series, issues));
    }
    let base = base_name(reading, path);
    let (mut series, mut issues): (Vec<Series>, Vec<Issue>) = (Vec::new(), Vec::new());
    for table in &timed {
        // A table of several is one sensor's.
        let name = if table.name.is_empty() {
            base.clone()
        } else {
            format!("{base}/{}", table.name)
        };
        for channel in table.channels.iter().filter(|channel| !channel.is_empty()) {
            if let Some((one, issue)) = series_of(channel, &name) {
                add(&mut series, one);
                issues.extend(issue);
            }
        }
    }
    if series.is_empty() {
        let columns: Vec<&str> = table
            .channels
            .iter()
            .map(|channel| channel.raw_name.as_str())
            .collect();
        let message = format!(
            "no column holds temperature, humidity, pressure, oxygen or water of the air or of a chamber, and it is no table of a four-point probe: found {}",
            columns.join(", ")
        );
        return Err(Issue::error("log-without-climate", message)
            .mend("name the columns with their units, as in Temperature (°C) and RH (%), or date, sample and resistance_ohm_per_sq"));
    }
    Ok(with_series(series, issues))
}

impl Log {
    /// BLAKE3 over readings, sensors and clock.
    pub fn data_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.clock_text().as_bytes());
        for series in &self.series {
            hasher.update(series.identity_text().as_bytes());
            for numbers in [&series.readings.elapsed_s, &series.readings.values] {
                hasher.update(&(numbers.len() as u64).to_le_bytes());
                for number in numbers {
                    hasher.update(&number.to_le_bytes());
                }
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// The clock as it enters the hash. The form is that of stored logs: another would make each of them a new revision.
    fn clock_text(&self) -> String {
        let offset = (self.clock_offset.as_ref())
            .map_or_else(|| "None".to_owned(), |offset| format!("Some({offset:?})"));
        let set_back: Vec<String> = (self.clock_set_back.iter())
            .map(|(time_s, by_s)| format!("({time_s:?}, {by_s:?})"))
            .collect();
        format!("({:?}, {offset}, [{}])", self.clock_start_s, set_back.join(", "))
    }
}

impl Series {
    /// A series that no column of its own stands for.
    pub(crate) fn plain(sensor: &str, quantity: ClimateQuantity, readings: LogReadings) -> Series {
        Series {
            sensor: sensor.to_owned(),
            quantity,
            raw_name: quantity.key().to_owned(),
            raw_unit: quantity.unit().to_owned(),
            interval_s: median_step(&readings.elapsed_s).unwrap_or(0.0),
            readings,
            is_mean: false,
        }
    }

    /// Sensor and quantity as they enter the hash, in the form of stored logs.
    fn identity_text(&self) -> String {
        let quantity = match self.quantity {
            ClimateQuantity::RelativeHumidity => "RelativeHumidity",
            ClimateQuantity::Temperature => "Temperature",
            ClimateQuantity::Pressure => "Pressure",
            ClimateQuantity::Oxygen => "Oxygen",
            ClimateQuantity::Water => "Water",
            ClimateQuantity::DewPoint => "DewPoint",
            ClimateQuantity::VapourPressure => "VapourPressure",
            ClimateQuantity::AbsoluteHumidity => "AbsoluteHumidity",
            ClimateQuantity::ElectrodeResistance => "ElectrodeResistance",
            ClimateQuantity::ElectrodeResistanceError => "ElectrodeResistanceError",
            ClimateQuantity::Flexings => "Flexings",
            ClimateQuantity::ProbeHumidity => "ProbeHumidity",
        };
        format!("({:?}, {quantity})", self.sensor)
    }
}

fn series_of(channel: &Channel, base: &str) -> Option<(Series, Option<Issue>)> {
    let column = climate_column(&channel.raw_name, &channel.raw_unit);
    let known = ClimateQuantity::measured(channel.quantity);
    let quantity = known.or_else(|| ClimateQuantity::measured(column.as_ref()?.quantity))?;
    // What the reader interpreted is converted already, and what is no measurement is out of it.
    let values: Vec<f64> = match (known, &column) {
        (None, Some(column)) => channel
            .values
            .iter()
            .map(|value| column.conversion.apply(*value))
            .collect(),
        _ => channel.values.to_vec(),
    };
    let of_air = column.as_ref().map_or(channel.quantity, |column| column.quantity);
    let codes = no_reading::codes(of_air, &channel.values);
    let is_measured =
        |(raw, value): (&f64, &f64)| !is_impossible(of_air, *raw, *value) && !codes.contains(&raw.to_bits());
    let kept: Vec<bool> = channel.values.iter().zip(&values).map(is_measured).collect();
    let only = |numbers: &[f64]| -> Vec<f64> {
        numbers
            .iter()
            .zip(&kept)
            .filter(|(_, kept)| **kept)
            .map(|(number, _)| *number)
            .collect()
    };
    let (elapsed_s, values) = (only(&channel.time_s), only(&values));
    let lost = kept.len() - values.len();
    let issue = (lost > 0).then(|| {
        let message = format!(
            "{lost} of {} readings of {} are no measurements; left out",
            kept.len(),
            quoted(&channel.raw_name)
        );
        Issue::warning("impossible-reading", message)
    });
    let series = Series {
        sensor: sensor_name(base, column.as_ref()),
        quantity,
        raw_name: channel.raw_name.clone(),
        raw_unit: channel.raw_unit.clone(),
        interval_s: median_step(&elapsed_s).unwrap_or(0.0),
        readings: LogReadings { elapsed_s, values },
        is_mean: column.is_some_and(|column| column.is_mean),
    };
    Some((series, issue))
}

/// A serial number names a sensor wherever it is read out; without one the logger's name does, with the part.
fn sensor_name(base: &str, column: Option<&ClimateColumn>) -> String {
    let Some(column) = column else {
        return base.to_owned();
    };
    match (&column.serial, column.part.as_str()) {
        (Some(serial), _) => serial.clone(),
        (None, "") => base.to_owned(),
        (None, part) => format!("{base}/{part}"),
    }
}

/// Adds a series; of a sensor's mean and last readings only the mean is kept, of two alike the second gets a number.
fn add(series: &mut Vec<Series>, mut one: Series) {
    let same = |a: &Series, b: &Series| a.sensor == b.sensor && a.quantity == b.quantity;
    match series.iter().position(|other| same(other, &one)) {
        Some(at) if one.is_mean && !series[at].is_mean => series[at] = one,
        Some(at) if series[at].is_mean => {}
        Some(_) => {
            let sensor = one.sensor.clone();
            let mut number = 2;
            while series.iter().any(|other| same(other, &one)) {
                one.sensor = format!("{sensor}/{number}");
                number += 1;
            }
            series.push(one);
        }
        None => series.push(one),
    }
}

/// Name of the logger: its serial number or station where the file states it, else the file's name up to a date.
fn base_name(reading: &Reading, path: &str) -> String {
    let stated = reading.original_metadata.iter().find_map(|(key, value)| {
        let key = key.to_lowercase();
        let is_serial = [
            "serial number",
            "serial no",
            "serial no.",
            "serial",
            "s/n",
            "seriennummer",
            "logger id",
        ];
        match key.as_str() {
            // `"TOA5","station","CR1000",...`
            "station" => value
                .split(',')
                .nth(1)
                .map(|name| name.trim_matches('"').to_owned()),
            key if is_serial.contains(&key) => value.split_whitespace().next().map(str::to_owned),
            _ => None,
        }
    });
    stated
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| name_of_file(path))
}

/// The file's name without its ending and without a date and what follows it: `Ta_RH_Test-2020-04-03` -> `Ta_RH_Test`.
fn name_of_file(path: &str) -> String {
    let file = path.rsplit('/').next().unwrap_or(path);
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    let marks = |c: char| matches!(c, '-' | '_' | ' ' | '.');
    let is_date = |at: usize| {
        let digits: Vec<char> = stem[at..].chars().filter(|c| !marks(*c)).take(8).collect();
        let year: String = digits.iter().take(4).collect();
        let starts = !stem[..at].ends_with(|c: char| c.is_ascii_digit());
        let year_is_whole = stem[at..].bytes().take(4).all(|b| b.is_ascii_digit());
        starts
            && year_is_whole
            && digits.len() == 8
            && digits.iter().all(char::is_ascii_digit)
            && ("1990".."2100").contains(&year.as_str())
    };
    let cut = stem.char_indices().map(|(at, _)| at).find(|&at| is_date(at));
    let name = cut.map_or(stem, |at| stem[..at].trim_end_matches(marks));
    if name.is_empty() {
        stem.to_owned()
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{ReadContext, read};

    fn of(name: &str, text: &str) -> Result<Vec<(String, &'static str, f64)>, String> {
        let reading = read(name, text.as_bytes(), &ReadContext::default()).unwrap();
        let found = log(&reading, &format!("ambient/{name}")).map_err(|issue| issue.code)?;
        Ok(found
            .series
            .iter()
            .map(|s| (s.sensor.clone(), s.quantity.key(), s.readings.values[0]))
            .collect())
    }

    #[test]
    fn every_sensor_of_a_table_is_a_series_in_canonical_units() {
        let text = "Time,A_Ta,A_RH,B Temp (F),B RH (%),B_P\n2026-04-03 18:05:14,18.3,37.6,212,32.5,985.9\n\
                    2026-04-03 18:06:14,18.3,37.6,212,32.5,985.9\n";
        let found = of("box-2026-04-03.csv", text).unwrap();
        let of = |sensor: &str, key: &'static str, value: f64| (format!("box/{sensor}"), key, value);
        assert_eq!(
            found[..2],
            [
                of("A", "temperature_c", 18.3),
                of("A", "relative_humidity_percent", 37.6)
            ]
        );
        assert!(
            (found[2].2 - 100.0).abs() < 1e-9 && found[2].0 == "box/B",
            "{found:?}"
        );
        assert_eq!(found.len(), 4);
    }

    /// Stored logs are known by this hash.
    #[test]
    fn the_hash_of_a_log_is_the_stored_one() {
        let text = "Time,A_Ta,A_RH\n2026-04-03 18:05:14,18.3,37.6\n2026-04-03 18:06:14,18.3,37.6\n";
        let reading = read("box.csv", text.as_bytes(), &ReadContext::default()).unwrap();
        let mut log = log(&reading, "ambient/box.csv").unwrap();
        (log.clock_offset, log.clock_set_back) = (Some("+02:00".to_owned()), vec![(60.0, 3600.0)]);
        log.series[0].sensor = "a \"b\" é".to_owned();
        let stored = "2cf731ae3b7900890fc3a152f3608a074b1f75da40c9ec77672f787736fcb606";
        assert_eq!(log.data_hash(), stored);
    }

    #[test]
    fn names_come_from_serial_numbers_or_files() {
        for (path, name) in [
            ("ambient/Ta_RH_Test-2020-04-03.csv", "Ta_RH_Test"),
            ("ambient/x/log_20200403_2.csv", "log"),
            ("ambient/20200403.csv", "20200403"),
            ("ambient/RH85_Desorption.csv", "RH85_Desorption"),
            ("ambient/DL_121TH_raw_RH05.csv", "DL_121TH_raw_RH05"),
        ] {
            assert_eq!(name_of_file(path), name);
        }
        let el3 = "el-3,Time,Celsius(°C),Humidity(%rh),Serial Number\n1,2026-06-13 16:12:18,24.5,50.5,010104085\n\
                   2,2026-06-13 16:32:18,22.5,71.5\n";
        assert_eq!(of("a.txt", el3).unwrap()[0].0, "010104085");
    }

    #[test]
    fn tables_without_dates_or_climate_are_refused_with_a_reason() {
        assert_eq!(
            of("a.csv", "time_s,current_a\n0,1\n1,2\n"),
            Err("log-without-dates".to_owned())
        );
        let toa5 =
            "\"TOA5\",\"s\"\n\"TIMESTAMP\",\"BattV\"\n\"TS\",\"V\"\n\"\",\"\"\n\"2026-01-01 00:00:00\",12\n";
        assert_eq!(of("a.dat", toa5), Err("log-without-climate".to_owned()));
    }
}
