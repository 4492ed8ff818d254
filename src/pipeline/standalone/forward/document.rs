//! The document that `ieap predict --json` prints.

use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::grounds::{Forecasts, Grounds};
use super::source::{LeftOutEntry, Source};
use super::surroundings::BroughtEntry;
use crate::analysis::forecast::Forecast;
use crate::domain::Drive;
use crate::domain::quantiles::NORMAL_95;
use crate::model::geometry::{CrossSection, Shape};
use crate::model::scaling::StripSize;
use crate::model::scaling::prediction::LINKS;
use crate::pipeline::findings::strip_modulus::StripModulus;

/// A prediction.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PredictionDocument {
    /// Always `ieap/prediction/2`.
    pub schema: &'static str,
    /// Sample whose laminate it is.
    pub sample: String,
    /// Material.
    pub material: String,
    /// Environment.
    pub environment: String,
    /// Humidity asked for, else the mean of the runs, percent; null where they state none.
    pub relative_humidity_percent: Option<f64>,
    /// The strip.
    pub strip: StripEntry,
    /// The drive.
    #[serde(serialize_with = "as_entry")]
    #[schemars(with = "DriveEntry")]
    pub drive: Drive,
    /// `lumped` or `distributed`.
    pub model: &'static str,
    /// Share by which the lumped model would be wrong at the tip; null where the electrodes' resistance is not known.
    pub lumped_error_at_tip: Option<f64>,
    /// What is predicted at the times asked for.
    pub rows: Vec<PredictedRow>,
    /// The same over the whole drive.
    pub course: Vec<PredictedRow>,
    /// Shapes at the times asked for; empty where no run tells how the strip bends.
    pub shapes: Vec<ShapeEntry>,
    /// Conditions to which laws took the runs; empty where runs were made in them.
    pub brought: Vec<BroughtEntry>,
    /// Runs that it is made from.
    pub sources: Vec<Told>,
    /// Runs in the same surroundings that tell nothing.
    pub left_out: Vec<LeftOutEntry>,
    /// What the intervals hold and what is missing for more.
    pub remarks: Vec<String>,
}

/// A strip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct StripEntry {
    /// Length, mm.
    pub length_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Thickness, mm; null where it is not known.
    pub thickness_mm: Option<f64>,
    /// Whether it is another strip than the sample.
    pub is_another: bool,
}

impl StripEntry {
    pub(super) fn of(grounds: &Grounds) -> StripEntry {
        StripEntry {
            length_mm: grounds.to.length_mm.value,
            width_mm: grounds.to.width_mm.value,
            thickness_mm: grounds.to.thickness_mm.map(|thickness| thickness.value),
            is_another: grounds.is_another,
        }
    }
}

/// A drive.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DriveEntry {
    /// Voltage before it, V.
    pub baseline_v: f64,
    /// What the source holds, one after the other.
    pub segments: Vec<SegmentEntry>,
}

/// A stretch of a drive, which lasts until the next one starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SegmentEntry {
    /// Start, s.
    pub start_s: f64,
    /// Voltage from then on, V; null for an open circuit.
    pub voltage_v: Option<f64>,
}

/// A drive as documents state it.
pub(in crate::pipeline::standalone) fn as_entry<S: Serializer>(
    drive: &Drive,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let segment = |(start_s, voltage_v)| SegmentEntry { start_s, voltage_v };
    let entry = DriveEntry {
        baseline_v: drive.baseline_v,
        segments: drive.levels().map(segment).collect(),
    };
    entry.serialize(serializer)
}

/// A run that tells.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Told {
    /// Path of the run.
    pub run: String,
    /// Model that it is fitted with.
    pub model: String,
    /// Voltage of its drive, V.
    pub voltage_v: f64,
}

impl Told {
    pub(super) fn all(grounds: &Grounds) -> Vec<Told> {
        let told = |source: &Source| Told {
            run: source.run.clone(),
            model: source.fitted_with.clone(),
            voltage_v: source.step_v,
        };
        let telling = grounds.sources.iter().filter(|source| grounds.tells(source));
        telling.map(told).collect()
    }
}

/// What is predicted at one time.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PredictedRow {
    /// Time, s.
    pub time_s: f64,
    /// Current, A.
    pub current_a: Forecast,
    /// Charge on the capacitors, C.
    pub charge_c: Forecast,
    /// Curvature, the mean over the length, 1/cm.
    pub curvature_per_cm: Option<Forecast>,
    /// Sideways displacement of the tip, mm.
    pub tip_displacement_mm: Option<Forecast>,
    /// Moment that holds the strip straight, mN mm; null where the stiffness is not known.
    pub blocked_moment_mn_mm: Option<Forecast>,
}

/// Rows at every time that was forecast.
pub(super) fn rows(grounds: &Grounds, forecasts: &Forecasts, time_s: &[f64]) -> Vec<PredictedRow> {
    let stiffness = Stiffness::of(&grounds.to, &grounds.modulus);
    let row = |(k, &time_s): (usize, &f64)| {
        let curvature = forecasts.curvature_per_cm.get(k);
        PredictedRow {
            time_s,
            current_a: forecasts.current_a[k],
            charge_c: forecasts.charge_c[k],
            curvature_per_cm: curvature.copied(),
            tip_displacement_mm: forecasts.tip_displacement_mm.get(k).copied(),
            blocked_moment_mn_mm: curvature
                .zip(stiffness.as_ref())
                .map(|(c, stiffness)| stiffness.moment(c)),
        }
    };
    time_s.iter().enumerate().map(row).collect()
}

