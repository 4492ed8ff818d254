//! Which modulus logs are to be simulated: the table `[dma]` of a spec.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::wrong::{Wrong, above_zero, from_zero};

/// Modulus logs to write, and what holds for all of them.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DmaSpec {
    /// Folder to write into, relative to the spec.
    pub folder: PathBuf,
    /// Lines that open every file: that it is simulated, and from what.
    pub statement: Vec<String>,
    /// Frequency of the oscillation, Hz.
    pub frequency_hz: f64,
    /// Interval of the readings, s.
    pub every_s: f64,
    /// Temperature beside the sample, degrees Celsius.
    pub temperature_c: f64,
    /// Time constant with which the chamber follows its generator, s.
    pub humidity_lag_s: f64,
    /// Humidities held, in order; the chamber is at the first one from the start.
    pub humidity: Vec<Hold>,
    /// Noise.
    pub noise: DmaNoise,
    /// The logs.
    pub log: Vec<LogSpec>,
}

/// A humidity that is held.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// Relative humidity, percent.
    pub relative_humidity_percent: f64,
    /// For how long, s.
    pub for_s: f64,
}

/// Gaussian noise of a log.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DmaNoise {
    /// Standard deviation of |E*|, percent of its value in the dry state.
    pub modulus_percent: f64,
    /// Standard deviation of the loss factor.
    pub loss_factor: f64,
    /// Standard deviation of the humidity, percent.
    pub relative_humidity_percent: f64,
    /// Standard deviation of the temperature, degrees Celsius.
    pub temperature_c: f64,
    /// Lag-1 autocorrelation of each, 0 to below 1.
    pub autocorrelation: f64,
}

/// One log: a sample whose modulus goes from one equilibrium to another as the humidity does.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogSpec {
    /// File to write, below the folder.
    pub file: PathBuf,
    /// Tags of the log's sidecar.
    #[serde(default)]
    pub tags: toml::Table,
    /// |E*| in equilibrium at the lowest humidity held, MPa.
    pub dry_mpa: f64,
    /// |E*| in equilibrium at the highest humidity held, MPa; between them it follows the humidity in proportion.
    pub humid_mpa: f64,
    /// tan delta at the lowest and at the highest humidity.
    pub loss_factor: [f64; 2],
    /// Time constant with which the modulus follows a rise of the humidity, s.
    pub wetting_s: f64,
    /// Time constant with which it follows a fall, s.
    pub drying_s: f64,
}

impl DmaSpec {
    /// Checks what serde cannot.
    pub(super) fn check(&self) -> Result<(), Wrong> {
        let of_spec = [
            ("dma.frequency_hz", self.frequency_hz),
            ("dma.every_s", self.every_s),
        ];
        let of_logs = self.log.iter().flat_map(|log| {
            [
                ("dma.log.dry_mpa", log.dry_mpa),
                ("dma.log.humid_mpa", log.humid_mpa),
                ("dma.log.wetting_s", log.wetting_s),
                ("dma.log.drying_s", log.drying_s),
            ]
        });
        let of_holds = self
            .humidity
            .iter()
            .map(|hold| ("dma.humidity.for_s", hold.for_s));
        let all = of_spec.into_iter().chain(of_logs).chain(of_holds);
        Wrong::unless_all(all, above_zero, "a number above 0")?;
        if self.humidity.is_empty() {
            let needed = "at least one [[dma.humidity]]";
            return Err(Wrong::new("dma.humidity", "nothing".into(), needed));
        }
        let correlation = [("dma.noise.autocorrelation", self.noise.autocorrelation)];
        let is_below_one = |part: f64| (0.0..1.0).contains(&part);
        Wrong::unless_all(correlation, is_below_one, "a number from 0 to below 1")?;
        let lag = [("dma.humidity_lag_s", self.humidity_lag_s)];
        Wrong::unless_all(lag, from_zero, "a time not below 0")
    }

    /// Paths that must stay below the spec's folder.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        let files = self.log.iter().map(|log| log.file.as_path());
        files.chain([self.folder.as_path()])
    }
}
