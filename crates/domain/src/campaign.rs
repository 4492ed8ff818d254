//! What campaign.toml says: the campaign, its samples, materials and environments.

use std::collections::BTreeMap;

use crate::string_enum;

use serde::{Deserialize, Serialize};

use super::climate::{ClimateRules, SensorStatement};
use super::monitoring::MonitoringRules;
use super::pairs::PairRules;
use super::{AskedFit, DateOrder, RunKind, Samples};

/// A sample: one strip of one material.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Sample {
    /// Id that tags name.
    pub id: String,
    /// Material id; one column group in the tables.
    pub material: String,
    /// Free length, mm.
    pub length_mm: Option<f64>,
    /// Width, mm.
    pub width_mm: Option<f64>,
    /// Thickness, mm.
    pub thickness_mm: Option<f64>,
    /// Active area, cm2, where it is not length times width.
    pub area_cm2: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square, as measured by a probe.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Production batch.
    pub batch: Option<String>,
}

impl Sample {
    /// Active area, cm2: given, or length times width.
    pub fn active_area_cm2(&self) -> Option<f64> {
        self.area_cm2
            .or_else(|| Some(self.length_mm? * self.width_mm? / 100.0))
    }
}

/// What the tables say of a material.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Material {
    /// Id that samples name.
    pub id: String,
    /// Electrode material.
    pub electrode: Option<String>,
    /// Membrane.
    pub membrane: Option<String>,
    /// Electrolyte.
    pub electrolyte: Option<String>,
    /// Current collector.
    pub current_collector: Option<String>,
    /// Reinforcement.
    pub reinforcement: Option<String>,
    /// Electrode thickness, micrometres.
    pub electrode_thickness_um: Option<f64>,
    /// Membrane thickness, micrometres.
    pub membrane_thickness_um: Option<f64>,
}

/// Surroundings of a run with defaults for what nothing measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Environment {
    /// Id that tags name: `vacuum`, `inert`, `air`, or one of the user's own.
    pub id: String,
    /// Default relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Default temperature, degrees Celsius.
    pub temperature_c: Option<f64>,
    /// Default pressure, Pa.
    pub pressure_pa: Option<f64>,
}

/// Ids of the environments that need no entry in campaign.toml, in the thesis's order.
pub const BUILT_IN_ENVIRONMENTS: [&str; 3] = ["vacuum", "inert", "air"];

/// A model that runs of a group are fitted with instead of the campaign's.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Adopted {
    /// Name of the group, `sample=CNaf-01,environment=air`.
    pub group: String,
    /// Model with the effects that extend it, `lumped-2 + faradaic-leak`.
    pub model: String,
}

/// A campaign as its campaign.toml states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// Short id.
    pub id: String,
    /// Title for the report.
    pub title: String,
    /// IANA time zone of file times without an offset, `Europe/Tallinn`.
    pub timezone: Option<String>,
    /// Order of day, month and year in dates that leave it open.
    #[serde(default)]
    pub date_order: Option<DateOrder>,
    /// Answers to questions that files leave open, by their keys.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub answers: BTreeMap<String, String>,
    /// A statement printed on every page, such as "simulated, not measured".
    pub notice: Option<String>,
    /// Samples in the file's order.
    pub samples: Samples,
    /// Materials in the file's order.
    pub materials: Vec<Material>,
    /// Environments: the built-in ones, then the file's own.
    pub environments: Vec<Environment>,
    /// Folder with the runs, relative to the campaign.
    pub runs_folder: String,
    /// Pattern that reads tags from file names.
    pub name_pattern: Option<String>,
    /// How files of one run find each other.
    #[serde(default)]
    pub pairs: PairRules,
    /// Folder with the modulus logs, relative to the campaign; it need not be there.
    pub dma_folder: String,
    /// Pattern that reads tags from the file names of modulus logs.
    pub dma_name_pattern: Option<String>,
    /// Folder with impedance spectra, relative to the campaign; it need not be there, and spectra may lie among the runs.
    #[serde(default = "impedance_folder")]
    pub impedance_folder: String,
    /// Pattern that reads tags from the file names of spectra; where there is none, that of the runs.
    #[serde(default)]
    pub impedance_name_pattern: Option<String>,
    /// Circuits as texts that spectra are fitted with beside those that every one is fitted with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub impedance_circuits: Vec<String>,
    /// Model that runs are fitted with.
    pub model: String,
    /// What the file states of how to fit; the rest is left to the program.
    #[serde(default)]
    pub fit: AskedFit,
    /// Tag keys that runs are grouped by for a diagnosis; empty: sample, environment and humidity.
    #[serde(default)]
    pub group_by: Vec<String>,
    /// Misfit of the simulation, percent of ranges, up to which it is right; none takes the default.
    #[serde(default)]
    pub tolerance_percent: Option<f64>,
    /// Models adopted for groups of runs, in the file's order; the last of a group holds.
    #[serde(default)]
    pub adopted: Vec<Adopted>,
    /// Climate sensors in the file's order; the first that speaks for a run counts.
    pub sensors: Vec<SensorStatement>,
    /// Rules for the climate of runs.
    pub climate: ClimateRules,
    /// Rules for long-term monitoring.
    #[serde(default)]
    pub monitoring: MonitoringRules,
    /// Rules for comparisons.
    #[serde(default)]
    pub compare: CompareRules,
    /// What the study asks.
    #[serde(default)]
    pub study: StudyRules,
    /// Folder with templates of the report that take the place of the program's own, relative to the campaign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub templates_folder: Option<String>,
    /// Keys of free tags that campaign.toml declares; others are kept and nothing is asked of them.
    #[serde(default)]
    pub extra_tags: Vec<String>,
}

