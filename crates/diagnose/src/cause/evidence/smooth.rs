//! Smooth courses over time as Gaussian processes of few columns: what they explain and what they cost, in closed form.

use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{KNOT_SPACING, KNOTS_FROM_S, NOTHING};
use crate::fitting::tangent::{DEPENDENT, Tangent};
use crate::readings::group::{Block, RunGroup};

/// A column of whitened readings, as pieces that begin at a row.
pub(crate) struct Column {
    pieces: Vec<(usize, Vec<f64>)>,
}

impl Column {
    pub(crate) fn of(pieces: Vec<(usize, Vec<f64>)>) -> Column {
        Column { pieces }
    }

    fn with(&self, series: &[f64]) -> f64 {
        let piece = |(first, values): &(usize, Vec<f64>)| dot(values, &series[*first..first + values.len()]);
        self.pieces.iter().map(piece).sum()
    }

    fn with_column(&self, other: &Column) -> f64 {
        let mut sum = 0.0;
        for (first, values) in &self.pieces {
            if let Some((_, others)) = other.pieces.iter().find(|(begin, _)| begin == first) {
                sum += dot(values, others);
            }
        }
        sum
    }
}

/// What columns with random coefficients of one size say of residuals, after a refit.
pub(crate) struct Process {
    products: Symmetric,
    with_residuals: Vec<f64>,
}

impl Process {
    pub(crate) fn of(columns: &[Column], tangent: &Tangent, residuals: &[f64]) -> Process {
        let mut left = residuals.to_vec();
        tangent.remove(&mut left);
        let absorbed: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| tangent.basis().iter().map(|q| column.with(q)).collect())
            .collect();
        let products = Symmetric::from_fn(columns.len(), |a, b| {
            columns[a].with_column(&columns[b]) - dot(&absorbed[a], &absorbed[b])
        });
        let mut process = Process {
            with_residuals: columns.iter().map(|column| column.with(&left)).collect(),
            products,
        };
        for (k, column) in columns.iter().enumerate() {
            // What is left of it is the rounding of what was taken off.
            if process.products.get(k, k) <= DEPENDENT * DEPENDENT * column.with_column(column) {
                process.forget(k);
            }
        }
        process
    }

    /// Makes a column one that acts on nothing.
    fn forget(&mut self, column: usize) {
        self.with_residuals[column] = 0.0;
        (0..self.products.order()).for_each(|other| self.products.set(column, other, 0.0));
    }

    /// The same with columns of such a size that one of amplitude `d` leaves `d` standard deviations on average; none where
    /// a refit takes up everything.
    pub(crate) fn of_unit_size(mut self) -> Option<Process> {
        let order = self.products.order();
        let trace: f64 = (0..order).map(|k| self.products.get(k, k)).sum();
        if !(trace > NOTHING && trace.is_finite()) {
            return None;
        }
        self.products = Symmetric::from_fn(order, |a, b| self.products.get(a, b) / trace);
        self.with_residuals.iter_mut().for_each(|v| *v /= trace.sqrt());
        Some(self)
    }

    /// Whether a refit takes up everything.
    pub(crate) fn is_nothing(&self) -> bool {
        self.squares().iter().sum::<f64>() <= NOTHING
    }

    /// Squares of the columns' lengths after the refit.
    pub(crate) fn squares(&self) -> Vec<f64> {
        let each = 0..self.products.order();
        each.map(|k| self.products.get(k, k).max(0.0)).collect()
    }

    /// The same with every column in parts of its unit.
    pub(crate) fn in_units(&self, units: &[f64]) -> Process {
        let scaled = |a: usize, b: usize| self.products.get(a, b) / (units[a] * units[b]);
        let each = self.with_residuals.iter().zip(units);
        Process {
            products: Symmetric::from_fn(units.len(), scaled),
            with_residuals: each.map(|(v, unit)| v / unit).collect(),
        }
    }

    /// Products of every column with the columns of these coefficients together.
    pub(crate) fn times(&self, coefficients: &[f64]) -> Vec<f64> {
        self.products.times(coefficients)
    }

    /// The coefficients that are most probable with these precisions, and what they make the penalised sum of squares fall by.
    pub(crate) fn most_probable(&self, precisions: &[f64]) -> (Vec<f64>, f64) {
        let mut normal = self.products.clone();
        for (k, precision) in precisions.iter().enumerate() {
            normal.add(k, k, *precision);
        }
        let found = normal.solve(&self.with_residuals, 1e-14);
        let fall = dot(&found, &self.with_residuals);
        (found, fall)
    }

    /// What the likelihood gains, and what the widths cost.
    pub(crate) fn parts(&self, amplitude: f64) -> (f64, f64) {
        let order = self.products.order();
        if amplitude == 0.0 || order == 0 {
            return (0.0, 0.0);
        }
        let unit = |a, b| f64::from(u8::from(a == b));
        let precision = Symmetric::from_fn(order, |a, b| {
            amplitude * amplitude * self.products.get(a, b) + unit(a, b)
        });
        let right: Vec<f64> = self.with_residuals.iter().map(|v| amplitude * v).collect();
        let explained = dot(&precision.solve(&right, 1e-14), &right);
        (0.5 * explained, -0.5 * precision.log_determinant())
    }
}

