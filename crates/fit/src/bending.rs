//! Step two: coupling and relaxation rate from the curvature, with the electrical parameters fixed.
//!
//! Curvature is `alpha A h(t; lambda)`, where h is the spring strain that the stored charge leaves; alpha is
//! linear. An offset is fitted beside it only where the readings before the step show one.

use ieap_domain::Drive;
use ieap_numerics::column_memory::LongColumn;
use ieap_numerics::global::Landscape;
use ieap_numerics::gram::CAPACITY;
use ieap_numerics::least_squares::{Bounds, Local, Problem, Stop};
use ieap_numerics::symmetric::Symmetric;

use super::electrical::Electrical;
use super::propagated_error::moved_by_circuit;
use super::sampled::Sampled;
use super::search::Search;
use super::shown::Shown;
use super::strain::{Charged, Strain};
use super::uncertainty::{CovarianceSums, Residuals};
use super::zero::Zero;

/// Rates in the coarse look.
const GRID: usize = 16;
/// Part of the sum of squares at which the search settles.
const SETTLE: f64 = 1e-12;

/// What the curvature says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bending {
    /// Coupling alpha, 1/(C cm).
    pub(super) coupling_per_c_cm: f64,
    /// Rate lambda, 1/s.
    pub(super) rate_per_s: f64,
    /// Zero of the curvature, 1/cm, where readings at rest tell it.
    pub(super) zero: Option<Zero>,
    /// Covariance of [alpha, lambda], the uncertainty of the electrical parameters included.
    pub(super) covariance: Symmetric,
    /// Whether the curvature shows any response to the charge.
    pub(super) shown: Shown,
    /// Whether the rate lies at the upper limit of the search.
    pub(super) at_upper_bound: bool,
    /// Residuals of the curvature.
    pub(super) residuals: Residuals,
    /// Why the search stopped.
    pub(super) stop: Stop,
    /// Evaluations of the whole step.
    pub(super) evaluations: u64,
}

/// The sum of squares over the relaxation rate, coupling and offset eliminated. The coordinate is
/// `ln(1 + lambda unit)`: a logarithm for fast relaxation that still holds none at all.
struct Rate<'a> {
    strain: &'a Strain<'a>,
    unit_s: f64,
    /// Upper limit of the coordinate.
    high: f64,
}

impl Rate<'_> {
    fn rate_per_s(&self, at: f64) -> f64 {
        at.exp_m1() / self.unit_s
    }
}

impl Problem for Rate<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::even(1, 0.0, self.high)
    }

    fn local(&self, at: &[f64], _: f64) -> Local {
        let mut local = self.strain.projected(self.rate_per_s(at[0]), self.unit_s);
        let stretch = at[0].exp();
        local.descent[0] *= stretch;
        local.normal.set(0, 0, local.normal.get(0, 0) * stretch * stretch);
        local
    }
}

impl Landscape for Rate<'_> {
    fn square(&self, at: &[f64]) -> f64 {
        self.strain.projected_square(self.rate_per_s(at[0]))
    }

    /// The best of no relaxation and rates spread over the record.
    fn starts(&self) -> Vec<Vec<f64>> {
        let (low, top) = (0.02_f64.ln(), self.high.exp_m1().max(0.1).ln());
        let rates = (0..GRID).map(|k| (low + (top - low) * k as f64 / GRID as f64).exp());
        let rough = |rate: f64| self.strain.solve(&self.strain.gram(rate / self.unit_s)).1;
        let squares = std::iter::once(0.0).chain(rates).map(|rate| (rate, rough(rate)));
        let best = squares.min_by(|a, b| a.1.total_cmp(&b.1));
        vec![vec![best.map_or(0.0, |(rate, _)| rate.ln_1p())]]
    }

    fn size(&self) -> f64 {
        self.strain.sampled.square()
    }
}

