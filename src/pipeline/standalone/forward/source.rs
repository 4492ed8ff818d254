//! A fitted run as a source of predictions: its model, the covariance of its parameters, its strip.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::forecast::Applied;
use crate::diagnose::laws_of;
use crate::domain::quantiles::NORMAL_95;
use crate::domain::{Drive, Estimate, ExtendedPlace, Fit, Level, Quantity, RunCurve, RunRecord};
use crate::fit::EdgeTimes;
use crate::model::changing::Change;
use crate::model::effects::Applied as Law;
use crate::model::scaling::propagation::{ReadAt, covariance, with_values};
use crate::model::scaling::{Identified, StripSize};
use crate::model::{Branch, LumpedModel};

/// Standard deviation of a number that lies anywhere between 0 and 1: what a bound alone says.
const UNIFORM: f64 = 0.288_675_134_594_812_9;

/// A run that tells what its strip's laminate does.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::pipeline::standalone) struct Source {
    /// Path of the run.
    pub run: String,
    /// Model that it is fitted with.
    pub fitted_with: String,
    /// Sample by number; 0 is the one asked for.
    pub sample: usize,
    /// Typical voltage of its drive, V.
    pub step_v: f64,
    /// Keys of the model's parameters, in the order of the covariance.
    pub keys: Vec<String>,
    /// The model of its strip.
    pub model: LumpedModel,
    /// Laws that were found beside it in its group; empty where none was adopted.
    pub laws: Vec<Law>,
    /// Models that the laws allow as well which brought it to the conditions asked for.
    pub variants: Vec<LumpedModel>,
    /// How the parameters change under the drive: those of the model, and of each variant; empty where they do not.
    pub changes: Vec<Change>,
    pub variant_changes: Vec<Vec<Change>>,
    /// Covariance of the model's parameters.
    pub covariance: Vec<f64>,
    /// Its strip.
    pub size: StripSize,
    /// Resistance of the electrodes that its fit found, Ohm per square.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Whether its bending is known.
    pub bends: bool,
    /// Its last reading, s after the drive began.
    pub lasted_s: f64,
    /// Parameters of which only a bound is known.
    pub bounded: Vec<String>,
}

/// A run that tells nothing.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LeftOutEntry {
    /// Path of the run.
    pub run: String,
    /// Why.
    pub reason: String,
}

impl Source {
    /// The run as one, or why it tells nothing.
    pub fn of(
        run: &RunRecord,
        curves: &[RunCurve],
        sample: usize,
        size: &StripSize,
    ) -> Result<Source, String> {
        let fit = run.fit.as_ref().ok_or("it has no fit")?;
        let drive = run.drive.as_ref().ok_or("its drive is not known")?;
        if let Some(place) = &fit.extended {
            return Source::of_group(run, place, drive, curves, sample, size);
        }
        if fit.is_of_group() {
            return Err(format!(
                "its fit with {} is of an earlier version, which did not store where its laws lie: `ieap run --only fit` makes it again",
                fit.model
            ));
        }
        let read = Read::of(fit)?;
        let (lasted_s, step_v) = shown(drive, curves);
        Ok(Source {
            run: run.path.clone(),
            fitted_with: fit.model.clone(),
            sample,
            step_v,
            covariance: correlated(fit, &read, drive, run.area_cm2.unwrap_or(1.0), curves),
            keys: read.keys,
            model: read.model,
            laws: Vec::new(),
            variants: Vec::new(),
            changes: Vec::new(),
            variant_changes: Vec::new(),
            size: *size,
            electrode_resistance_ohm_per_sq: fit.parameter("re_ohm_per_sq").and_then(|e| e.value),
            bends: read.bends,
            lasted_s,
            bounded: read.bounded,
        })
    }

    /// A run of a group that was fitted with laws: with the place of the whole model.
    fn of_group(
        run: &RunRecord,
        place: &ExtendedPlace,
        drive: &Drive,
        curves: &[RunCurve],
        sample: usize,
        size: &StripSize,
    ) -> Result<Source, String> {
        // JSON has no endless resistance.
        let base = place
            .base
            .iter()
            .map(|value| if value.is_nan() { f64::INFINITY } else { *value });
        let model = with_values(&base.collect::<Vec<f64>>());
        let branches =
            (1..=model.branches.len()).flat_map(|k| [format!("r{k}_ohm_cm2"), format!("c{k}_f_per_cm2")]);
        let rest = ["rss_ohm_cm2", "alpha_per_c_cm", "lambda_per_s"].map(str::to_owned);
        let (lasted_s, step_v) = shown(drive, curves);
        let laws = laws_of(place)?;
        let of_laws = laws.iter().flat_map(|law| &law.parameters);
        if !place.covariance.iter().chain(of_laws).all(|v| v.is_finite()) {
            return Err("the errors of its laws are not determined".to_owned());
        }
        Ok(Source {
            run: run.path.clone(),
            fitted_with: run.fit.as_ref().map(|fit| fit.model.clone()).unwrap_or_default(),
            sample,
            step_v,
            keys: branches.chain(rest).collect(),
            bends: model.charge_to_curvature_per_c_cm != 0.0,
            model,
            laws,
            variants: Vec::new(),
            changes: Vec::new(),
            variant_changes: Vec::new(),
            covariance: place.covariance.clone(),
            size: *size,
            electrode_resistance_ohm_per_sq: None,
            lasted_s,
            bounded: Vec::new(),
        })
    }