/// Weights of smooth knots at every reading of a block; their squares sum to one at each.
pub(super) struct Knots {
    /// A series for each knot.
    pub(super) weights: Vec<Vec<f64>>,
}

impl Knots {
    /// Over the logarithm of the time since the last edge of the drive.
    pub(super) fn since_edge(group: &RunGroup, block: usize, longest_s: f64) -> Knots {
        let place = |t: f64| ((t.max(0.0) + KNOTS_FROM_S) / KNOTS_FROM_S).ln() / KNOT_SPACING;
        let places: Vec<f64> = since_edge(group, block).into_iter().map(place).collect();
        Knots::at(&places, place(longest_s))
    }

    /// Over the clock from the start of the record, this many.
    pub(super) fn by_clock(group: &RunGroup, block: usize, count: usize) -> Knots {
        let own = &group.blocks[block];
        let run = &group.runs[own.run];
        let longest_s = run.duration_s.max(f64::MIN_POSITIVE);
        let last = (count - 1) as f64;
        let times = run.times(own.channel).iter();
        let places: Vec<f64> = times.map(|t| t / longest_s * last).collect();
        Knots::at(&places, last)
    }

    fn at(places: &[f64], last: f64) -> Knots {
        let count = last.ceil().max(0.0) as usize + 1;
        let bell = |knot: usize, place: f64| (-0.5 * (place - knot as f64).powi(2)).exp();
        let size = |place: f64| {
            let sum: f64 = (0..count).map(|knot| bell(knot, place).powi(2)).sum();
            sum.sqrt().max(f64::MIN_POSITIVE)
        };
        let sizes: Vec<f64> = places.iter().map(|&place| size(place)).collect();
        let of_knot = |knot: usize| {
            let each = places.iter().zip(&sizes);
            each.map(|(&place, size)| bell(knot, place) / size).collect()
        };
        Knots {
            weights: (0..count).map(of_knot).collect(),
        }
    }
}

/// Columns of a channel that its runs share, one for each knot since the edge: `piece` makes a block's part of a column from
/// the place of the block and the knot's weights.
pub(super) fn shared_since_edge(
    group: &RunGroup,
    channel: usize,
    piece: impl Fn(usize, &[f64]) -> (usize, Vec<f64>),
) -> Vec<Column> {
    let longest_s = longest_s(group);
    let mut shared: Vec<Vec<(usize, Vec<f64>)>> = Vec::new();
    for (place, _) in blocks_of(group, channel) {
        let knots = Knots::since_edge(group, place, longest_s).weights;
        shared.resize_with(knots.len().max(shared.len()), Vec::new);
        for (column, weights) in shared.iter_mut().zip(&knots) {
            column.push(piece(place, weights));
        }
    }
    shared.into_iter().map(Column::of).collect()
}

/// The blocks of a channel, with their places.
pub(super) fn blocks_of<'g>(group: &'g RunGroup, channel: usize) -> impl Iterator<Item = (usize, &'g Block)> {
    let all = group.blocks.iter().enumerate();
    all.filter(move |(_, block)| block.channel == channel)
}

/// Time since the last edge of the drive at every reading of a block, s; below 0 before the first.
fn since_edge(group: &RunGroup, block: usize) -> Vec<f64> {
    let own = &group.blocks[block];
    let run = &group.runs[own.run];
    let edges_s = run.drive().edges_s();
    let mut next = 0;
    let since = |&t: &f64| {
        while edges_s.get(next).is_some_and(|start_s| *start_s <= t) {
            next += 1;
        }
        match next {
            0 => -1.0,
            after => t - edges_s[after - 1],
        }
    };
    run.times(own.channel).iter().map(since).collect()
}

/// The longest record of the group, s.
pub(super) fn longest_s(group: &RunGroup) -> f64 {
    group.runs.iter().map(|run| run.duration_s).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_of_one_column_is_a_gaussian_of_one_number() {
        let column = Column::of(vec![(1, vec![3.0, 4.0])]);
        let residuals = [9.0, 6.0, 8.0, -5.0];
        let process = Process::of(&[column], &Tangent::default(), &residuals);
        // y = c x + noise: the likelihood ratio of variance 1 + a^2 25 and of 1 along the unit column, at y = 10.
        let a: f64 = 0.7;
        let variance = 1.0 + a * a * 25.0;
        let expected = -0.5 * variance.ln() + 0.5 * 100.0 * (1.0 - 1.0 / variance);
        let (fall, width) = process.parts(a);
        assert!((fall + width - expected).abs() < 1e-9);
        assert_eq!(process.parts(0.0), (0.0, 0.0));
    }

    #[test]
    fn knots_weigh_every_place_alike() {
        let knots = Knots::at(&[0.0, 0.3, 1.7, 4.0], 4.0);
        assert_eq!(knots.weights.len(), 5);
        for place in 0..4 {
            let sum: f64 = knots.weights.iter().map(|own| own[place] * own[place]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