string_enum! {
    /// What materials may be compared by, as their entries state it.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum MaterialClass {
        /// Electrode material.
        Electrode = "electrode",
        /// Membrane.
        Membrane = "membrane",
        /// Electrolyte.
        Electrolyte = "electrolyte",
    }
}

impl MaterialClass {
    /// What a material states of it.
    pub fn of(self, material: &Material) -> Option<&str> {
        match self {
            MaterialClass::Electrode => material.electrode.as_deref(),
            MaterialClass::Membrane => material.membrane.as_deref(),
            MaterialClass::Electrolyte => material.electrolyte.as_deref(),
        }
    }
}

string_enum! {
    /// What a study varies on purpose.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Factor {
        /// What surrounds the strip.
        Environment = "environment",
        /// Relative humidity.
        Humidity = "humidity",
        /// Step voltage.
        Voltage = "voltage",
        /// Material.
        Material = "material",
    }
}

/// What the study asks, `[study]` of campaign.toml.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyRules {
    /// What is compared; empty: whatever the campaign varies.
    pub compare: Vec<Factor>,
    /// Whether materials are put together, as samples of one.
    pub materials_together: bool,
    /// Whether conditions are compared over all their voltages and not at equal ones.
    pub voltages_together: bool,
    /// Scatter from run to run, percent, where the campaign has one run a condition and so cannot tell it.
    pub scatter_percent: Option<f64>,
    /// An effect that is no larger than this is none, percent; none: the program's own.
    pub alike_percent: Option<f64>,
}

/// Rules of campaign.toml, `[compare]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareRules {
    /// What stands for the material in comparisons; none: the material itself.
    #[serde(default)]
    pub by: Option<MaterialClass>,
}

/// The folder of spectra where campaign.toml names none.
pub fn impedance_folder() -> String {
    "impedance".to_owned()
}

impl Campaign {
    /// The sample of that id.
    pub fn sample(&self, id: &str) -> Option<&Sample> {
        self.samples.find(id)
    }

    /// Name of a run as lists show it: its path without the folder that all runs share.
    pub fn run_name<'p>(&self, path: &'p str) -> &'p str {
        let below = path.strip_prefix(self.runs_folder.trim_end_matches('/'));
        below.and_then(|rest| rest.strip_prefix('/')).unwrap_or(path)
    }

    /// What the files of the folder of `path` (relative, with `/`) measure; a spectrum is told by its columns.
    pub fn kind_of(&self, path: &str) -> RunKind {
        let rest = path.strip_prefix(self.dma_folder.as_str());
        if rest.is_some_and(|rest| rest.starts_with('/')) {
            RunKind::Dma
        } else {
            RunKind::Actuation
        }
    }

    /// Folders beside the runs folder that are looked through where they are there.
    pub fn optional_folders(&self) -> [&str; 2] {
        [self.dma_folder.as_str(), self.impedance_folder.as_str()]
    }

    /// The pattern for the file names of that kind.
    pub fn name_pattern_of(&self, kind: RunKind) -> Option<&str> {
        match kind {
            RunKind::Actuation => self.name_pattern.as_deref(),
            RunKind::Dma => self.dma_name_pattern.as_deref(),
            RunKind::Impedance => {
                let own = self.impedance_name_pattern.as_deref();
                own.or(self.name_pattern.as_deref())
            }
        }
    }

    /// What stands for a material in comparisons: its class, where `[compare] by` names one and the material states it.
    pub fn compared_as<'a>(&'a self, material: &'a str) -> &'a str {
        let stated = self.materials.iter().find(|stated| stated.id == material);
        let class = self
            .compare
            .by
            .zip(stated)
            .and_then(|(class, stated)| class.of(stated));
        class.unwrap_or(material)
    }

    /// The environment of that id.
    pub fn environment(&self, id: &str) -> Option<&Environment> {
        self.environments.iter().find(|environment| environment.id == id)
    }
}
