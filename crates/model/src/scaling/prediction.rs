//! What a strip of another size will do, with the uncertainty of the identified parameters and of both sizes.

use super::propagation::{Identified, Strip, derivatives, deviations, extended};
use super::{ScalingError, StripSize, lumped_model};
use crate::changing::{Change, Changing, Now};
use crate::coupling::CurvaturePerArealCharge;
use crate::distributed::branched::BranchedStrip;
use crate::distributed::criterion::LUMPED_TOLERANCE;
use crate::distributed::{Laminate, LumpedError};
use crate::effects::Applied;
use crate::effects::smooth_laws::smooth_law;
use crate::geometry::Shape;
use crate::lumped::{Branch, LumpedModel};
use ieap_domain::Drive;
use ieap_numerics::line::halved;

/// Links of the chain that a strip's shape is drawn with.
pub const LINKS: usize = 40;

/// Which model says what the strip does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CarriedBy {
    /// The lumped one: it is enough, or nothing is known of the electrodes.
    Lumped,
    /// The distributed one with the same branches.
    Distributed,
}

/// A response at the times asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Values.
    pub value: Vec<f64>,
    /// Their standard errors.
    pub standard_error: Vec<f64>,
}

/// Responses of a strip with their standard errors. Noise of a measurement is not contained.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The model of the new strip.
    pub model: LumpedModel,
    /// By which model.
    pub carried_by: CarriedBy,
    /// Current, A.
    pub current_a: Series,
    /// Charge on the capacitors, C.
    pub charge_c: Series,
    /// Charge that has flowed through R_ss since the drive began, C: the same whichever way it flowed.
    pub leaked_charge_c: Series,
    /// Curvature, 1/cm, the mean over the length; for the lumped model the same as that of the identified strip, for
    /// it follows the areal charge.
    pub curvature_per_cm: Series,
    /// Sideways displacement of the tip of the initially straight strip, mm.
    pub tip_displacement_mm: Series,
    /// Curvature of each of [`LINKS`] links of equal length, from the clamp on, 1/cm.
    pub local_curvature_per_cm: Vec<Series>,
    /// What the lumped model gets wrong on the new strip; none where the electrodes' resistance is not known, so
    /// that a longer strip may well charge unevenly and nobody can say.
    pub lumped_error: Option<LumpedError>,
}

