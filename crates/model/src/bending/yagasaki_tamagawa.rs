//! Yagasaki and Tamagawa's law (1): a strip whose modulus changes with the time since the step.

use ieap_domain::Drive;

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `kappa = alpha q E0 / E(t)`, `E(t) = E0 + (E1 t + E2) e^(-lambda t)`, with alpha = mu/(E0 I).
///
/// Bending tells only the ratios E1/E0 and E2/E0: the modulus itself needs a force.
pub struct YagasakiTamagawa;

impl BendingLaw for YagasakiTamagawa {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa = alpha q E0 / E(t),  E(t) = E0 + (E1 t + E2) e^(-lambda t),  E0 > E2 > 0,  E1, lambda > 0",
            driven_by: "the moment mu q of the charge (15), which the lumped circuit gives, on a strip of changing modulus",
            source: "Yagasaki and Tamagawa as the thesis states it, equation 1",
            limits: "the modulus counts time from one step of the voltage: runs with further steps are not described; \
                     in the end the strip is bent by alpha q",
        }
    }

    fn shapes(&self) -> &'static [Shape] {
        // E1/E0 in 1/s, E2/E0, lambda.
        &[Shape::Rate, Shape::Part, Shape::Rate]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        let softened = |(q, elapsed_s): (f64, Option<f64>)| {
            let t = elapsed_s.unwrap_or(0.0);
            q / (1.0 + (shapes[0] * t + shapes[1]) * (-shapes[2] * t).exp())
        };
        vec![
            charge
                .charge_c()
                .into_iter()
                .zip(charge.elapsed_s())
                .map(softened)
                .collect(),
        ]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "alpha_final_per_c_cm",
                stated: Stated::Coupling,
                of: |at| at[0],
            },
            Reported {
                key: "e1_per_e0_per_s",
                stated: Stated::FromZero,
                of: |at| at[1],
            },
            Reported {
                key: "e2_per_e0",
                stated: Stated::FromZero,
                of: |at| at[2],
            },
            Reported {
                key: "stiffening_rate_per_s",
                stated: Stated::FromZero,
                of: |at| at[3],
            },
        ]
    }

    fn refuses(&self, drive: &Drive) -> Option<&'static str> {
        (drive.segments.len() > 1)
            .then_some("its modulus counts the time from one step, and the drive of this run has several")
    }
}
