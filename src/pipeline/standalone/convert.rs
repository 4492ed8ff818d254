//! The verb `convert`: one measure of bending into all others, with the errors of what is given.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::domain::Estimate;
use crate::domain::number::fixed;
use crate::domain::quantiles::NORMAL_95;
use crate::domain::typed_value::{Measured, ValueKind};
use crate::model::geometry::conversion::{Bending, ConversionError, FURTHEST_TURN_RAD, KnownStrip};
use crate::pipeline::PipelineError;
use crate::pipeline::documents::fits::as_object;

/// Thickness times curvature from which a strip is no thin beam: strains over the thickness are then beyond 5 %.
const THIN: f64 = 0.1;

const DEG: f64 = 180.0 / std::f64::consts::PI;

/// The name that a measure is typed under.
fn name(bending: Bending) -> &'static str {
    match bending {
        Bending::Curvature => "curvature",
        Bending::Radius => "radius",
        Bending::Displacement => "displacement",
        Bending::TipDisplacement => "tip-displacement",
        Bending::TangentAngle => "tangent-angle",
        Bending::StrainDifference => "strain-difference",
        Bending::BendingStrain => "bending-strain",
        Bending::Moment => "moment",
        Bending::Energy => "energy",
    }
}

/// What a measure is typed as, its key in documents, with the unit, and by what the canonical value is multiplied there.
fn stated(bending: Bending) -> (ValueKind, &'static str, f64) {
    match bending {
        Bending::Curvature => (ValueKind::Curvature, "curvature_per_cm", 1.0),
        Bending::Radius => (ValueKind::Length, "radius_mm", 1.0),
        Bending::Displacement => (ValueKind::Length, "displacement_mm", 1.0),
        Bending::TipDisplacement => (ValueKind::Length, "tip_displacement_mm", 1.0),
        Bending::TangentAngle => (ValueKind::Angle, "tangent_angle_deg", DEG),
        Bending::StrainDifference => (ValueKind::Strain, "strain_difference_percent", 100.0),
        Bending::BendingStrain => (ValueKind::Strain, "bending_strain_percent", 100.0),
        Bending::Moment => (ValueKind::Moment, "bending_moment_mn_mm", 1.0),
        Bending::Energy => (ValueKind::Energy, "strain_energy_uj", 1.0),
    }
}

/// A strip with the errors of its dimensions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeasuredStrip {
    /// Free length, mm.
    pub length_mm: Option<Measured>,
    /// Where a displacement is seen, mm ahead of the clamp.
    pub seen_at_mm: Option<Measured>,
    /// Width, mm.
    pub width_mm: Option<Measured>,
    /// Thickness, mm.
    pub thickness_mm: Option<Measured>,
    /// Modulus, MPa.
    pub modulus_mpa: Option<Measured>,
    /// Distance of the neutral layer from the centroid, mm.
    pub neutral_layer_shift_mm: Option<Measured>,
    /// Mean elongation, a share.
    pub mean_elongation: Option<Measured>,
}

impl MeasuredStrip {
    fn inputs(&mut self) -> [&mut Option<Measured>; 7] {
        [
            &mut self.length_mm,
            &mut self.seen_at_mm,
            &mut self.width_mm,
            &mut self.thickness_mm,
            &mut self.modulus_mpa,
            &mut self.neutral_layer_shift_mm,
            &mut self.mean_elongation,
        ]
    }

    fn known(&self) -> KnownStrip {
        let value = |measured: Option<Measured>| measured.map(|m| m.value);
        KnownStrip {
            length_mm: value(self.length_mm),
            seen_at_mm: value(self.seen_at_mm),
            width_mm: value(self.width_mm),
            thickness_mm: value(self.thickness_mm),
            modulus_mpa: value(self.modulus_mpa),
            neutral_layer_shift_mm: value(self.neutral_layer_shift_mm).unwrap_or(0.0),
            mean_elongation: value(self.mean_elongation).unwrap_or(0.0),
        }
    }

