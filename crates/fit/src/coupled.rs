//! The current after an open circuit, where the problem is no longer separable: what the branches exchange
//! while the source is away depends on every resistance. All parameters are searched together.

use ieap_domain::{Drive, Level};
use ieap_model::{Branch, LumpedModel};
use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Problem, Stop};

use super::circuit::Solution;
use super::sampled::Sampled;

/// Step of the difference quotients in logarithms.
const STEP: f64 = 1e-6;
/// Evaluations allowed.
const LIMIT: u64 = 60;

/// A refined solution with what the covariance needs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Refined {
    /// Logarithms of the time constants, conductances and the sum of squares.
    pub(super) solution: Solution,
    /// Current at every reading, A.
    pub(super) fitted: Vec<f64>,
    /// Derivatives of the current with respect to [ln c_1.., steady, ln tau_1..], by column.
    pub(super) jacobian: Vec<Vec<f64>>,
    /// Why the search stopped.
    pub(super) stop: Stop,
    /// Evaluations of the current and its derivatives.
    pub(super) evaluations: u64,
}

/// Whether the source comes back after an open circuit.
pub(super) fn is_coupled(drive: &Drive) -> bool {
    let open = drive
        .segments
        .iter()
        .position(|segment| segment.level == Level::OpenCircuit);
    open.is_some_and(|first| {
        drive.segments[first..]
            .iter()
            .any(|segment| matches!(segment.level, Level::Voltage(_)))
    })
}

/// The current of unit area as a function of [ln c_1.., steady / unit, ln tau_1..].
struct Current<'a> {
    drive: &'a Drive,
    sampled: &'a Sampled,
    branches: usize,
    unit_a_per_v: f64,
    bounds: Bounds,
}

impl Current<'_> {
    fn at(&self, place: &[f64]) -> Vec<f64> {
        let n = self.branches;
        let branch = |k: usize| Branch {
            resistance_ohm_cm2: (-place[k]).exp(),
            capacitance_f_per_cm2: (place[k] + place[n + 1 + k]).exp(),
        };
        let model = LumpedModel {
            branches: (0..n).map(branch).collect(),
            steady_state_resistance_ohm_cm2: (place[n].max(0.0) * self.unit_a_per_v).recip(),
            charge_to_curvature_per_c_cm: 0.0,
            relaxation_rate_per_s: 0.0,
        };
        let mut current = model.current_a(self.drive, 1.0, &self.sampled.time_s);
        self.sampled.weigh_all(&mut current);
        current
    }

    fn jacobian(&self, place: &[f64], here: &[f64]) -> Vec<Vec<f64>> {
        let column = |k: usize| {
            let mut there = place.to_vec();
            let step = if there[k] + STEP > self.bounds.high[k] {
                -STEP
            } else {
                STEP
            };
            there[k] += step;
            self.at(&there)
                .iter()
                .zip(here)
                .map(|(a, b)| (a - b) / step)
                .collect()
        };
        (0..place.len()).map(column).collect()
    }
}

impl Problem for Current<'_> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, place: &[f64], _: f64) -> Local {
        let here = self.at(place);
        let jacobian = self.jacobian(place, &here);
        let mut values = self.sampled.values.to_vec();
        self.sampled.weigh_all(&mut values);
        let residuals: Vec<f64> = values.iter().zip(&here).map(|(y, f)| y - f).collect();
        Local::of(&residuals, &jacobian)
    }
}

impl<'a> Current<'a> {
    /// About `conductances_a_per_v` (of the branches, and the steady one), with time constants between `low` and `high`
    /// (logarithms of s), and a place to start from.
    fn about(
        drive: &'a Drive,
        sampled: &'a Sampled,
        conductances_a_per_v: &[f64],
        log_time_constants: &[f64],
        (low, high): (f64, f64),
    ) -> (Current<'a>, Vec<f64>) {
        let n = log_time_constants.len();
        let unit_a_per_v: f64 = conductances_a_per_v.iter().sum();
        // A branch that was given no current starts small, so that the search may still raise it.
        let logs = |k: usize| conductances_a_per_v[k].max(1e-3 * unit_a_per_v).ln();
        let mut start: Vec<f64> = (0..n).map(logs).collect();
        start.push(conductances_a_per_v[n] / unit_a_per_v);
        start.extend(log_time_constants);
        let mut bounds = Bounds::even(n, unit_a_per_v.ln() - 20.0, unit_a_per_v.ln() + 10.0);
        bounds.push(0.0, 1e3);
        (0..n).for_each(|_| bounds.push(low, high));
        let current = Current {
            drive,
            sampled,
            branches: n,
            unit_a_per_v,
            bounds,
        };
        (current, start)
    }
}

/// Searches on from a separable solution, whose branches must all carry current, with the time constants
/// between `low` and `high` (logarithms of s).
pub(super) fn refine(drive: &Drive, sampled: &Sampled, from: &Solution, low: f64, high: f64) -> Refined {
    let n = from.log_time_constants.len();
    let (current, start) = Current::about(
        drive,
        sampled,
        &from.conductances_a_per_v,
        &from.log_time_constants,
        (low, high),
    );
    let unit_a_per_v = current.unit_a_per_v;
    let rounding = 4.0 * f64::EPSILON * sampled.square();
    let found = Levenberg::by_region(LIMIT, 1e-10, rounding).search(&current, &start);
    let place = &found.at;
    let fitted = current.at(place);
    let mut jacobian = current.jacobian(place, &fitted);
    jacobian[n].iter_mut().for_each(|value| *value /= unit_a_per_v);
    let mut conductances_a_per_v: Vec<f64> = place[..n].iter().map(|log| log.exp()).collect();
    conductances_a_per_v.push(place[n] * unit_a_per_v);
    Refined {
        solution: Solution {
            log_time_constants: place[n + 1..].to_vec(),
            conductances_a_per_v,
            offset_a: 0.0,
            square: found.local.square,
        },
        fitted,
        jacobian,
        stop: found.stop,
        evaluations: found.evaluations,
    }
}
