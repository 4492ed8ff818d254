//! The climate beside the samples: sensors, their series, what a run had of it, and what to know of the sensors.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Issue, Quantity, TagSource};

/// A measured mean agrees with a stated humidity within this, percent points: the accuracy that makers of capacitive sensors state.
const HUMIDITY_AGREES_PERCENT: f64 = 3.0;
/// The same of a temperature, °C: of thermistor loggers.
const TEMPERATURE_AGREES_C: f64 = 1.0;

string_enum! {
    /// What a log holds: the air, and what a four-point probe says of a sample's electrodes.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum ClimateQuantity {
        /// Relative humidity over water, percent.
        RelativeHumidity = "relative_humidity_percent" => "Relative humidity",
        /// Temperature, °C.
        Temperature = "temperature_c" => "Temperature",
        /// Pressure of the air, or in a chamber, Pa.
        Pressure = "pressure_pa" => "Pressure",
        /// Oxygen in the gas of a chamber, ppm by volume.
        Oxygen = "oxygen_ppm" => "Oxygen",
        /// Water in the gas of a chamber, ppm by volume.
        Water = "water_ppm" => "Water",
        /// Dew point over water, °C.
        DewPoint = "dew_point_c" => "Dew point",
        /// Partial pressure of water vapour, Pa.
        VapourPressure = "vapour_pressure_pa" => "Vapour pressure",
        /// Mass of water vapour in a volume of air, g/m³.
        AbsoluteHumidity = "absolute_humidity_g_per_m3" => "Absolute humidity",
        /// Resistance of both electrodes along the strip, Ohm per square, by a probe.
        ElectrodeResistance = "electrode_resistance_ohm_per_sq" => "Electrode resistance",
        /// Its standard error, Ohm per square.
        ElectrodeResistanceError = "electrode_resistance_error_ohm_per_sq" => "Standard error of the electrode resistance",
        /// Flexings of the strip so far.
        Flexings = "flexings" => "Flexings",
        /// Relative humidity when the probe was read, percent.
        ProbeHumidity = "probe_humidity_percent" => "Relative humidity at the probe",
    }
}

impl ClimateQuantity {
    /// What sensors of the climate and of chambers measure, in the order in which pages show it.
    pub const MEASURED: [ClimateQuantity; 5] = [
        ClimateQuantity::RelativeHumidity,
        ClimateQuantity::Temperature,
        ClimateQuantity::Pressure,
        ClimateQuantity::Oxygen,
        ClimateQuantity::Water,
    ];

    /// Whether it is the humidity or the temperature: what is known of such sensors holds of no other.
    pub fn is_of_air(self) -> bool {
        matches!(
            self,
            ClimateQuantity::RelativeHumidity | ClimateQuantity::Temperature
        )
    }

    /// Whether a probe measured it: it says nothing of the climate.
    pub fn is_of_probe(self) -> bool {
        matches!(
            self,
            ClimateQuantity::ElectrodeResistance
                | ClimateQuantity::ElectrodeResistanceError
                | ClimateQuantity::Flexings
                | ClimateQuantity::ProbeHumidity
        )
    }

    /// Whether a mean of readings may mean what is stated.
    pub fn agree(self, stated: f64, mean: f64) -> bool {
        let allowed = match self {
            ClimateQuantity::RelativeHumidity => HUMIDITY_AGREES_PERCENT,
            ClimateQuantity::Temperature => TEMPERATURE_AGREES_C,
            _ => 0.0,
        };
        // The last digits of a binary fraction say nothing: 2.51 - 2.5 is 0.00999...
        (stated - mean).abs() <= allowed + 1e-12 * stated.abs().max(mean.abs())
    }

    /// Unit as printed.
    pub fn unit(self) -> &'static str {
        match self {
            ClimateQuantity::RelativeHumidity | ClimateQuantity::ProbeHumidity => "%",
            ClimateQuantity::Temperature | ClimateQuantity::DewPoint => "°C",
            ClimateQuantity::VapourPressure | ClimateQuantity::Pressure => "Pa",
            ClimateQuantity::Oxygen | ClimateQuantity::Water => "ppm",
            ClimateQuantity::AbsoluteHumidity => "g/m³",
            ClimateQuantity::ElectrodeResistance | ClimateQuantity::ElectrodeResistanceError => "Ω/sq",
            ClimateQuantity::Flexings => "",
        }
    }

    /// The measured quantity that a channel of `quantity` holds.
    pub fn measured(quantity: Quantity) -> Option<ClimateQuantity> {
        match quantity {
            Quantity::RelativeHumidity => Some(ClimateQuantity::RelativeHumidity),
            Quantity::Temperature => Some(ClimateQuantity::Temperature),
            Quantity::Pressure => Some(ClimateQuantity::Pressure),
            Quantity::Oxygen => Some(ClimateQuantity::Oxygen),
            Quantity::Water => Some(ClimateQuantity::Water),
            _ => None,
        }
    }
}

