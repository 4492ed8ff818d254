//! The thesis's law (14): the charge strains the spring of the network, and a dashpot lets the strain relax.

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `kappa = alpha q_S`, `q_S' = q' - lambda q_S`.
pub struct BackRelaxation;

impl BendingLaw for BackRelaxation {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa = alpha q_S,  q_S' = q' - lambda q_S",
            driven_by: "the charge strains the polymer network from inside, between spring and dashpot",
            source: "V. Vunder, equations 14 to 20",
            limits: "under a held voltage all bending relaxes in the end",
        }
    }

    fn shapes(&self) -> &'static [Shape] {
        &[Shape::Rate]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        vec![charge.sprung_c(shapes[0])]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "alpha_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0],
            },
            Reported {
                key: "lambda_per_s",
                stated: Stated::FromZero,
                of: |at| at[1],
            },
        ]
    }
}
