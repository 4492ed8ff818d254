//! Bao's two-way transport (2): what the ions drag along bends the strip, and its surplus diffuses back.

use super::{BendingLaw, ChargeCourse, LawText, Reported, Shape, Stated};

/// `kappa' = K1 q' - (kappa - K2 q) / tau_2`.
///
/// With `q_S' = q' - q_S / tau_2` it is `kappa = K1 q_S + K2 (q - q_S)` for any drive.
pub struct BaoTwoWay;

impl BendingLaw for BaoTwoWay {
    fn about(&self) -> LawText {
        LawText {
            equation: "kappa' = K1 q' - (kappa - K2 q) / tau_2",
            driven_by: "the charge, which the lumped circuit gives: ions drag water along, its surplus flows back",
            source: "Bao and others as the thesis states it, equation 2",
            limits: "K2 = 0 is the thesis's model, K2 between 0 and K1 keeps a part of the bending, K2 above K1 creeps on; \
                     one time constant for all that flows back",
        }
    }

    fn couplings(&self) -> usize {
        2
    }

    fn shapes(&self) -> &'static [Shape] {
        &[Shape::Rate]
    }

    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>> {
        let sprung = charge.sprung_c(shapes[0]);
        let relaxed = charge
            .charge_c()
            .iter()
            .zip(&sprung)
            .map(|(q, s)| q - s)
            .collect();
        vec![sprung, relaxed]
    }

    fn reported(&self) -> &'static [Reported] {
        &[
            Reported {
                key: "k1_per_c_cm",
                stated: Stated::Signed,
                of: |at| at[0],
            },
            Reported {
                key: "k2_per_c_cm",
                stated: Stated::Signed,
                of: |at| at[1],
            },
            Reported {
                key: "transport_s",
                stated: Stated::Time,
                of: |at| at[2],
            },
            Reported {
                key: "kept_part",
                stated: Stated::Signed,
                of: |at| at[1] / at[0],
            },
        ]
    }
}
