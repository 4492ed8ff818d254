//! What a strip of another size will do, with the uncertainty of the identified parameters and of both sizes.

use super::propagation::{derivatives, deviations, values};
use super::{ScalingError, StripSize, lumped_model};
use crate::coupling::CurvaturePerArealCharge;
use crate::distributed::branched::{BranchedStrip, voltage_time_integral};
use crate::distributed::criterion::LUMPED_TOLERANCE;
use crate::distributed::{Laminate, LumpedError};
use crate::geometry::Shape;
use crate::lumped::{Branch, LumpedModel};
use ieap_domain::Drive;

/// Links of the chain that a strip's shape is drawn with.
pub const LINKS: usize = 40;

/// What was identified, on which strip, how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified<'a> {
    /// The model of the identified strip.
    pub model: &'a LumpedModel,
    /// Covariance of its parameters, row by row, in the order R_1, C_1, R_2, C_2, ..., R_ss, alpha, lambda and in
    /// their units. Parameters given with their variances alone (a diagonal) are taken as uncorrelated, which
    /// those of one fit seldom are.
    pub covariance: &'a [f64],
    /// Size of the strip.
    pub size: &'a StripSize,
    /// Resistance of both electrodes along the strip, Ohm per square, where it was measured.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
}

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
    /// Charge that has flowed through R_ss since the drive began, C.
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
/// The strips have no area or another thickness, the covariance does not belong to the model's parameters, or the
/// distributed model is needed for a drive with an open circuit.
pub fn predict(
    identified: &Identified,
    to: &StripSize,
    drive: &Drive,
    time_s: &[f64],
) -> Result<Prediction, ScalingError> {
    let model = lumped_model(identified.model, identified.size, to)?;
    let n = values(identified.model).len();
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
    let asked = Asked {
        electrodes,
        drive,
        time_s,
    };
    let found = asked.respond(&model, to)?;
    let changed = |model: &LumpedModel| {
        let carried = lumped_model(model, identified.size, to).ok()?;
        asked.respond(&carried, to).ok().map(|r| r.series)
    };
    let slopes = derivatives(identified, &found.series, changed);
    let by_length = asked.length_slopes(&model, to, &found.series)?;
    let areas = identified
        .size
        .relative_area_error()
        .hypot(to.relative_area_error());
    let series: Vec<Series> = (0..found.series.len())
        .map(|which| {
            let of: Vec<&[f64]> = slopes.iter().map(|slope| slope[which].as_slice()).collect();
            let value = found.series[which].clone();
            let of_parameters = deviations(identified.covariance, &of, time_s.len());
            let of_size = |k: usize| match which < PER_AREA {
                true => value[k] * areas,
                false => by_length[which][k] * to.length.standard_error_mm,
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

/// Responses in the order of [`Prediction`]: current, charge, leaked charge, curvature, tip, then the links.
struct Found {
    series: Vec<Vec<f64>>,
}

struct Asked<'a> {
    /// Ohm per square; none for the lumped model.
    electrodes: Option<f64>,
    drive: &'a Drive,
    time_s: &'a [f64],
}

impl Asked<'_> {
    /// What a strip of that size and model does.
    fn respond(&self, model: &LumpedModel, of: &StripSize) -> Result<Found, ScalingError> {
        let area = of.active_area();
        let (drive, time_s) = (self.drive, self.time_s);
        let link_cm = area.length_cm / LINKS as f64;
        let Some(electrode_resistance_ohm_per_sq) = self.electrodes else {
            let curvature = model.curvature_per_cm(drive, area.area_cm2(), time_s);
            let tip =
                |curvature: &f64| 10.0 * Shape::from_curvature(&[*curvature], area.length_cm).tip_cm().1;
            let leak = area.area_cm2() / model.steady_state_resistance_ohm_cm2;
            let mut series = vec![
                model.current_a(drive, area.area_cm2(), time_s),
                model.charge_c(drive, area.area_cm2(), time_s),
                time_s
                    .iter()
                    .map(|t| leak * voltage_time_integral(drive, *t))
                    .collect(),
                curvature.clone(),
                curvature.iter().map(tip).collect(),
            ];
            series.extend(std::iter::repeat_n(curvature, LINKS));
            return Ok(Found { series });
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
            found.leaked_charge_c,
            found.mean_curvature_per_cm,
            tips,
        ];
        series.extend(places);
        Ok(Found { series })
    }

    /// Derivatives by the length, per mm, with the charge per area held; zeros where it is exact.
    fn length_slopes(
        &self,
        model: &LumpedModel,
        to: &StripSize,
        at: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, ScalingError> {
        if to.length.standard_error_mm == 0.0 {
            return Ok(at.iter().map(|series| vec![0.0; series.len()]).collect());
        }
        let step_mm = 1e-4 * to.length.value_mm;
        let with = |change_mm: f64| {
            let mut changed = *to;
            changed.length.value_mm += change_mm;
            self.respond(&lumped_model(model, to, &changed)?, &changed)
        };
        let (longer, shorter) = (with(step_mm)?, with(-step_mm)?);
        let pairs = longer.series.iter().zip(&shorter.series);
        let slope = |(up, down): (&Vec<f64>, &Vec<f64>)| {
            let each = up.iter().zip(down);
            each.map(|(up, down)| (up - down) / (2.0 * step_mm)).collect()
        };
        Ok(pairs.map(slope).collect())
    }
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
    for _ in 0..60 {
        let middle = 0.5 * (enough + too_much);
        match is_enough(middle) {
            true => enough = middle,
            false => too_much = middle,
        }
    }
    enough
}

#[cfg(test)]
mod tests {
    use super::super::Dimension;
    use super::super::propagation::with_values;
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn size(length_mm: f64, width_mm: f64, relative_error: f64) -> StripSize {
        let dimension = |value_mm| Dimension {
            value_mm,
            standard_error_mm: relative_error * value_mm,
        };
        StripSize {
            length: dimension(length_mm),
            width: dimension(width_mm),
            thickness: None,
        }
    }

    /// CNaf in air at 2 V, thesis table 5.
    fn cnaf() -> LumpedModel {
        with_values(&[521.4, 0.098, 2629.9, 0.13, 5660.0, 13.88, 3.8e-4])
    }

    const TIME_S: [f64; 5] = [0.0, 20.0, 100.0, 700.0, 3000.0];

    /// Lower factor of the covariance: relative deviations of a few percent, R_1 and C_1 falling together.
    fn factor() -> Vec<f64> {
        let (n, parameters) = (7, values(&cnaf()));
        let mut factor = vec![0.0; n * n];
        for k in 0..n {
            factor[k * n + k] = 0.02 * parameters[k];
        }
        factor[n] = -0.015 * parameters[1];
        factor[5 * n + 3] = 0.01 * parameters[5];
        factor
    }

    fn covariance() -> Vec<f64> {
        let (n, l) = (7, factor());
        (0..n * n)
            .map(|k| (0..n).map(|m| l[k / n * n + m] * l[k % n * n + m]).sum())
            .collect()
    }

    /// Standard deviation of what real strips do whose parameters and sizes scatter: parameters identified with
    /// the nominal area of a strip that is really larger or smaller, applied to another such strip.
    fn scattered(from: &StripSize, to: &StripSize, draws: usize) -> [Vec<f64>; 3] {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (nominal, l, drive) = (values(&cnaf()), factor(), Drive::step(2.0));
        let mut sums = vec![[[0.0; 2]; 3]; TIME_S.len()];
        for _ in 0..draws {
            let white: Vec<f64> = (0..7).map(|_| normal()).collect();
            let mut drawn: Vec<f64> = (0..7)
                .map(|k| nominal[k] + (0..7).map(|m| l[k * 7 + m] * white[m]).sum::<f64>())
                .collect();
            let mut real = |size: &StripSize| {
                let length = size.length.value_mm + size.length.standard_error_mm * normal();
                let width = size.width.value_mm + size.width.standard_error_mm * normal();
                (length / 10.0, length * width / 100.0)
            };
            let ((_, from_cm2), (to_cm, to_cm2)) = (real(from), real(to));
            let larger = from_cm2 / from.area_cm2();
            for k in [0, 2, 4] {
                drawn[k] *= larger;
            }
            for k in [1, 3] {
                drawn[k] /= larger;
            }
            drawn[5] *= from_cm2 / to_cm2;
            let model = with_values(&drawn);
            let current = model.current_a(&drive, to_cm2, &TIME_S);
            let curvature = model.curvature_per_cm(&drive, to_cm2, &TIME_S);
            for (k, sums) in sums.iter_mut().enumerate() {
                let tip_mm = 10.0 * Shape::from_curvature(&[curvature[k]], to_cm).tip_cm().1;
                for (sum, value) in sums.iter_mut().zip([current[k], curvature[k], tip_mm]) {
                    sum[0] += value;
                    sum[1] += value * value;
                }
            }
        }
        let n = draws as f64;
        let deviation = |which: usize| {
            let each = sums.iter().map(|sums| sums[which]);
            each.map(|[sum, square]| ((square - sum * sum / n) / (n - 1.0)).max(0.0).sqrt())
                .collect()
        };
        [deviation(0), deviation(1), deviation(2)]
    }

    fn predicted(from: &StripSize, to: &StripSize, resistance: Option<f64>) -> Prediction {
        let identified = Identified {
            model: &cnaf(),
            covariance: &covariance(),
            size: from,
            electrode_resistance_ohm_per_sq: resistance,
        };
        predict(&identified, to, &Drive::step(2.0), &TIME_S).unwrap()
    }

    #[test]
    fn standard_errors_are_the_scatter_of_drawn_strips() {
        let (from, to) = (size(5.0, 2.0, 0.01), size(12.0, 3.0, 0.015));
        let found = predicted(&from, &to, None);
        let [current, curvature, tip] = scattered(&from, &to, 6000);
        let pairs = [
            (&found.current_a.standard_error, current),
            (&found.curvature_per_cm.standard_error, curvature),
            (&found.tip_displacement_mm.standard_error, tip),
        ];
        for (which, (stated, drawn)) in pairs.iter().enumerate() {
            for k in 0..TIME_S.len() {
                if drawn[k] == 0.0 {
                    assert_eq!(stated[k], 0.0);
                    continue;
                }
                // 6,000 draws know a deviation to 0.9 %; the rest is curvature of second order.
                assert!(
                    (stated[k] / drawn[k] - 1.0).abs() < 0.04,
                    "{which} {k}: {} {}",
                    stated[k],
                    drawn[k]
                );
            }
        }
    }

    #[test]
    fn a_larger_strip_draws_more_current_and_bends_to_the_same_curvature() {
        let (from, to) = (size(5.0, 2.0, 0.0), size(10.0, 4.0, 0.0));
        let found = predicted(&from, &to, Some(2.5));
        let drive = Drive::step(2.0);
        let small = cnaf().current_a(&drive, 0.1, &TIME_S);
        let bent = cnaf().curvature_per_cm(&drive, 0.1, &TIME_S);
        for k in 0..TIME_S.len() {
            assert!((found.current_a.value[k] / small[k] - 4.0).abs() < 1e-12);
            assert!((found.curvature_per_cm.value[k] - bent[k]).abs() <= 1e-14 * bent[2]);
        }
        assert_eq!(found.tip_displacement_mm.value[0], 0.0);
        let error = found.lumped_error.unwrap();
        assert!(error.lumped_is_enough(0.01), "{error:?}");
        let long = predicted(&from, &size(100.0, 4.0, 0.0), Some(2.5));
        assert!(!long.lumped_error.unwrap().lumped_is_enough(0.01));
        assert_eq!(predicted(&from, &to, None).lumped_error, None);
    }

    #[test]
    fn the_distributed_model_is_taken_where_the_lumped_one_is_not_enough() {
        let (from, long) = (size(5.0, 2.0, 0.0), size(100.0, 4.0, 0.01));
        let found = predicted(&from, &long, Some(2.5));
        assert_eq!(found.carried_by, CarriedBy::Distributed);
        let lumped = predicted(&from, &long, None);
        assert_eq!(lumped.carried_by, CarriedBy::Lumped);
        // Early the far end lags, late the strip has charged as a whole.
        let share = |k: usize| found.curvature_per_cm.value[k] / lumped.curvature_per_cm.value[k];
        assert!(share(1) < 0.9 && share(4) > share(1), "{} {}", share(1), share(4));
        let links = |k: usize| found.local_curvature_per_cm[k].value[1];
        assert!(links(0) > 1.2 * links(LINKS - 1));
        assert!(found.tip_displacement_mm.standard_error[4] > 0.0);
        let mut open = Drive::step(2.0);
        open.segments[0].level = ieap_domain::Level::OpenCircuit;
        let identified = Identified {
            model: &cnaf(),
            covariance: &covariance(),
            size: &from,
            electrode_resistance_ohm_per_sq: Some(2.5),
        };
        let refused = predict(&identified, &long, &open, &TIME_S).unwrap_err();
        assert_eq!(refused, ScalingError::OpenCircuitAlong);
    }

    #[test]
    fn a_covariance_of_another_model_is_refused() {
        let strip = size(5.0, 2.0, 0.0);
        let identified = Identified {
            model: &cnaf(),
            covariance: &[1.0; 25],
            size: &strip,
            electrode_resistance_ohm_per_sq: None,
        };
        let error = predict(&identified, &strip, &Drive::step(1.0), &TIME_S).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the covariance has 25 entries; 7 parameters need 49"
        );
    }
}
