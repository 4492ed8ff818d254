//! The smooth shapes of a span at the nodes that stand for its readings: their products with each other, and with any series
//! made white, cost next to nothing.

use ieap_numerics::decay::blocks;
use ieap_numerics::sums::add;

use crate::joint::nodes::Nodes;
use crate::joint::whitening::Whitener;
use crate::sampled::{Sampled, Span};

use super::columns::{inner, orthonormal};
use super::lagged::{Products, products};
use super::spread::{add_decay, rates_per_s};

/// Orthonormal sums of exponentials.
pub(super) struct ShortShapes {
    /// Times since the first reading, s.
    elapsed_s: Vec<f64>,
    rates_per_s: Vec<f64>,
    /// The nodes of which only the first reading stands for itself.
    nodes: Nodes,
    /// Of each shape what it holds of every exponential.
    parts: Vec<Vec<f64>>,
}

impl ShortShapes {
    /// The shapes of a span, and their part in its readings as its `level`; none where the readings are uneven, or follow a
    /// voltage that moves.
    pub(super) fn of(sampled: &Sampled, span: &Span, level: &mut [f64]) -> Option<ShortShapes> {
        if span.segment.is_some() && sampled.course.is_some() {
            return None;
        }
        let elapsed_s = &sampled.elapsed_s[span.first..span.end];
        let rates_per_s = match span.segment {
            Some(_) => rates_per_s(elapsed_s),
            None => vec![0.0],
        };
        let elapsed_s: Vec<f64> = elapsed_s.iter().map(|t| t - elapsed_s[0]).collect();
        let (nodes, values) = Nodes::of(&elapsed_s, 1, &sampled.values[span.first..span.end])?;
        // Behind the values of each column stands what it holds of every exponential.
        let with_parts = |(k, rate): (usize, &f64)| {
            let mut column = nodes.column_before(*rate, 0);
            column.extend((0..rates_per_s.len()).map(|other| f64::from(u8::from(other == k))));
            column
        };
        let columns = rates_per_s.iter().enumerate().map(with_parts).collect();
        let shapes = orthonormal(columns, values.len());
        let (mut rest, mut amplitudes) = (values, vec![0.0; rates_per_s.len()]);
        for shape in &shapes {
            let (shape, parts) = shape.split_at(rest.len());
            let part = inner(shape, &rest);
            add(&mut rest, -part, shape);
            add(&mut amplitudes, part, parts);
        }
        let blocks = blocks(&elapsed_s, 0, elapsed_s.len());
        for (rate, amplitude) in rates_per_s.iter().zip(&amplitudes) {
            add_decay(*amplitude, *rate, &blocks, &elapsed_s, level);
        }
        let parts = shapes.into_iter().map(|mut shape| shape.split_off(rest.len()));
        Some(ShortShapes {
            parts: parts.collect(),
            elapsed_s,
            rates_per_s,
            nodes,
        })
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.parts.len()
    }

    /// The shapes that these columns, one of every exponential, make.
    fn made_of(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let shape = |parts: &Vec<f64>| {
            let mut shape = vec![0.0; columns[0].len()];
            let each = columns.iter().zip(parts).filter(|(_, part)| **part != 0.0);
            each.for_each(|(column, part)| add(&mut shape, *part, column));
            shape
        };
        self.parts.iter().map(shape).collect()
    }

    /// The shapes made white, and a series over all readings that is white already; none where the rule of the whitener is not
    /// the same for all readings.
    pub(super) fn white(
        &self,
        span: &Span,
        whitener: &Whitener,
        series: &[f64],
    ) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        let steady = whitener.steady(span)?;
        let (nodes, series) = Nodes::of(&self.elapsed_s, steady.coefficients.len(), series)?;
        let column = |rate: &f64| nodes.white_column(*rate, span, whitener, &steady);
        let columns: Vec<Vec<f64>> = self.rates_per_s.iter().map(column).collect();
        Some((self.made_of(&columns), series))
    }

    /// Products of the shapes, and of the series over all readings, with each other, of every one with those up to itself and
    /// the series last, in units of `scale`.
    pub(super) fn among(&self, series: &[f64], scale: f64) -> Option<Vec<Vec<Products>>> {
        let before = |readings: usize| {
            let column = |rate: &f64| self.nodes.column_before(*rate, readings);
            let columns: Vec<Vec<f64>> = self.rates_per_s.iter().map(column).collect();
            let mut series_before = vec![0.0; readings];
            series_before.extend(&series[..series.len() - readings]);
            let (_, series) = Nodes::of(&self.elapsed_s, 1, &series_before)?;
            let mut shapes = self.made_of(&columns);
            shapes.push(series);
            Some(shapes)
        };
        let (own, earlier) = (before(0)?, before(1)?);
        let per_square = (scale * scale).recip();
        let pair = |a: usize, b: usize| {
            let later = |x: &[Vec<f64>], y: &[Vec<f64>]| inner(&x[a][1..], &y[b][1..]);
            let across = later(&own, &earlier) + later(&earlier, &own);
            let each = [
                own[a][0] * own[b][0],
                later(&own, &own),
                later(&earlier, &earlier),
                across,
            ];
            each.map(|product| per_square * product)
        };
        let row = |a: usize| (0..=a).map(|b| pair(a, b)).collect();
        let mut among: Vec<Vec<Products>> = (0..own.len()).map(row).collect();
        // The series is no smooth one: nodes do not stand for its products with itself.
        let last = products(series, series);
        among[self.count()][self.count()] = last.map(|product| per_square * product);
        Some(among)
    }
}
