//! campaign.toml as serde sees it, before anything is checked.

use std::collections::BTreeMap;

use ieap_domain::{ClimateRules, Environment, Material, Sample, SensorStatement};
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
    pub runs: Runs,
    #[serde(default)]
    pub pair: Vec<Spanned<Pair>>,
    #[serde(default)]
    pub dma: Folder,
    #[serde(default)]
    pub impedance: Spectra,
    #[serde(default)]
    pub report: Report,
    #[serde(default)]
    pub sensor: Vec<Spanned<SensorStatement>>,
    #[serde(default)]
    pub climate: ClimateRules,
    #[serde(default)]
    pub adopted: Vec<Spanned<Adopted>>,
    #[serde(default)]
    pub monitoring: Monitoring,
    #[serde(default)]
    pub compare: Compare,
    #[serde(default)]
    pub study: Study,
    #[serde(default)]
    pub tags: Tags,
    #[serde(default)]
    pub fit: Fit,
    #[serde(default)]
    pub answers: BTreeMap<String, String>,
}

impl File {
    /// Takes the folders that another reading names.
    pub fn take_places(&mut self, other: File) {
        self.runs.folder = other.runs.folder;
        self.dma.folder = other.dma.folder;
        self.impedance.folder = other.impedance.folder;
        self.report.templates = other.report.templates;
    }
}

/// `[tags]`.
#[derive(Deserialize, Default)]
pub(super) struct Tags {
    #[serde(default)]
    pub extra: Vec<String>,
}

/// `[fit]`.
#[derive(Default, Deserialize)]
pub(super) struct Fit {
    pub method: Option<String>,
    pub simultaneous: Option<bool>,
    #[serde(default)]
    pub known: Vec<Spanned<Known>>,
}

/// `[[fit.known]]`. A key that is misspelt would turn an error into an exact value.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Known {
    pub parameter: Option<String>,
    pub value: Option<f64>,
    pub standard_error: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub source: Option<String>,
    pub sample: Option<String>,
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
    pub date_order: Option<String>,
    pub notice: Option<String>,
    pub model: Option<String>,
    #[serde(default)]
    pub group_by: Vec<String>,
    pub tolerance_percent: Option<f64>,
}

/// `[runs]`.
#[derive(Deserialize, Default)]
pub(super) struct Runs {
    pub folder: Option<String>,
    pub name_pattern: Option<String>,
    pub pair_by: Option<Vec<String>>,
}

/// `[[pair]]`.
#[derive(Deserialize)]
pub(super) struct Pair {
    pub current: Option<String>,
    pub bending: Option<String>,
}

/// `[dma]`.
#[derive(Deserialize, Default)]
pub(super) struct Folder {
    pub folder: Option<String>,
    pub name_pattern: Option<String>,
}

/// `[impedance]`.
#[derive(Deserialize, Default)]
pub(super) struct Spectra {
    pub folder: Option<String>,
    pub name_pattern: Option<String>,
    #[serde(default)]
    pub circuits: Vec<String>,
}

/// `[report]`.
#[derive(Deserialize, Default)]
pub(super) struct Report {
    pub templates: Option<String>,
}

/// `[compare]`.
#[derive(Deserialize, Default)]
pub(super) struct Compare {
    pub by: Option<String>,
}

/// `[study]`.
#[derive(Deserialize, Default)]
pub(super) struct Study {
    #[serde(default)]
    pub compare: Vec<String>,
    pub within: Option<Vec<String>>,
    pub at_equal: Option<Vec<String>>,
    pub scatter_percent: Option<f64>,
    pub alike_percent: Option<f64>,
}

/// `[monitoring]`.
#[derive(Deserialize, Default)]
pub(super) struct Monitoring {
    #[serde(default)]
    pub reference: BTreeMap<String, Scalar>,
    pub false_alarm_runs: Option<f64>,
    #[serde(default)]
    pub limit: Vec<Limit>,
    #[serde(default)]
    pub command: Vec<String>,
    pub command_time_limit_s: Option<f64>,
    #[serde(default)]
    pub acknowledged: Vec<String>,
}

/// A tag's value.
#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum Scalar {
    Whole(i64),
    Number(f64),
    Text(String),
}

impl Scalar {
    /// As tags are stored.
    pub fn text(self) -> String {
        match self {
            Scalar::Whole(number) => number.to_string(),
            Scalar::Number(number) => number.to_string(),
            Scalar::Text(text) => text,
        }
    }
}

/// `[[monitoring.limit]]`.
#[derive(Deserialize)]
pub(super) struct Limit {
    pub parameter: Option<String>,
    pub material: Option<String>,
    pub below: Option<f64>,
    pub above: Option<f64>,
}
