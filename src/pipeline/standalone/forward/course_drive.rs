//! The verb `drive`: which voltage brings the tip to a wanted course, open loop.

use schemars::JsonSchema;
use serde::Serialize;

use super::asked::AskedStrip;
use super::document::{DriveEntry, StripEntry, Told, as_entry};
use super::grounds::{Grounds, applied_until};
use super::predict::{model_word, remarks};
use super::source::LeftOutEntry;
use crate::analysis::forecast::Forecast;
use crate::domain::number::fixed;
use crate::domain::typed_value::Measured;
use crate::domain::{Drive, Estimate};
use crate::model::course::{Course, Pulses, VoltageLimits, WantedAt, course, response};
use crate::model::geometry::conversion::{curvature_from_tip, tip_displacement_mm};
use crate::pipeline::{Context, PipelineError};

/// Samples of the voltage, unless asked otherwise, and at most: the search takes their square.
const SAMPLES: f64 = 200.0;
const MOST_SAMPLES: f64 = 600.0;
/// Rounds in which the tip is taken to follow the curvature as it does at the course found before.
const ROUNDS: usize = 12;
/// Part of the squared error that a round has to take off for another one.
const WORTH: f64 = 1e-5;
/// Part of the largest voltage by which two typical voltages differ that the same runs speak of.
const SAME_VOLTAGE: f64 = 0.01;
/// Nearness at which a wanted displacement counts as reached, as a share of the largest wanted one.
const REACHED: f64 = 0.05;
/// Rows of the text and the document at most.
const ROWS: usize = 25;

/// A course of the tip.
#[derive(Debug, Clone, PartialEq)]
pub enum Wanted {
    /// Rows of time, s, and displacement, mm, straight between them.
    Course(Vec<(f64, f64)>),
    /// One displacement, mm, for a time, s.
    Hold {
        /// Displacement, mm.
        tip_mm: f64,
        /// For how long, s.
        for_s: f64,
    },
}

impl Wanted {
    fn end_s(&self) -> f64 {
        match self {
            Wanted::Course(rows) => rows.last().map_or(0.0, |row| row.0),
            Wanted::Hold { for_s, .. } => *for_s,
        }
    }

    fn at(&self, time_s: f64) -> f64 {
        let rows = match self {
            Wanted::Hold { tip_mm, .. } => return *tip_mm,
            Wanted::Course(rows) => rows,
        };
        let after = rows.partition_point(|row| row.0 <= time_s);
        match (after.checked_sub(1).map(|k| rows[k]), rows.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (time_s - a.0) / (b.0 - a.0),
            (Some(only), None) => only.1,
            (None, first) => first.map_or(0.0, |first| first.1),
        }
    }
}

/// Which drive is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveCourse {
    /// The strip, and which runs tell.
    pub strip: AskedStrip,
    /// What its tip shall do.
    pub wanted: Wanted,
    /// Time between changes of the voltage, s; none: a two-hundredth of the course.
    pub every_s: Option<f64>,
    /// Largest voltage of either sign, V; none: the largest that was measured.
    pub max_voltage_v: Option<f64>,
    /// Largest rate of change, V/s; none: it may jump.
    pub max_slope_v_per_s: Option<f64>,
    /// Onset of electrolysis, V; none: as a diagnosis found it.
    pub onset_v: Option<Measured>,
}

/// The drive found.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DriveDocument {
    /// Always `ieap/drive/2`.
    pub schema: &'static str,
    /// Sample whose laminate it is.
    pub sample: String,
    /// Environment.
    pub environment: String,
    /// The strip.
    pub strip: StripEntry,
    /// `lumped` or `distributed`.
    pub model: &'static str,
    /// Largest voltage that was allowed, V.
    pub voltage_limit_v: f64,
    /// What set it.
    pub limited_by: String,
    /// The drive: what the source is to hold from each start on.
    #[serde(serialize_with = "as_entry")]
    #[schemars(with = "DriveEntry")]
    pub drive: Drive,
    /// End of the course, s.
    pub end_s: f64,
    /// Wanted and reached at some times.
    pub rows: Vec<ReachedRow>,
    /// The same at every sample, for the figure.
    #[serde(skip)]
    pub course: Vec<ReachedRow>,
    /// Root mean square of reached minus wanted over the course, mm.
    pub rms_error_mm: f64,
    /// What no voltage within the limits goes below, to first order about the course found, mm.
    pub least_rms_error_mm: f64,
    /// Largest difference, mm.
    pub largest_error_mm: f64,
    /// When the tip first comes near to what is wanted, s; null where it never does.
    pub reached_after_s: Option<f64>,
    /// For how long of the course it is near, s.
    pub near_for_s: f64,
    /// Charge that flows through the leak, either way, C.
    pub leaked_charge_c: Forecast,
    /// Runs that it is made from.
    pub sources: Vec<Told>,
    /// Runs in the same surroundings that tell nothing.
    pub left_out: Vec<LeftOutEntry>,
    /// What the intervals hold and what is missing for more.
    pub remarks: Vec<String>,
}

