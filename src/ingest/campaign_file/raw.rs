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
