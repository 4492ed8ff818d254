//! Problems with certified answers: the nonlinear regression sets of the Statistical Reference Datasets of NIST
//! (https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml), against which the least-squares kernel is held.

mod average;
mod digits;
mod higher;
mod lower;
mod many_readings;

/// How hard NIST calls a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Difficulty {
    Lower,
    Average,
    Higher,
}

/// Value of a model and its derivatives with respect to the parameters `b`.
#[derive(Clone, Copy)]
pub(super) enum Model {
    /// At `x`.
    OfOne(fn(b: &[f64], x: f64, slopes: &mut [f64]) -> f64),
    /// At `x1` and `x2`.
    OfTwo(fn(b: &[f64], x: [f64; 2], slopes: &mut [f64]) -> f64),
}

impl Model {
    pub(super) fn at(self, b: &[f64], x: &[f64], slopes: &mut [f64]) -> f64 {
        match self {
            Model::OfOne(model) => model(b, x[0], slopes),
            Model::OfTwo(model) => model(b, [x[0], x[1]], slopes),
        }
    }
}

/// Where the readings of a problem stand.
pub(super) enum Readings {
    /// x and y.
    Typed(&'static [f64], &'static [f64]),
    /// A line for each reading, predictors first and the response last; lines from # on are remarks.
    File(&'static str),
    /// The same, but what is fitted is the logarithm of the response.
    FileOfLogarithms(&'static str),
}

impl Readings {
    /// Predictors and response of every reading.
    pub(super) fn rows(&self) -> Vec<(Vec<f64>, f64)> {
        let read = |text: &str| -> Vec<(Vec<f64>, f64)> {
            let lines = text.lines().filter(|line| !line.starts_with('#'));
            let row = |line: &str| {
                let mut numbers: Vec<f64> = line.split(' ').map(|n| n.parse().unwrap()).collect();
                let y = numbers.pop().unwrap();
                (numbers, y)
            };
            lines.map(row).collect()
        };
        match *self {
            Readings::Typed(x, y) => x.iter().zip(y).map(|(x, y)| (vec![*x], *y)).collect(),
            Readings::File(text) => read(text),
            Readings::FileOfLogarithms(text) => {
                let rows = read(text).into_iter();
                rows.map(|(x, y)| (x, y.ln())).collect()
            }
        }
    }
}

/// A problem with data, both official starts and the certified answer.
pub(super) struct Problem {
    /// `NIST StRD, <name>`.
    pub(super) source: &'static str,
    pub(super) difficulty: Difficulty,
    pub(super) model: Model,
    pub(super) readings: Readings,
    pub(super) starts: [&'static [f64]; 2],
    pub(super) certified: &'static [f64],
    /// Certified residual sum of squares.
    pub(super) square: f64,
}

/// Every problem.
pub(super) fn problems() -> impl Iterator<Item = &'static Problem> {
    lower::PROBLEMS
        .iter()
        .chain(&average::PROBLEMS)
        .chain(&higher::PROBLEMS)
        .chain(&many_readings::PROBLEMS)
}