/// Predicts a strip of the size `to` and of the same laminate in the given drive, to first order in the errors.
///
/// Where the electrodes' resistance is known and the lumped model would be wrong by more than
/// [`LUMPED_TOLERANCE`] on the new strip, the distributed one is taken.
///
/// # Errors
/// The strips have no area or another thickness, the covariance does not belong to the model's parameters, the distributed
/// model is needed for a drive with an open circuit, or laws are asked of another strip.
pub fn predict(
    identified: &Identified,
    to: &StripSize,
    drive: &Drive,
    time_s: &[f64],
) -> Result<Prediction, ScalingError> {
    let model = lumped_model(identified.model, identified.size, to)?;
    let n = identified.values().len();
    if identified.covariance.len() != n * n {
        return Err(ScalingError::CovarianceSize {
            found: identified.covariance.len(),
            parameters: n,
            needed: n * n,
        });
    }
    let lumped_error = identified
        .electrode_resistance_ohm_per_sq
        .map(|resistance| lumped_error(identified.model, resistance, to));
    let needed = |error: LumpedError| !error.lumped_is_enough(LUMPED_TOLERANCE);
    let electrodes = identified
        .electrode_resistance_ohm_per_sq
        .filter(|_| lumped_error.is_some_and(needed));
    if electrodes.is_some() && !identified.changes.is_empty() {
        return Err(ScalingError::ChangesAlong);
    }
    let is_plain = electrodes.is_none() && identified.changes.is_empty() && identified.size == to;
    if !identified.laws.is_empty() && !is_plain {
        return Err(ScalingError::LawsElsewhere);
    }
    let of_climate = |own: &Applied| smooth_law(own.effect.about().id)?.logged();
    if let Some(quantity) = identified.laws.iter().find_map(of_climate) {
        let quantity = quantity.label().to_lowercase();
        return Err(ScalingError::LawOfClimate { quantity });
    }
    let asked = Asked {
        electrodes,
        changes: identified.changes,
        drive,
        time_s,
    };
    let found = asked.respond(&model, identified.laws, to)?;
    let changed = |model: &LumpedModel, laws: &[Applied]| {
        let carried = lumped_model(model, identified.size, to).ok()?;
        asked.respond(&carried, laws, to).ok()
    };
    let slopes = derivatives(identified, &found, changed);
    let by_length = asked.length_slopes(&model, identified.laws, to, &found)?;
    let areas = identified
        .size
        .relative_area_error()
        .hypot(to.relative_area_error());
    let series: Vec<Series> = (0..found.len())
        .map(|which| {
            let of: Vec<&[f64]> = slopes.iter().map(|slope| slope[which].as_slice()).collect();
            let value = found[which].clone();
            let of_parameters = deviations(identified.covariance, &of, time_s.len());
            let of_size = |k: usize| {
                if which < PER_AREA {
                    value[k] * areas
                } else {
                    by_length[which][k] * to.length_mm.standard_error
                }
            };
            let error = |k: usize| of_parameters[k].hypot(of_size(k));
            Series {
                standard_error: (0..time_s.len()).map(error).collect(),
                value,
            }
        })
        .collect();
    let mut series = series.into_iter();
    let mut next = || series.next().unwrap_or_default();
    Ok(Prediction {
        model,
        carried_by: match electrodes {
            Some(_) => CarriedBy::Distributed,
            None => CarriedBy::Lumped,
        },
        current_a: next(),
        charge_c: next(),
        leaked_charge_c: next(),
        curvature_per_cm: next(),
        tip_displacement_mm: next(),
        local_curvature_per_cm: (0..LINKS).map(|_| next()).collect(),
        lumped_error,
    })
}

/// Number of the first responses, which follow the area.
const PER_AREA: usize = 3;

struct Asked<'a> {
    /// Ohm per square; none for the lumped model.
    electrodes: Option<f64>,
    changes: &'a [Change],
    drive: &'a Drive,
    time_s: &'a [f64],
}

