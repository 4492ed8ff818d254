//! NIST StRD, nonlinear regression, the problems of all levels whose readings are many: they stand in files.

use std::f64::consts::TAU;

use super::higher::cubic_ratio;
use super::{Difficulty, Model, Problem, Readings};

pub(super) static PROBLEMS: [Problem; 10] = [
    Problem {
        source: "NIST StRD, Chwirut1",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(decay_over_line),
        readings: Readings::File(include_str!("readings/chwirut1.dat")),
        starts: [&[0.1, 0.01, 0.02], &[0.15, 0.008, 0.010]],
        certified: &[1.9027818370E-01, 6.1314004477E-03, 1.0530908399E-02],
        square: 2.3844771393E+03,
    },
    Problem {
        source: "NIST StRD, Chwirut2",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(decay_over_line),
        readings: Readings::File(include_str!("readings/chwirut2.dat")),
        starts: [&[0.1, 0.01, 0.02], &[0.15, 0.008, 0.010]],
        certified: &[1.6657666537E-01, 5.1653291286E-03, 1.2150007096E-02],
        square: 5.1304802941E+02,
    },
    Problem {
        source: "NIST StRD, Gauss1",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(two_bells),
        readings: Readings::File(include_str!("readings/gauss1.dat")),
        starts: [
            &[97.0, 0.009, 100.0, 65.0, 20.0, 70.0, 178.0, 16.5],
            &[94.0, 0.0105, 99.0, 63.0, 25.0, 71.0, 180.0, 20.0],
        ],
        certified: &[
            9.8778210871E+01,
            1.0497276517E-02,
            1.0048990633E+02,
            6.7481111276E+01,
            2.3129773360E+01,
            7.1994503004E+01,
            1.7899805021E+02,
            1.8389389025E+01,
        ],
        square: 1.3158222432E+03,
    },
    Problem {
        source: "NIST StRD, Gauss2",
        difficulty: Difficulty::Lower,
        model: Model::OfOne(two_bells),
        readings: Readings::File(include_str!("readings/gauss2.dat")),
        starts: [
            &[96.0, 0.009, 103.0, 106.0, 18.0, 72.0, 151.0, 18.0],
            &[98.0, 0.0105, 103.0, 105.0, 20.0, 73.0, 150.0, 20.0],
        ],
        certified: &[
            9.9018328406E+01,
            1.0994945399E-02,
            1.0188022528E+02,
            1.0703095519E+02,
            2.3578584029E+01,
            7.2045589471E+01,
            1.5327010194E+02,
            1.9525972636E+01,
        ],
        square: 1.2475282092E+03,
    },
    Problem {
        source: "NIST StRD, Gauss3",
        difficulty: Difficulty::Average,
        model: Model::OfOne(two_bells),
        readings: Readings::File(include_str!("readings/gauss3.dat")),
        starts: [
            &[94.9, 0.009, 90.1, 113.0, 20.0, 73.8, 140.0, 20.0],
            &[96.0, 0.0096, 80.0, 110.0, 25.0, 74.0, 139.0, 25.0],
        ],
        certified: &[
            9.8940368970E+01,
            1.0945879335E-02,
            1.0069553078E+02,
            1.1163619459E+02,
            2.3300500029E+01,
            7.3705031418E+01,
            1.4776164251E+02,
            1.9668221230E+01,
        ],
        square: 1.2444846360E+03,
    },
    Problem {
        source: "NIST StRD, Kirby2",
        difficulty: Difficulty::Average,
        model: Model::OfOne(square_ratio),
        readings: Readings::File(include_str!("readings/kirby2.dat")),
        starts: [
            &[2.0, -0.1, 0.003, -0.001, 0.00001],
            &[1.5, -0.15, 0.0025, -0.0015, 0.00002],
        ],
        certified: &[
            1.6745063063E+00,
            -1.3927397867E-01,
            2.5961181191E-03,
            -1.7241811870E-03,
            2.1664802578E-05,
        ],
        square: 3.9050739624E+00,
    },
    Problem {
        source: "NIST StRD, Hahn1",
        difficulty: Difficulty::Average,
        model: Model::OfOne(cubic_ratio),
        readings: Readings::File(include_str!("readings/hahn1.dat")),
        starts: [
            &[10.0, -1.0, 0.05, -0.00001, -0.05, 0.001, -0.000001],
            &[1.0, -0.1, 0.005, -0.000001, -0.005, 0.0001, -0.0000001],
        ],
        certified: &[
            1.0776351733E+00,
            -1.2269296921E-01,
            4.0863750610E-03,
            -1.4262662514E-06,
            -5.7609940901E-03,
            2.4053735503E-04,
            -1.2314450199E-07,
        ],
        square: 1.5324382854E+00,
    },
    Problem {
        source: "NIST StRD, Nelson",
        difficulty: Difficulty::Average,
        model: Model::OfTwo(ageing),
        readings: Readings::FileOfLogarithms(include_str!("readings/nelson.dat")),
        starts: [&[2.0, 0.0001, -0.01], &[2.5, 0.000000005, -0.05]],
        certified: &[2.5906836021E+00, 5.6177717026E-09, -5.7701013174E-02],
        square: 3.7976833176E+00,
    },
    Problem {
        source: "NIST StRD, ENSO",
        difficulty: Difficulty::Average,
        model: Model::OfOne(three_cycles),
        readings: Readings::File(include_str!("readings/enso.dat")),
        starts: [
            &[11.0, 3.0, 0.5, 40.0, -0.7, -1.3, 25.0, -0.3, 1.4],
            &[10.0, 3.0, 0.5, 44.0, -1.5, 0.5, 26.0, -0.1, 1.5],
        ],
        certified: &[
            1.0510749193E+01,
            3.0762128085E+00,
            5.3280138227E-01,
            4.4311088700E+01,
            -1.6231428586E+00,
            5.2554493756E-01,
            2.6887614440E+01,
            2.1232288488E-01,
            1.4966870418E+00,
        ],
        square: 7.8853978668E+02,
    },
    Problem {
        source: "NIST StRD, Bennett5",
        difficulty: Difficulty::Higher,
        model: Model::OfOne(shifted_power),
        readings: Readings::File(include_str!("readings/bennett5.dat")),
        starts: [&[-2000.0, 50.0, 0.8], &[-1500.0, 45.0, 0.85]],
        certified: &[-2.5235058043E+03, 4.6736564644E+01, 9.3218483193E-01],
        square: 5.2404744073E-04,
    },
];

