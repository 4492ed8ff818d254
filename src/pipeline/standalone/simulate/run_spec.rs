//! One run of a spec: its sample, its drive, its parameters.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

use super::effect_spec::EffectSpec;
use super::noise_spec::Noise;
use super::wave::Wave;
use super::wrong::{Wrong, above_zero, from_zero};
use crate::domain::{Drive, Issue};
use crate::model::{LumpedModel, fit_model};
use crate::truth::{HiddenEffect, Truth, TruthError};

/// One run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// File to write, below the output folder.
    pub file: PathBuf,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Free length, cm; some effects need it.
    pub length_cm: Option<f64>,
    /// Width, cm; none: area over length.
    pub width_cm: Option<f64>,
    /// Voltage held before the drive, V: a discharge starts from it.
    #[serde(default)]
    pub baseline_v: f64,
    /// Step at time zero, V; or `drive`; or `pulses`; or `wave`.
    pub voltage_v: Option<f64>,
    /// Segments of the drive; or `voltage_v`; or `pulses`.
    #[serde(default)]
    pub drive: Vec<SegmentSpec>,
    /// A train of pulses from time zero on; or `voltage_v`; or `drive`.
    pub pulses: Option<Pulses>,
    /// A sine or a chirp from time zero on; or one of those.
    pub wave: Option<Wave>,
    /// Parameters by their stored keys; those left out are 0, or absent branches.
    pub parameters: BTreeMap<String, f64>,
    /// Effects hidden in this run, beside those of the spec.
    #[serde(default)]
    pub effect: Vec<EffectSpec>,
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

/// Whether each segment starts after the one before.
pub(super) fn rise(segments: &[SegmentSpec]) -> bool {
    segments.is_sorted_by(|a, b| a.start_s < b.start_s)
}

/// Pulses of one voltage with 0 V between and after them.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulses {
    /// Voltage of a pulse, V.
    pub voltage_v: f64,
    /// Length of a pulse, s.
    pub on_s: f64,
    /// Length of a pause, s.
    pub off_s: f64,
    /// Number of pulses.
    pub count: u32,
}

impl Pulses {
    fn levels(&self) -> Vec<(f64, Option<f64>)> {
        let pulse = |k: u32| {
            let start_s = f64::from(k) * (self.on_s + self.off_s);
            [(start_s, Some(self.voltage_v)), (start_s + self.on_s, Some(0.0))]
        };
        (0..self.count).flat_map(pulse).collect()
    }
}

/// Whether a run may give it: a parameter of the lumped model with the most branches.
fn is_parameter(key: &str) -> bool {
    let parameters = fit_model("lumped-4").map_or(&[][..], |model| model.parameters);
    parameters.iter().any(|of| !of.derived && of.key == key)
}

impl RunSpec {
    pub(super) fn check(&self) -> Result<(), Wrong> {
        let place = |what: &str| format!("run {}: {what}", self.file.display());
        if let Some(key) = self.parameters.keys().find(|key| !is_parameter(key)) {
            let needed = "one of r1_ohm_cm2 c1_f_per_cm2 (and so on to r4_ohm_cm2 c4_f_per_cm2) rss_ohm_cm2 alpha_per_c_cm lambda_per_s";
            return Err(Wrong::new(&place("parameters"), key.clone(), needed));
        }
        self.check_parameters(&place)?;
        let ordered = rise(&self.drive);
        let drives = [
            self.voltage_v.is_some(),
            !self.drive.is_empty(),
            self.pulses.is_some(),
            self.wave.is_some(),
        ];
        if drives.into_iter().filter(|given| *given).count() != 1 || !ordered {
            let found = format!(
                "voltage_v {:?}, {} segments, {} pulses and {} waves",
                self.voltage_v,
                self.drive.len(),
                self.pulses.map_or(0, |pulses| pulses.count),
                i32::from(self.wave.is_some())
            );
            let needed = "one of voltage_v, pulses, wave, and a drive of segments with rising start_s";
            return Err(Wrong::new(&place("drive"), found, needed));
        }
        if let Some(pulses) = self.pulses
            && !(above_zero(pulses.on_s) && above_zero(pulses.off_s) && pulses.count > 0)
        {
            let needed = "on_s and off_s above 0 and a count of 1 or more";
            return Err(Wrong::new(&place("pulses"), format!("{pulses:?}"), needed));
        }
        if let Some(wave) = &self.wave {
            wave.check(&place("wave"))?;
            if self.baseline_v != 0.0 {
                let found = format!("{} V", self.baseline_v);
                return Err(Wrong::new(
                    &place("baseline_v"),
                    found,
                    "no baseline: a wave starts from rest",
                ));
            }
        }
        let sizes = [
            ("area_cm2", Some(self.area_cm2)),
            ("length_cm", self.length_cm),
            ("width_cm", self.width_cm),
        ];
        let sizes = sizes
            .into_iter()
            .filter_map(|(key, size)| Some((place(key), size?)));
        Wrong::unless_all(sizes, above_zero, "a number above 0")
    }

