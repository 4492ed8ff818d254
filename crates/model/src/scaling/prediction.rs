//! What a strip of another size will do, with the uncertainty of the identified parameters and of both sizes.

use super::{ScalingError, StripSize, lumped_model};
use crate::coupling::CurvaturePerArealCharge;
use crate::distributed::{Laminate, LumpedError};
use crate::geometry::Shape;
use crate::lumped::{Branch, LumpedModel};
use ieap_domain::Drive;

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

/// Responses of a strip with their standard errors. Noise of a measurement is not contained.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The model of the new strip.
    pub model: LumpedModel,
    /// Current, A.
    pub current_a: Vec<f64>,
    /// Its standard error, A.
    pub current_standard_error_a: Vec<f64>,
    /// Curvature, 1/cm; the same as that of the identified strip, for it follows the areal charge.
    pub curvature_per_cm: Vec<f64>,
    /// Its standard error, 1/cm.
    pub curvature_standard_error_per_cm: Vec<f64>,
    /// Sideways displacement of the tip of the initially straight strip, mm.
    pub tip_displacement_mm: Vec<f64>,
    /// Its standard error, mm.
    pub tip_displacement_standard_error_mm: Vec<f64>,
    /// What the lumped model gets wrong on the new strip; none where the electrodes' resistance is not known, so
    /// that a longer strip may well charge unevenly and nobody can say.
    pub lumped_error: Option<LumpedError>,
}

/// Predicts a strip of the size `to` and of the same laminate in the given drive, to first order in the errors.
///
/// # Errors
/// The strips have no area or another thickness, or the covariance does not belong to the model's parameters.
pub fn predict(
    identified: &Identified,
    to: &StripSize,
    drive: &Drive,
    time_s: &[f64],
) -> Result<Prediction, ScalingError> {
    let model = lumped_model(identified.model, identified.size, to)?;
    let parameters = values(identified.model);
    let n = parameters.len();
    if identified.covariance.len() != n * n {
        return Err(ScalingError::CovarianceSize {
            found: identified.covariance.len(),
            parameters: n,
            needed: n * n,
        });
    }
    let area_cm2 = to.area_cm2();
    let current_a = model.current_a(drive, area_cm2, time_s);
    let curvature_per_cm = model.curvature_per_cm(drive, area_cm2, time_s);
    let slopes = slopes(identified, &parameters, |changed| {
        // Alpha is that of the identified strip here, and so is the area it belongs to.
        let bent = changed.curvature_per_cm(drive, identified.size.area_cm2(), time_s);
        (changed.current_a(drive, area_cm2, time_s), bent)
    });
    let areas = identified
        .size
        .relative_area_error()
        .hypot(to.relative_area_error());
    let (current_slopes, curvature_slopes): (Vec<Vec<f64>>, Vec<Vec<f64>>) = slopes.into_iter().unzip();
    let of_parameters = deviations(identified.covariance, &current_slopes, time_s.len());
    let current_errors = of_parameters.iter().zip(&current_a);
    let curvature_standard_error_per_cm = deviations(identified.covariance, &curvature_slopes, time_s.len());
    let tips: Vec<(f64, f64)> = curvature_per_cm
        .iter()
        .zip(&curvature_standard_error_per_cm)
        .map(|(curvature, error)| tip_mm(*curvature, *error, to))
        .collect();
    Ok(Prediction {
        current_standard_error_a: current_errors
            .map(|(error, current)| error.hypot(current * areas))
            .collect(),
        lumped_error: identified
            .electrode_resistance_ohm_per_sq
            .map(|resistance| lumped_error(identified.model, resistance, to)),
        model,
        current_a,
        curvature_per_cm,
        curvature_standard_error_per_cm,
        tip_displacement_mm: tips.iter().map(|tip| tip.0).collect(),
        tip_displacement_standard_error_mm: tips.iter().map(|tip| tip.1).collect(),
    })
}

/// Standard deviation at each time of what has these derivatives by the parameters (one row of times each).
fn deviations(covariance: &[f64], slopes: &[Vec<f64>], times: usize) -> Vec<f64> {
    let n = slopes.len();
    let variance = |time: usize| -> f64 {
        let entry = |k: usize| slopes[k / n][time] * covariance[k] * slopes[k % n][time];
        (0..n * n).map(entry).sum()
    };
    (0..times).map(|time| variance(time).max(0.0).sqrt()).collect()
}

/// The parameters in the covariance's order.
fn values(model: &LumpedModel) -> Vec<f64> {
    let branches = model.branches.iter();
    let mut values: Vec<f64> = branches
        .flat_map(|b| [b.resistance_ohm_cm2, b.capacitance_f_per_cm2])
        .collect();
    values.extend([
        model.steady_state_resistance_ohm_cm2,
        model.charge_to_curvature_per_c_cm,
        model.relaxation_rate_per_s,
    ]);
    values
}

