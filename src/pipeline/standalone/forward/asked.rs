//! Which strip is asked for, and in which surroundings.

use crate::analysis::conditions::HUMIDITY_GAP_PERCENT;
use crate::analysis::laws::Covariate;
use crate::domain::Sample;
use crate::domain::typed_value::Measured;
use crate::model::scaling::StripSize;
use crate::pipeline::PipelineError;

/// A strip of the laminate of a sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AskedStrip {
    /// Sample whose fits tell.
    pub sample: String,
    /// Environment of the runs; none where the sample was measured in one only.
    pub environment: Option<String>,
    /// Relative humidity, percent; none: that of all runs.
    pub relative_humidity_percent: Option<f64>,
    /// A humidity that changes meanwhile: times, s, from which on it is so many percent; empty where it does not.
    pub humidity_course: Vec<(f64, f64)>,
    /// Temperature, °C; none: that of all runs.
    pub temperature_c: Option<f64>,
    /// Hours since the start of the sample's first run; none: those of all runs.
    pub age_h: Option<f64>,
    /// Length, where it is another.
    pub length_mm: Option<Measured>,
    /// Width, where it is another.
    pub width_mm: Option<Measured>,
    /// Thickness, where it is another.
    pub thickness_mm: Option<Measured>,
    /// Modulus; none: from the modulus logs.
    pub modulus_mpa: Option<Measured>,
    /// Resistance of both electrodes along the strip, Ohm per square; none: what campaign.toml or the fits say.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
}

/// A condition that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Condition {
    /// What it is of.
    pub covariate: Covariate,
    /// The option that asks for it.
    pub option: &'static str,
    /// What is asked for, in the covariate's unit.
    pub to: f64,
    /// Runs this near are taken as they are, in the same unit.
    pub alike: f64,
}

/// Temperature and age at which runs are taken as they are: what sensors of a laboratory agree to; runs of one age are one run.
/// Humidities that are alike are those of one condition.
const TEMPERATURE_ALIKE_C: f64 = 1.0;
const AGE_ALIKE_H: f64 = 0.0;

impl AskedStrip {
    /// The conditions asked for.
    pub(super) fn conditions(&self) -> Vec<Condition> {
        let condition = |covariate, option, to: Option<f64>, alike| {
            to.map(|to| Condition {
                covariate,
                option,
                to,
                alike,
            })
        };
        let all = [
            condition(
                Covariate::RelativeHumidity,
                self.humidity_option(),
                self.humidity_percent(),
                HUMIDITY_GAP_PERCENT,
            ),
            condition(
                Covariate::Temperature,
                "--temperature",
                self.temperature_c,
                TEMPERATURE_ALIKE_C,
            ),
            condition(Covariate::Age, "--age", self.age_h, AGE_ALIKE_H),
        ];
        all.into_iter().flatten().collect()
    }

    /// The humidity asked for, percent; of one that changes its beginning.
    pub(super) fn humidity_percent(&self) -> Option<f64> {
        let begins = self.humidity_course.first().map(|row| row.1);
        begins.or(self.relative_humidity_percent)
    }

    fn humidity_option(&self) -> &'static str {
        if self.humidity_course.is_empty() {
            "--rh"
        } else {
            "--rh-course"
        }
    }

    /// Whether it is another strip than the sample itself.
    pub fn is_another(&self) -> bool {
        self.length_mm.is_some() || self.width_mm.is_some() || self.thickness_mm.is_some()
    }

    /// Its size; what is not asked for is the sample's.
    pub(super) fn size(&self, of: &StripSize) -> StripSize {
        StripSize {
            length_mm: self.length_mm.unwrap_or(of.length_mm),
            width_mm: self.width_mm.unwrap_or(of.width_mm),
            thickness_mm: self.thickness_mm.or(of.thickness_mm),
        }
    }
}

/// The size of a sample, as campaign.toml states it; its width is that of its active area.
///
/// # Errors
/// Its length or area is not stated.
pub(super) fn size_of(sample: &Sample) -> Result<StripSize, PipelineError> {
    let known = sample.length_mm.zip(sample.active_area_cm2());
    let (length_mm, area_cm2) = known.ok_or_else(|| PipelineError::BadArgument {
        what: "--sample",
        found: format!(
            "{:?}, whose length or width campaign.toml does not state",
            sample.id
        ),
        needed: "length_mm and width_mm of the sample in campaign.toml".to_owned(),
    })?;
    Ok(StripSize {
        length_mm: Measured::exact(length_mm),
        width_mm: Measured::exact(100.0 * area_cm2 / length_mm),
        thickness_mm: sample.thickness_mm.map(Measured::exact),
    })
}
