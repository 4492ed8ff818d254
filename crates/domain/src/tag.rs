//! Tags of a run and where each came from.

use crate::string_enum;
use crate::unit_of_key::parted;

use serde::{Deserialize, Serialize};

/// Tag keys with a meaning of their own; any other key is a free tag, which campaign.toml declares (`[tags] extra`).
pub mod keys {
    /// Sample id of campaign.toml.
    pub const SAMPLE: &str = "sample";
    /// `vacuum`, `inert`, `air` or an environment of campaign.toml.
    pub const ENVIRONMENT: &str = "environment";
    /// Nominal step voltage, V.
    pub const VOLTAGE_V: &str = "voltage_v";
    /// Relative humidity, percent.
    pub const RELATIVE_HUMIDITY_PERCENT: &str = "relative_humidity_percent";
    /// Temperature, degrees Celsius.
    pub const TEMPERATURE_C: &str = "temperature_c";
    /// Pressure, Pa.
    pub const PRESSURE_PA: &str = "pressure_pa";
    /// Oxygen in the chamber, ppm.
    pub const OXYGEN_PPM: &str = "oxygen_ppm";
    /// Water in the chamber, ppm.
    pub const WATER_PPM: &str = "water_ppm";
    /// Start of the run, RFC 3339.
    pub const STARTED_AT: &str = "started_at";
    /// Shorted time before the run, s.
    pub const REST_BEFORE_S: &str = "rest_before_s";
    /// Cycle number, an integer.
    pub const CYCLE: &str = "cycle";
    /// The instrument.
    pub const INSTRUMENT: &str = "instrument";
    /// Who measured.
    pub const OPERATOR: &str = "operator";
    /// Free text.
    pub const NOTE: &str = "note";
    /// Stretches of open circuit, s: `600-1200, 1800-2400`; the value may be a list.
    pub const OPEN_CIRCUIT: &str = "open_circuit";
    /// Stretches of which no reading is used in fits, s; the value may be a list.
    pub const LEAVE_OUT: &str = "leave_out";
    /// Marks of the instrument while which the current is not used in fits: names of their columns or their texts.
    pub const LEAVE_OUT_MARKED: &str = "leave_out_marked";
    /// Keys that speak of the record and not of the run.
    pub const RECORD: [&str; 4] = [OPEN_CIRCUIT, LEAVE_OUT, LEAVE_OUT_MARKED, CLOCK_OFFSET_S];
    /// Seconds to add to the times of every clock of a run but the one of its voltage (or current).
    pub const CLOCK_OFFSET_S: &str = "clock_offset_s";
    /// Id of the planned run that this is, from a run sheet; a free tag.
    pub const PLANNED: &str = "planned";
    /// Hours of exposure before the run; a covariate of laws.
    pub const EXPOSURE_H: &str = "exposure_h";
    /// Calibration that the instrument had; a covariate of laws.
    pub const CALIBRATION: &str = "calibration";
    /// Resistance of both electrodes along the strip, Ohm per square: by a probe, or as stated.
    pub const ELECTRODE_RESISTANCE: &str = "electrode_resistance_ohm_per_sq";
    /// Its standard error, Ohm per square.
    pub const ELECTRODE_RESISTANCE_ERROR: &str = "electrode_resistance_error_ohm_per_sq";
    /// Flexings of the strip before the run.
    pub const FLEXINGS: &str = "flexings";
    /// Known keys that are neither among [`CONDITIONS`] nor [`RECORD`].
    pub const OTHERS: [&str; 9] = [
        OXYGEN_PPM,
        WATER_PPM,
        NOTE,
        PLANNED,
        EXPOSURE_H,
        CALIBRATION,
        ELECTRODE_RESISTANCE,
        ELECTRODE_RESISTANCE_ERROR,
        FLEXINGS,
    ];
    /// Keys of what a run is told by; beside them stand [`NOTE`], which may say anything, and those of [`RECORD`].
    pub const CONDITIONS: [&str; 11] = [
        SAMPLE,
        ENVIRONMENT,
        VOLTAGE_V,
        RELATIVE_HUMIDITY_PERCENT,
        TEMPERATURE_C,
        PRESSURE_PA,
        STARTED_AT,
        REST_BEFORE_S,
        CYCLE,
        INSTRUMENT,
        OPERATOR,
    ];
    /// Ending of keys that say what a column of an instrument measures: `storage_modulus_column = "E'/MPa"`.
    pub const COLUMN: &str = "_column";
    /// Keys whose value must be a number.
    pub const NUMERIC: [&str; 12] = [
        OXYGEN_PPM,
        WATER_PPM,
        VOLTAGE_V,
        RELATIVE_HUMIDITY_PERCENT,
        TEMPERATURE_C,
        PRESSURE_PA,
        REST_BEFORE_S,
        CYCLE,
        CLOCK_OFFSET_S,
        ELECTRODE_RESISTANCE,
        ELECTRODE_RESISTANCE_ERROR,
        FLEXINGS,
    ];
}

