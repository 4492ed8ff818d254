//! NIST StRD, nonlinear regression, higher level of difficulty.

use super::lower::saturation;
use super::{Difficulty, Model, Problem, Readings};

const MGH09_X: [f64; 11] = [
    4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625,
];
const MGH09_Y: [f64; 11] = [
    0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246,
];

const MGH10_X: [f64; 16] = [
    50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0, 95.0, 100.0, 105.0, 110.0, 115.0, 120.0, 125.0,
];
const MGH10_Y: [f64; 16] = [
    34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0,
    4427.0, 3820.0, 3307.0, 2872.0,
];

/// Electron mobility over the logarithm of the density (Thurber).
const THURBER_X: [f64; 37] = [
    -3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363, -2.322, -1.501,
    -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545, -0.400, -0.309, -0.109, -0.103,
    0.010, 0.119, 0.377, 0.790, 0.963, 1.006, 1.115, 1.572, 1.841, 2.047, 2.200,
];
const THURBER_Y: [f64; 37] = [
    80.574, 84.248, 87.264, 87.195, 89.076, 89.608, 89.868, 90.101, 92.405, 95.854, 100.696, 101.060,
    401.672, 390.724, 567.534, 635.316, 733.054, 759.087, 894.206, 990.785, 1090.109, 1080.914, 1122.643,
    1178.351, 1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384, 1442.962,
    1464.350, 1468.705, 1447.894, 1457.628,
];

/// Biochemical oxygen demand over days (Box, Hunter and Hunter 1978).
const BOX_BOD_X: [f64; 6] = [1.0, 2.0, 3.0, 5.0, 7.0, 10.0];
const BOX_BOD_Y: [f64; 6] = [109.0, 149.0, 149.0, 191.0, 213.0, 224.0];

/// Pasture yield and onion weight over time (Ratkowsky 1983).
const RAT42_X: [f64; 9] = [9.0, 14.0, 21.0, 28.0, 42.0, 57.0, 63.0, 70.0, 79.0];
const RAT42_Y: [f64; 9] = [
    8.930, 10.800, 18.590, 22.330, 39.350, 56.110, 61.730, 64.620, 67.080,
];
const RAT43_X: [f64; 15] = [
    1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
];
const RAT43_Y: [f64; 15] = [
    16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56, 689.96,
    637.56, 717.41,
];

/// Circular interference transmittance over the wavelength (Eckerle).
const ECKERLE_X: [f64; 35] = [
    400.0, 405.0, 410.0, 415.0, 420.0, 425.0, 430.0, 435.0, 436.5, 438.0, 439.5, 441.0, 442.5, 444.0, 445.5,
    447.0, 448.5, 450.0, 451.5, 453.0, 454.5, 456.0, 457.5, 459.0, 460.5, 462.0, 463.5, 465.0, 470.0, 475.0,
    480.0, 485.0, 490.0, 495.0, 500.0,
];
const ECKERLE_Y: [f64; 35] = [
    0.0001575, 0.0001699, 0.0002350, 0.0003102, 0.0004917, 0.0008710, 0.0017418, 0.0046400, 0.0065895,
    0.0097302, 0.0149002, 0.0237310, 0.0401683, 0.0712559, 0.1264458, 0.2073413, 0.2902366, 0.3445623,
    0.3698049, 0.3668534, 0.3106727, 0.2078154, 0.1164354, 0.0616764, 0.0337200, 0.0194023, 0.0117831,
    0.0074357, 0.0022732, 0.0008800, 0.0004579, 0.0002345, 0.0001586, 0.0001143, 0.0000710,
];

