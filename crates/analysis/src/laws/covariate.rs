//! What a parameter may follow from run to run: covariates with their keys, units and effects.

use crate::word::{Word, word};

/// Something that differs between runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Covariate {
    /// Relative humidity, percent.
    RelativeHumidity,
    /// Temperature, °C.
    Temperature,
    /// Whether the humidity rose or fell to the run.
    Direction,
    /// Cycle number as tagged.
    Cycle,
    /// Hours since the start of the sample's first run.
    Age,
    /// Hours of exposure before the run, from a tag.
    Exposure,
    /// Place of the run among the sample's runs.
    RunOrder,
    /// Whether it is the sample's first run.
    FirstRun,
    /// Shorted time before the run, s.
    RestBefore,
    /// Instrument as tagged.
    Instrument,
    /// Calibration as tagged.
    Calibration,
    /// Who measured.
    Operator,
    /// Batch of the sample.
    Batch,
    /// Environment: a factor of the design.
    Environment,
    /// Step voltage, V: a factor of the design.
    Voltage,
    /// A tag that campaign.toml declares, with numbers.
    TagNumber(DeclaredTag),
    /// A tag that campaign.toml declares, with names.
    TagName(DeclaredTag),
}

/// The key of a tag that campaign.toml declares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
pub struct DeclaredTag(Word);

impl DeclaredTag {
    /// The tag of that key. Keys are kept for as long as the program runs: they are few, and covariates are copied
    /// everywhere.
    pub fn of(key: &str) -> DeclaredTag {
        DeclaredTag(word(key))
    }
}

impl<'de> serde::Deserialize<'de> for DeclaredTag {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<DeclaredTag, D::Error> {
        String::deserialize(from).map(|key| DeclaredTag::of(&key))
    }
}

/// How values of a covariate compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// By size.
    Number,
    /// As the same or not.
    Category,
}

impl Covariate {
    /// Every covariate but declared tags, which come after them.
    pub const ALL: [Covariate; 15] = [
        Covariate::RelativeHumidity,
        Covariate::Temperature,
        Covariate::Direction,
        Covariate::Cycle,
        Covariate::Age,
        Covariate::Exposure,
        Covariate::RunOrder,
        Covariate::FirstRun,
        Covariate::RestBefore,
        Covariate::Instrument,
        Covariate::Calibration,
        Covariate::Operator,
        Covariate::Batch,
        Covariate::Environment,
        Covariate::Voltage,
    ];

    /// Those that grow as a sample is used.
    pub const OF_AGE: [Covariate; 4] = [
        Covariate::Cycle,
        Covariate::Age,
        Covariate::Exposure,
        Covariate::RunOrder,
    ];

    /// Stored name; that of the tag where there is one.
    pub fn key(self) -> &'static str {
        match self {
            Covariate::RelativeHumidity => "relative_humidity_percent",
            Covariate::Temperature => "temperature_c",
            Covariate::Direction => "humidity_direction",
            Covariate::Cycle => "cycle",
            Covariate::Age => "age_h",
            Covariate::Exposure => "exposure_h",
            Covariate::RunOrder => "run_order",
            Covariate::FirstRun => "first_run",
            Covariate::RestBefore => "rest_before_s",
            Covariate::Instrument => "instrument",
            Covariate::Calibration => "calibration",
            Covariate::Operator => "operator",
            Covariate::Batch => "batch",
            Covariate::Environment => "environment",
            Covariate::Voltage => "voltage_v",
            Covariate::TagNumber(tag) | Covariate::TagName(tag) => tag.0,
        }
    }

    /// Name in sentences.
    pub fn label(self) -> &'static str {
        match self {
            Covariate::RelativeHumidity => "relative humidity",
            Covariate::Temperature => "temperature",
            Covariate::Direction => "wetting or drying",
            Covariate::Cycle => "cycle",
            Covariate::Age => "age",
            Covariate::Exposure => "exposure",
            Covariate::RunOrder => "order of the runs",
            Covariate::FirstRun => "first run",
            Covariate::RestBefore => "rest before the run",
            Covariate::Instrument => "instrument",
            Covariate::Calibration => "calibration",
            Covariate::Operator => "operator",
            Covariate::Batch => "batch",
            Covariate::Environment => "environment",
            Covariate::Voltage => "voltage",
            Covariate::TagNumber(tag) | Covariate::TagName(tag) => tag.0,
        }
    }

    /// Unit as printed; empty for a pure number or a name.
    pub fn unit(self) -> &'static str {
        match self {
            Covariate::RelativeHumidity => "% RH",
            Covariate::Temperature => "°C",
            Covariate::Age | Covariate::Exposure => "h",
            Covariate::RestBefore => "s",
            Covariate::Voltage => "V",
            _ => "",
        }
    }

    /// Whether it is set or logged for a run, so that a study asks what it does; else it tells how a strip was used, or by whom.
    pub fn is_condition(self) -> bool {
        matches!(
            self,
            Covariate::Temperature | Covariate::Exposure | Covariate::TagNumber(_) | Covariate::TagName(_)
        )
    }

    /// How its values compare.
    pub fn kind(self) -> Kind {
        match self {
            Covariate::Instrument
            | Covariate::Calibration
            | Covariate::Operator
            | Covariate::Batch
            | Covariate::Environment
            | Covariate::Voltage
            | Covariate::TagName(_) => Kind::Category,
            _ => Kind::Number,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_distinct() {
        let mut keys: Vec<&str> = Covariate::ALL.iter().map(|covariate| covariate.key()).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), Covariate::ALL.len());
    }

    #[test]
    fn a_declared_tag_is_the_same_wherever_it_is_named() {
        let one = Covariate::TagName(DeclaredTag::of("specimen"));
        assert_eq!(
            one,
            Covariate::TagName(DeclaredTag::of(&String::from("specimen")))
        );
        assert!(one > Covariate::Voltage && one.key() == "specimen");
    }
}
