//! Step one: the electrical parameters from the current, with their covariance.

use crate::domain::Drive;
use crate::model::{Branch, LumpedModel};
use crate::numerics::correlation::{Autoregression, slow_excess};
use crate::numerics::decay::{BLOCK, Column};
use crate::numerics::gram::{Gram, dot};
use crate::numerics::levenberg::Stop;
use crate::numerics::student::quantile_95;
use crate::numerics::symmetric::{CAPACITY, Symmetric};

use super::circuit::Circuit;
use super::sampled::Sampled;
use super::search::{Found, Limits, search};

/// A further branch must lower the sum of squares by this many long-run variances. Two parameters fitted to
/// noise, one of them a time constant that may lie anywhere on the record, reach it about once in 20 000 runs.
const BRANCH_EVIDENCE: f64 = 25.0;
/// Eigenvalue of the scaled normal matrix below which a direction counts as lost.
const LOST: f64 = 1e-13;

/// Residuals of one response with what they say of the noise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Residuals {
    /// Fitted values at the readings used.
    pub(super) fitted: Vec<f64>,
    /// Measured minus fitted.
    pub(super) residuals: Vec<f64>,
    /// Sum of their squares.
    pub(super) square: f64,
    /// Variance and lag-1 correlation.
    pub(super) noise: Autoregression,
    /// Factor for slow misfit beyond the autoregression.
    pub(super) excess: f64,
    /// Half-width of a 95 % interval in standard errors.
    pub(super) quantile: f64,
}

impl Residuals {
    /// From fitted values at all readings of `sampled`, of a fit with `parameters` parameters.
    pub(super) fn new(sampled: &Sampled, fitted: Vec<f64>, parameters: usize) -> Residuals {
        let residuals: Vec<f64> = sampled.values.iter().zip(&fitted).map(|(y, f)| y - f).collect();
        let (mut square, mut product, mut last) = (0.0, 0.0, 0.0);
        for &r in &residuals {
            square += r * r;
            product += r * last;
            last = r;
        }
        let readings = residuals.len() as f64;
        let noise = Autoregression::from_sums(square, product, readings, parameters as f64);
        let excess = slow_excess(&residuals, noise.long_run_variance(), parameters);
        let freedom = noise.effective_readings(readings) - parameters as f64;
        Residuals {
            fitted,
            residuals,
            square,
            noise,
            excess,
            quantile: quantile_95(freedom.max(2.0)),
        }
    }

    /// Variance of a long sum per reading, not below what rounding of numbers of size `peak` leaves.
    pub(super) fn long_run_variance(&self, peak: f64) -> f64 {
        let all = self.noise.long_run_variance().max(self.noise.variance) * self.excess;
        all.max((1e-9 * peak).powi(2))
    }
}

/// What the current says of the circuit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Electrical {
    /// Active area, cm2.
    pub(super) area_cm2: f64,
    /// Branch conductances A/R_k, A/V, fastest branch first.
    pub(super) conductances_s: Vec<f64>,
    /// Time constants, s.
    pub(super) time_constants_s: Vec<f64>,
    /// Whether each time constant lies at a limit of the search: below, above.
    pub(super) at_bound: Vec<Option<Bound>>,
    /// Steady conductance A/R_ss, A/V.
    pub(super) steady_s: f64,
    /// Whether any reading was taken at a held voltage other than zero, so that R_ss carries current.
    pub(super) steady_visible: bool,
    /// Covariance of [ln c_1.., steady, ln tau_1..].
    pub(super) covariance: Symmetric,
    /// Residuals of the current.
    pub(super) residuals: Residuals,
    /// Why the search stopped.
    pub(super) stop: Stop,
    /// Evaluations of the whole step.
    pub(super) evaluations: u64,
}

/// The limit at which a time constant lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bound {
    /// Much shorter than the sampling interval.
    Low,
    /// Much longer than the record.
    High,
}

