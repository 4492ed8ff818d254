//! What parameters of one strip become on another.

use thiserror::Error;

use super::size::{Dimension, StripSize};
use crate::coupling::CurvaturePerTotalCharge;
use crate::lumped::LumpedModel;
use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Estimate, Parameter};

/// Why parameters cannot be carried over.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ScalingError {
    /// The laminates differ, so nothing carries over by area alone.
    #[error(
        "the strips are {from_mm} mm and {to_mm} mm thick, apart by more than twice the error of the two; parameters \
         carry over between strips of one laminate only: identify the other laminate from a run of its own"
    )]
    OtherLaminate {
        /// Thickness of the identified strip, mm.
        from_mm: f64,
        /// Thickness of the strip to predict, mm.
        to_mm: f64,
    },
    /// A length that no strip can have.
    #[error("a strip of {length_mm} mm by {width_mm} mm; both need to be positive numbers")]
    NoArea {
        /// Length given, mm.
        length_mm: f64,
        /// Width given, mm.
        width_mm: f64,
    },
    /// A parameter whose dimension is not known here.
    #[error(
        "it is not known how parameter {key} depends on the strip's size; leave it out or add it in model/scaling.rs"
    )]
    UnknownParameter {
        /// The parameter's key.
        key: String,
    },
    /// The distributed model is needed, and has no answer to an open circuit.
    #[error(
        "the strip charges unevenly along its length, and an open circuit cannot be predicted there: hold a voltage in its place"
    )]
    OpenCircuitAlong,
    /// The distributed model is needed, and its strip does not change.
    #[error(
        "the strip charges unevenly along its length, and a humidity that changes cannot be predicted there: ask for one humidity, --rh"
    )]
    ChangesAlong,
    /// The covariance belongs to other parameters.
    #[error("the covariance has {found} entries; {parameters} parameters need {needed}")]
    CovarianceSize {
        /// Entries given.
        found: usize,
        /// Parameters of the model.
        parameters: usize,
        /// Their square.
        needed: usize,
    },
}

/// How a stored parameter follows the size of the strip, by its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dependence {
    /// Belongs to the laminate; no dimension entered when it was identified.
    None,
    /// Belongs to the laminate, but was computed with the area of the identified strip.
    ThroughArea,
    /// Belongs to one strip, with the inverse of its area.
    InverseArea,
    /// Belongs to strips of one width, with its inverse: kappa = mu q per unit length.
    InverseWidth,
}

fn dependence(key: &str) -> Option<Dependence> {
    match key {
        "mu_per_c" => Some(Dependence::InverseWidth),
        "re_ohm_per_sq" => Some(Dependence::None),
        // R per area times C per area: the area cancels.
        "tau_s" | "tau1_s" | "tau2_s" | "tau3_s" | "tau4_s" => Some(Dependence::None),
        // Found as ratios, from the shape of the responses.
        "re_l2_per_rc" | "re_l2_per_rss" => Some(Dependence::None),
        // Of the laminate and the ions in it, whose thickness is the same: times, and parts of a whole.
        "retardation_s" | "transport_s" | "kept_part" | "e2_per_e0" => Some(Dependence::None),
        // Couplings to the charge of the whole sample: alpha, and those of the rival models.
        _ if key.ends_with("_per_c_cm") => Some(Dependence::InverseArea),
        _ if key.ends_with("_per_s") => Some(Dependence::None),
        _ if key.ends_with("_ohm_cm2") || key.ends_with("_f_per_cm2") => Some(Dependence::ThroughArea),
        _ => None,
    }
}

