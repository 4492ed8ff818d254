//! campaign.toml as serde sees it, before anything is checked.

use serde::Deserialize;
use toml::Spanned;

/// The whole file.
#[derive(Deserialize)]
pub(super) struct File {
    pub campaign: Option<Head>,
    #[serde(default)]
    pub sample: Vec<Spanned<Sample>>,
    #[serde(default)]
    pub material: Vec<Spanned<Material>>,
    #[serde(default)]
    pub environment: Vec<Spanned<Environment>>,
    #[serde(default)]
    pub runs: Folder,
    #[serde(default)]
    pub dma: Folder,
    #[serde(default)]
    pub sensor: Vec<Spanned<Sensor>>,
    #[serde(default)]
    pub climate: Climate,
    #[serde(default)]
    pub adopted: Vec<Spanned<Adopted>>,
}

/// `[[adopted]]`.
#[derive(Deserialize)]
pub(super) struct Adopted {
    pub group: Option<String>,
    pub model: Option<String>,
}

/// `[campaign]`.
#[derive(Deserialize)]
pub(super) struct Head {
    pub id: Option<String>,
    pub title: Option<String>,
    pub timezone: Option<String>,
    pub notice: Option<String>,
    pub model: Option<String>,
    #[serde(default)]
    pub group_by: Vec<String>,
}

/// `[[sample]]`.
#[derive(Deserialize)]
pub(super) struct Sample {
    pub id: Option<String>,
    pub material: Option<String>,
    pub length_mm: Option<f64>,
    pub width_mm: Option<f64>,
    pub thickness_mm: Option<f64>,
    pub area_cm2: Option<f64>,
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    pub batch: Option<String>,
}

/// `[[material]]`.
#[derive(Deserialize)]
pub(super) struct Material {
    pub id: Option<String>,
    pub electrode: Option<String>,
    pub membrane: Option<String>,
    pub electrolyte: Option<String>,
    pub current_collector: Option<String>,
    pub reinforcement: Option<String>,
    pub electrode_thickness_um: Option<f64>,
    pub membrane_thickness_um: Option<f64>,
}

/// `[[environment]]`.
#[derive(Deserialize)]
pub(super) struct Environment {
    pub id: Option<String>,
    pub relative_humidity_percent: Option<f64>,
    pub temperature_c: Option<f64>,
    pub pressure_pa: Option<f64>,
}

/// `[runs]`, `[dma]`.
#[derive(Deserialize, Default)]
pub(super) struct Folder {
    pub folder: Option<String>,
    pub name_pattern: Option<String>,
}

/// `[[sensor]]`.
#[derive(Deserialize)]
pub(super) struct Sensor {
    pub id: Option<String>,
    pub files: Option<String>,
    pub place: Option<String>,
    #[serde(default)]
    pub environments: Vec<String>,
    #[serde(default)]
    pub samples: Vec<String>,
    pub relative_humidity_accuracy_percent: Option<f64>,
    pub temperature_accuracy_c: Option<f64>,
    pub relative_humidity_correction_percent: Option<f64>,
    pub temperature_correction_c: Option<f64>,
    pub utc_offset: Option<String>,
    pub calibration: Option<String>,
}

/// `[climate]`.
#[derive(Deserialize, Default)]
pub(super) struct Climate {
    pub relative_humidity_tolerance_percent: Option<f64>,
    pub temperature_tolerance_c: Option<f64>,
    pub longest_gap_s: Option<f64>,
    pub exposure_above_percent: Option<f64>,
}
