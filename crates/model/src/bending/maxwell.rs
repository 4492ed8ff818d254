//! A Maxwell material (thesis figure 9B) under the moment of the charge (15): spring and dashpot in a row.

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `kappa' = alpha (q' + (E/eta) q)` with `alpha = mu/(E I)`: the strip bends with the charge and then flows on.
pub struct Maxwell;

impl BendingLaw for Maxwell {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa' = alpha (q' + (E/eta) q)",
            driven_by: "the moment mu q of the charge (15), which the lumped circuit gives, put on from outside",
            source: "thesis figure 9B",
            limits: "under a held voltage the bending never falls, and it grows without end",
        }
    }

    fn shapes(&self) -> &'static [Shape] {
        &[Shape::Rate]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        let gathered = charge.integral_c_s();
        let flowed = |(q, sum): (&f64, f64)| q + shapes[0] * sum;
        vec![charge.charge_c().iter().zip(gathered).map(flowed).collect()]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "alpha_first_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0],
            },
            Reported {
                key: "flow_rate_per_s",
                stated: Stated::FromZero,
                of: |at| at[1],
            },
        ]
    }
}
