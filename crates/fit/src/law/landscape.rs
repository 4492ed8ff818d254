//! The sum of squares of the curvature over the shapes of a law, its couplings and an offset eliminated.

use ieap_model::bending::{BendingLaw, ChargeCourse, Shape};
use ieap_numerics::global::Landscape;
use ieap_numerics::least_squares::{Bounds, Local, Problem};
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use crate::sampled::Sampled;

/// Steps of the coordinates for derivatives.
const STEP: f64 = 1e-5;
/// Pivot, relative to the diagonal, below which courses count as alike.
const ALIKE: f64 = 1e-14;
/// Largest ratio that is searched.
const MOST_EXCESS: f64 = 1e3;
/// Places from which a search descends.
const DESCENTS: usize = 3;
/// Values of a rate in the coarse look of a law with one shape, and with several.
const GRID_ALONE: usize = 17;
const GRID_AMONG: usize = 10;

/// How shapes are searched: rates by `ln(1 + rate unit)`, a logarithm for fast ones that still holds none at all; parts
/// as they are; ratios by `ln(1 + ratio)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinates {
    unit_s: f64,
    highest_rate: f64,
}

impl Coordinates {
    pub(super) fn of(sampled: &Sampled) -> Coordinates {
        let (shortest_s, longest_s) = sampled.time_scales_s();
        let unit_s = if longest_s > 0.0 { longest_s } else { 1.0 };
        Coordinates {
            unit_s,
            highest_rate: (10.0 * unit_s / shortest_s.min(unit_s)).ln_1p(),
        }
    }

    pub(super) fn value(&self, shape: Shape, at: f64) -> f64 {
        match shape {
            Shape::Rate => at.exp_m1() / self.unit_s,
            Shape::Part => at,
            Shape::Excess => at.exp_m1(),
        }
    }

    pub(super) fn values(&self, shapes: &[Shape], at: &[f64]) -> Vec<f64> {
        shapes
            .iter()
            .zip(at)
            .map(|(&shape, &at)| self.value(shape, at))
            .collect()
    }

    /// The least and the greatest coordinate; the least is no shape at all.
    pub(super) fn limits(&self, shape: Shape) -> (f64, f64) {
        match shape {
            Shape::Rate => (0.0, self.highest_rate),
            Shape::Part => (0.0, 1.0),
            Shape::Excess => (0.0, MOST_EXCESS.ln_1p()),
        }
    }

    /// Coordinates of a coarse look.
    fn grid(&self, shape: Shape, alone: bool) -> Vec<f64> {
        match shape {
            Shape::Part => vec![0.05, 0.3, 0.7],
            Shape::Excess => [0.1_f64, 0.5, 2.0, 10.0].map(f64::ln_1p).to_vec(),
            Shape::Rate => {
                let count = if alone { GRID_ALONE } else { GRID_AMONG };
                let (low, top) = (0.02_f64.ln(), self.highest_rate.exp_m1().max(0.1).ln());
                let rate = |k: usize| (low + (top - low) * k as f64 / count as f64).exp().ln_1p();
                (0..count).map(rate).collect()
            }
        }
    }
}

/// The sum of squares over what stands for the readings.
pub(super) struct Shapes<'a> {
    pub(super) law: &'static dyn BendingLaw,
    pub(super) charge: &'a ChargeCourse,
    pub(super) nodes: &'a Sampled,
    /// Weighted values.
    pub(super) values: Vec<f64>,
    pub(super) with_offset: bool,
    pub(super) coordinates: Coordinates,
}

/// Weighted courses with their coefficients.
pub(super) struct Solved {
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) coefficients: Vec<f64>,
    /// Weighted values without what the courses explain.
    pub(super) left: Vec<f64>,
    normal: Symmetric,
}