fn with_values(values: &[f64]) -> LumpedModel {
    let (branches, rest) = values.split_at(values.len() - 3);
    let branch = |pair: &[f64]| Branch {
        resistance_ohm_cm2: pair[0],
        capacitance_f_per_cm2: pair[1],
    };
    LumpedModel {
        branches: branches.chunks_exact(2).map(branch).collect(),
        steady_state_resistance_ohm_cm2: rest[0],
        charge_to_curvature_per_c_cm: rest[1],
        relaxation_rate_per_s: rest[2],
    }
}

/// Derivatives of current and curvature by every parameter, by central differences; zero where the parameter has
/// no variance. At a value of zero, which a rate may have, the difference is taken upwards.
fn slopes(
    identified: &Identified,
    parameters: &[f64],
    respond: impl Fn(&LumpedModel) -> (Vec<f64>, Vec<f64>),
) -> Vec<(Vec<f64>, Vec<f64>)> {
    let n = parameters.len();
    let slope = |k: usize| {
        let variance = identified.covariance[k * n + k];
        if variance <= 0.0 || !parameters[k].is_finite() {
            let (current, bent) = respond(identified.model);
            return (vec![0.0; current.len()], vec![0.0; bent.len()]);
        }
        let above = if parameters[k] == 0.0 {
            1e-3 * variance.sqrt()
        } else {
            1e-4 * parameters[k].abs()
        };
        let below = if parameters[k] == 0.0 { 0.0 } else { above };
        let at = |change: f64| {
            let mut changed = parameters.to_vec();
            changed[k] += change;
            respond(&with_values(&changed))
        };
        let (high, low) = (at(above), at(-below));
        let difference = |high: &[f64], low: &[f64]| -> Vec<f64> {
            let pairs = high.iter().zip(low);
            pairs.map(|(high, low)| (high - low) / (above + below)).collect()
        };
        (difference(&high.0, &low.0), difference(&high.1, &low.1))
    };
    (0..n).map(slope).collect()
}

/// Displacement of the tip of an arc, mm, and its standard error: `d = (1 - cos u)/kappa` with `u = kappa L`, so
/// `dd/dL = sin u` and `dd/dkappa = L^2 (u sin u - 1 + cos u)/u^2`.
fn tip_mm(curvature_per_cm: f64, curvature_error_per_cm: f64, of: &StripSize) -> (f64, f64) {
    let length_cm = of.active_area().length_cm;
    let turn = curvature_per_cm * length_cm;
    let displacement_mm = 10.0 * Shape::from_curvature(&[curvature_per_cm], length_cm).tip_cm().1;
    let lever = if turn.abs() < 1e-3 {
        0.5 - turn * turn / 8.0
    } else {
        (turn * turn.sin() - 1.0 + turn.cos()) / (turn * turn)
    };
    let by_curvature = 10.0 * length_cm * length_cm * lever * curvature_error_per_cm;
    (
        displacement_mm,
        by_curvature.hypot(turn.sin() * of.length.standard_error_mm),
    )
}

/// The criterion for the new strip, the branches seen as one that conducts at first as all of them.
fn lumped_error(model: &LumpedModel, electrode_resistance_ohm_per_sq: f64, to: &StripSize) -> LumpedError {
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

#[cfg(test)]
mod tests {
    use super::super::Dimension;
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
            (&found.current_standard_error_a, current),
            (&found.curvature_standard_error_per_cm, curvature),
            (&found.tip_displacement_standard_error_mm, tip),
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
    fn the_tips_error_holds_for_a_strip_that_bends_over() {
        // Bent by 2 rad, where the sideways displacement grows slower than the length and the curvature.
        let of = size(12.0, 3.0, 0.02);
        for curvature in [1.7, -1.7, 5e-4] {
            let tip = |curvature: f64, length_cm: f64| {
                10.0 * Shape::from_curvature(&[curvature], length_cm).tip_cm().1
            };
            let by_curvature = (tip(curvature + 1e-4, 1.2) - tip(curvature - 1e-4, 1.2)) / 2e-4;
            let by_length = (tip(curvature, 1.2001) - tip(curvature, 1.1999)) / 2e-4;
            let expected = (0.05 * by_curvature).hypot(0.024 * by_length);
            let (displacement, error) = tip_mm(curvature, 0.05, &of);
            assert!(
                (error / expected - 1.0).abs() < 1e-6,
                "{curvature}: {error} {expected}"
            );
            assert_eq!(displacement, tip(curvature, 1.2));
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
            assert!((found.current_a[k] / small[k] - 4.0).abs() < 1e-12);
            assert!((found.curvature_per_cm[k] - bent[k]).abs() <= 1e-14 * bent[2]);
        }
        assert_eq!(found.tip_displacement_mm[0], 0.0);
        let error = found.lumped_error.unwrap();
        assert!(error.lumped_is_enough(0.01), "{error:?}");
        let long = predicted(&from, &size(100.0, 4.0, 0.0), Some(2.5));
        assert!(!long.lumped_error.unwrap().lumped_is_enough(0.01));
        assert_eq!(predicted(&from, &to, None).lumped_error, None);
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
