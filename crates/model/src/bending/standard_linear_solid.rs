//! A standard linear solid (thesis figure 9C) under the moment of the charge (15): a spring beside a Maxwell arm.

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `sigma + (eta/E2) sigma' = E1 eps + eta (1 + E1/E2) eps'` with the moment of the charge as the stress:
/// `kappa = alpha_0 (q + (E2/E1) (q - q_S))`, where q_S is the charge that a spring of the rate
/// `E1 E2 / ((E1 + E2) eta)` still feels. It bends by `alpha_0 = mu/((E1 + E2) I)` at once and by `mu/(E1 I)` in the end.
pub struct StandardLinearSolid;

impl BendingLaw for StandardLinearSolid {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa + tau kappa' = alpha_inf q + alpha_0 tau q',  alpha_inf >= alpha_0",
            driven_by: "the moment mu q of the charge (15), which the lumped circuit gives, put on from outside",
            source: "thesis figure 9C",
            limits: "under a held voltage the bending never falls: it creeps from alpha_0 q to alpha_inf q",
        }
    }

    fn shapes(&self) -> &'static [Shape] {
        &[Shape::Rate, Shape::Excess]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        let sprung = charge.sprung_c(shapes[0]);
        let crept = |(q, s): (&f64, f64)| q + shapes[1] * (q - s);
        vec![charge.charge_c().iter().zip(sprung).map(crept).collect()]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "alpha_first_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0],
            },
            Reported {
                key: "alpha_final_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0] * (1.0 + at[2]),
            },
            Reported {
                key: "retardation_s",
                stated: Stated::Time,
                of: |at| at[1],
            },
        ]
    }

    fn natural(&self, reported: &[f64]) -> Vec<f64> {
        vec![reported[0], reported[2].recip(), reported[1] / reported[0] - 1.0]
    }

    /// Without the arm's spring nothing creeps, and the rate has nothing to shape.
    fn is_idle(&self, shapes: &[f64]) -> bool {
        shapes[1] <= 0.0
    }
}