/// e^(-b1 x) / (b2 + b3 x).
fn decay_over_line(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let line = b[1] + b[2] * x;
    let value = (-b[0] * x).exp() / line;
    slopes[0] = -x * value;
    slopes[1] = -value / line;
    slopes[2] = x * slopes[1];
    value
}

/// b1 e^(-b2 x) + b3 e^(-(x - b4)^2 / b5^2) + b6 e^(-(x - b7)^2 / b8^2).
fn two_bells(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    slopes[0] = (-b[1] * x).exp();
    slopes[1] = -b[0] * x * slopes[0];
    let mut sum = b[0] * slopes[0];
    for k in [2, 5] {
        let place = (x - b[k + 1]) / b[k + 2];
        slopes[k] = (-place * place).exp();
        slopes[k + 1] = 2.0 * b[k] * slopes[k] * place / b[k + 2];
        slopes[k + 2] = slopes[k + 1] * place;
        sum += b[k] * slopes[k];
    }
    sum
}

/// (b1 + b2 x + b3 x^2) / (1 + b4 x + b5 x^2).
fn square_ratio(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let per = (1.0 + x * (b[3] + x * b[4])).recip();
    let value = (b[0] + x * (b[1] + x * b[2])) * per;
    slopes[0] = per;
    slopes[1] = x * per;
    slopes[2] = x * x * per;
    slopes[3] = -value * slopes[1];
    slopes[4] = -value * slopes[2];
    value
}

/// b1 - b2 x1 e^(-b3 x2).
fn ageing(b: &[f64], [weeks, celsius]: [f64; 2], slopes: &mut [f64]) -> f64 {
    let speed = (-b[2] * celsius).exp();
    slopes[0] = 1.0;
    slopes[1] = -weeks * speed;
    slopes[2] = b[1] * weeks * celsius * speed;
    b[0] + b[1] * slopes[1]
}

/// b1 + b2 cos(2 pi x/12) + b3 sin(2 pi x/12) + b5 cos(2 pi x/b4) + b6 sin(2 pi x/b4) + b8 cos(2 pi x/b7) + b9 sin(2 pi x/b7).
fn three_cycles(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    slopes[0] = 1.0;
    (slopes[2], slopes[1]) = (TAU * x / 12.0).sin_cos();
    let mut sum = b[0] + b[1] * slopes[1] + b[2] * slopes[2];
    for k in [3, 6] {
        let angle = TAU * x / b[k];
        let (sin, cos) = angle.sin_cos();
        slopes[k] = (b[k + 1] * sin - b[k + 2] * cos) * angle / b[k];
        slopes[k + 1] = cos;
        slopes[k + 2] = sin;
        sum += b[k + 1] * cos + b[k + 2] * sin;
    }
    sum
}

/// b1 (b2 + x)^(-1/b3).
fn shifted_power(b: &[f64], x: f64, slopes: &mut [f64]) -> f64 {
    let base = b[1] + x;
    slopes[0] = base.powf(-b[2].recip());
    slopes[1] = -b[0] * slopes[0] / (b[2] * base);
    slopes[2] = b[0] * slopes[0] * base.ln() / (b[2] * b[2]);
    b[0] * slopes[0]
}