/// Stiffness of a strip, as moment per curvature, with its relative error.
struct Stiffness {
    moment_per_curvature: f64,
    relative_error: f64,
}

impl Stiffness {
    fn of(size: &StripSize, modulus: &StripModulus) -> Option<Stiffness> {
        let (thickness, modulus_mpa) = size.thickness_mm.zip(modulus.modulus_mpa.value)?;
        let section = CrossSection::symmetrical(size.width_mm.value, thickness.value);
        let of_modulus = modulus.modulus_mpa.standard_error.unwrap_or(0.0) / modulus_mpa;
        // I goes with the cube of the thickness.
        let of_size = (size.width_mm.relative_error()).hypot(3.0 * thickness.relative_error());
        Some(Stiffness {
            moment_per_curvature: section.bending_moment_mn_mm(modulus_mpa, 1.0),
            relative_error: of_modulus.hypot(of_size),
        })
    }

    fn moment(&self, curvature: &Forecast) -> Forecast {
        let scale = self.moment_per_curvature;
        let mut moment = *curvature;
        let parts = &mut moment.standard_deviation;
        parts.parameters = scale * parts.parameters.hypot(curvature.value * self.relative_error);
        parts.conditions *= scale;
        parts.misfit *= scale;
        for part in [&mut parts.runs, &mut parts.voltages, &mut parts.samples] {
            *part = part.map(|part| part * scale);
        }
        moment.value = scale * curvature.value;
        let of_stiffness = NORMAL_95 * moment.value * self.relative_error;
        let half = (scale * (curvature.high_95 - curvature.value)).hypot(of_stiffness);
        moment.low_95 = moment.value - half;
        moment.high_95 = moment.value + half;
        moment
    }
}

/// The shape of the strip at one time, from the clamp on.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ShapeEntry {
    /// Time, s.
    pub time_s: f64,
    /// Links of the strip, from the clamp on.
    pub links: Vec<LinkEntry>,
    /// Joints of the links: one more than there are links.
    pub joints: Vec<JointEntry>,
}

/// A link of a strip's shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LinkEntry {
    /// Its middle along the strip, mm.
    pub along_mm: f64,
    /// Curvature there, 1/cm.
    pub curvature_per_cm: f64,
    /// Lower end of its 95 % interval.
    pub curvature_low_95: f64,
    /// Upper end.
    pub curvature_high_95: f64,
}

/// A joint of a strip's shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct JointEntry {
    /// mm ahead of the clamp.
    pub x_mm: f64,
    /// mm sideways.
    pub y_mm: f64,
}

impl ShapeEntry {
    /// The shape at the time of that index.
    pub(super) fn at(grounds: &Grounds, forecasts: &Forecasts, k: usize, time_s: f64) -> Option<ShapeEntry> {
        let links: Option<Vec<&Forecast>> = forecasts
            .local_curvature_per_cm
            .iter()
            .map(|link| link.get(k))
            .collect();
        let links = links.filter(|links| links.len() == LINKS)?;
        let link_mm = grounds.to.length_mm.value / LINKS as f64;
        let curvature_per_cm: Vec<f64> = links.iter().map(|link| link.value).collect();
        let shape = Shape::from_curvature(&curvature_per_cm, link_mm / 10.0);
        let link = |(k, forecast): (usize, &&Forecast)| LinkEntry {
            along_mm: (k as f64 + 0.5) * link_mm,
            curvature_per_cm: forecast.value,
            curvature_low_95: forecast.low_95,
            curvature_high_95: forecast.high_95,
        };
        let joints = shape.x_cm.iter().zip(&shape.y_cm);
        Some(ShapeEntry {
            time_s,
            links: links.iter().enumerate().map(link).collect(),
            joints: joints
                .map(|(x_cm, y_cm)| JointEntry {
                    x_mm: 10.0 * x_cm,
                    y_mm: 10.0 * y_cm,
                })
                .collect(),
        })
    }
}

impl PredictionDocument {
    /// Rows as a table with units in the names: those asked for.
    pub fn csv(&self, rows: &[PredictedRow]) -> String {
        let columns = [
            "current_a",
            "charge_c",
            "curvature_per_cm",
            "tip_displacement_mm",
            "blocked_moment_mn_mm",
        ];
        let heads = columns.map(|name| format!("{name},{name}_low_95,{name}_high_95"));
        let mut text = format!("time_s,{}\n", heads.join(","));
        for row in rows {
            let cells = [
                Some(row.current_a),
                Some(row.charge_c),
                row.curvature_per_cm,
                row.tip_displacement_mm,
                row.blocked_moment_mn_mm,
            ];
            let cells = cells.map(|cell| match cell {
                Some(p) => format!("{},{},{}", p.value, p.low_95, p.high_95),
                None => ",,".to_owned(),
            });
            // Writing to a string does not fail.
            let _ = writeln!(text, "{},{}", row.time_s, cells.join(","));
        }
        text
    }
}
