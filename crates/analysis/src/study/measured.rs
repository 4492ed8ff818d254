//! The values of one parameter over the conditions of a material, with the scatter that the design tells.

use std::collections::{BTreeMap, BTreeSet};

use ieap_numerics::linear::LeastSquares;
use ieap_numerics::mixed::{Estimated, MixedModel, Mixture, Reading, Unit, Width};

use super::answer::Basis;
use super::policy::FEWEST_LEFT;

/// A condition of a material: place of its surroundings and of its voltage among all of the campaign.
pub type Cell = (usize, usize);

/// A run's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Place of the run among the facts.
    pub place: usize,
    /// Number of its sample.
    pub sample: usize,
    /// Its condition.
    pub cell: Cell,
    /// Relative humidity, percent, where it is known.
    pub humidity_percent: Option<f64>,
    /// The value on its scale.
    pub y: f64,
    /// Its variance by the fit.
    pub variance: f64,
    /// As how many values it counts: 1, and less where it may be of something else than its condition says.
    pub weight: f64,
    /// Where that is less than one: how far off it stands, in the standard errors that the others leave.
    pub off: Option<f64>,
}

/// What is known of a condition in which no value is determined.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bound {
    /// It is below this.
    pub below: Option<f64>,
    /// It is above this.
    pub above: Option<f64>,
}

/// Scatter from run to run where conditions have one run each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Variance, the errors of the fits with it.
    pub variance: f64,
    /// As many readings are left over to tell it; none where it is stated.
    pub left: Option<f64>,
    /// Where it is known from.
    pub basis: Basis,
}

/// One parameter of one material.
#[derive(Clone)]
pub struct Measured {
    /// Conditions with a value, in order.
    pub cells: Vec<Cell>,
    /// Values.
    pub values: Vec<Value>,
    /// Conditions with a bound and no value.
    pub bounds: BTreeMap<Cell, Bound>,
    by_fits: Option<Estimated>,
    with_scatter: Option<Estimated>,
    single: Option<Scatter>,
}

impl Measured {
    /// `dry`: places of surroundings that hold no water; `stated`: variance from run to run that campaign.toml states.
    pub fn new(
        mut values: Vec<Value>,
        bounds: BTreeMap<Cell, Bound>,
        dry: &[usize],
        stated: Option<f64>,
    ) -> Measured {
        let cells: Vec<Cell> = distinct(values.iter().map(|value| value.cell));
        let (model, estimated) = of_conditions(&mut values, &cells);
        let is_single = values.len() == cells.len();
        let single = is_single
            .then(|| stated.map(Scatter::stated).or_else(|| scatter(&values, dry)))
            .flatten();
        Measured {
            by_fits: by_fits(&model),
            with_scatter: estimated.filter(|_| !is_single),
            single,
            cells,
            values,
            bounds,
        }
    }

    /// Values with a model of their own, whose combinations are of its columns and not of conditions; none where its columns
    /// depend on each other.
    pub fn of_columns(values: Vec<Value>, model: &MixedModel) -> Option<Measured> {
        Some(Measured {
            by_fits: Some(by_fits(model)?),
            with_scatter: model.estimated(),
            single: None,
            cells: Vec::new(),
            values,
            bounds: BTreeMap::new(),
        })
    }

    /// What the repeats tell; none where nothing is left to tell a scatter from.
    pub fn estimated(&self) -> Option<&Estimated> {
        self.with_scatter.as_ref()
    }

    /// Place of a condition among those with a value.
    pub fn at(&self, cell: Cell) -> Option<usize> {
        self.cells.binary_search(&cell).ok()
    }

    /// Whether no condition has a second run.
    pub fn is_of_single_runs(&self) -> bool {
        !self.cells.is_empty() && self.values.len() == self.cells.len()
    }

    /// A combination of conditions by the errors of the fits alone.
    pub fn by_fits(&self, factors: &[f64]) -> Option<Mixture> {
        Some(self.by_fits.as_ref()?.combined(factors))
    }

    /// The same with scatter, and where that is known from.
    pub fn with_scatter(&self, factors: &[f64]) -> Option<(Mixture, Basis)> {
        if let Some(single) = &self.single {
            let each = factors.iter().map(|factor| factor * factor).sum::<f64>().sqrt();
            let mean = self.by_fits(factors)?.mean();
            let own = match single.left {
                Some(left) => Mixture::of_scatter(mean, each, (single.variance, left)),
                None => Mixture::normal(mean, each * single.variance.sqrt()),
            };
            return Some((own, single.basis));
        }
        Some((self.with_scatter.as_ref()?.combined(factors), Basis::Repeats))
    }

    /// Standard deviation from run to run.
    pub fn scatter(&self) -> Option<f64> {
        let of_repeats = self
            .with_scatter
            .as_ref()
            .and_then(|own| own.variances.last().copied());
        self.single.map(|own| own.variance).or(of_repeats).map(f64::sqrt)
    }
}

impl Scatter {
    fn stated(variance: f64) -> Scatter {
        Scatter {
            variance,
            left: None,
            basis: Basis::Stated,
        }
    }
}

