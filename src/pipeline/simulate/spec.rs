//! What is to be simulated: SPEC.toml.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use thiserror::Error;

use crate::domain::{Drive, Level, Segment};
use crate::model::{Branch, LumpedModel};

/// A file that says which runs to write.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// What holds for all runs.
    pub simulation: Simulation,
    /// Standard deviations and correlation of the noise.
    pub noise: Noise,
    /// How the potentiostat samples after the step, in order of time.
    pub sampling: Vec<Sampling>,
    /// How the camera samples after the step; empty: with the potentiostat.
    #[serde(default)]
    pub camera: Vec<Sampling>,
    /// Folders below the output folder that get a tags.toml.
    #[serde(default)]
    pub folder: Vec<FolderTags>,
    /// The runs.
    pub run: Vec<RunSpec>,
}

/// What holds for all runs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// Seed of the noise.
    pub seed: u64,
    /// Folder to write into, relative to the spec.
    pub folder: PathBuf,
    /// Lines that open every file: that it is simulated, and from what.
    pub statement: Vec<String>,
    /// Recorded time before the step, s.
    #[serde(default)]
    pub baseline_s: f64,
    /// Sampling before the step, s.
    #[serde(default = "one_second")]
    pub baseline_every_s: f64,
    /// Candidate effects to hide in the runs; none is known to this version.
    #[serde(default)]
    pub effects: Vec<String>,
}

fn one_second() -> f64 {
    1.0
}

/// Gaussian noise with a lag-1 correlation between neighbouring readings.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Standard deviation of the current, A.
    pub current_a: f64,
    /// Standard deviation of the curvature, 1/cm.
    pub curvature_per_cm: f64,
    /// Lag-1 autocorrelation, 0 to below 1.
    #[serde(default)]
    pub autocorrelation: f64,
    /// Smallest step of the printed current, A; 0: not quantised.
    #[serde(default)]
    pub current_step_a: f64,
}

/// Even sampling up to a time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Last time sampled so, s.
    pub until_s: f64,
    /// Interval, s.
    pub every_s: f64,
}

/// Tags for a folder.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FolderTags {
    /// Folder below the output folder.
    pub path: PathBuf,
    /// Its tags.
    pub tags: toml::Table,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// File to write, below the output folder.
    pub file: PathBuf,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Step at time zero, V; or `drive`.
    pub voltage_v: Option<f64>,
    /// Segments of the drive; or `voltage_v`.
    #[serde(default)]
    pub drive: Vec<SegmentSpec>,
    /// Parameters by their stored keys; those left out are 0, or absent branches.
    pub parameters: BTreeMap<String, f64>,
    /// Tags of the run's sidecar.
    #[serde(default)]
    pub tags: toml::Table,
}

/// One segment of a drive.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentSpec {
    /// Start, s.
    pub start_s: f64,
    /// Voltage held, V; none: open circuit.
    pub voltage_v: Option<f64>,
}