/// Parameters identified on the strip `from`, for the strip `to` of the same laminate.
///
/// Standard errors and intervals are widened by the errors of the dimensions: of the first strip for what was
/// divided by its area, of both for alpha. Undetermined parameters stay so, one-sided bounds stay bounds.
///
/// # Errors
/// The strips have no area or another thickness, or a parameter's dependence on size is not known.
pub fn carry_over(
    parameters: &[Parameter],
    from: &StripSize,
    to: &StripSize,
) -> Result<Vec<Parameter>, ScalingError> {
    check(from, to)?;
    let carried = |parameter: &Parameter| {
        let unknown = || ScalingError::UnknownParameter {
            key: parameter.key.clone(),
        };
        let both = from.relative_area_error().hypot(to.relative_area_error());
        let (factor, relative_error) = match dependence(&parameter.key).ok_or_else(unknown)? {
            Dependence::None => (1.0, 0.0),
            Dependence::ThroughArea => (1.0, from.relative_area_error()),
            Dependence::InverseArea => (from.area_cm2() / to.area_cm2(), both),
            Dependence::InverseWidth => (
                from.width.value_mm / to.width.value_mm,
                from.width.relative().hypot(to.width.relative()),
            ),
        };
        Ok(Parameter {
            key: parameter.key.clone(),
            estimate: scaled(&parameter.estimate, factor, relative_error),
        })
    };
    parameters.iter().map(carried).collect()
}

fn check(from: &StripSize, to: &StripSize) -> Result<(), ScalingError> {
    for size in [from, to] {
        let positive = |d: &Dimension| d.value_mm.is_finite() && d.value_mm > 0.0;
        if !positive(&size.length) || !positive(&size.width) {
            return Err(ScalingError::NoArea {
                length_mm: size.length.value_mm,
                width_mm: size.width.value_mm,
            });
        }
    }
    if let Some((a, b)) = from.thickness.zip(to.thickness) {
        // Equal numbers without errors are one laminate however they were rounded.
        let rounding = 1e-9 * a.value_mm;
        let error = a.standard_error_mm.hypot(b.standard_error_mm);
        if (a.value_mm - b.value_mm).abs() > 2.0 * error + rounding {
            return Err(ScalingError::OtherLaminate {
                from_mm: a.value_mm,
                to_mm: b.value_mm,
            });
        }
    }
    Ok(())
}

/// An estimate times a positive factor that has a relative error of its own, independent of the estimate.
fn scaled(estimate: &Estimate, factor: f64, relative_error: f64) -> Estimate {
    let mut result = estimate.clone();
    let half = NORMAL_95 * relative_error;
    if let Some(value) = estimate.value {
        result.value = Some(value * factor);
        result.standard_error = estimate
            .standard_error
            .map(|error| factor * error.hypot(value * relative_error));
        let away = |end: f64| factor * (end - value).hypot(value * half);
        result.low_95 = estimate.low_95.map(|low| value * factor - away(low));
        result.high_95 = estimate.high_95.map(|high| value * factor + away(high));
    } else {
        // A bound moves away from what it bounds, by the factor that the dimensions allow.
        result.low_95 = estimate
            .low_95
            .map(|low| low * factor * (-half * low.signum()).exp());
        result.high_95 = estimate
            .high_95
            .map(|high| high * factor * (half * high.signum()).exp());
    }
    result
}

