//! Several runs with parameters shared or free: one sum of squares over one list of coordinates.

use ieap_domain::Drive;
use ieap_model::LumpedModel;
use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Minimum, Problem};

use super::layout::Layout;
use super::readings::{Offsets, RunReadings};
use super::spectrum_rows::SpectrumRows;
use super::spring::Spring;
use crate::policy::LOST_BELOW;
use crate::zero::Zero;

/// Step of the difference quotients, in coordinates scaled to be of order one.
const STEP: f64 = 1e-3;
/// The same where the model is a closed form.
const FINE_STEP: f64 = 1e-5;

/// Where a local parameter of a run comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Slot {
    /// A coordinate of the search.
    Searched(usize),
    /// A value held, in the parameter's own unit.
    Held(f64),
}

impl Slot {
    /// Whether the parameter is searched.
    pub(crate) fn is_searched(self) -> bool {
        matches!(self, Slot::Searched(_))
    }
}

/// The sum of squares of a group of runs.
#[derive(Debug, Clone)]
pub(crate) struct JointProblem<'a> {
    pub(crate) runs: Vec<RunReadings<'a>>,
    pub(crate) layout: Layout,
    /// For every run where its local parameters come from.
    pub(crate) slots: Vec<Vec<Slot>>,
    /// Size of a local parameter of one coordinate unit.
    pub(crate) units: Vec<f64>,
    pub(crate) bounds: Bounds,
    /// What is known of features before any reading.
    pub(crate) known: Vec<Spring>,
    /// Spectra of the runs' strips.
    pub(crate) spectra: Vec<SpectrumRows>,
}

impl<'a> JointProblem<'a> {
    /// Local parameters of a run, in their own units.
    pub(crate) fn of_run(&self, run: usize, at: &[f64]) -> Vec<f64> {
        let value = |(local, slot): (usize, &Slot)| match *slot {
            Slot::Searched(k) => at[k] * self.units[local],
            Slot::Held(value) => value,
        };
        self.slots[run].iter().enumerate().map(value).collect()
    }

    /// The model of a run.
    pub(crate) fn model(&self, local: &[f64]) -> LumpedModel {
        self.layout.model(local)
    }

    pub(crate) fn offsets(&self, local: &[f64]) -> Offsets {
        Offsets {
            current_a: local[self.layout.current_offset()],
            curvature_per_cm: local[self.layout.curvature_offset()],
        }
    }

    /// The zeros of a run's current and curvature at a minimum; none of one that is not searched.
    pub(crate) fn zeros(&self, run: usize, bottom: &Minimum) -> [Option<Zero>; 2] {
        let local = self.of_run(run, &bottom.at);
        let covariance = bottom.local.normal.floored_inverse(LOST_BELOW);
        [self.layout.current_offset(), self.layout.curvature_offset()].map(|place| {
            let Slot::Searched(k) = self.slots[run][place] else {
                return None;
            };
            Some(Zero {
                value: local[place],
                standard_error: self.units[place] * covariance.error(k),
            })
        })
    }

    /// Weighted residuals of a run over its condensed readings, under a drive with their edges.
    pub(crate) fn residuals(&self, run: usize, drive: &Drive, local: &[f64], out: &mut Vec<f64>) {
        out.clear();
        self.runs[run].condensed_under(drive, &self.model(local), self.offsets(local), out);
    }

    /// Sum of squares over the condensed readings of all runs: below that of all readings by what no model of exponentials could
    /// explain, which is the same wherever the parameters are.
    pub(crate) fn condensed_square(&self, at: &[f64]) -> f64 {
        self.sum(at, |run, model, offsets, out| run.condensed(model, offsets, out))
    }

    /// Sum of squares over all readings.
    pub(crate) fn square(&self, at: &[f64]) -> f64 {
        self.sum(at, |run, model, offsets, out| run.whole(model, offsets, out))
    }

    fn sum<R>(&self, at: &[f64], residuals: R) -> f64
    where
        R: Fn(&RunReadings, &LumpedModel, Offsets, &mut Vec<f64>),
    {
        let mut out = Vec::new();
        let of_run = |run: usize| {
            let local = self.of_run(run, at);
            out.clear();
            residuals(
                &self.runs[run],
                &self.model(&local),
                self.offsets(&local),
                &mut out,
            );
            inner(&out, &out)
        };
        let readings: f64 = (0..self.runs.len()).map(of_run).sum();
        readings + self.beside(at)
    }

    /// The part of the sum of squares that is not of the runs' readings.
    pub(crate) fn beside(&self, at: &[f64]) -> f64 {
        let known = self.known.iter().map(|spring| spring.gap(self, at).powi(2));
        let square = |left: &Vec<f64>| inner(left, left);
        let spectra = self.spectra.iter().map(|own| square(&self.of_spectrum(own, at)));
        known.chain(spectra).sum()
    }

