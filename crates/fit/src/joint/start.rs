//! From two-step solutions to the coordinates of a joint search.

use crate::bending::Bending;
use crate::electrical::Electrical;
use crate::joint::policy::FARTHEST_LOG;
use ieap_domain::Drive;
use ieap_numerics::least_squares::Bounds;
use ieap_numerics::sums;

use super::layout::Layout;
use super::problem::{JointProblem, Slot};
use super::readings::RunReadings;

/// Local parameters of a run to start from, in their own units, and which of them are there to be searched.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    pub(crate) local: Vec<f64>,
    pub(crate) searched: Vec<bool>,
}

impl Start {
    /// From resistances and capacitances of the branches (any order) and the steady conductance, all of unit area.
    pub(crate) fn new(branches: &[(f64, f64)], steady_s_per_cm2: f64) -> Start {
        let layout = Layout {
            branches: branches.len(),
        };
        let mut sorted = branches.to_vec();
        sorted.sort_by(|a, b| (a.0 * a.1).total_cmp(&(b.0 * b.1)));
        let mut local = vec![0.0; layout.len()];
        for (k, (resistance, capacitance)) in sorted.iter().enumerate() {
            local[layout.resistance(k)] = resistance.ln();
            local[layout.capacitance(k)] = capacitance.ln();
        }
        local[layout.steady()] = steady_s_per_cm2;
        let mut searched = vec![false; layout.len()];
        searched[..=layout.steady()].fill(true);
        Start { local, searched }
    }

    /// From step one, with `branches` branches: where it found fewer, others are put beside them that carry little.
    pub(crate) fn of(electrical: &Electrical, branches: usize) -> Start {
        let area = electrical.area_cm2;
        let found = electrical
            .conductances_a_per_v
            .iter()
            .zip(&electrical.time_constants_s);
        let mut pairs: Vec<(f64, f64)> = found
            .filter(|(c, tau)| **c > 0.0 && **tau > 0.0)
            .map(|(c, tau)| (area / c, c * tau / area))
            .collect();
        while pairs.len() < branches {
            let (resistance, capacitance) = pairs.last().copied().unwrap_or((1e3, 1e-2));
            pairs.push((3.0 * resistance, capacitance));
        }
        pairs.truncate(branches);
        let mut start = Start::new(&pairs, electrical.steady_a_per_v / area);
        if let Some(offset_a) = electrical.offset_a {
            let index = Layout { branches }.current_offset();
            start.local[index] = offset_a;
            start.searched[index] = true;
        }
        if !electrical.steady_visible {
            start.searched[Layout { branches }.steady()] = false;
        }
        start
    }

    /// The same with the circuit of `local`, parameters of as many branches, and the zero of its current.
    pub(crate) fn with_circuit(mut self, local: &[f64]) -> Start {
        let layout = self.layout();
        self.local[..=layout.steady()].copy_from_slice(&local[..=layout.steady()]);
        self.local[layout.current_offset()] = local[layout.current_offset()];
        self
    }

    /// The same with coupling and rate of step two.
    pub(crate) fn with_bending(mut self, bending: &Bending) -> Start {
        let layout = self.layout();
        self.local[layout.coupling()] = bending.coupling_per_c_cm;
        self.local[layout.rate()] = bending.rate_per_s;
        self.searched[layout.coupling()] = true;
        self.searched[layout.rate()] = true;
        if let Some(zero) = bending.zero {
            self.local[layout.curvature_offset()] = zero.value;
            self.searched[layout.curvature_offset()] = true;
        }
        self
    }

    pub(crate) fn layout(&self) -> Layout {
        Layout {
            branches: (self.local.len() - 5) / 2,
        }
    }
}

/// Step of the difference quotients of columns, in logarithms and in parts of a parameter.
const STEP: f64 = 1e-5;