/// Wanted and reached at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct ReachedRow {
    /// Time, s.
    pub time_s: f64,
    /// Voltage held until then, V.
    pub voltage_v: f64,
    /// Wanted displacement of the tip, mm.
    pub wanted_mm: f64,
    /// Expected displacement.
    pub reached_mm: Forecast,
}

impl DriveCourse {
    /// Looks for the drive.
    ///
    /// # Errors
    /// No run tells how the strip bends, the wanted course or a limit makes no sense, or the database cannot be read.
    pub fn run(&self, context: &Context) -> Result<DriveDocument, PipelineError> {
        let grounds = Grounds::of(context, &self.strip)?;
        if !grounds.bends() {
            let found = format!("{:?}, whose runs do not tell how it bends", grounds.sample.id);
            return Err(PipelineError::bad_argument(
                "--sample",
                found,
                "runs with a curvature or a displacement",
            ));
        }
        let end_s = self.wanted.end_s();
        let every_s = self.every_s.unwrap_or(end_s / SAMPLES);
        let possible = end_s > 0.0 && every_s > 0.0 && end_s / every_s <= MOST_SAMPLES && every_s <= end_s;
        if !possible {
            let needed = format!("a course of 1 to {MOST_SAMPLES} samples");
            return Err(PipelineError::bad_argument(
                "--every",
                format!("{every_s} s for a course of {end_s} s"),
                &needed,
            ));
        }
        let samples = (end_s / every_s).round() as usize;
        let times: Vec<f64> = (1..=samples).map(|k| every_s * k as f64).collect();
        let wanted: Vec<f64> = times.iter().map(|time| self.wanted.at(*time)).collect();
        let (limit_v, limited_by) = self.limit(&grounds)?;
        let limits = VoltageLimits {
            lowest_v: -limit_v,
            highest_v: limit_v,
            change_v: self
                .max_slope_v_per_s
                .map_or(f64::INFINITY, |slope| slope * every_s),
            from_v: 0.0,
        };
        let (drive, least_square) = search(&grounds, &wanted, &times, &limits, every_s)?;
        let forecasts = grounds.forecasts(&drive, &times)?;
        let row = |(k, time_s): (usize, &f64)| ReachedRow {
            time_s: *time_s,
            voltage_v: drive.segments[k].level.volts().unwrap_or(0.0),
            wanted_mm: wanted[k],
            reached_mm: forecasts.tip_displacement_mm[k],
        };
        let course: Vec<ReachedRow> = times.iter().enumerate().map(row).collect();
        let misses: Vec<f64> = course
            .iter()
            .map(|row| row.reached_mm.value - row.wanted_mm)
            .collect();
        let near = REACHED * wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let first = misses.iter().position(|miss| miss.abs() <= near);
        let within = misses.iter().filter(|miss| miss.abs() <= near).count();
        let leaked = forecasts.leaked_charge_c.last().copied();
        let leaked_charge_c = leaked
            .ok_or_else(|| PipelineError::bad_argument("--for", "0 s".to_owned(), "a longer course"))?;
        let mut remarks = remarks(&grounds, &forecasts, &drive);
        remarks.retain(|remark| !remark.contains("locked moment"));
        if end_s > grounds.longest_s() {
            remarks.push(format!(
                "The course is longer than the longest run ({} s): nothing was seen after that.",
                fixed(grounds.longest_s(), 0)
            ));
        }
        let step = (samples / ROWS).max(1);
        Ok(DriveDocument {
            schema: "ieap/drive/2",
            sample: grounds.sample.id.clone(),
            environment: grounds.environment.clone(),
            strip: StripEntry::of(&grounds),
            model: model_word(&forecasts),
            voltage_limit_v: limit_v,
            limited_by,
            drive,
            end_s,
            rows: course.iter().skip(step - 1).step_by(step).copied().collect(),
            rms_error_mm: (misses.iter().map(|miss| miss * miss).sum::<f64>() / samples as f64).sqrt(),
            least_rms_error_mm: (least_square / samples as f64).sqrt(),
            largest_error_mm: misses.iter().fold(0.0, |most, miss| most.max(miss.abs())),
            reached_after_s: first.map(|k| times[k]),
            near_for_s: every_s * within as f64,
            leaked_charge_c,
            sources: Told::all(&grounds),
            left_out: grounds.left_out.clone(),
            course,
            remarks,
        })
    }