    fn check(&self) -> Result<(), PipelineError> {
        let lengths = [
            ("--length", self.length_mm),
            ("--at", self.seen_at_mm),
            ("--width", self.width_mm),
            ("--thickness", self.thickness_mm),
            ("--modulus", self.modulus_mpa),
        ];
        for (what, measured) in lengths {
            if let Some(measured) = measured.filter(|m| m.value <= 0.0) {
                return Err(PipelineError::bad_argument(
                    what,
                    measured.value.to_string(),
                    "a positive number",
                ));
            }
        }
        Ok(())
    }
}

/// What a conversion gives.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ConversionDocument {
    /// Always `ieap/convert/1`.
    pub schema: &'static str,
    /// Key of the measure that was given.
    pub given: &'static str,
    /// Its value, in the unit of its key.
    pub value: f64,
    /// Its standard error; null where none was stated.
    pub standard_error: Option<f64>,
    /// Every measure by its key.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub values: Vec<(String, Estimate)>,
    /// What the formulas do not hold for, and how near that is here.
    pub remarks: Vec<String>,
}

/// Converts `NAME=VALUE`, the value with its unit, on that strip.
///
/// # Errors
/// The measure or its value cannot be read, or no circle has such a bending.
pub fn convert(given: &str, strip: &MeasuredStrip) -> Result<ConversionDocument, PipelineError> {
    strip.check()?;
    let names = Bending::ALL.map(name).join(", ");
    let parts = given.split_once('=');
    let found = parts.and_then(|(typed, text)| {
        let typed = typed.trim().replace('_', "-");
        let bending = Bending::ALL.into_iter().find(|own| name(*own) == typed);
        Some((bending?, text))
    });
    let Some((bending, text)) = found else {
        let needed = format!("one of {names}, then = and the value with its unit: displacement=1.2mm");
        return Err(PipelineError::bad_argument(
            "what is converted",
            format!("{given:?}"),
            &needed,
        ));
    };
    let (kind, key, scale) = stated(bending);
    let typed = kind.parse(text).map_err(|error| PipelineError::Typed {
        what: name(bending),
        error,
    })?;
    let curvature = |strip: &MeasuredStrip, value| strip.known().to_curvature(bending, value);
    let curvature_per_cm = curvature(strip, typed.value)
        .map_err(|error| PipelineError::bad_argument(name(bending), text.to_owned(), needed(error)))?;
    let values = Bending::ALL.into_iter().map(|wanted| {
        let (_, key, scale) = stated(wanted);
        let at = |strip: &MeasuredStrip, value| {
            let curvature_per_cm = curvature(strip, value)?;
            let number = strip.known().from_curvature(wanted, curvature_per_cm)?;
            Ok(number * scale)
        };
        (key.to_owned(), estimate(strip, typed, at))
    });
    let mut document = ConversionDocument {
        schema: "ieap/convert/1",
        given: key,
        value: typed.value * scale,
        standard_error: (typed.standard_error > 0.0).then_some(typed.standard_error * scale),
        values: values.collect(),
        remarks: remarks(&strip.known(), curvature_per_cm),
    };
    small(strip, curvature_per_cm, &mut document.values);
    Ok(document)
}

fn needed(error: ConversionError) -> String {
    match error {
        ConversionError::Needs(what) => format!("{what} beside it, as an option"),
        other => other.to_string(),
    }
}

