//! A run of a spec whose curvatures and voltages are read at places along the strip: the distributed model.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::run_spec::{SegmentSpec, drive_of, rise};
use super::sampling::Sampling;
use super::wrong::{Wrong, above_zero, from_zero};
use crate::domain::Drive;
use crate::model::Branch;
use crate::model::coupling::{ActiveArea, CurvaturePerTotalCharge};
use crate::model::distributed::{DistributedModel, Laminate};

/// One run along a strip.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StripSpec {
    /// File to write, below the output folder.
    pub file: PathBuf,
    /// Free length, mm.
    pub length_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Places of the curvatures, mm from the clamp.
    #[serde(default)]
    pub curvature_at_mm: Vec<f64>,
    /// Places of the voltages, mm from the clamp.
    #[serde(default)]
    pub voltage_at_mm: Vec<f64>,
    /// Standard deviation of the voltages, V.
    #[serde(default)]
    pub voltage_noise_v: f64,
    /// Voltage held before the drive, V.
    #[serde(default)]
    pub baseline_v: f64,
    /// Step at time zero, V; or `drive`.
    pub voltage_v: Option<f64>,
    /// Segments of held voltages; or `voltage_v`.
    #[serde(default)]
    pub drive: Vec<SegmentSpec>,
    /// How all channels are sampled after the step; none: as the potentiostat of the spec.
    #[serde(default)]
    pub sampling: Vec<Sampling>,
    /// The laminate.
    pub parameters: StripParameters,
    /// Tags of the run's sidecar.
    #[serde(default)]
    pub tags: toml::Table,
    /// Nothing: the library's effects act on the strip as a whole, and those who try are told so.
    #[serde(default)]
    effect: Vec<toml::Value>,
}

/// What is said to those who hide an effect in a strip.
pub(super) const NO_EFFECTS: &str = "no effect in a [[strip]]: effects act on the strip as a whole; hide them in a [[run]], or change the strip's own parameters";

/// Parameters of the distributed model as thesis table 3 states them; R_c, C, R_e positive.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StripParameters {
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub re_ohm_per_sq: f64,
    /// Resistance of the chain across the laminate, Ohm cm2.
    pub rc_ohm_cm2: f64,
    /// Capacitance, F/cm2.
    pub c_f_per_cm2: f64,
    /// Steady-state resistance, Ohm cm2; none: no steady current.
    pub rss_ohm_cm2: Option<f64>,
    /// Curvature per total charge of the strip, 1/(C cm).
    pub alpha_per_c_cm: f64,
    /// Rate of back-relaxation, 1/s.
    pub lambda_per_s: f64,
}

impl StripSpec {
    pub(super) fn check(&self) -> Result<(), Wrong> {
        let place = |what: &str| format!("strip {}: {what}", self.file.display());
        let given = &self.parameters;
        if !self.effect.is_empty() {
            let found = match self.effect.len() {
                1 => "an effect".to_owned(),
                many => format!("{many} effects"),
            };
            return Err(Wrong::new(&place("effect"), found, NO_EFFECTS));
        }
        self.check_numbers(&place)?;
        let positive = [
            ("length_mm", self.length_mm),
            ("width_mm", self.width_mm),
            ("re_ohm_per_sq", given.re_ohm_per_sq),
            ("rc_ohm_cm2", given.rc_ohm_cm2),
            ("c_f_per_cm2", given.c_f_per_cm2),
            ("rss_ohm_cm2", given.rss_ohm_cm2.unwrap_or(1.0)),
        ];
        let at = |(key, number): (&str, f64)| (place(key), number);
        Wrong::unless_all(positive.map(at), above_zero, "a number above 0")?;
        let not_negative = [
            ("voltage_noise_v", self.voltage_noise_v),
            ("lambda_per_s", given.lambda_per_s),
        ];
        Wrong::unless_all(not_negative.map(at), from_zero, "a number of 0 or above")?;
        if self.voltage_v.is_some() != self.drive.is_empty() {
            let found = format!("voltage_v {:?}, {} segments", self.voltage_v, self.drive.len());
            return Err(Wrong::new(&place("drive"), found, "one of voltage_v and drive"));
        }
        self.check_drive_and_places(&place)
    }

    /// That every voltage and time is a number.
    fn check_numbers(&self, place: &dyn Fn(&str) -> String) -> Result<(), Wrong> {
        let segments = self.drive.iter().flat_map(|segment| {
            [
                ("drive: start_s", segment.start_s),
                ("drive: voltage_v", segment.voltage_v.unwrap_or(0.0)),
            ]
        });
        let single = [
            ("voltage_v", self.voltage_v.unwrap_or(0.0)),
            ("baseline_v", self.baseline_v),
            ("alpha_per_c_cm", self.parameters.alpha_per_c_cm),
        ];
        let all = single.into_iter().chain(segments);
        let all = all.map(|(key, value)| (place(key), value));
        Wrong::unless_all(all, f64::is_finite, "a number")
    }

    fn check_drive_and_places(&self, place: &dyn Fn(&str) -> String) -> Result<(), Wrong> {
        if !rise(&self.drive) || self.drive.iter().any(|own| own.voltage_v.is_none()) {
            let needed = "held voltages in order of time";
            return Err(Wrong::new(&place("drive"), format!("{:?}", self.drive), needed));
        }
        let places = || self.curvature_at_mm.iter().chain(&self.voltage_at_mm);
        if let Some(beyond) = places().find(|at| !(0.0..=self.length_mm).contains(*at)) {
            let needed = format!("0 to {}", self.length_mm);
            return Err(Wrong::new(&place("places"), beyond.to_string(), &needed));
        }
        for (key, at_mm) in [
            ("curvature_at_mm", &self.curvature_at_mm),
            ("voltage_at_mm", &self.voltage_at_mm),
        ] {
            let twice = at_mm.iter().enumerate().find(|(k, at)| at_mm[..*k].contains(at));
            if let Some((_, twice)) = twice {
                return Err(Wrong::new(
                    &place(key),
                    format!("{twice} twice"),
                    "each place once",
                ));
            }
        }
        Ok(())
    }

    /// The drive, from the steady state at the baseline.
    pub fn drive(&self) -> Drive {
        drive_of(self.baseline_v, self.voltage_v, None, &self.drive)
    }

    /// The strip.
    pub fn model(&self) -> DistributedModel {
        let of = ActiveArea {
            length_cm: self.length_mm / 10.0,
            width_cm: self.width_mm / 10.0,
        };
        let given = &self.parameters;
        Laminate {
            electrode_resistance_ohm_per_sq: given.re_ohm_per_sq,
            branch: Branch {
                resistance_ohm_cm2: given.rc_ohm_cm2,
                capacitance_f_per_cm2: given.c_f_per_cm2,
            },
            steady_state_resistance_ohm_cm2: given.rss_ohm_cm2.unwrap_or(f64::INFINITY),
            coupling: CurvaturePerTotalCharge(given.alpha_per_c_cm).areal(&of),
            relaxation_rate_per_s: given.lambda_per_s,
        }
        .strip(&of)
    }
}