/// What campaign.toml says of a sensor, `[[sensor]]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SensorStatement {
    /// The sensor's id as its files give it, or one of the user's own together with `files`.
    pub id: String,
    /// Files that are this sensor's, as the beginning of their path below `ambient/`.
    pub files: Option<String>,
    /// Where it stands; sensors of one place are compared.
    pub place: Option<String>,
    /// Environments that it speaks for; none stated: all but vacuum and inert gas.
    pub environments: Vec<String>,
    /// Samples that it speaks for; none stated: all.
    pub samples: Vec<String>,
    /// Accuracy of the relative humidity, percent points.
    pub relative_humidity_accuracy_percent: Option<f64>,
    /// Accuracy of the temperature, K.
    pub temperature_accuracy_c: Option<f64>,
    /// Added to every reading of relative humidity, percent points, from its calibration.
    pub relative_humidity_correction_percent: Option<f64>,
    /// Added to every reading of temperature, K, from its calibration.
    pub temperature_correction_c: Option<f64>,
    /// Offset of its clock from UTC, `+02:00`, where its files state none or a wrong one.
    pub utc_offset: Option<String>,
    /// When and against what it was calibrated.
    pub calibration: Option<String>,
}

/// Rules of campaign.toml, `[climate]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClimateRules {
    /// Largest deviation from the run's mean of relative humidity, percent points.
    pub relative_humidity_tolerance_percent: f64,
    /// Largest deviation from the run's mean of temperature, K.
    pub temperature_tolerance_c: f64,
    /// Longest time between two readings that a run may contain, s.
    pub longest_gap_s: f64,
    /// Relative humidity above which hours count as exposure, percent.
    pub exposure_above_percent: f64,
    /// Largest deviation from the run's mean of the pressure, percent of it.
    pub pressure_tolerance_percent: f64,
    /// Oxygen that no reading within a run may be above, ppm; none stated: not looked at.
    pub oxygen_limit_ppm: Option<f64>,
    /// Water that no reading within a run may be above, ppm; none stated: not looked at.
    pub water_limit_ppm: Option<f64>,
}

impl Default for ClimateRules {
    /// Tolerances are what makers state for capacitive humidity sensors and thermistors: a smaller change cannot
    /// be told from the sensor. The gap: within an hour the air of a room drifts by less than that (docs/climate.md).
    /// 60 % is the upper end of what is recommended for rooms, so that an ordinary room is no exposure. The thesis's vacuum
    /// stood at 50 to 60 Pa: a tenth about its mean.
    fn default() -> ClimateRules {
        ClimateRules {
            relative_humidity_tolerance_percent: 3.0,
            temperature_tolerance_c: 1.0,
            longest_gap_s: 3600.0,
            exposure_above_percent: 60.0,
            pressure_tolerance_percent: 10.0,
            oxygen_limit_ppm: None,
            water_limit_ppm: None,
        }
    }
}

/// A series of one sensor in one file, without its readings.
#[derive(Debug, Clone, PartialEq)]
pub struct LogSeries {
    /// Row id of its log.
    pub log_id: i64,
    /// Number of the series in its log.
    pub ordinal: u32,
    /// Path of the log's file.
    pub path: String,
    /// BLAKE3 of the log's readings and clock.
    pub data_hash: String,
    /// The sensor as the file names it.
    pub sensor: String,
    /// What is measured.
    pub quantity: ClimateQuantity,
    /// Why its readings are not used; none where they are.
    pub not_used: Option<String>,
    /// Number of readings.
    pub readings: usize,
    /// Time between most readings, s.
    pub interval_s: f64,
    /// The clock's date and time at the log's first row, s since 1970-01-01T00:00 on that clock.
    pub clock_start_s: f64,
    /// Time from there to this series' first reading, s.
    pub first_s: f64,
    /// Time from the first to the last reading, s.
    pub length_s: f64,
    /// Offset from UTC that the file states, `+02:00`.
    pub clock_offset: Option<String>,
    /// Where the clock was set back: time since the log's first row and by how much, s.
    pub clock_set_back: Vec<(f64, f64)>,
}

/// Readings of a [`LogSeries`].
#[derive(Debug, Clone, PartialEq)]
pub struct LogReadings {
    /// Time since the clock's start of the log, s, increasing.
    pub elapsed_s: Vec<f64>,
    /// Readings in the quantity's unit, as the file has them.
    pub values: Vec<f64>,
}

/// What a run had of one quantity by one sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunClimate {
    /// The sensor, or [`RunClimate::own_column`].
    pub sensor: String,
    /// What is known.
    pub quantity: ClimateQuantity,
    /// Whether this sensor is the one that speaks for the run.
    pub chosen: bool,
    /// Readings within the run; 0: the mean is interpolated between the readings before and after it.
    pub readings: usize,
    /// Mean over the run.
    pub mean: f64,
    /// Standard deviation of the readings; none with fewer than two.
    pub standard_deviation: Option<f64>,
    /// Slope of the straight line through the readings, per hour; none with fewer than three.
    pub drift_per_h: Option<f64>,
    /// Largest distance of a reading from the mean.
    pub largest_deviation: f64,
    /// Longest time between two neighbouring readings that the run touches, s.
    pub largest_gap_s: f64,
    /// Stated accuracy of the sensor for this quantity; none: not stated.
    pub accuracy: Option<f64>,
}

