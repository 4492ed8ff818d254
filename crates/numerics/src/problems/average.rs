//! NIST StRD, nonlinear regression, average level of difficulty.

use super::lower::{LANCZOS_STARTS, LANCZOS_X, MISRA_X, MISRA_Y, three_decays};
use super::{Difficulty, Model, Problem, Readings};

const LANCZOS1_Y: [f64; 24] = [
    2.513400000000E+00,
    2.044333373291E+00,
    1.668404436564E+00,
    1.366418021208E+00,
    1.123232487372E+00,
    9.268897180037E-01,
    7.679338563728E-01,
    6.388775523106E-01,
    5.337835317402E-01,
    4.479363617347E-01,
    3.775847884350E-01,
    3.197393199326E-01,
    2.720130773746E-01,
    2.324965529032E-01,
    1.996589546065E-01,
    1.722704126914E-01,
    1.493405660168E-01,
    1.300700206922E-01,
    1.138119324644E-01,
    1.000415587559E-01,
    8.833209084540E-02,
    7.833544019350E-02,
    6.976693743449E-02,
    6.239312536719E-02,
];
const LANCZOS2_Y: [f64; 24] = [
    2.51340, 2.04433, 1.66840, 1.36642, 1.12323, 0.926890, 0.767934, 0.638878, 0.533784, 0.447936, 0.377585,
    0.319739, 0.272013, 0.232497, 0.199659, 0.172270, 0.149341, 0.130070, 0.113812, 0.100042, 0.0883321,
    0.0783354, 0.0697669, 0.0623931,
];

const MGH17_X: [f64; 33] = [
    0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0, 130.0, 140.0, 150.0,
    160.0, 170.0, 180.0, 190.0, 200.0, 210.0, 220.0, 230.0, 240.0, 250.0, 260.0, 270.0, 280.0, 290.0, 300.0,
    310.0, 320.0,
];
const MGH17_Y: [f64; 33] = [
    0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628,
    0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420,
    0.414, 0.411, 0.406,
];

/// Quantum defects in iodine atoms (Roszman).
const ROSZMAN_X: [f64; 25] = [
    -4868.68, -4868.09, -4867.41, -3375.19, -3373.14, -3372.03, -2473.74, -2472.35, -2469.45, -1894.65,
    -1893.40, -1497.24, -1495.85, -1493.41, -1208.68, -1206.18, -1206.04, -997.92, -996.61, -996.31, -834.94,
    -834.66, -710.03, -530.16, -464.17,
];
const ROSZMAN_Y: [f64; 25] = [
    0.252429, 0.252141, 0.251809, 0.297989, 0.296257, 0.295319, 0.339603, 0.337731, 0.333820, 0.389510,
    0.386998, 0.438864, 0.434887, 0.427893, 0.471568, 0.461699, 0.461144, 0.513532, 0.506641, 0.505062,
    0.535648, 0.533726, 0.568064, 0.612886, 0.624169,
];

pub(super) static PROBLEMS: [Problem; 6] = [
    Problem {
        source: "NIST StRD, Misra1c",
        difficulty: Difficulty::Average,
        model: Model::OfOne(root_saturation),
        readings: Readings::Typed(&MISRA_X, &MISRA_Y),
        starts: [&[500.0, 0.0001], &[600.0, 0.0002]],
        certified: &[6.3642725809E+02, 2.0813627256E-04],
        square: 4.0966836971E-02,
    },
    Problem {
        source: "NIST StRD, Misra1d",
        difficulty: Difficulty::Average,
        model: Model::OfOne(hyperbola),
        readings: Readings::Typed(&MISRA_X, &MISRA_Y),
        starts: [&[500.0, 0.0001], &[450.0, 0.0003]],
        certified: &[4.3736970754E+02, 3.0227324449E-04],
        square: 5.6419295283E-02,
    },
    Problem {
        source: "NIST StRD, Lanczos1",
        difficulty: Difficulty::Average,
        model: Model::OfOne(three_decays),
        readings: Readings::Typed(&LANCZOS_X, &LANCZOS1_Y),
        starts: LANCZOS_STARTS,
        certified: &[
            9.5100000027E-02,
            1.0000000001E+00,
            8.6070000013E-01,
            3.0000000002E+00,
            1.5575999998E+00,
            5.0000000001E+00,
        ],
        square: 1.4307867721E-25,
    },
    Problem {
        source: "NIST StRD, Lanczos2",
        difficulty: Difficulty::Average,
        model: Model::OfOne(three_decays),
        readings: Readings::Typed(&LANCZOS_X, &LANCZOS2_Y),
        starts: LANCZOS_STARTS,
        certified: &[
            9.6251029939E-02,
            1.0057332849E+00,
            8.6424689056E-01,
            3.0078283915E+00,
            1.5529016879E+00,
            5.0028798100E+00,
        ],
        square: 2.2299428125E-11,
    },
    Problem {
        source: "NIST StRD, MGH17",
        difficulty: Difficulty::Average,
        model: Model::OfOne(two_decays),
        readings: Readings::Typed(&MGH17_X, &MGH17_Y),
        starts: [&[50.0, 150.0, -100.0, 1.0, 2.0], &[0.5, 1.5, -1.0, 0.01, 0.02]],
        certified: &[
            3.7541005211E-01,
            1.9358469127E+00,
            -1.4646871366E+00,
            1.2867534640E-02,
            2.2122699662E-02,
        ],
        square: 5.4648946975E-05,
    },
    Problem {
        source: "NIST StRD, Roszman1",
        difficulty: Difficulty::Average,
        model: Model::OfOne(quantum_defect),
        readings: Readings::Typed(&ROSZMAN_X, &ROSZMAN_Y),
        starts: [
            &[0.1, -0.00001, 1000.0, -100.0],
            &[0.2, -0.000005, 1200.0, -150.0],
        ],
        certified: &[
            2.0196866396E-01,
            -6.1953516256E-06,
            1.2044556708E+03,
            -1.8134269537E+02,
        ],
        square: 4.9484847331E-04,
    },
];

/// b1 (1 - (1 + 2 b2 x)^-1/2).
fn root_saturation(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let base = 1.0 + 2.0 * b[1] * x;
    slopes[0] = 1.0 - base.powf(-0.5);
    slopes[1] = b[0] * x * base.powf(-1.5);
    b[0] * slopes[0]
}

/// b1 b2 x / (1 + b2 x).
fn hyperbola(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let base = 1.0 + b[1] * x;
    slopes[0] = b[1] * x / base;
    slopes[1] = b[0] * x / (base * base);
    b[0] * slopes[0]
}

/// b1 + b2 e^(-b4 x) + b3 e^(-b5 x).
fn two_decays(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    slopes[0] = 1.0;
    for k in [1, 2] {
        slopes[k] = (-b[k + 2] * x).exp();
        slopes[k + 2] = -x * b[k] * slopes[k];
    }
    b[0] + b[1] * slopes[1] + b[2] * slopes[2]
}

/// b1 - b2 x - arctan(b3 / (x - b4)) / pi.
fn quantum_defect(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let apart = x - b[3];
    let square = std::f64::consts::PI * (apart * apart + b[2] * b[2]);
    slopes[0] = 1.0;
    slopes[1] = -x;
    slopes[2] = -apart / square;
    slopes[3] = -b[2] / square;
    b[0] - b[1] * x - (b[2] / apart).atan() / std::f64::consts::PI
}