/// Why a spec cannot be simulated.
#[derive(Debug, Error)]
pub enum SpecError {
    /// The file cannot be read.
    #[error("{path}: the simulation spec cannot be read: {source}")]
    Unreadable {
        /// The spec.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not a spec.
    #[error("{path}: {detail}")]
    Malformed {
        /// The spec.
        path: PathBuf,
        /// Where and what.
        detail: String,
    },
    /// A value makes no sense.
    #[error("{path}: {place}: found {found}, needed {needed}")]
    BadValue {
        /// The spec.
        path: PathBuf,
        /// Which value.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        needed: String,
    },
}

impl Spec {
    /// Reads and checks a spec.
    ///
    /// # Errors
    /// See [`SpecError`].
    pub fn read(path: &Path) -> Result<Spec, SpecError> {
        let text = std::fs::read_to_string(path).map_err(|source| SpecError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let spec: Spec = toml::from_str(&text).map_err(|e| SpecError::Malformed {
            path: path.to_owned(),
            detail: e.to_string(),
        })?;
        let bad = |(place, found, needed): (String, String, &str)| SpecError::BadValue {
            path: path.to_owned(),
            place,
            found,
            needed: needed.to_owned(),
        };
        spec.check().map_err(bad)?;
        Ok(spec)
    }

    fn check(&self) -> Result<(), (String, String, &'static str)> {
        if let Some(effect) = self.simulation.effects.first() {
            return Err((
                "simulation.effects".into(),
                effect.clone(),
                "nothing: this version knows no effects",
            ));
        }
        if !(0.0..1.0).contains(&self.noise.autocorrelation) {
            let found = self.noise.autocorrelation.to_string();
            return Err((
                "noise.autocorrelation".into(),
                found,
                "a number from 0 to below 1",
            ));
        }
        for sampling in self.sampling.iter().chain(&self.camera) {
            if sampling.every_s.is_nan() || sampling.every_s <= 0.0 {
                return Err((
                    "sampling.every_s".into(),
                    sampling.every_s.to_string(),
                    "a time above 0",
                ));
            }
        }
        let safe = |path: &Path| {
            path.components()
                .all(|c| matches!(c, std::path::Component::Normal(_)))
        };
        let paths = self
            .run
            .iter()
            .map(|run| &run.file)
            .chain(self.folder.iter().map(|folder| &folder.path));
        for path in paths.chain([&self.simulation.folder]) {
            if !safe(path) {
                return Err((
                    path.display().to_string(),
                    "a path out of the folder".into(),
                    "a path below it",
                ));
            }
        }
        self.run.iter().try_for_each(RunSpec::check)
    }
}

/// Parameter keys that a run may give.
const PARAMETER_KEYS: [&str; 7] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
];

impl RunSpec {
    fn check(&self) -> Result<(), (String, String, &'static str)> {
        let place = |what: &str| format!("run {}: {what}", self.file.display());
        if let Some(key) = self
            .parameters
            .keys()
            .find(|key| !PARAMETER_KEYS.contains(&key.as_str()))
        {
            let needed = "one of r1_ohm_cm2 c1_f_per_cm2 r2_ohm_cm2 c2_f_per_cm2 rss_ohm_cm2 alpha_per_c_cm lambda_per_s";
            return Err((place("parameters"), key.clone(), needed));
        }
        let ordered = self
            .drive
            .windows(2)
            .all(|pair| pair[0].start_s < pair[1].start_s);
        if self.voltage_v.is_some() != self.drive.is_empty() || !ordered {
            let found = format!("voltage_v {:?} and {} segments", self.voltage_v, self.drive.len());
            return Err((
                place("drive"),
                found,
                "either voltage_v or segments with rising start_s",
            ));
        }
        if self.area_cm2.is_nan() || self.area_cm2 <= 0.0 {
            return Err((place("area_cm2"), self.area_cm2.to_string(), "an area above 0"));
        }
        Ok(())
    }

    /// The drive, from the discharged state.
    pub fn drive(&self) -> Drive {
        match self.voltage_v {
            Some(voltage_v) => Drive::step(voltage_v),
            None => Drive {
                baseline_v: 0.0,
                segments: self
                    .drive
                    .iter()
                    .map(|segment| Segment {
                        start_s: segment.start_s,
                        level: segment.voltage_v.map_or(Level::OpenCircuit, Level::Voltage),
                    })
                    .collect(),
            },
        }
    }

    /// The model with the run's parameters. A branch without resistance and capacitance is absent.
    pub fn model(&self) -> LumpedModel {
        let parameter = |key: &str| self.parameters.get(key).copied();
        let branch = |r: &str, c: &str| {
            Some(Branch {
                resistance_ohm_cm2: parameter(r)?,
                capacitance_f_per_cm2: parameter(c)?,
            })
        };
        LumpedModel {
            branches: [
                branch("r1_ohm_cm2", "c1_f_per_cm2"),
                branch("r2_ohm_cm2", "c2_f_per_cm2"),
            ]
            .into_iter()
            .flatten()
            .collect(),
            steady_state_resistance_ohm_cm2: parameter("rss_ohm_cm2").unwrap_or(f64::INFINITY),
            charge_to_curvature_per_c_cm: parameter("alpha_per_c_cm").unwrap_or(0.0),
            relaxation_rate_per_s: parameter("lambda_per_s").unwrap_or(0.0),
        }
    }
}