/// The number with the errors of the value and of every dimension, to first order and independent of each other.
fn estimate(
    strip: &MeasuredStrip,
    typed: Measured,
    at: impl Fn(&MeasuredStrip, f64) -> Result<f64, ConversionError>,
) -> Estimate {
    let value = match at(strip, typed.value) {
        Ok(value) if value.is_finite() => value,
        Ok(_) => return Estimate::not_determined("the strip is straight"),
        Err(error) => return Estimate::not_determined(error.to_string()),
    };
    let half = |up: Result<f64, ConversionError>, down: Result<f64, ConversionError>| match (up, down) {
        (Ok(up), Ok(down)) => 0.5 * (up - down),
        // At an end of what a formula holds for, one side is all there is.
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => one - value,
        (Err(_), Err(_)) => 0.0,
    };
    let error = typed.standard_error;
    let mut variance = half(at(strip, typed.value + error), at(strip, typed.value - error)).powi(2);
    let mut changed = *strip;
    for k in 0..changed.inputs().len() {
        let Some(dimension) = *changed.inputs()[k] else {
            continue;
        };
        let mut with = |sign: f64| {
            *changed.inputs()[k] = Some(Measured::exact(dimension.value + sign * dimension.standard_error));
            let found = at(&changed, typed.value);
            *changed.inputs()[k] = Some(dimension);
            found
        };
        variance += half(with(1.0), with(-1.0)).powi(2);
    }
    if variance == 0.0 {
        return Estimate::exact(value);
    }
    let error = variance.sqrt();
    Estimate::determined(value, error, value - NORMAL_95 * error, value + NORMAL_95 * error)
}

/// The approximation for small bending beside the exact strain difference, where the two differ.
fn small(strip: &MeasuredStrip, curvature_per_cm: f64, values: &mut Vec<(String, Estimate)>) {
    let known = strip.known();
    let without = KnownStrip {
        mean_elongation: 0.0,
        ..known
    };
    if known.mean_elongation == 0.0 {
        return;
    }
    let number = without.from_curvature(Bending::StrainDifference, curvature_per_cm);
    let estimate = match number {
        Ok(number) => Estimate::exact(100.0 * number),
        Err(error) => Estimate::not_determined(error.to_string()),
    };
    let after = values
        .iter()
        .position(|(key, _)| key == "strain_difference_percent");
    let place = after.map_or(values.len(), |at| at + 1);
    values.insert(place, ("strain_difference_small_percent".to_owned(), estimate));
}

fn remarks(strip: &KnownStrip, curvature_per_cm: f64) -> Vec<String> {
    let mut remarks = vec![
        "All measures take the strip as one circle: a strip that bends unevenly along its length has no one curvature."
            .to_owned(),
    ];
    let turn = strip
        .length_mm
        .map(|length| (curvature_per_cm / 10.0 * length).abs());
    if let Some(turn) = turn.filter(|turn| *turn > FURTHEST_TURN_RAD) {
        remarks.push(format!(
            "The tip has turned by {} degrees and comes back: this tip displacement belongs to a smaller curvature too.",
            fixed(turn * DEG, 0)
        ));
    }
    let thin = strip
        .thickness_mm
        .map(|thickness| (curvature_per_cm / 10.0 * thickness).abs());
    if let Some(share) = thin.filter(|share| *share > THIN) {
        remarks.push(format!(
            "Thickness times curvature is {}: moment, energy and strains are those of a thin strip, below {THIN}.",
            fixed(share, 2)
        ));
    }
    if strip.mean_elongation == 0.0 && strip.thickness_mm.is_some() {
        remarks.push(
            "No mean elongation is given (--elongation): exact and small strain difference are then the same.".to_owned(),
        );
    }
    if strip.modulus_mpa.is_some() && strip.neutral_layer_shift_mm == 0.0 {
        remarks.push(
            "The neutral layer is taken in the middle (--neutral-shift); at the surface moment and energy are four times as large."
                .to_owned(),
        );
    }
    if let Some(thickness_mm) = strip.thickness_mm.filter(|_| strip.neutral_layer_shift_mm != 0.0) {
        let layer = |from_neutral_mm: f64| 10.0 * curvature_per_cm * from_neutral_mm;
        let shift_mm = strip.neutral_layer_shift_mm;
        remarks.push(format!(
            "The bending strain is that about the middle of the thickness. With the neutral layer {shift_mm} mm beside it the outer layers are strained by {} and {} %; their difference is the same, and the middle is strained by {} % (--elongation).",
            fixed(layer(0.5 * thickness_mm + shift_mm), 3),
            fixed(layer(shift_mm - 0.5 * thickness_mm), 3),
            fixed(layer(shift_mm), 3)
        ));
    }
    remarks
}

#[cfg(test)]
mod tests;