    /// The largest voltage allowed, and what sets it: the option, what was measured, the onset of electrolysis.
    fn limit(&self, grounds: &Grounds) -> Result<(f64, String), PipelineError> {
        let positive = |what: &'static str, value: Option<f64>| match value.filter(|value| *value <= 0.0) {
            Some(value) => Err(PipelineError::bad_argument(
                what,
                value.to_string(),
                "a positive number",
            )),
            None => Ok(()),
        };
        positive("--max-voltage", self.max_voltage_v)?;
        positive("--max-slope", self.max_slope_v_per_s)?;
        positive("--onset", self.onset_v.map(|onset| onset.value))?;
        let (low_v, high_v) = grounds.measured_v();
        let mut limit = match self.max_voltage_v {
            Some(volts) => (volts, "--max-voltage".to_owned()),
            None => (
                low_v.abs().max(high_v.abs()),
                "the largest voltage that was measured (--max-voltage allows another)".to_owned(),
            ),
        };
        let given = self
            .onset_v
            .map(|onset| (onset.value, "the onset of electrolysis given".to_owned()));
        let found = || grounds.onset_v.as_ref().and_then(onset_found);
        if let Some(onset) = given.or_else(found).filter(|onset| onset.0 < limit.0) {
            limit = onset;
        }
        Ok(limit)
    }
}

/// The lower end of the onset that a diagnosis found: below it nothing was seen to leak.
fn onset_found(onset: &Estimate) -> Option<(f64, String)> {
    let low = onset.low_95.or(onset.value).filter(|low| *low > 0.0)?;
    Some((
        low,
        format!(
            "the onset of electrolysis that the diagnosis found, {} V, at the lower end of its interval (--onset sets another)",
            fixed(onset.value?, 2)
        ),
    ))
}

fn drive_of(course_v: &[f64], every_s: f64) -> Drive {
    let level = |(k, volts): (usize, &f64)| (every_s * k as f64, Some(*volts));
    Drive::of_levels(0.0, course_v.iter().enumerate().map(level))
}

/// The drive whose tip comes nearest to the wanted course, and the sum of squared errors, mm2, that no other within the
/// limits goes below. The curvature follows the voltage linearly; the tip does not follow the curvature so, and is taken
/// to first order about the course found before (Gauss-Newton).
fn search(
    grounds: &Grounds,
    wanted: &[f64],
    times: &[f64],
    limits: &VoltageLimits,
    every_s: f64,
) -> Result<(Drive, f64), PipelineError> {
    let length_mm = grounds.to.length_mm.value;
    let (mut reference_v, mut best): (f64, Option<(f64, Drive)>) = (limits.highest_v, None);
    let mut pulses = pulses(grounds, times, (reference_v, every_s))?;
    let mut asked = bent(wanted, length_mm)?;
    let slopes = |curvatures: &[f64]| -> Vec<f64> {
        let slope = |curvature: &f64| tip_slope(*curvature, length_mm);
        curvatures.iter().map(slope).collect()
    };
    let (mut weight, mut least_square) = (slopes(&asked), 0.0);
    // Whether the tip is taken about a course that was found, and no longer about the wanted one.
    let mut about_found = false;
    for _ in 0..ROUNDS {
        let at = WantedAt {
            value: &asked,
            weight: &weight,
        };
        let Course {
            voltage_v,
            least_square: possible,
        } = course(&pulses, at, limits);
        let drive = drive_of(&voltage_v, every_s);
        let (curvature, tip) = grounds.centre(&drive, times)?;
        let miss: f64 = tip
            .iter()
            .zip(wanted)
            .map(|(tip, wanted)| (tip - wanted).powi(2))
            .sum();
        let typical_v = applied_until(&drive, times).typical_v;
        let improved = best
            .as_ref()
            .is_none_or(|(least, _)| miss < (1.0 - WORTH) * least);
        if improved {
            best = Some((miss, drive));
        }
        // Runs at other voltages tell of a drive with another typical one: only else is there something to mend.
        if (typical_v - reference_v).abs() > SAME_VOLTAGE * limits.highest_v && typical_v != 0.0 {
            reference_v = typical_v;
            pulses = self::pulses(grounds, times, (reference_v, every_s))?;
            continue;
        }
        least_square = possible;
        if !improved && about_found {
            break;
        }
        about_found = true;
        weight = slopes(&curvature);
        // From what the pulses add up to: what they leave of the course found stays as it is.
        let linear = response(&pulses, &voltage_v);
        for k in 0..asked.len() {
            asked[k] = linear[k] + (wanted[k] - tip[k]) / weight[k];
        }
    }
    best.map(|(miss, drive)| (drive, least_square.min(miss)))
        .ok_or_else(|| PipelineError::bad_argument("--for", "0 s".to_owned(), "a longer course"))
}