impl Shapes<'_> {
    /// Courses of the couplings, and ones where an offset is fitted, all weighted.
    pub(super) fn columns(&self, shapes: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = self.law.courses(self.charge, shapes);
        if self.with_offset {
            columns.push(vec![1.0; self.charge.len()]);
        }
        columns.iter_mut().for_each(|column| self.nodes.weigh_all(column));
        columns
    }

    /// The best couplings, and offset, for these shapes.
    pub(super) fn solve(&self, shapes: &[f64]) -> Solved {
        let columns = self.columns(shapes);
        let Local { normal, descent, .. } = Local::of(&self.values, &columns);
        let coefficients = match normal.cholesky(ALIKE) {
            Some(factor) => factor.solve(&descent),
            // Courses that are alike: the first alone says what there is.
            None => alone(&normal, &descent),
        };
        let mut left = self.values.clone();
        for (coefficient, column) in coefficients.iter().zip(&columns) {
            sums::add(&mut left, -coefficient, column);
        }
        Solved {
            columns,
            coefficients,
            left,
            normal,
        }
    }

    /// Weighted curvature per unit of the coordinate `k`, by a difference within the limits.
    fn slope(&self, at: &[f64], k: usize, coefficients: &[f64]) -> Vec<f64> {
        let shapes = self.law.shapes();
        let (low, high) = self.coordinates.limits(shapes[k]);
        let ends = [(at[k] - STEP).max(low), (at[k] + STEP).min(high)];
        let bent = |end: f64| {
            let mut there = at.to_vec();
            there[k] = end;
            let columns = self.columns(&self.coordinates.values(shapes, &there));
            sums::combined(&columns, coefficients)
        };
        let [below, above] = ends.map(bent);
        let width = ends[1] - ends[0];
        above.iter().zip(below).map(|(a, b)| (a - b) / width).collect()
    }

    fn square_left(&self, left: &[f64]) -> f64 {
        // What no course reaches between the nodes is the same for all shapes.
        sums::square(left) + (self.nodes.square() - sums::square(&self.values)).max(0.0)
    }
}

fn alone(normal: &Symmetric, right: &[f64]) -> Vec<f64> {
    let mut coefficients = vec![0.0; right.len()];
    let best = (0..right.len())
        .filter(|&k| normal.get(k, k) > 0.0)
        .max_by(|&a, &b| {
            let explained = |k: usize| right[k] * right[k] / normal.get(k, k);
            explained(a).total_cmp(&explained(b))
        });
    if let Some(k) = best {
        coefficients[k] = right[k] / normal.get(k, k);
    }
    coefficients
}

impl Problem for Shapes<'_> {
    fn bounds(&self) -> Bounds {
        let shapes = self.law.shapes().iter();
        let (low, high) = shapes.map(|&shape| self.coordinates.limits(shape)).unzip();
        Bounds { low, high }
    }

    /// Slopes with the couplings held, made orthogonal to the courses: Kaufman's form of variable projection.
    fn local(&self, at: &[f64], _: f64) -> Local {
        let solved = self.solve(&self.coordinates.values(self.law.shapes(), at));
        let count = self.law.shapes().len();
        let slopes: Vec<Vec<f64>> = (0..count)
            .map(|k| {
                let mut slope = self.slope(at, k, &solved.coefficients);
                let right: Vec<f64> = solved
                    .columns
                    .iter()
                    .map(|column| sums::dot(column, &slope))
                    .collect();
                if let Some(factor) = solved.normal.cholesky(ALIKE) {
                    let explained = factor.solve(&right);
                    for (coefficient, column) in explained.iter().zip(&solved.columns) {
                        sums::add(&mut slope, -coefficient, column);
                    }
                }
                slope
            })
            .collect();
        Local {
            square: self.square_left(&solved.left),
            ..Local::of(&solved.left, &slopes)
        }
    }
}

impl Landscape for Shapes<'_> {
    fn square(&self, at: &[f64]) -> f64 {
        let solved = self.solve(&self.coordinates.values(self.law.shapes(), at));
        self.square_left(&solved.left)
    }

    fn starts(&self) -> Vec<Vec<f64>> {
        let shapes = self.law.shapes();
        let mut places: Vec<Vec<f64>> = vec![Vec::new()];
        for &shape in shapes {
            let grid = self.coordinates.grid(shape, shapes.len() == 1);
            let with = |place: &Vec<f64>| {
                let place = place.clone();
                let further = move |&at: &f64| [place.as_slice(), &[at]].concat();
                grid.iter().map(further).collect::<Vec<_>>()
            };
            places = places.iter().flat_map(with).collect();
        }
        places.push(vec![0.0; shapes.len()]);
        let mut judged: Vec<(f64, Vec<f64>)> = places
            .into_iter()
            .map(|place| (self.square(&place), place))
            .collect();
        judged.sort_by(|a, b| a.0.total_cmp(&b.0));
        judged
            .into_iter()
            .take(DESCENTS)
            .map(|(_, place)| place)
            .collect()
    }

    fn size(&self) -> f64 {
        self.nodes.square()
    }
}