/// Fits coupling and rate to the curvature readings, given the circuit (with one branch at least).
pub(super) fn identify(drive: &Drive, electrical: &Electrical, sampled: &Sampled, how: Search) -> Bending {
    let responses = electrical.model(1.0, 0.0).segment_responses(drive);
    let compressed = sampled.compressed();
    let full = Strain {
        responses: &responses,
        area_cm2: electrical.area_cm2,
        sampled,
        with_offset: sampled.tells_zero(),
        charged: None,
    };
    let charged = Charged::new(&responses, &compressed);
    let short = Strain {
        sampled: &compressed,
        charged: Some(&charged),
        ..full
    };
    let (shortest_s, longest_s) = sampled.time_scales_s();
    let unit_s = if longest_s > 0.0 { longest_s } else { 1.0 };
    let high = (10.0 * unit_s / shortest_s.min(unit_s)).ln_1p();
    let landscape = Rate {
        strain: &short,
        unit_s,
        high,
    };
    let found = how.minimise(&landscape, SETTLE);
    let rate_per_s = landscape.rate_per_s(found.at[0]);
    let (x, _) = short.solve(&short.gram(rate_per_s));
    let residuals = residuals(&full, rate_per_s, &x);
    let shown = Shown::of(&residuals, sampled, full.with_offset);
    let (covariance, zero_error) = covariance(drive, electrical, &full, &short, rate_per_s, &x, &residuals);
    Bending {
        coupling_per_c_cm: x[0],
        rate_per_s,
        zero: full.with_offset.then_some(Zero {
            value: x[2],
            standard_error: zero_error,
        }),
        covariance,
        shown,
        at_upper_bound: found.at[0] >= high * (1.0 - 1e-9),
        residuals,
        stop: found.stop,
        evaluations: found.evaluations + 1,
    }
}

fn residuals(full: &Strain, rate_per_s: f64, x: &[f64; CAPACITY]) -> Residuals {
    let mut fitted = LongColumn::with_capacity(full.sampled.len());
    full.each_block(rate_per_s, |block, columns, _| {
        let offset = x[2];
        fitted.extend(columns[0][..block.len].iter().map(|h| x[0] * h + offset));
    });
    Residuals::new(full.sampled, fitted, if full.with_offset { 3 } else { 2 })
}

/// Covariance of [alpha, lambda]: noise of the curvature, plus what the uncertainty of the electrical
/// parameters moves them by (delta method); and the standard error of the zero, 1/cm, 0 where none is fitted.
fn covariance(
    drive: &Drive,
    electrical: &Electrical,
    full: &Strain,
    short: &Strain,
    rate_per_s: f64,
    x: &[f64; CAPACITY],
    residuals: &Residuals,
) -> (Symmetric, f64) {
    let mut scales = [1.0; CAPACITY];
    scales[1] = x[0];
    let gram = short.gram(rate_per_s);
    let normal = Symmetric::from_fn(gram.matrix.order(), |row, column| {
        scales[row] * scales[column] * gram.matrix.get(row, column)
    });
    let mut sums = CovarianceSums::with_normal(normal, residuals.coefficients());
    full.each_block(rate_per_s, |block, columns, _| {
        sums.add(block.len, columns, &scales)
    });
    let own = sums.covariance(residuals);
    let mut jacobian: Vec<Vec<f64>> = vec![Vec::new(); if short.with_offset { 3 } else { 2 }];
    short.each_block(rate_per_s, |block, columns, _| {
        for (k, column) in columns.iter().enumerate() {
            jacobian[k].extend(column[..block.len].iter().map(|value| scales[k] * value));
        }
    });
    let base: Vec<f64> = jacobian[0].iter().map(|strain| x[0] * strain).collect();
    let moves = moved_by_circuit(electrical, &jacobian, &base, |circuit| {
        let moved = Strain {
            responses: &circuit.model(1.0, 0.0).segment_responses(drive),
            charged: None,
            ..*short
        };
        let mut bent = Vec::with_capacity(base.len());
        moved.each_block(rate_per_s, |block, columns, _| {
            bent.extend(columns[0][..block.len].iter().map(|strain| x[0] * strain));
        });
        bent
    });
    let of = |row: usize, column: usize| {
        own.get(row, column) + electrical.covariance.form(&moves[row], &moves[column])
    };
    let zero = if short.with_offset { of(2, 2) } else { 0.0 };
    (Symmetric::from_fn(2, of), zero.max(0.0).sqrt())
}
