//! NIST StRD, nonlinear regression, lower level of difficulty.

use super::{Difficulty, Model, Problem, Readings};

/// Volume and pressure of monomolecular adsorption (Misra 1978); four models share these readings.
pub(super) const MISRA_X: [f64; 14] = [
    77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0,
];
pub(super) const MISRA_Y: [f64; 14] = [
    10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78,
];

/// Generated from 0.0951 e^-x + 0.8607 e^-3x + 1.5576 e^-5x (Lanczos 1956).
pub(super) const LANCZOS_X: [f64; 24] = [
    0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9,
    0.95, 1.0, 1.05, 1.1, 1.15,
];
const LANCZOS3_Y: [f64; 24] = [
    2.5134, 2.0443, 1.6684, 1.3664, 1.1232, 0.9269, 0.7679, 0.6389, 0.5338, 0.4479, 0.3776, 0.3197, 0.2720,
    0.2325, 0.1997, 0.1723, 0.1493, 0.1301, 0.1138, 0.1000, 0.0883, 0.0783, 0.0698, 0.0624,
];
pub(super) const LANCZOS_STARTS: [&[f64]; 2] =
    [&[1.2, 0.3, 5.6, 5.5, 6.5, 7.6], &[0.5, 0.7, 3.6, 4.2, 4.0, 6.3]];

const DAN_WOOD_X: [f64; 6] = [1.309, 1.471, 1.490, 1.565, 1.611, 1.680];
const DAN_WOOD_Y: [f64; 6] = [2.138, 3.421, 3.597, 4.340, 4.882, 5.660];

pub(super) static PROBLEMS: [Problem; 4] = [
    Problem {
        source: "NIST StRD, Misra1a",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(saturation),
        readings: Readings::Typed(&MISRA_X, &MISRA_Y),
        starts: [&[500.0, 0.0001], &[250.0, 0.0005]],
        certified: &[2.3894212918E+02, 5.5015643181E-04],
        square: 1.2455138894E-01,
    },
    Problem {
        source: "NIST StRD, Misra1b",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(squared_saturation),
        readings: Readings::Typed(&MISRA_X, &MISRA_Y),
        starts: [&[500.0, 0.0001], &[300.0, 0.0002]],
        certified: &[3.3799746163E+02, 3.9039091287E-04],
        square: 7.5464681533E-02,
    },
    Problem {
        source: "NIST StRD, DanWood",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(power),
        readings: Readings::Typed(&DAN_WOOD_X, &DAN_WOOD_Y),
        starts: [&[1.0, 5.0], &[0.7, 4.0]],
        certified: &[7.6886226176E-01, 3.8604055871E+00],
        square: 4.3173084083E-03,
    },
    Problem {
        source: "NIST StRD, Lanczos3",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(three_decays),
        readings: Readings::Typed(&LANCZOS_X, &LANCZOS3_Y),
        starts: LANCZOS_STARTS,
        certified: &[
            8.6816414977E-02,
            9.5498101505E-01,
            8.4400777463E-01,
            2.9515951832E+00,
            1.5825685901E+00,
            4.9863565084E+00,
        ],
        square: 1.6117193594E-08,
    },
];

/// b1 (1 - e^(-b2 x)).
pub(super) fn saturation(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let left = (-b[1] * x).exp();
    slopes[0] = -(-b[1] * x).exp_m1();
    slopes[1] = b[0] * x * left;
    b[0] * slopes[0]
}

/// b1 (1 - (1 + b2 x/2)^-2).
fn squared_saturation(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let base = 1.0 + 0.5 * b[1] * x;
    slopes[0] = 1.0 - base.powi(-2);
    slopes[1] = b[0] * x * base.powi(-3);
    b[0] * slopes[0]
}

/// b1 x^b2.
fn power(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    slopes[0] = x.powf(b[1]);
    slopes[1] = b[0] * slopes[0] * x.ln();
    b[0] * slopes[0]
}

/// b1 e^(-b2 x) + b3 e^(-b4 x) + b5 e^(-b6 x).
pub(super) fn three_decays(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let mut sum = 0.0;
    for k in [0, 2, 4] {
        let left = (-b[k + 1] * x).exp();
        slopes[k] = left;
        slopes[k + 1] = -b[k] * x * left;
        sum += b[k] * left;
    }
    sum
}