    /// As the model of a strip asks for it, with the electrodes' resistance where it is known.
    pub fn identified(&self, electrode_resistance_ohm_per_sq: Option<f64>) -> Identified<'_> {
        Identified {
            model: &self.model,
            laws: &self.laws,
            covariance: &self.covariance,
            size: &self.size,
            electrode_resistance_ohm_per_sq,
            changes: &self.changes,
        }
    }
}

/// How long a run shows what it does after its drive began, s, and the typical voltage of that, V.
fn shown(drive: &Drive, curves: &[RunCurve]) -> (f64, f64) {
    let start_s = drive.segments.first().map_or(0.0, |segment| segment.start_s());
    let last = |curve: &RunCurve| curve.time_s.last().copied().unwrap_or(start_s);
    let last_s = curves.iter().map(last).fold(start_s, f64::max);
    (last_s - start_s, applied(drive, last_s).typical_v)
}

/// The voltages of a drive up to `end_s`; open circuits, in which the source holds none, do not count.
pub(super) fn applied(drive: &Drive, end_s: f64) -> Applied {
    let ends = drive.segments.iter().skip(1).map(|segment| segment.start_s());
    let (mut lasting_s, mut size, mut square) = (0.0, 0.0, 0.0);
    for (segment, end) in drive.segments.iter().zip(ends.chain([f64::INFINITY])) {
        let span_s = (end.min(end_s) - segment.start_s()).max(0.0);
        if let Level::Voltage(volts) = segment.level {
            lasting_s += span_s;
            size += span_s * volts.abs();
            square += span_s * volts * volts;
        }
    }
    let nominal_v = drive.nominal_step_v();
    if lasting_s <= 0.0 || square <= 0.0 {
        return Applied::step(nominal_v);
    }
    let (mean, typical_v) = (size / lasting_s, (square / lasting_s).sqrt());
    // Mean of (|v| - typical)^2, whose square is 2 typical (typical - mean).
    let strays_v = (2.0 * typical_v * (typical_v - mean)).max(0.0).sqrt();
    Applied {
        typical_v: typical_v.copysign(nominal_v),
        strays_v: if strays_v < 1e-6 * typical_v {
            0.0
        } else {
            strays_v
        },
    }
}

/// Covariance of the parameters that a fit determines: their keys, and a row and a column for each. The standard errors are
/// the fit's; correlations are those that its readings leave, their noise taken as white. None where the fit is not of a
/// lumped model, or has no circuit.
pub fn fitted_covariance(fit: &Fit, drive: &Drive, area_cm2: f64) -> Option<(Vec<String>, Vec<Vec<f64>>)> {
    let read = Read::of(fit)
        .ok()
        .filter(|read| fit.model.starts_with("lumped-") && !read.errors.is_empty())?;
    let whole = correlated(fit, &read, drive, area_cm2, &fit.curves);
    let all = read.keys.len();
    let told = |at: &usize| read.errors[*at] > 0.0 && !read.bounded.contains(&read.keys[*at]);
    let kept: Vec<usize> = (0..all).filter(told).collect();
    let row = |j: &usize| kept.iter().map(|k| whole[j * all + k]).collect();
    let keys = kept.iter().map(|at| read.keys[*at].clone()).collect();
    Some((keys, kept.iter().map(row).collect()))
}

fn correlated(fit: &Fit, read: &Read, drive: &Drive, area_cm2: f64, curves: &[RunCurve]) -> Vec<f64> {
    let at = |quantity: Quantity| -> (&[f64], f64) {
        let curve = curves.iter().find(|curve| curve.quantity == quantity);
        let noise = fit.noise.iter().find(|noise| noise.quantity == quantity);
        let times = curve.map_or(&[][..], |curve| &curve.time_s);
        (times, noise.map_or(0.0, |noise| noise.standard_deviation))
    };
    let edges = EdgeTimes::of(drive);
    let read_at = ReadAt {
        drive: edges.drive(),
        area_cm2,
        current: at(Quantity::Current),
        curvature: at(Quantity::Curvature),
    };
    covariance(&read.model, &read.errors, &read_at)
}

/// A fit as a lumped model, with the standard errors in the order of the covariance.
struct Read<'a> {
    fit: &'a Fit,
    model: LumpedModel,
    /// Whether its bending is known.
    bends: bool,
    /// Keys of the parameters, in that order.
    keys: Vec<String>,
    errors: Vec<f64>,
    /// Parameters of which only a bound is known.
    bounded: Vec<String>,
}

