//! What is held of scatters before any value is looked at, and the places at which they are tried: all of it stands here.
//!
//! What repeats from reading to reading has the density 1 over its size, errors of fits counted with it; a component half a law
//! of Cauchy whose width is the size of that ([`Width::Readings`]) or of all that differs ([`Width::All`]), so that of few
//! blocks it is neither known to be nothing nor taken to be of any size (Gelman, Bayesian Analysis 1, 515, 2006).
//! Counted: `cargo test -p ieap-analysis --lib study -- --include-ignored --nocapture`, docs/validation/study.md.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_2_PI;

use super::likely::{AtReadings, Rows};
use super::model::{MixedModel, Width};

/// Distance of two places, in the standard deviations of a logarithm that so many values tell: sums over a bell at this distance
/// are right to 1 % (Poisson's formula). Ends of intervals are Student's to 0.5 %, to 2.4 % where two readings are left over
/// (`cargo unit -p ieap-numerics of_one_scatter`).
const STEP: f64 = 2.0;
/// The same in natural logarithms at most.
const WIDEST_STEP: f64 = 1.5;
/// A scatter below this part of all that differs is rounding.
const LEAST_PART: f64 = 1e-9;

/// Places of one scatter: nothing, where that is possible, then so many steps of its logarithm above the least.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    least: f64,
    step: f64,
    has_nothing: bool,
}

impl Axis {
    fn new(least: f64, told_by: f64, has_nothing: bool) -> Axis {
        let step = (STEP / (2.0 * told_by.max(1.0)).sqrt()).min(WIDEST_STEP);
        Axis {
            least,
            step,
            has_nothing,
        }
    }

    /// The first place.
    pub fn first(&self) -> i32 {
        i32::from(!self.has_nothing)
    }

    /// The size at a place.
    pub fn at(&self, place: i32) -> f64 {
        if place == 0 {
            0.0
        } else {
            (self.least + f64::from(place - 1) * self.step).exp()
        }
    }

    /// The place nearest to a size.
    pub fn nearest(&self, size: f64) -> i32 {
        let steps = (size.ln() - self.least) / self.step;
        1 + steps.round().clamp(0.0, 1e4) as i32
    }

    /// How many places this many natural logarithms are, one at least.
    pub fn places(&self, logarithms: f64) -> i32 {
        (logarithms / self.step).round().max(1.0) as i32
    }

    /// Up to where nothing reaches.
    fn end_of_nothing(&self) -> f64 {
        (self.least - 0.5 * self.step).exp()
    }
}

/// The densities before of a model, and the places at which its scatters are tried: that of readings first.
pub(super) struct Before {
    /// Error of a fit.
    fit: f64,
    /// Size of all that differs.
    all: f64,
    widths: Vec<Width>,
    pub axes: Vec<Axis>,
    /// Places from which the most likely ones are sought.
    pub start: Vec<i32>,
}

impl Before {
    /// `left`: readings beyond what is fixed. None where `X` loses a direction.
    pub fn new(model: &MixedModel, rows: &Rows, left: f64) -> Option<Before> {
        let readings = || model.units.iter().flat_map(|unit| &unit.readings);
        let count = model.readings();
        let mean = readings().map(|own| own.weight * own.value).sum::<f64>() / count;
        let square: f64 = readings()
            .map(|own| own.weight * (own.value - mean).powi(2))
            .sum();
        let known: f64 = readings().map(|own| own.weight * own.variance).sum();
        let all = (square / count)
            .sqrt()
            .max(LEAST_PART * mean.abs())
            .max(f64::MIN_POSITIVE.sqrt());
        let fit = (known / count).sqrt();
        let from = from_reading_to_reading(model, rows, left, all)?;
        // Where fits are not exact, what they leave is told to a part of their error.
        let least = if fit > 0.0 {
            (0.5 * fit / left.max(1.0).powf(0.25)).ln()
        } else {
            (LEAST_PART * all).ln()
        };
        let mut axes = vec![Axis::new(least, left, fit > 0.0)];
        let size = from.hypot(fit).max(LEAST_PART * all);
        let mut start = vec![axes[0].nearest(from.max(LEAST_PART * all))];
        for (component, width) in model.widths.iter().enumerate() {
            let (levels, most) = levels(model, component);
            let width = match width {
                Width::Readings => 1.0,
                Width::All => size.min(all) / all,
            };
            // Below its part in the mean of the readings that share it a component makes no difference.
            let axis = Axis::new((0.3 * width / most.max(1.0).sqrt()).ln(), 0.5 * levels, true);
            start.push(axis.nearest(width.sqrt()));
            axes.push(axis);
        }
        Some(Before {
            fit,
            all,
            widths: model.widths.clone(),
            axes,
            start,
        })
    }

    /// The variances at some places, that of readings last, and the logarithm of the mass that these have before.
    pub fn at(&self, places: &[i32]) -> (Vec<f64>, f64) {
        let own = self.axes[0].at(places[0]);
        let mut log_mass = match places[0] {
            0 => (self.axes[0].end_of_nothing() / self.fit).asinh(),
            _ => self.axes[0].step * own / own.hypot(self.fit),
        }
        .ln();
        let mut variances = Vec::with_capacity(places.len());
        let components = self.axes.iter().zip(places).skip(1);
        for ((axis, &place), width) in components.zip(&self.widths) {
            let part = axis.at(place);
            let mass = match place {
                0 => axis.end_of_nothing().atan(),
                _ => axis.step * part / (1.0 + part * part),
            };
            log_mass += (FRAC_2_PI * mass).ln();
            let width = match width {
                Width::Readings => own.hypot(self.fit),
                Width::All => self.all,
            };
            variances.push((part * width).powi(2));
        }
        variances.push(own * own);
        (variances, log_mass)
    }
}

/// About what differs from reading to reading: what is left where blocks may differ by whatever they do.
fn from_reading_to_reading(model: &MixedModel, rows: &Rows, left: f64, all: f64) -> Option<f64> {
    let at = AtReadings::of(rows, all * all)?;
    let square = at.square_beside(&vec![1e4 * all * all; model.components()]);
    Some((square / left).max(0.0).sqrt() * all)
}

/// How many different values a component has, and the most readings that share one.
fn levels(model: &MixedModel, component: usize) -> (f64, f64) {
    let mut sharing: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for unit in &model.units {
        let readings: f64 = unit.readings.iter().map(|own| own.weight).sum();
        let own = unit.random.iter().zip(&model.component_of).enumerate();
        for (column, _) in own.filter(|(_, (entry, of))| **entry != 0.0 && **of == component) {
            *sharing.entry((unit.block, column)).or_default() += readings;
        }
    }
    (sharing.len() as f64, sharing.into_values().fold(0.0, f64::max))
}