impl Start {
    /// What the current, or the curvature, at these times gains by each of its parameters that is searched, per logarithm or
    /// part of it, beside its zero.
    pub(crate) fn columns(&self, drive: &Drive, area_cm2: f64, bends: bool, time_s: &[f64]) -> Vec<Vec<f64>> {
        let layout = self.layout();
        let (own, zero) = if bends {
            (layout.coupling()..=layout.rate(), layout.curvature_offset())
        } else {
            (0..=layout.steady(), layout.current_offset())
        };
        let at = |local: &[f64]| {
            let model = layout.model(local);
            if bends {
                model.curvature_per_cm(drive, area_cm2, time_s)
            } else {
                model.current_a(drive, area_cm2, time_s)
            }
        };
        let record_s = time_s
            .last()
            .zip(time_s.first())
            .map_or(1.0, |(last, first)| last - first);
        let size = |place: usize| {
            let own = self.local[place].abs();
            match place {
                _ if layout.is_logarithm(place) => 1.0,
                _ if place == layout.steady() => own.max((-self.local[layout.resistance(0)]).exp()),
                _ if place == layout.rate() => own.max(record_s.recip()),
                _ => own,
            }
        };
        let column = |place: usize| {
            let moved = |by: f64| {
                let mut local = self.local.clone();
                local[place] += by * size(place);
                at(&local)
            };
            let pairs = moved(STEP).into_iter().zip(moved(-STEP));
            pairs
                .map(|(above, below)| (above - below) / (2.0 * STEP))
                .collect()
        };
        let mut columns: Vec<Vec<f64>> = own.filter(|&place| self.searched[place]).map(column).collect();
        if self.searched[zero] {
            columns.push(vec![1.0; time_s.len()]);
        }
        columns
    }
}

/// The problem of these runs, and the coordinates that the starts stand for; local parameters in `shared` have
/// one coordinate for all runs (which starts at the first run's value).
pub(crate) fn problem<'a>(
    runs: Vec<RunReadings<'a>>,
    starts: &[Start],
    shared: &[usize],
) -> (JointProblem<'a>, Vec<f64>) {
    let layout = starts.first().map_or(Layout { branches: 1 }, Start::layout);
    let mut problem = JointProblem {
        units: units(&runs, starts, layout),
        runs,
        layout,
        slots: Vec::new(),
        bounds: Bounds::default(),
        known: Vec::new(),
        spectra: Vec::new(),
    };
    let mut at = Vec::new();
    let mut common: Vec<Option<usize>> = vec![None; layout.len()];
    for start in starts {
        let mut slots = Vec::with_capacity(layout.len());
        for (local, &value) in start.local.iter().enumerate() {
            let is_shared = shared.contains(&local);
            match common[local] {
                Some(k) if is_shared => {
                    slots.push(Slot::Searched(k));
                    continue;
                }
                _ if !start.searched[local] => {
                    slots.push(Slot::Held(value));
                    continue;
                }
                _ => {}
            }
            let k = at.len();
            at.push(value / problem.units[local]);
            let (low, high) = limits(&problem, local, at[k]);
            problem.bounds.push(low, high);
            if is_shared {
                common[local] = Some(k);
            }
            slots.push(Slot::Searched(k));
        }
        problem.slots.push(slots);
    }
    (problem, at)
}

/// Sizes of the local parameters, so that coordinates are of order one.
fn units(runs: &[RunReadings], starts: &[Start], layout: Layout) -> Vec<f64> {
    let mut units = vec![1.0; layout.len()];
    let most = |value: &dyn Fn(&Start) -> f64| starts.iter().map(value).fold(0.0_f64, f64::max);
    let or_one = |value: f64| {
        if value > 0.0 && value.is_finite() {
            value
        } else {
            1.0
        }
    };
    units[layout.steady()] = or_one(most(&|start| {
        (0..layout.branches).map(|k| (-start.local[k]).exp()).sum()
    }));
    units[layout.coupling()] = or_one(most(&|start| start.local[layout.coupling()].abs()));
    let peak = |curvature: bool| {
        let response = |run: &RunReadings| {
            let response = if curvature { &run.curvature } else { &run.current };
            let values = response.as_ref().map(|response| &*response.sampled.values);
            sums::peak(values.unwrap_or_default())
        };
        or_one(runs.iter().map(response).fold(0.0, f64::max))
    };
    units[layout.current_offset()] = peak(false);
    units[layout.curvature_offset()] = peak(true);
    let longest_s = runs
        .iter()
        .filter_map(|run| run.curvature.as_ref())
        .map(|response| response.sampled.time_scales_s().1)
        .fold(0.0, f64::max);
    units[layout.rate()] = or_one(longest_s).recip();
    units
}

fn limits(problem: &JointProblem, local: usize, start: f64) -> (f64, f64) {
    let layout = problem.layout;
    if layout.is_logarithm(local) {
        return (start - FARTHEST_LOG, start + FARTHEST_LOG);
    }
    if local == layout.steady() {
        return (0.0, 1e4);
    }
    if local == layout.rate() {
        let shortest_s = problem
            .runs
            .iter()
            .filter_map(|run| run.curvature.as_ref())
            .map(|response| response.sampled.time_scales_s().0)
            .fold(f64::INFINITY, f64::min);
        let fastest = 10.0 / shortest_s / problem.units[local];
        return (
            0.0,
            if fastest.is_finite() {
                fastest.max(10.0)
            } else {
                1e4
            },
        );
    }
    (-1e6, 1e6)
}
