//! Curves of the runs of a material at the times of a grid, each on the scale of its condition.

use std::collections::BTreeMap;

use super::measured::{Cell, Measured};
use super::measures::CURRENT_CURVE;
use super::placed::Placed;
use super::policy::LEAST_ERROR;
use crate::model_free::curves::{StepCurves, TimePoint};

/// Curves of one channel of a material.
pub(super) struct Curves {
    /// Values by the place of their time on the grid, in percent of the size of their condition.
    pub at: BTreeMap<i32, Measured>,
    /// Mean curve of each condition, by the same place, in the unit of the channel.
    pub means: BTreeMap<Cell, BTreeMap<i32, f64>>,
    /// Size of the curves of each condition, in that unit.
    pub sizes: BTreeMap<Cell, f64>,
}

impl Curves {
    /// None where no run has a curve.
    pub fn of(
        placed: &Placed,
        curves: &[StepCurves],
        stated_percent: Option<f64>,
        key: &str,
    ) -> Option<Curves> {
        let mut points: BTreeMap<i32, BTreeMap<usize, TimePoint>> = BTreeMap::new();
        let mut values: BTreeMap<Cell, BTreeMap<i32, Vec<f64>>> = BTreeMap::new();
        for (&place, &cell) in &placed.cells {
            let run = placed.facts[place].run;
            for &point in curves.get(run).map_or(&[][..], |own| points_of(own, key)) {
                points.entry(point.place).or_default().insert(place, point);
                let of_cell = values.entry(cell).or_default();
                of_cell.entry(point.place).or_default().push(point.value);
            }
        }
        let mean = |own: BTreeMap<i32, Vec<f64>>| {
            let each = own.into_iter();
            each.map(|(at, all)| (at, all.iter().sum::<f64>() / all.len() as f64))
                .collect()
        };
        let means: BTreeMap<Cell, _> = values.into_iter().map(|(cell, own)| (cell, mean(own))).collect();
        let sizes = sizes(&means);
        let stated = stated_percent.map(|percent| percent * percent);
        let measured = |at: BTreeMap<usize, TimePoint>| {
            let scaled = |(place, point): (usize, TimePoint)| {
                let factor = 100.0 / sizes[&placed.cells[&place]];
                (place, (factor * point.value, factor * factor * point.variance))
            };
            placed.measured(&at.into_iter().map(scaled).collect(), BTreeMap::new(), stated)
        };
        let at: BTreeMap<i32, Measured> = points.into_iter().map(|(at, own)| (at, measured(own))).collect();
        (!at.is_empty()).then_some(Curves { at, means, sizes })
    }

    /// The time at which most conditions have a value.
    pub fn fullest(&self) -> Option<&Measured> {
        self.at.values().max_by_key(|own| own.cells.len())
    }
}

/// The curve of one channel of a run.
pub(super) fn points_of<'c>(of: &'c StepCurves, key: &str) -> &'c [TimePoint] {
    if key == CURRENT_CURVE {
        &of.current
    } else {
        &of.bending
    }
}

/// From the lowest to the highest of a curve that begins at nothing.
pub(super) fn range(curve: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = curve.fold((0.0_f64, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    high - low
}

/// Sizes of the curves of the conditions: one number for each surroundings and one for each voltage, multiplied. What differs
/// from run to run is in proportion to them.
fn sizes(means: &BTreeMap<Cell, BTreeMap<i32, f64>>) -> BTreeMap<Cell, f64> {
    let range_of = |curve: &BTreeMap<i32, f64>| range(curve.values().copied());
    let least = LEAST_ERROR * means.values().map(range_of).fold(f64::MIN_POSITIVE, f64::max);
    let ranges: BTreeMap<Cell, f64> = means
        .iter()
        .map(|(&cell, curve)| (cell, range_of(curve).max(least).ln()))
        .collect();
    let mean = |is_in: &dyn Fn(&Cell) -> bool, of: &dyn Fn(&Cell) -> f64| {
        let all: Vec<f64> = ranges.keys().filter(|cell| is_in(cell)).map(of).collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    };
    let at_voltage: BTreeMap<usize, f64> = ranges
        .keys()
        .map(|&(_, voltage)| (voltage, mean(&|cell| cell.1 == voltage, &|cell| ranges[cell])))
        .collect();
    let over = |cell: &Cell| ranges[cell] - at_voltage[&cell.1];
    let size = |cell: &Cell| (at_voltage[&cell.1] + mean(&|own| own.0 == cell.0, &over)).exp();
    ranges.keys().map(|cell| (*cell, size(cell))).collect()
}