/// Code of the issue of a needed tag that no source gives; its place is the key.
pub const MISSING: &str = "tag-missing";

/// A key as it is said, and its unit: `relative humidity` and `%` of `relative_humidity_percent`. The unit is empty where it
/// has none, and for a laboratory's own keys, whose endings may mean anything.
pub fn spoken(key: &str) -> (String, &'static str) {
    let mut known = keys::CONDITIONS.iter().chain(&keys::OTHERS).chain(&keys::RECORD);
    let named = known.find(|known| **known == key).and_then(|key| parted(key));
    let (words, unit) = named.unwrap_or((key, ""));
    (words.replace('_', " "), unit)
}

/// A tag as it is said: `voltage 2 V`, `sample S1`.
pub fn said(key: &str, value: &str) -> String {
    match spoken(key) {
        (words, "") => format!("{words} {value}"),
        (words, unit) => format!("{words} {value}\u{a0}{unit}"),
    }
}

/// Code of what is said where two sources give a run different tags; its place is the key. A warning where none of them is there
/// to overrule the other.
pub const DISAGREEMENT: &str = "tag-disagreement";

/// Code of what is said of one measurement under two names that are tagged differently; its place is the key.
pub const NAMES_CONTRADICT: &str = "names-contradict";

/// Codes of the issues that say of a tag file or a run sheet that it, or a statement in it, cannot be read. A run that it
/// speaks for waits: tags of weaker sources in their place would be other tags.
pub const UNREADABLE: [&str; 4] = [
    "tag-file-unreadable",
    "tag-file-not-toml",
    "tag-not-flat",
    "run-sheet-damaged",
];

string_enum! {
    /// Where a tag came from, strongest first.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum TagSource {
        /// Set by hand with `ieap tag`.
        Hand = "hand" => "set by hand",
        /// A column of the file beside voltage and current, averaged over the run: what was measured is not what a label promised.
        Column = "column" => "its own column",
        /// Ambient logs, averaged over the run.
        Ambient = "ambient" => "ambient log",
        /// `<file name>.toml` beside the data file.
        Sidecar = "sidecar" => "sidecar",
        /// `tags.toml` in the file's folder or one above it.
        Folder = "folder" => "tags.toml",
        /// A row of a run sheet whose planned name is the file's.
        RunSheet = "run_sheet" => "run sheet",
        /// What `ieap init` read of the names of files and folders: the name as a witness in other words, so that no person's
        /// statement nor a climate that was measured gives way to it.
        Derived = "derived" => "read from its name by `ieap init`",
        /// `name_pattern` matched against the file name.
        FileName = "file_name" => "file name",
        /// The file's own header.
        Header = "header" => "file header",
        /// The voltage channel of the file.
        Channel = "channel" => "voltage channel",
        /// Readings of a four-point probe before and after the run.
        Probe = "probe" => "probe",
        /// Defaults of the environment in campaign.toml.
        EnvironmentDefault = "environment_default" => "environment default",
    }
}

impl TagSource {
    /// Whether a person or the head of the file stated it, so that it is no reading.
    pub fn is_stated(self) -> bool {
        self <= TagSource::Header && !self.is_measured_climate()
    }

    /// Whether it is a mean of what sensors measured while the run went on.
    pub fn is_measured_climate(self) -> bool {
        matches!(self, TagSource::Column | TagSource::Ambient)
    }
}

/// One tag as one source gives it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tag {
    /// Tag key.
    pub key: String,
    /// Value as text; numbers in the shortest form that reads back the same.
    pub value: String,
    /// Where it came from.
    pub source: TagSource,
    /// Which file or rule: `runs/tags.toml`, `VSTEP1`, `tester on 2026-11-20T10:00:00Z`.
    pub detail: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_said_with_their_units_and_those_of_a_laboratory_as_they_are() {
        assert_eq!(
            said("relative_humidity_percent", "33"),
            "relative humidity 33\u{a0}%"
        );
        assert_eq!(said("voltage_v", "-2"), "voltage -2\u{a0}V");
        assert_eq!(
            said("electrode_resistance_ohm_per_sq", "4"),
            "electrode resistance 4\u{a0}Ohm/sq"
        );
        assert_eq!(said("sample", "S1"), "sample S1");
        assert_eq!(said("vitamin_c", "2"), "vitamin c 2");
    }
}