pub(super) static PROBLEMS: [Problem; 7] = [
    Problem {
        source: "NIST StRD, MGH09",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(kowalik_osborne),
        readings: Readings::Typed(&MGH09_X, &MGH09_Y),
        starts: [&[25.0, 39.0, 41.5, 39.0], &[0.25, 0.39, 0.415, 0.39]],
        certified: &[
            1.9280693458E-01,
            1.9128232873E-01,
            1.2305650693E-01,
            1.3606233068E-01,
        ],
        square: 3.0750560385E-04,
    },
    Problem {
        source: "NIST StRD, MGH10",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(thermistor),
        readings: Readings::Typed(&MGH10_X, &MGH10_Y),
        starts: [&[2.0, 400000.0, 25000.0], &[0.02, 4000.0, 250.0]],
        certified: &[5.6096364710E-03, 6.1813463463E+03, 3.4522363462E+02],
        square: 8.7945855171E+01,
    },
    Problem {
        source: "NIST StRD, Thurber",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(cubic_ratio),
        readings: Readings::Typed(&THURBER_X, &THURBER_Y),
        starts: [
            &[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03],
            &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05],
        ],
        certified: &[
            1.2881396800E+03,
            1.4910792535E+03,
            5.8323836877E+02,
            7.5416644291E+01,
            9.6629502864E-01,
            3.9797285797E-01,
            4.9727297349E-02,
        ],
        square: 5.6427082397E+03,
    },
    Problem {
        source: "NIST StRD, BoxBOD",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(saturation),
        readings: Readings::Typed(&BOX_BOD_X, &BOX_BOD_Y),
        starts: [&[1.0, 1.0], &[100.0, 0.75]],
        certified: &[2.1380940889E+02, 5.4723748542E-01],
        square: 1.1680088766E+03,
    },
    Problem {
        source: "NIST StRD, Rat42",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(logistic),
        readings: Readings::Typed(&RAT42_X, &RAT42_Y),
        starts: [&[100.0, 1.0, 0.1], &[75.0, 2.5, 0.07]],
        certified: &[7.2462237576E+01, 2.6180768402E+00, 6.7359200066E-02],
        square: 8.0565229338E+00,
    },
    Problem {
        source: "NIST StRD, Rat43",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(richards),
        readings: Readings::Typed(&RAT43_X, &RAT43_Y),
        starts: [&[100.0, 10.0, 1.0, 1.0], &[700.0, 5.0, 0.75, 1.3]],
        certified: &[
            6.9964151270E+02,
            5.2771253025E+00,
            7.5962938329E-01,
            1.2792483859E+00,
        ],
        square: 8.7864049080E+03,
    },
    Problem {
        source: "NIST StRD, Eckerle4",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(bell),
        readings: Readings::Typed(&ECKERLE_X, &ECKERLE_Y),
        starts: [&[1.0, 10.0, 500.0], &[1.5, 5.0, 450.0]],
        certified: &[1.5543827178E+00, 4.0888321754E+00, 4.5154121844E+02],
        square: 1.4635887487E-03,
    },
];

/// b1 (x^2 + b2 x) / (x^2 + b3 x + b4).
fn kowalik_osborne(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let (over, under) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
    slopes[0] = over / under;
    slopes[1] = b[0] * x / under;
    slopes[2] = -b[0] * over * x / (under * under);
    slopes[3] = -b[0] * over / (under * under);
    b[0] * slopes[0]
}

/// b1 e^(b2 / (x + b3)).
fn thermistor(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let per = (x + b[2]).recip();
    slopes[0] = (b[1] * per).exp();
    slopes[1] = b[0] * per * slopes[0];
    slopes[2] = -b[1] * per * slopes[1];
    b[0] * slopes[0]
}

/// (b1 + b2 x + b3 x^2 + b4 x^3) / (1 + b5 x + b6 x^2 + b7 x^3).
pub(super) fn cubic_ratio(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let over = b[0] + x * (b[1] + x * (b[2] + x * b[3]));
    let per = (1.0 + x * (b[4] + x * (b[5] + x * b[6]))).recip();
    let mut power = 1.0;
    for k in 0..4 {
        slopes[k] = power * per;
        if k > 0 {
            slopes[3 + k] = -over * power * per * per;
        }
        power *= x;
    }
    over * per
}

/// b1 / (1 + e^(b2 - b3 x)).
fn logistic(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let e = (b[1] - b[2] * x).exp();
    slopes[0] = (1.0 + e).recip();
    slopes[1] = -b[0] * e * slopes[0] * slopes[0];
    slopes[2] = -x * slopes[1];
    b[0] * slopes[0]
}

/// b1 / (1 + e^(b2 - b3 x))^(1/b4).
fn richards(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let e = (b[1] - b[2] * x).exp();
    let power = -b[3].recip();
    slopes[0] = (1.0 + e).powf(power);
    slopes[1] = b[0] * power * e * (1.0 + e).powf(power - 1.0);
    slopes[2] = -x * slopes[1];
    slopes[3] = b[0] * power * power * e.ln_1p() * slopes[0];
    b[0] * slopes[0]
}

/// b1/b2 e^(-(x - b3)^2 / (2 b2^2)).
fn bell(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let place = (x - b[2]) / b[1];
    slopes[0] = (-0.5 * place * place).exp() / b[1];
    slopes[1] = b[0] * slopes[0] * (place * place - 1.0) / b[1];
    slopes[2] = b[0] * slopes[0] * place / b[1];
    b[0] * slopes[0]
}
