//! The verb `predict`.

use super::asked::AskedStrip;
use super::document::{PredictionDocument, ShapeEntry, StripEntry, Told, rows};
use super::grounds::{Forecasts, Grounds};
use crate::domain::Drive;
use crate::domain::number::seconds::seconds;
use crate::domain::number::{fixed, percent};
use crate::model::distributed::criterion::LUMPED_TOLERANCE;
use crate::model::scaling::CarriedBy;
use crate::model::scaling::prediction::largest_electrode_resistance;
use crate::pipeline::{Context, PipelineError};

/// Times of a course that are evenly spaced, and those that are so in their logarithm.
const EVEN_TIMES: usize = 80;
const LOGARITHMIC_TIMES: usize = 60;
/// Shortest of them over the longest.
const SHORTEST: f64 = 1e-4;
/// A length is another where it differs by more than this part: rounding.
const LONGER: f64 = 1.01;

/// What is to be predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Predict {
    /// The strip, and which runs tell.
    pub strip: AskedStrip,
    /// The drive.
    pub drive: Drive,
    /// Times at which numbers are asked for, s; empty: some between the first second and the longest run.
    pub at_s: Vec<f64>,
}

impl Predict {
    /// Predicts from the stored fits.
    ///
    /// # Errors
    /// No run tells, the strip is of another laminate, a time cannot be, or the database cannot be read.
    pub fn run(&self, context: &Context) -> Result<PredictionDocument, PipelineError> {
        let grounds = Grounds::of(context, &self.strip)?;
        let longest_s = grounds.longest_s();
        let at_s = if self.at_s.is_empty() {
            some_times(longest_s)
        } else {
            self.at_s.clone()
        };
        if let Some(time) = at_s.iter().find(|time| !time.is_finite() || **time < 0.0) {
            return Err(PipelineError::BadArgument {
                what: "--at",
                found: time.to_string(),
                needed: "times in s from the start of the drive on".to_owned(),
            });
        }
        let end_s = at_s.iter().copied().fold(0.0, f64::max);
        let mut times = course_times(&self.drive, end_s);
        times.extend(&at_s);
        times.sort_by(f64::total_cmp);
        times.dedup();
        let forecasts = grounds.forecasts(&self.drive, &times)?;
        let course = rows(&grounds, &forecasts, &times);
        let place = |time: &f64| times.iter().position(|known| known == time);
        let places: Vec<usize> = at_s.iter().filter_map(place).collect();
        let shape = |&k: &usize| ShapeEntry::at(&grounds, &forecasts, k, times[k]);
        let mut remarks = remarks(&grounds, &forecasts, &self.drive);
        if end_s > longest_s {
            remarks.push(format!(
                "Times after {} s lie beyond the longest run: nothing was seen there.",
                seconds(longest_s)
            ));
        }
        Ok(PredictionDocument {
            schema: "ieap/prediction/2",
            sample: grounds.sample.id.clone(),
            material: grounds.sample.material.clone(),
            environment: grounds.environment.clone(),
            relative_humidity_percent: grounds.humidity_percent,
            strip: StripEntry::of(&grounds),
            drive: self.drive.clone(),
            model: model_word(&forecasts),
            lumped_error_at_tip: forecasts.lumped_error,
            rows: places.iter().map(|&k| course[k].clone()).collect(),
            shapes: places.iter().filter_map(shape).collect(),
            course,
            brought: grounds.brought.0.clone(),
            sources: Told::all(&grounds),
            left_out: grounds.left_out.clone(),
            remarks,
        })
    }
}

pub(super) fn model_word(forecasts: &Forecasts) -> &'static str {
    match forecasts.carried_by {
        CarriedBy::Distributed => "distributed",
        CarriedBy::Lumped => "lumped",
    }
}

/// 1, 3, 10, ... s up to the longest run.
fn some_times(longest_s: f64) -> Vec<f64> {
    let decades = (0..8).flat_map(|decade| [1.0, 3.0].map(|first: f64| first * 10f64.powi(decade)));
    let within: Vec<f64> = decades.filter(|time| *time <= longest_s).collect();
    if within.is_empty() {
        vec![longest_s]
    } else {
        within
    }
}

/// Times that show a course from the start of the drive to its end.
pub(super) fn course_times(drive: &Drive, end_s: f64) -> Vec<f64> {
    let even = (0..=EVEN_TIMES).map(|k| end_s * k as f64 / EVEN_TIMES as f64);
    let part = |k: usize| SHORTEST.powf(1.0 - k as f64 / LOGARITHMIC_TIMES as f64);
    let logarithmic = (0..LOGARITHMIC_TIMES).map(|k| end_s * part(k));
    let edges = drive.edges_s();
    let within = edges.into_iter().filter(|edge| (0.0..=end_s).contains(edge));
    even.chain(logarithmic).chain(within).collect()
}