/// What a volt held in a sample makes of the curvature from then on, 1/(cm V), told by steps of that voltage: one from the
/// beginning, or of a strip that changes meanwhile one from each sample.
fn pulses(
    grounds: &Grounds,
    times: &[f64],
    (reference_v, every_s): (f64, f64),
) -> Result<Pulses, PipelineError> {
    let from = |k: usize| -> Result<Vec<f64>, PipelineError> {
        let step = Drive::of_levels(0.0, [(every_s * k as f64, Some(reference_v))]);
        Ok(grounds.centre(&step, times)?.0)
    };
    if !grounds.changes() {
        let step = from(0)?;
        let before = std::iter::once(0.0).chain(step.iter().copied());
        let pulse = step
            .iter()
            .zip(before)
            .map(|(now, before)| (now - before) / reference_v);
        return Ok(Pulses::alike(&pulse.collect::<Vec<f64>>()));
    }
    let steps: Vec<Vec<f64>> = (0..times.len()).map(from).collect::<Result<_, _>>()?;
    let next = steps.iter().skip(1).map(Some).chain([None]);
    let answer = |(k, (own, next)): (usize, (&Vec<f64>, Option<&Vec<f64>>))| {
        let after = |j: usize| next.map_or(0.0, |next| next[j]);
        (k..times.len())
            .map(|j| (own[j] - after(j)) / reference_v)
            .collect()
    };
    Ok(Pulses::of(
        steps.iter().zip(next).enumerate().map(answer).collect(),
    ))
}

/// Curvatures, 1/cm, at which a strip that bends evenly has its tip where it is wanted, mm.
fn bent(wanted: &[f64], length_mm: f64) -> Result<Vec<f64>, PipelineError> {
    let farthest = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    let at = |tip_mm: &f64| {
        curvature_from_tip(*tip_mm, length_mm).ok_or_else(|| {
            let needed = format!(
                "at most {} mm: farther no strip of {length_mm} mm bends its tip aside",
                fixed(0.7246 * length_mm, 2)
            );
            PipelineError::bad_argument("the wanted displacement", format!("{farthest} mm"), &needed)
        })
    };
    wanted.iter().map(at).collect()
}

/// By how much the tip of a strip goes with its curvature, mm cm; at least a tenth of that of a straight one, so that
/// one step never asks for more than there is.
fn tip_slope(curvature_per_cm: f64, length_mm: f64) -> f64 {
    let small = 1e-3 / length_mm;
    let (up, down) = (curvature_per_cm + small, curvature_per_cm - small);
    let slope = (tip_displacement_mm(up, length_mm) - tip_displacement_mm(down, length_mm)) / (2.0 * small);
    slope.max(0.1 * length_mm * length_mm / 20.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wanted_course_goes_straight_between_its_rows_and_holds_at_its_ends() {
        let course = Wanted::Course(vec![(10.0, 0.0), (20.0, 1.0), (30.0, 1.0)]);
        for (time, wanted) in [
            (0.0, 0.0),
            (10.0, 0.0),
            (15.0, 0.5),
            (20.0, 1.0),
            (29.0, 1.0),
            (40.0, 1.0),
        ] {
            assert!((course.at(time) - wanted).abs() < 1e-12, "{time}");
        }
        assert_eq!(course.end_s(), 30.0);
    }
}