impl Asked<'_> {
    /// What a strip of that size and model does, in the order of [`Prediction`]: current, charge, leaked charge, curvature,
    /// tip, then the links.
    fn respond(
        &self,
        model: &LumpedModel,
        laws: &[Applied],
        of: &StripSize,
    ) -> Result<Vec<Vec<f64>>, ScalingError> {
        let area = of.active_area();
        let (drive, time_s) = (self.drive, self.time_s);
        let link_cm = area.length_cm / LINKS as f64;
        let evenly = |mut series: Vec<Vec<f64>>, curvature: Vec<f64>| {
            let tip =
                |curvature: &f64| 10.0 * Shape::from_curvature(&[*curvature], area.length_cm).tip_cm().1;
            let tips = curvature.iter().map(tip).collect();
            series.extend([curvature.clone(), tips]);
            series.extend(std::iter::repeat_n(curvature, LINKS));
            series
        };
        if !laws.is_empty() {
            let strip = Strip {
                drive,
                area_cm2: area.area_cm2(),
                length_cm: Some(area.length_cm),
            };
            let found = extended(model, laws, &strip, [time_s, time_s]);
            let of_current = vec![found.current_a, found.charge_c, found.leaked_charge_c];
            return Ok(evenly(of_current, found.curvature_per_cm));
        }
        let Some(electrode_resistance_ohm_per_sq) = self.electrodes else {
            let changing = Changing::new(model, self.changes, drive);
            let now: Vec<Now> = time_s.iter().map(|t| changing.at(*t, area.area_cm2())).collect();
            let of = |one: fn(&Now) -> f64| -> Vec<f64> { now.iter().map(one).collect() };
            let of_current = vec![
                of(|now| now.current_a),
                of(|now| now.charge_c),
                of(|now| now.leaked_charge_c),
            ];
            return Ok(evenly(of_current, of(|now| now.curvature_per_cm)));
        };
        let strip = BranchedStrip {
            model,
            electrode_resistance_ohm_per_sq,
            length_cm: area.length_cm,
            width_cm: area.width_cm,
        };
        let middles: Vec<f64> = (0..LINKS).map(|k| (k as f64 + 0.5) * link_cm).collect();
        let found = strip
            .respond(drive, &middles, time_s)
            .ok_or(ScalingError::OpenCircuitAlong)?;
        let tip = |k: usize| {
            let shape = Shape::from_curvature(found.curvature_per_cm.profile(k), link_cm);
            10.0 * shape.tip_cm().1
        };
        let tips = (0..time_s.len()).map(tip).collect();
        let local = |place: usize| {
            (0..time_s.len())
                .map(|k| found.curvature_per_cm.at(k, place))
                .collect()
        };
        let places: Vec<Vec<f64>> = (0..LINKS).map(local).collect();
        let mut series = vec![
            found.current_a,
            found.charge_c,
            either_way(&found.leaked_charge_c),
            found.mean_curvature_per_cm,
            tips,
        ];
        series.extend(places);
        Ok(series)
    }

    /// Derivatives by the length, per mm, with the charge per area held; zeros where it is exact.
    fn length_slopes(
        &self,
        model: &LumpedModel,
        laws: &[Applied],
        to: &StripSize,
        at: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, ScalingError> {
        if to.length_mm.standard_error == 0.0 {
            return Ok(at.iter().map(|series| vec![0.0; series.len()]).collect());
        }
        let step_mm = 1e-4 * to.length_mm.value;
        let with = |change_mm: f64| {
            let mut changed = *to;
            changed.length_mm.value += change_mm;
            self.respond(&lumped_model(model, to, &changed)?, laws, &changed)
        };
        let (longer, shorter) = (with(step_mm)?, with(-step_mm)?);
        let pairs = longer.iter().zip(&shorter);
        let slope = |(up, down): (&Vec<f64>, &Vec<f64>)| {
            let each = up.iter().zip(down);
            each.map(|(up, down)| (up - down) / (2.0 * step_mm)).collect()
        };
        Ok(pairs.map(slope).collect())
    }
}

/// What flowed from time to time, summed whichever way it flowed.
fn either_way(passed: &[f64]) -> Vec<f64> {
    let (mut sum, mut before) = (0.0, 0.0);
    passed
        .iter()
        .map(|&now| {
            sum += f64::abs(now - before);
            before = now;
            sum
        })
        .collect()
}

/// The criterion for the new strip, the branches seen as one that conducts at first as all of them.
pub fn lumped_error(
    model: &LumpedModel,
    electrode_resistance_ohm_per_sq: f64,
    to: &StripSize,
) -> LumpedError {
    let conductance: f64 = model.branches.iter().map(|b| b.resistance_ohm_cm2.recip()).sum();
    let laminate = Laminate {
        electrode_resistance_ohm_per_sq,
        branch: Branch {
            resistance_ohm_cm2: conductance.recip(),
            capacitance_f_per_cm2: model.total_capacitance_f_per_cm2(),
        },
        steady_state_resistance_ohm_cm2: model.steady_state_resistance_ohm_cm2,
        coupling: CurvaturePerArealCharge(0.0),
        relaxation_rate_per_s: model.relaxation_rate_per_s,
    };
    laminate.strip(&to.active_area()).lumped_error()
}

/// Largest resistance of the electrodes, Ohm per square, with which the lumped model is wrong on that strip by no
/// more than the share `tolerance`.
pub fn largest_electrode_resistance(model: &LumpedModel, to: &StripSize, tolerance: f64) -> f64 {
    let is_enough = |resistance: f64| lumped_error(model, resistance, to).lumped_is_enough(tolerance);
    let (mut enough, mut too_much) = (0.0, 1.0);
    while is_enough(too_much) && too_much < 1e12 {
        (enough, too_much) = (too_much, 2.0 * too_much);
    }
    halved(enough, too_much, 60, is_enough).0
}

#[cfg(test)]
mod tests;