    /// Weighted residuals of a spectrum at a place.
    fn of_spectrum(&self, spectrum: &SpectrumRows, at: &[f64]) -> Vec<f64> {
        spectrum.residuals(&self.model(&self.of_run(spectrum.run, at)))
    }

    /// Adds a spectrum to a sum of squares at a place.
    pub(crate) fn add_spectrum(&self, spectrum: &SpectrumRows, at: &[f64], all: &mut Local) {
        let here = self.of_spectrum(spectrum, at);
        let column = |slot: &Slot| -> Option<Column> {
            let Slot::Searched(k) = *slot else { return None };
            let with = |step: f64| {
                let mut moved = at.to_vec();
                moved[k] += step;
                self.of_spectrum(spectrum, &moved)
            };
            // One-sided at a limit; the model's derivative has the other sign than the residual's.
            let below = if at[k] - FINE_STEP < self.bounds.low[k] {
                0.0
            } else {
                FINE_STEP
            };
            let pairs = with(-below).into_iter().zip(with(FINE_STEP));
            Some((
                k,
                pairs
                    .map(|(low, high)| (low - high) / (FINE_STEP + below))
                    .collect(),
            ))
        };
        let electrical = &self.slots[spectrum.run][..=self.layout.steady()];
        let columns: Vec<Column> = electrical.iter().filter_map(column).collect();
        all.square += inner(&here, &here);
        add_run(&columns, &here, all);
    }

    /// Searches from `start`, until a further step would lower the sum of squares by less than `settle`.
    pub(crate) fn search(&self, start: &[f64], limit: u64, settle: f64) -> Minimum {
        Levenberg::by_diagonal(limit, settle).search(self, start)
    }

    /// Derivatives of what the model says of a run, whose weighted residuals are `here`, each with its coordinate: central
    /// differences, one-sided at a limit at zero.
    pub(crate) fn columns(&self, run: usize, drive: &Drive, at: &[f64], here: &[f64]) -> Vec<Column> {
        let local = self.of_run(run, at);
        let (mut above, mut below) = (Vec::new(), Vec::new());
        let mut columns: Vec<Column> = Vec::new();
        for (index, slot) in self.slots[run].iter().enumerate() {
            let Slot::Searched(k) = *slot else { continue };
            let mut moved = local.clone();
            moved[index] = local[index] + STEP * self.units[index];
            self.residuals(run, drive, &moved, &mut above);
            let one_sided = at[k] - STEP < self.bounds.low[k];
            if !one_sided {
                moved[index] = local[index] - STEP * self.units[index];
                self.residuals(run, drive, &moved, &mut below);
            }
            let (from, width) = if one_sided {
                (here, STEP)
            } else {
                (below.as_slice(), 2.0 * STEP)
            };
            // Residual is measured minus model: the model's derivative has the other sign.
            columns.push((k, from.iter().zip(&above).map(|(b, a)| (b - a) / width).collect()));
        }
        columns
    }
}

/// A coordinate, and the derivative of the weighted model by it at the readings of one run.
pub(crate) type Column = (usize, Vec<f64>);

/// Adds what a run with these residuals says of its coordinates, which are in rising order.
pub(crate) fn add_run(columns: &[Column], here: &[f64], all: &mut Local) {
    for (j, (row, left)) in columns.iter().enumerate() {
        all.descent[*row] += inner(left, here);
        for (column, right) in &columns[..=j] {
            let sum = all.normal.get(*row, *column) + inner(left, right);
            all.normal.set(*row, *column, sum);
        }
    }
}

impl Problem for JointProblem<'_> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let of_run = |(run, own): (usize, &RunReadings)| {
            let mut here = Vec::new();
            self.residuals(run, own.drive, &self.of_run(run, at), &mut here);
            here
        };
        let residuals: Vec<Vec<f64>> = self.runs.iter().enumerate().map(of_run).collect();
        let mut all = Local::zero(at.len());
        all.square = residuals.iter().map(|here| inner(here, here)).sum();
        if all.square > most {
            return all;
        }
        for (run, here) in residuals.iter().enumerate() {
            add_run(&self.columns(run, self.runs[run].drive, at, here), here, &mut all);
        }
        self.known
            .iter()
            .for_each(|spring| spring.add(self, at, &mut all));
        self.spectra
            .iter()
            .for_each(|spectrum| self.add_spectrum(spectrum, at, &mut all));
        all
    }
}

/// Inner product, summed in order: ends of profiles along flat valleys show in how it is rounded.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