/// What the intervals hold, what they leave out, and what would tell more.
pub(super) fn remarks(grounds: &Grounds, forecasts: &Forecasts, drive: &Drive) -> Vec<String> {
    let mut remarks = vec![model_in_words(grounds, forecasts)];
    let of_laws = grounds.own().find(|source| !source.laws.is_empty());
    remarks.extend(of_laws.map(|source| {
        format!(
            "Fitted with {}: its laws act under this drive as under those that they were found from.",
            source.fitted_with
        )
    }));
    remarks.extend(grounds.brought.1.iter().cloned());
    let (low_v, high_v) = grounds.measured_v();
    let step_v = drive.nominal_step_v();
    let near_v = 0.02 * low_v.abs().max(high_v.abs());
    if step_v < low_v - near_v || step_v > high_v + near_v {
        let taken = match of_laws {
            Some(_) => "the laws are taken on",
            None => "the runs at the nearest voltage are taken",
        };
        remarks.push(format!(
            "{} V lies outside what was measured ({} to {} V): {taken}, and what sets in beyond is not known.",
            volts(step_v),
            volts(low_v),
            volts(high_v)
        ));
    }
    if let Some(first) = forecasts.current_a.last() {
        let parts = first.standard_deviation;
        if parts.voltages.is_none() {
            remarks.push(
                "Only one voltage was measured: that the strip answers others in proportion is taken for granted, and no interval holds what it does otherwise."
                    .to_owned(),
            );
        }
        if parts.runs.is_none() {
            remarks.push(
                "No run was repeated: how a run differs from the one before is not in the intervals."
                    .to_owned(),
            );
        }
        if grounds.is_another && parts.samples.is_none() {
            remarks.push(format!(
                "Only one sample of {} was measured: how strips of it differ is not in the intervals.",
                grounds.sample.material
            ));
        }
    }
    remarks.push(grounds.misfit.source.clone());
    for key in ["rss_ohm_cm2", "lambda_per_s"] {
        let bounded = grounds
            .sources
            .iter()
            .filter(|source| source.bounded.iter().any(|b| b == key));
        let runs: Vec<&str> = bounded.map(|source| source.run.as_str()).collect();
        if !runs.is_empty() {
            remarks.push(format!(
                "Of {key} only a bound is known in {}: it is taken anywhere within.",
                runs.join(", ")
            ));
        }
    }
    if !grounds.bends() {
        remarks.push(
            "No run of the sample tells how it bends: curvature, shape and tip are not predicted.".to_owned(),
        );
    } else {
        remarks.push(modulus_in_words(grounds));
    }
    remarks
}

/// A voltage with as many decimals as it has, four at most.
fn volts(volts: f64) -> f64 {
    (1e4 * volts).round() / 1e4
}

fn modulus_in_words(grounds: &Grounds) -> String {
    let modulus = &grounds.modulus;
    match (&modulus.modulus_mpa.value, &grounds.to.thickness_mm) {
        (Some(value), Some(_)) => format!(
            "Blocked moment: E = {} MPa, {}.",
            fixed(*value, 0),
            modulus.source
        ),
        (Some(_), None) => "No blocked moment: the thickness is not known; give --thickness.".to_owned(),
        (None, _) => format!(
            "No blocked moment: {}.",
            modulus
                .modulus_mpa
                .reason
                .as_deref()
                .unwrap_or("the modulus is not known")
        ),
    }
}

/// Which model carries over, by the criterion of the electrodes' resistance.
fn model_in_words(grounds: &Grounds, forecasts: &Forecasts) -> String {
    let length_mm = grounds.to.length_mm.value;
    match (forecasts.carried_by, forecasts.lumped_error) {
        (CarriedBy::Distributed, Some(error)) => format!(
            "Distributed model: at {length_mm} mm the lumped one would be wrong by up to {} at the tip, for the electrodes resist along the strip.",
            percent(error, 1)
        ),
        (_, Some(error)) => format!(
            "Lumped model: at {length_mm} mm it is wrong by at most {} at the tip.",
            percent(error, 1)
        ),
        (_, None) if length_mm <= LONGER * grounds.from.length_mm.value => {
            "Lumped model: the strip is no longer than the one that was fitted.".to_owned()
        }
        (_, None) => {
            let most = grounds
                .sources
                .iter()
                .map(|source| largest_electrode_resistance(&source.model, &grounds.to, LUMPED_TOLERANCE));
            format!(
                "Lumped model, and whether it carries over to {length_mm} mm is not known: it does where both electrodes together resist less than {} Ohm per square along the strip. Measure that with a four-point probe and state it (electrode_resistance_ohm_per_sq of the sample, or --electrode-resistance): then the distributed model is taken where it is needed.",
                fixed(most.fold(f64::INFINITY, f64::min), 2)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_reach_from_the_first_second_to_the_end() {
        assert_eq!(some_times(700.0), [1.0, 3.0, 10.0, 30.0, 100.0, 300.0]);
        assert_eq!(some_times(0.4), [0.4]);
        let times = course_times(&Drive::step(1.0), 100.0);
        assert!(times.contains(&0.0) && times.contains(&100.0));
        assert!(times.iter().all(|time| (0.0..=100.0).contains(time)));
    }
}
