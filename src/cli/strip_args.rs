//! Options that name a strip: which sample's fits tell, in which surroundings, and of which size it is.

use std::path::{Path, PathBuf};

use clap::Args;

use super::exit::CliError;
use super::typed;
use crate::domain::typed_value::Measured;
use crate::pipeline::standalone::forward::AskedStrip;
use crate::pipeline::standalone::forward::drive_file::read_humidity;

/// A strip of the laminate of a sample.
#[derive(Debug, Args)]
pub struct StripArgs {
    /// Sample whose fits tell
    #[arg(long, value_name = "SAMPLE")]
    sample: String,
    /// Environment of the runs [default: the only one]
    #[arg(long, value_name = "ENVIRONMENT")]
    environment: Option<String>,
    /// Relative humidity: of the runs, to 5 %, or between theirs, by the laws of the study [default: all runs]
    #[arg(long, value_name = "PERCENT", value_parser = typed::humidity)]
    rh: Option<f64>,
    /// A humidity that changes meanwhile, by the laws of the study: a table of time_s and relative_humidity_percent, each row
    /// held until the next
    #[arg(long, value_name = "FILE.csv", conflicts_with = "rh")]
    rh_course: Option<PathBuf>,
    /// Temperature, as 25C: of the runs, to 1 °C, or between theirs, by the laws [default: all runs]
    #[arg(long, value_name = "TEMPERATURE", value_parser = typed::temperature, allow_hyphen_values = true)]
    temperature: Option<f64>,
    /// Age of the sample since its first run, as 200h, by the laws [default: all runs]
    #[arg(long, value_name = "TIME", value_parser = typed::time)]
    age: Option<f64>,
    /// Length of another strip of the laminate, as 12mm or 12±0.1mm [default: the sample's]
    #[arg(long, value_name = "LENGTH", value_parser = typed::length)]
    length: Option<Measured>,
    /// Its width
    #[arg(long, value_name = "WIDTH", value_parser = typed::length)]
    width: Option<Measured>,
    /// Its thickness; another than the sample's is another laminate
    #[arg(long, value_name = "THICKNESS", value_parser = typed::length)]
    thickness: Option<Measured>,
    /// Resistance of both electrodes together along the strip, Ohm per square [default: what campaign.toml or a
    /// distributed fit says]
    #[arg(long, value_name = "OHM")]
    electrode_resistance: Option<f64>,
}

impl StripArgs {
    /// The strip, with a modulus where one is given.
    ///
    /// # Errors
    /// The file of a humidity that changes cannot be read.
    pub fn asked(&self, modulus_mpa: Option<Measured>) -> Result<AskedStrip, CliError> {
        let humidity_course = self.rh_course.as_deref().map(read_humidity).transpose()?;
        Ok(AskedStrip {
            sample: self.sample.clone(),
            environment: self.environment.clone(),
            relative_humidity_percent: self.rh,
            humidity_course: humidity_course.unwrap_or_default(),
            temperature_c: self.temperature,
            age_h: self.age.map(|age_s| age_s / 3600.0),
            length_mm: self.length,
            width_mm: self.width,
            thickness_mm: self.thickness,
            modulus_mpa,
            electrode_resistance_ohm_per_sq: self.electrode_resistance,
        })
    }
}

/// Where a file is written, by its ending.
#[derive(Debug, Args)]
pub struct OutputFile {
    /// Also write a table (.csv) or a figure (.svg, .png, .pdf)
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write over a file that is there
    #[arg(long)]
    overwrite: bool,
}

impl OutputFile {
    /// The file with its ending in small letters, where one is asked for, and whether it may be written over.
    pub fn asked(&self) -> Option<(&Path, String, bool)> {
        let path = self.output.as_deref()?;
        let ending = path
            .extension()
            .map_or(String::new(), |ending| ending.to_string_lossy().to_lowercase());
        Some((path, ending, self.overwrite))
    }
}
