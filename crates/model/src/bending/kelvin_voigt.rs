//! A Kelvin-Voigt solid (thesis figure 9A) under the moment of the charge (15): spring and dashpot side by side.

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `kappa + (eta/E) kappa' = alpha q` with `alpha = mu/(E I)`: the bending follows the charge late.
///
/// With the relaxed part of (14) at the rate `E/eta` it is `kappa = alpha (q - q_S)`.
pub struct KelvinVoigt;

impl BendingLaw for KelvinVoigt {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa + (eta/E) kappa' = alpha q",
            driven_by: "the moment mu q of the charge (15), which the lumped circuit gives, put on from outside",
            source: "thesis figure 9A",
            limits: "under a held voltage the bending never falls: it creeps to alpha q and stays",
        }
    }

    fn shapes(&self) -> &'static [Shape] {
        &[Shape::Rate]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        let sprung = charge.sprung_c(shapes[0]);
        vec![charge.charge_c().iter().zip(sprung).map(|(q, s)| q - s).collect()]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "alpha_final_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0],
            },
            Reported {
                key: "retardation_s",
                stated: Stated::Time,
                of: |at| at[1],
            },
        ]
    }
}