/// The mixed model of conditions: samples are blocks; where there are two or more they differ by chance, and by chance in each
/// of the surroundings; with what it says. Values that may be of something else count for less, here and in whatever is made of them.
fn of_conditions(values: &mut [Value], cells: &[Cell]) -> (MixedModel, Option<Estimated>) {
    let samples: BTreeSet<usize> = values.iter().map(|value| value.sample).collect();
    let parts: Vec<usize> = distinct(values.iter().map(|value| value.cell.0));
    let row = |value: &Value| Row {
        block: value.sample,
        fixed: one_of(cells, &value.cell),
        random: if samples.len() > 1 {
            [vec![1.0], one_of(&parts, &value.cell.0)].concat()
        } else {
            Vec::new()
        },
    };
    let chance: &[(usize, Width)] = if samples.len() > 1 {
        &[(1, Width::All), (parts.len(), Width::Readings)]
    } else {
        &[]
    };
    let rows: Vec<Row> = values.iter().map(row).collect();
    let (model, places) = placed(values, rows.into_iter(), chance);
    let (model, odd, estimated) = model.with_odd_weighed();
    for own in odd {
        if let Some(at) = places.iter().position(|place| *place == own.place) {
            (values[at].weight, values[at].off) = (own.weight, Some(own.off));
        }
    }
    (model, estimated)
}

/// Row of a value in a mixed model.
pub(super) struct Row {
    /// Block.
    pub block: usize,
    /// What is fixed.
    pub fixed: Vec<f64>,
    /// What is left to chance.
    pub random: Vec<f64>,
}

/// A mixed model of values, a row for each; values with the same row are one unit of it. `chance`: the columns of each
/// component, in their order.
pub(super) fn model(
    values: &[Value],
    rows: impl Iterator<Item = Row>,
    chance: &[(usize, Width)],
) -> MixedModel {
    placed(values, rows, chance).0
}

/// The same, with the unit of each value and its place there.
fn placed(
    values: &[Value],
    rows: impl Iterator<Item = Row>,
    chance: &[(usize, Width)],
) -> (MixedModel, Vec<(usize, usize)>) {
    let (mut units, mut of_values): (Vec<Unit>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    let mut places: BTreeMap<(usize, Vec<u64>), usize> = BTreeMap::new();
    for (value, row) in values.iter().zip(rows) {
        let reading = Reading {
            value: value.y,
            variance: value.variance,
            weight: value.weight,
        };
        let entries = row.fixed.iter().chain(&row.random);
        let bits = entries.map(|entry| entry.to_bits()).collect();
        let at = *places.entry((row.block, bits)).or_insert(units.len());
        of_values.push((at, units.get(at).map_or(0, |unit| unit.readings.len())));
        match units.get_mut(at) {
            Some(unit) => unit.readings.push(reading),
            None => units.push(Unit {
                block: row.block,
                fixed: row.fixed,
                random: row.random,
                readings: vec![reading],
            }),
        }
    }
    let columns = chance.iter().enumerate();
    let model = MixedModel {
        units,
        component_of: columns
            .flat_map(|(of, (columns, _))| vec![of; *columns])
            .collect(),
        widths: chance.iter().map(|(_, width)| *width).collect(),
    };
    (model, of_values)
}

/// Different ones, in order.
pub(super) fn distinct<T: Ord>(of: impl Iterator<Item = T>) -> Vec<T> {
    of.collect::<BTreeSet<T>>().into_iter().collect()
}

/// 1 at the place of one of several in order, else 0.
pub(super) fn one_of<T: Ord>(several: &[T], own: &T) -> Vec<f64> {
    let entry = |other: &T| f64::from(u8::from(other == own));
    several.iter().map(entry).collect()
}

fn by_fits(model: &MixedModel) -> Option<Estimated> {
    model.at(&vec![0.0; model.components() + 1])
}

/// The scatter that single runs tell: of dry environments about their mean at each voltage where two or more have two
/// voltages in common, for they hold no water that could act otherwise at another voltage; else what environment and voltage
/// leave. The rule was fixed before any data were looked at.
fn scatter(values: &[Value], dry: &[usize]) -> Option<Scatter> {
    let of_dry: Vec<&Value> = values
        .iter()
        .filter(|value| dry.contains(&value.cell.0))
        .collect();
    let at = |voltage: usize| of_dry.iter().filter(|value| value.cell.1 == voltage).count();
    let shared: Vec<&Value> = of_dry
        .iter()
        .copied()
        .filter(|value| at(value.cell.1) > 1)
        .collect();
    additive(&shared, Basis::DryPair)
        .or_else(|| additive(&values.iter().collect::<Vec<_>>(), Basis::Additive))
}

/// What surroundings and voltage leave where both act alike; none where they leave nothing.
fn additive(values: &[&Value], basis: Basis) -> Option<Scatter> {
    let levels = |of: fn(&Value) -> usize| {
        let mut levels: Vec<usize> = values.iter().map(|value| of(value)).collect();
        levels.sort_unstable();
        levels.dedup();
        levels
    };
    let surroundings = levels(|value| value.cell.0);
    let voltages = levels(|value| value.cell.1);
    if surroundings.len() < 2 || voltages.len() < 2 {
        return None;
    }
    let column = |holds: &dyn Fn(&Value) -> bool| -> Vec<f64> {
        values
            .iter()
            .map(|value| f64::from(u8::from(holds(value))))
            .collect()
    };
    let mut columns: Vec<Vec<f64>> = surroundings
        .iter()
        .map(|&own| column(&|value| value.cell.0 == own))
        .collect();
    columns.extend(
        voltages[1..]
            .iter()
            .map(|&own| column(&|value| value.cell.1 == own)),
    );
    let left = (values.len().checked_sub(columns.len())).filter(|left| *left >= FEWEST_LEFT)? as f64;
    let y: Vec<f64> = values.iter().map(|value| value.y).collect();
    Some(Scatter {
        variance: LeastSquares::of(columns, &y)?.square() / left,
        left: Some(left),
        basis,
    })
}