impl Electrical {
    /// The circuit as a model, with the given coupling and relaxation rate.
    pub(super) fn model(&self, charge_to_curvature_per_c_cm: f64, relaxation_rate_per_s: f64) -> LumpedModel {
        let branch = |(c, tau): (&f64, &f64)| Branch {
            resistance_ohm_cm2: self.area_cm2 / c,
            capacitance_f_per_cm2: c * tau / self.area_cm2,
        };
        LumpedModel {
            branches: self
                .conductances_s
                .iter()
                .zip(&self.time_constants_s)
                .map(branch)
                .collect(),
            steady_state_resistance_ohm_cm2: self.area_cm2 / self.steady_s,
            charge_to_curvature_per_c_cm,
            relaxation_rate_per_s,
        }
    }

    /// The circuit with its logarithmic parameters moved by `by`, in the covariance's order.
    pub(super) fn moved(&self, by: &[f64; CAPACITY]) -> Electrical {
        let n = self.conductances_s.len();
        let mut moved = self.clone();
        for k in 0..n {
            moved.conductances_s[k] *= by[k].exp();
            moved.time_constants_s[k] *= by[n + 1 + k].exp();
        }
        moved.steady_s += by[n];
        moved
    }
}

/// Fits at most `branches` branches; those that the current does not show are left out.
pub(super) fn identify(drive: &Drive, area_cm2: f64, sampled: &Sampled, branches: usize) -> Electrical {
    let grouped = sampled.grouped();
    let peak = sampled.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let limits = Limits::of(sampled);
    let mut evaluations = 0;
    let mut fit = |count: usize| {
        let limits = limits.unwrap_or(Limits { low: 0.0, high: 1.0 });
        let found = search(drive, sampled, &grouped, count, limits);
        evaluations += found.evaluations;
        (fitted(drive, sampled, &found, peak), found)
    };
    let most = if limits.is_some() { branches } else { 0 };
    let mut chosen = fit(most);
    for count in (0..most).rev() {
        let simpler = fit(count);
        let gain = simpler.0.square - chosen.0.square;
        let all_used = chosen.1.solution.conductances_s[..=count]
            .iter()
            .all(|&c| c > 0.0);
        if all_used && gain > BRANCH_EVIDENCE * chosen.0.long_run_variance(peak) {
            break;
        }
        chosen = simpler;
    }
    let (residuals, found) = chosen;
    assemble(drive, area_cm2, sampled, limits, residuals, &found, evaluations)
}

/// Residuals of a solution over all readings.
fn fitted(drive: &Drive, sampled: &Sampled, found: &Found, _peak: f64) -> Residuals {
    let circuit = Circuit { drive, sampled };
    let solution = &found.solution;
    let mut fitted = Vec::with_capacity(sampled.len());
    circuit.each_block(&solution.log_time_constants, |block, columns, _| {
        let start = fitted.len();
        fitted.resize(start + block.len, 0.0);
        for (column, conductance) in columns.iter().zip(&solution.conductances_s) {
            for (out, value) in fitted[start..].iter_mut().zip(column) {
                *out += conductance * value;
            }
        }
    });
    Residuals::new(sampled, fitted, 2 * solution.log_time_constants.len() + 1)
}