    /// Values that a strip can have: without them there would be no current, or none that is a number.
    fn check_parameters(&self, place: &impl Fn(&str) -> String) -> Result<(), Wrong> {
        for (key, &value) in &self.parameters {
            let (is_possible, needed) = match key.as_str() {
                "alpha_per_c_cm" => (value.is_finite(), "a number"),
                "lambda_per_s" => (from_zero(value), "a number of 0 or more"),
                "rss_ohm_cm2" => (value > 0.0, "a number above 0, or none where nothing leaks"),
                _ => (above_zero(value), "a number above 0"),
            };
            if !is_possible {
                return Err(Wrong::new(&place(key), value.to_string(), needed));
            }
            let other = if key.starts_with('r') {
                format!("c{}_f_per_cm2", &key[1..2])
            } else {
                format!("r{}_ohm_cm2", &key[1..2])
            };
            let is_of_branch = !["alpha_per_c_cm", "lambda_per_s", "rss_ohm_cm2"].contains(&key.as_str());
            if is_of_branch && !self.parameters.contains_key(&other) {
                let needed = "resistance and capacitance of a branch, or neither";
                return Err(Wrong::new(&place(key), format!("{key} without {other}"), needed));
            }
        }
        Ok(())
    }

    /// The drive, from the steady state at the baseline.
    pub fn drive(&self) -> Drive {
        match &self.wave {
            Some(wave) => wave.drive(self.baseline_v),
            None => drive_of(self.baseline_v, self.voltage_v, self.pulses, &self.drive),
        }
    }

    /// The sample of the run with effects hidden in it.
    pub fn truth(&self, effects: Vec<HiddenEffect>) -> Truth {
        let model = self.model();
        Truth {
            branches: model.branches,
            steady_state_resistance_ohm_cm2: model.steady_state_resistance_ohm_cm2,
            charge_to_curvature_per_c_cm: model.charge_to_curvature_per_c_cm,
            relaxation_rate_per_s: model.relaxation_rate_per_s,
            area_cm2: self.area_cm2,
            length_cm: self.length_cm,
            width_cm: self.width_cm,
            effects,
        }
    }

    /// The model with the run's parameters. A branch without resistance and capacitance is absent.
    pub fn model(&self) -> LumpedModel {
        LumpedModel::of_parameters(|key| self.parameters.get(key).copied())
    }
}

/// The drive that is stated in one of three ways, from the steady state at the baseline.
pub(super) fn drive_of(
    baseline_v: f64,
    voltage_v: Option<f64>,
    pulses: Option<Pulses>,
    given: &[SegmentSpec],
) -> Drive {
    let levels = match (voltage_v, pulses) {
        (Some(_), _) => vec![(0.0, voltage_v)],
        (None, Some(pulses)) => pulses.levels(),
        (None, None) => given.iter().map(|own| (own.start_s, own.voltage_v)).collect(),
    };
    Drive::of_levels(baseline_v, levels)
}

/// Refuses a run, noise or effects that make no sense, as those of a spec are refused.
///
/// # Errors
/// What was found where, and what was needed.
pub fn checked_run(run: &RunSpec, noise: &Noise, effects: &[HiddenEffect]) -> Result<(), Issue> {
    let told = |wrong: Wrong| {
        Issue::error("bad-value", format!("found {}", wrong.found))
            .at(wrong.place)
            .mend(format!("give {}", wrong.needed))
    };
    run.check().and_then(|()| noise.check()).map_err(told)?;
    effects.iter().try_for_each(|effect| {
        let refused = |error: TruthError| {
            Issue::error("bad-effect", error.to_string()).at(format!("effect {}", effect.id))
        };
        effect.check().map_err(refused)
    })
}