impl RunClimate {
    /// What stands for the sensor where a run's own column of that name measured.
    pub fn own_column(name: &str) -> String {
        format!("{} {name}", TagSource::Column.label())
    }

    /// The column's name where a column of the run's own file measured it, and not a sensor with a log.
    pub fn own_name(&self) -> Option<&str> {
        own_name(&self.sensor)
    }
}

fn own_name(sensor: &str) -> Option<&str> {
    sensor.strip_prefix(TagSource::Column.label())?.strip_prefix(' ')
}

/// The sensor in words: `sensor 10173910`, `its own column RH (%)`.
pub fn sensor_words(sensor: &str) -> String {
    match own_name(sensor) {
        Some(_) => sensor.to_owned(),
        None => format!("sensor {sensor}"),
    }
}

/// Climate around a run, thinned for drawing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClimateCurve {
    /// The sensor.
    pub sensor: String,
    /// What is drawn.
    pub quantity: ClimateQuantity,
    /// Time since the run's start, s.
    pub time_s: Vec<f64>,
    /// Readings.
    pub values: Vec<f64>,
}

/// A sensor with what its files hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensorSummary {
    /// The sensor.
    pub sensor: String,
    /// Where it stands; empty: not stated.
    pub place: String,
    /// What it measures.
    pub quantity: ClimateQuantity,
    /// Files that hold its readings.
    pub files: usize,
    /// Readings, those that stand in two files counted once.
    pub readings: usize,
    /// First reading, RFC 3339 UTC.
    pub from: String,
    /// Last reading, RFC 3339 UTC.
    pub to: String,
    /// Time between most readings, s.
    pub interval_s: f64,
    /// Smallest reading.
    pub least: f64,
    /// Mean of the readings.
    pub mean: f64,
    /// Largest reading.
    pub most: f64,
    /// Time zone of its clock and where that is known from, in words.
    pub clock: String,
    /// Stated accuracy.
    pub accuracy: Option<f64>,
    /// Correction that is added to its readings.
    pub correction: Option<f64>,
    /// Calibration as stated.
    pub calibration: Option<String>,
    /// Why its readings are not used; none where they are.
    pub not_used: Option<String>,
    /// Thinned readings for drawing: s since 1970 UTC, and values.
    pub curve: (Vec<f64>, Vec<f64>),
}

/// Two sensors of one place that measured at the same time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensorPair {
    /// One sensor.
    pub first: String,
    /// The other.
    pub second: String,
    /// What both measure.
    pub quantity: ClimateQuantity,
    /// Hours in which both measured.
    pub hours: f64,
    /// Mean of first minus second.
    pub bias: f64,
    /// Standard deviation of first minus second.
    pub standard_deviation: f64,
    /// What the accuracies allow: root of the sum of their squares, or the campaign's tolerance.
    pub allowed: f64,
    /// Whether both accuracies are stated.
    pub accuracies_are_stated: bool,
    /// Hours that the second clock is ahead of the first, where the readings show it.
    pub clock_ahead_h: Option<f64>,
    /// Bias and standard deviation with the second clock put right.
    pub put_right: Option<(f64, f64)>,
}

/// Hours above a humidity that a sample has seen between its first and its last run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Exposure {
    /// The sample.
    pub sample: String,
    /// The humidity, percent.
    pub above_percent: f64,
    /// Start of its first run, RFC 3339 UTC.
    pub from: String,
    /// End of its last run, RFC 3339 UTC.
    pub to: String,
    /// Sensors that speak for it, in the order in which they count.
    pub sensors: Vec<String>,
    /// Hours above that humidity.
    pub above_h: f64,
    /// Hours that the logs cover.
    pub covered_h: f64,
    /// Hours that no log covers.
    pub uncovered_h: f64,
    /// Hours in runs in surroundings that no sensor speaks for, such as vacuum.
    pub elsewhere_h: f64,
    /// Why there is nothing; none where there is.
    pub reason: Option<String>,
}

/// What the logs of a campaign come to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClimateAssessment {
    /// Sensors with their quantities.
    pub sensors: Vec<SensorSummary>,
    /// Pairs of sensors in one place.
    pub pairs: Vec<SensorPair>,
    /// Exposure of each sample with runs.
    pub exposures: Vec<Exposure>,
    /// What to know of the sensors, files and clocks.
    pub issues: Vec<Issue>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_read_back() {
        for quantity in ClimateQuantity::ALL {
            assert_eq!(ClimateQuantity::from_key(quantity.key()), Some(quantity));
            let json = serde_json::to_string(&quantity).unwrap();
            assert_eq!(json, format!("\"{}\"", quantity.key()));
        }
    }
}