/// Orders the branches and adds the covariance.
fn assemble(
    drive: &Drive,
    area_cm2: f64,
    sampled: &Sampled,
    limits: Option<Limits>,
    residuals: Residuals,
    found: &Found,
    evaluations: u64,
) -> Electrical {
    let n = found.solution.log_time_constants.len();
    let mut order: Vec<usize> = (0..n).collect();
    let logs = &found.solution.log_time_constants;
    order.sort_by(|&a, &b| logs[a].total_cmp(&logs[b]));
    let logs: Vec<f64> = order.iter().map(|&k| logs[k]).collect();
    let conductances_s: Vec<f64> = order.iter().map(|&k| found.solution.conductances_s[k]).collect();
    let bound = |log: &f64| match limits {
        Some(limits) if *log <= limits.low + 1e-6 => Some(Bound::Low),
        Some(limits) if *log >= limits.high - 1e-6 => Some(Bound::High),
        _ => None,
    };
    let circuit = Circuit { drive, sampled };
    let mut scales = [1.0; CAPACITY];
    for k in 0..n {
        scales[k] = conductances_s[k];
        scales[n + 1 + k] = conductances_s[k];
    }
    let mut sums = CovarianceSums::new(2 * n + 1, residuals.noise.correlation);
    circuit.each_block(&logs, |block, columns, _| sums.add(block.len, columns, &scales));
    Electrical {
        area_cm2,
        at_bound: logs.iter().map(bound).collect(),
        time_constants_s: logs.iter().map(|log| log.exp()).collect(),
        conductances_s,
        steady_s: found.solution.conductances_s[n],
        steady_visible: sums.gram.matrix.get(n, n) > 0.0,
        covariance: sums.covariance(&residuals),
        residuals,
        stop: found.stop,
        evaluations,
    }
}

/// Sums for the covariance of least squares under noise that is a first-order autoregression:
/// `(J'J)^-1 J' Omega J (J'J)^-1`, with `Omega_st = rho^|s-t|` summed by one recursion along the record.
pub(super) struct CovarianceSums {
    /// J'J.
    pub(super) gram: Gram,
    middle: Symmetric,
    correlation: f64,
    remembered: [f64; CAPACITY],
}

impl CovarianceSums {
    pub(super) fn new(columns: usize, correlation: f64) -> CovarianceSums {
        CovarianceSums {
            gram: Gram::new(columns),
            middle: Symmetric::zero(columns),
            correlation,
            remembered: [0.0; CAPACITY],
        }
    }

    /// Adds a block of `len` readings whose design columns, times `scales`, are the Jacobian's.
    pub(super) fn add(&mut self, len: usize, columns: &[Column], scales: &[f64; CAPACITY]) {
        let mut scaled = [[0.0; BLOCK]; CAPACITY];
        let mut memory = [[0.0; BLOCK]; CAPACITY];
        for (k, column) in columns.iter().enumerate() {
            let mut z = self.remembered[k];
            for t in 0..len {
                let value = scales[k] * column[t];
                scaled[k][t] = value;
                z = self.correlation * z + value;
                memory[k][t] = z;
            }
            self.remembered[k] = z;
        }
        let n = columns.len();
        self.gram.add(&scaled[..n], &[0.0; BLOCK]);
        for row in 0..n {
            for column in 0..=row {
                let both = dot(&scaled[row], &memory[column]) + dot(&memory[row], &scaled[column]);
                self.middle.set(row, column, self.middle.get(row, column) + both);
            }
        }
    }

    /// The covariance. Where the data lose a direction altogether the plain inverse with that direction held
    /// at rounding is taken, so that its variance is huge and combinations that do not need it stay small.
    pub(super) fn covariance(&self, residuals: &Residuals) -> Symmetric {
        let n = self.gram.matrix.order();
        let inverse = self.gram.matrix.floored_inverse(LOST);
        let lost = (0..n).any(|k| inverse.get(k, k) * self.gram.matrix.get(k, k) > 0.01 / LOST);
        let variance = residuals.noise.variance * residuals.excess;
        if lost {
            let memory =
                residuals.noise.long_run_variance().max(residuals.noise.variance) / residuals.noise.variance;
            let memory = if memory.is_finite() { memory } else { 1.0 };
            return Symmetric::from_fn(n, |row, column| variance * memory * inverse.get(row, column));
        }
        let middle = Symmetric::from_fn(n, |row, column| {
            self.middle.get(row, column) - self.gram.matrix.get(row, column)
        });
        let sandwich = inverse.sandwich(&middle);
        Symmetric::from_fn(n, |row, column| variance * sandwich.get(row, column))
    }
}