impl Read<'_> {
    fn of(fit: &Fit) -> Result<Read<'_>, String> {
        let mut read = Read {
            fit,
            model: with_values(&[0.0; 3]),
            bends: false,
            keys: Vec::new(),
            errors: Vec::new(),
            bounded: Vec::new(),
        };
        read.model.branches = read.branches()?;
        read.model.steady_state_resistance_ohm_cm2 = read.steady_state()?;
        let (coupling, relaxation) = (read.known("alpha_per_c_cm"), read.relaxation());
        read.bends = coupling.is_some() && relaxation.is_some();
        let value = |known: Option<(f64, f64)>| known.map_or(0.0, |(value, _)| value);
        read.model.charge_to_curvature_per_c_cm = value(coupling.filter(|_| read.bends));
        read.model.relaxation_rate_per_s = value(relaxation);
        for (key, known) in [("alpha_per_c_cm", coupling), ("lambda_per_s", relaxation)] {
            read.gather(key, known.map_or(0.0, |(_, error)| error));
        }
        Ok(read)
    }

    fn gather(&mut self, key: &str, error: f64) {
        self.keys.push(key.to_owned());
        self.errors.push(error);
    }

    fn known(&self, key: &str) -> Option<(f64, f64)> {
        let estimate = self.fit.parameter(key)?;
        Some((estimate.value?, error_of(estimate)))
    }

    /// The branches, as many as the fit determines: those of a lumped model, or the one of a distributed.
    fn branches(&mut self) -> Result<Vec<Branch>, String> {
        let keys = |k: usize| (format!("r{k}_ohm_cm2"), format!("c{k}_f_per_cm2"));
        let along = ("rc_ohm_cm2".to_owned(), "c_f_per_cm2".to_owned());
        let named = std::iter::once(along).chain((1..=4).map(keys));
        let mut branches = Vec::new();
        for (r, c) in named {
            let Some(((resistance, r_error), (capacitance, c_error))) = self.known(&r).zip(self.known(&c))
            else {
                continue;
            };
            self.gather(&r, r_error);
            self.gather(&c, c_error);
            branches.push(Branch {
                resistance_ohm_cm2: resistance,
                capacitance_f_per_cm2: capacitance,
            });
        }
        if branches.is_empty() {
            Err(format!(
                "its fit with {} determines no branch of a circuit; fit it with a lumped or the distributed model",
                self.fit.model
            ))
        } else {
            Ok(branches)
        }
    }

    /// R_ss; where only a lower bound is known, the conductance lies anywhere between none and that of the bound.
    fn steady_state(&mut self) -> Result<f64, String> {
        let key = "rss_ohm_cm2";
        if let Some((value, error)) = self.known(key) {
            self.gather(key, error);
            return Ok(value);
        }
        let bound = self.fit.parameter(key).and_then(|estimate| estimate.low_95);
        let bound = bound
            .filter(|bound| *bound > 0.0)
            .ok_or("its R_ss is not determined")?;
        self.bounded.push(key.to_owned());
        let middle = 2.0 * bound;
        self.gather(key, middle * middle * UNIFORM / bound);
        Ok(middle)
    }

    /// Lambda; where only an upper bound is known, it lies anywhere below.
    fn relaxation(&mut self) -> Option<(f64, f64)> {
        let key = "lambda_per_s";
        self.known(key).or_else(|| {
            let bound = self.fit.parameter(key)?.high_95?;
            self.bounded.push(key.to_owned());
            Some((0.5 * bound, UNIFORM * bound))
        })
    }
}

/// The standard error, or what the interval says of it.
fn error_of(estimate: &Estimate) -> f64 {
    let ends = estimate.low_95.zip(estimate.high_95);
    let of_interval = ends.map(|(low, high)| (high - low) / (2.0 * NORMAL_95));
    let error = estimate.standard_error.or(of_interval).unwrap_or(0.0);
    if error.is_finite() { error.max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Segment;

    #[test]
    fn voltages_of_a_drive_are_weighed_by_their_time() {
        assert_eq!(applied(&Drive::step(-1.5), 100.0), Applied::step(-1.5));
        let segment = |start_s, volts| Segment::at(start_s, Level::Voltage(volts));
        let pulses = Drive {
            baseline_v: 0.0,
            segments: vec![segment(0.0, 2.0), segment(10.0, 0.0)],
        };
        let found = applied(&pulses, 20.0);
        assert!((found.typical_v - 2.0_f64.sqrt()).abs() < 1e-12);
        let strays = 0.5 * ((2.0 - 2.0_f64.sqrt()).powi(2) + 2.0);
        assert!((found.strays_v - strays.sqrt()).abs() < 1e-12);
        let swung = Drive {
            baseline_v: 0.0,
            segments: vec![segment(0.0, 2.0), segment(10.0, -2.0)],
        };
        assert_eq!(applied(&swung, 20.0), Applied::step(2.0));
        assert_eq!(applied(&pulses, 0.0), Applied::step(2.0));
    }
}