/// The lumped model of the strip `to`, from that identified on `from`: alpha changes, nothing else.
///
/// # Errors
/// The strips have no area or another thickness.
pub fn lumped_model(
    identified: &LumpedModel,
    from: &StripSize,
    to: &StripSize,
) -> Result<LumpedModel, ScalingError> {
    check(from, to)?;
    let alpha = CurvaturePerTotalCharge(identified.charge_to_curvature_per_c_cm);
    Ok(LumpedModel {
        charge_to_curvature_per_c_cm: alpha.areal(&from.active_area()).total(&to.active_area()).0,
        ..identified.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(length_mm: f64, width_mm: f64) -> StripSize {
        let dimension = |value_mm| Dimension {
            value_mm,
            standard_error_mm: 0.0,
        };
        StripSize {
            length: dimension(length_mm),
            width: dimension(width_mm),
            thickness: Some(dimension(0.22)),
        }
    }

    fn parameter(key: &str, estimate: Estimate) -> Parameter {
        Parameter {
            key: key.to_owned(),
            estimate,
        }
    }

    #[test]
    fn alpha_follows_the_inverse_area_and_the_laminate_keeps_the_rest() {
        let estimate = Estimate::determined(24.62, 0.5, 23.64, 25.6);
        let keys = [
            "r1_ohm_cm2",
            "c1_f_per_cm2",
            "rss_ohm_cm2",
            "re_ohm_per_sq",
            "lambda_per_s",
        ];
        let mut parameters: Vec<Parameter> =
            keys.iter().map(|key| parameter(key, estimate.clone())).collect();
        parameters.push(parameter("alpha_per_c_cm", estimate.clone()));
        let carried = carry_over(&parameters, &exact(5.0, 2.0), &exact(10.0, 4.0)).unwrap();
        for (before, after) in parameters[..5].iter().zip(&carried) {
            assert_eq!(before.estimate.value, after.estimate.value);
            assert_eq!(before.estimate.standard_error, after.estimate.standard_error);
        }
        let alpha = &carried[5].estimate;
        assert!((alpha.value.unwrap() - 24.62 / 4.0).abs() < 1e-12);
        assert!((alpha.standard_error.unwrap() - 0.5 / 4.0).abs() < 1e-12);
        assert!((alpha.low_95.unwrap() - 23.64 / 4.0).abs() < 1e-12);
    }

    #[test]
    fn errors_of_the_dimensions_enter_where_the_area_did() {
        let mut from = exact(5.0, 2.0);
        from.width.standard_error_mm = 0.06;
        let mut to = exact(10.0, 4.0);
        to.length.standard_error_mm = 0.4;
        let sure = Estimate::determined(100.0, 0.0, 100.0, 100.0);
        let parameters =
            ["c1_f_per_cm2", "alpha_per_c_cm", "lambda_per_s"].map(|key| parameter(key, sure.clone()));
        let errors: Vec<f64> = carry_over(&parameters, &from, &to)
            .unwrap()
            .iter()
            .map(|p| p.estimate.standard_error.unwrap() / p.estimate.value.unwrap())
            .collect();
        assert!((errors[0] - 0.03).abs() < 1e-12);
        assert!((errors[1] - 0.05).abs() < 1e-12, "{errors:?}");
        assert_eq!(errors[2], 0.0);
    }

    #[test]
    fn what_is_not_determined_stays_so_and_bounds_stay_bounds() {
        let mut from = exact(5.0, 2.0);
        from.width.standard_error_mm = 0.2;
        let parameters = [
            parameter("rss_ohm_cm2", Estimate::above(5000.0, "no steady current shows")),
            parameter("alpha_per_c_cm", Estimate::not_determined("no curvature")),
        ];
        let carried = carry_over(&parameters, &from, &exact(5.0, 1.0)).unwrap();
        let bound = &carried[0].estimate;
        assert_eq!((bound.value, bound.high_95), (None, None));
        assert!(bound.low_95.unwrap() < 5000.0 && bound.low_95.unwrap() > 4000.0);
        assert_eq!(carried[1], parameters[1]);
    }

    #[test]
    fn another_laminate_no_area_and_unknown_parameters_are_refused() {
        let mut thick = exact(5.0, 2.0);
        thick.thickness = Some(Dimension {
            value_mm: 0.3,
            standard_error_mm: 0.01,
        });
        let error = carry_over(&[], &exact(5.0, 2.0), &thick).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("the strips are 0.22 mm and 0.3 mm thick"),
            "{error}"
        );
        let flat = carry_over(&[], &exact(5.0, 2.0), &exact(5.0, 0.0)).unwrap_err();
        assert!(matches!(flat, ScalingError::NoArea { .. }));
        let unknown = [parameter("mass_g", Estimate::not_determined("never weighed"))];
        let error = carry_over(&unknown, &exact(5.0, 2.0), &exact(5.0, 2.0)).unwrap_err();
        assert_eq!(
            error,
            ScalingError::UnknownParameter {
                key: "mass_g".to_owned()
            }
        );
    }

    #[test]
    fn every_parameter_that_a_fit_stores_can_be_carried_over() {
        for model in crate::fit_models() {
            for description in model.parameters {
                assert!(dependence(description.key).is_some(), "{}", description.key);
            }
        }
    }
}
