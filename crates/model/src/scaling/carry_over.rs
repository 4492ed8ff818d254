//! What the model of one strip becomes on another.

use thiserror::Error;

use super::size::StripSize;
use crate::coupling::CurvaturePerTotalCharge;
use crate::lumped::LumpedModel;

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
    /// Laws are known of the strip, and of the conditions, that they were found in.
    #[error(
        "laws that were found beside the model are known of that strip, all along it and in one humidity: ask for the strip itself"
    )]
    LawsElsewhere,
    /// A law follows what sensors logged, of which the drive says nothing.
    #[error(
        "a law that was found beside the model follows the {quantity} that was logged during the runs, and nothing says what it will be: fit without that law to predict"
    )]
    LawOfClimate {
        /// What it follows.
        quantity: String,
    },
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

fn check(from: &StripSize, to: &StripSize) -> Result<(), ScalingError> {
    for size in [from, to] {
        let (length_mm, width_mm) = (size.length_mm.value, size.width_mm.value);
        let positive = |mm: f64| mm.is_finite() && mm > 0.0;
        if !positive(length_mm) || !positive(width_mm) {
            return Err(ScalingError::NoArea { length_mm, width_mm });
        }
    }
    if let Some((a, b)) = from.thickness_mm.zip(to.thickness_mm) {
        // Equal numbers without errors are one laminate however they were rounded.
        let rounding = 1e-9 * a.value;
        let error = a.standard_error.hypot(b.standard_error);
        if (a.value - b.value).abs() > 2.0 * error + rounding {
            return Err(ScalingError::OtherLaminate {
                from_mm: a.value,
                to_mm: b.value,
            });
        }
    }
    Ok(())
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
    use ieap_domain::testing::branch;
    use ieap_domain::typed_value::Measured;

    fn exact(length_mm: f64, width_mm: f64) -> StripSize {
        StripSize {
            length_mm: Measured::exact(length_mm),
            width_mm: Measured::exact(width_mm),
            thickness_mm: Some(Measured::exact(0.22)),
        }
    }

    fn model() -> LumpedModel {
        LumpedModel {
            branches: vec![branch(60.0, 0.03)],
            steady_state_resistance_ohm_cm2: 5000.0,
            charge_to_curvature_per_c_cm: 24.62,
            relaxation_rate_per_s: 0.01,
        }
    }

    #[test]
    fn alpha_follows_the_inverse_area_and_the_laminate_keeps_the_rest() {
        let carried = lumped_model(&model(), &exact(5.0, 2.0), &exact(10.0, 4.0)).unwrap();
        assert!((carried.charge_to_curvature_per_c_cm - 24.62 / 4.0).abs() < 1e-12);
        let charge_to_curvature_per_c_cm = model().charge_to_curvature_per_c_cm;
        let back = LumpedModel {
            charge_to_curvature_per_c_cm,
            ..carried
        };
        assert_eq!(back, model());
    }

    #[test]
    fn another_laminate_and_no_area_are_refused() {
        let mut thick = exact(5.0, 2.0);
        thick.thickness_mm = Some(Measured {
            value: 0.3,
            standard_error: 0.01,
        });
        let error = lumped_model(&model(), &exact(5.0, 2.0), &thick).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("the strips are 0.22 mm and 0.3 mm thick"),
            "{error}"
        );
        let flat = lumped_model(&model(), &exact(5.0, 2.0), &exact(5.0, 0.0)).unwrap_err();
        assert!(matches!(flat, ScalingError::NoArea { .. }));
    }
}
