//! The sum of squares of a group under the base model with effects added.

use ieap_fit::WhitenedChannel;
use ieap_model::effects::{Applied, Effect, Limits};
use ieap_model::extended::ExtendedModel;
use ieap_model::{Branch, LumpedModel};
use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Minimum, Problem};
use ieap_numerics::sums::{add, dot};
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::policy::REACH;
use crate::readings::group::RunGroup;

/// An effect whose parameters are free.
#[derive(Clone)]
pub(crate) struct FreeEffect {
    pub(crate) effect: &'static dyn Effect,
    pub(crate) variant: usize,
    pub(crate) limits: Vec<Limits>,
    /// Size of each linear parameter of one coordinate unit.
    units: Vec<f64>,
    /// Values of the held parameters; the others' are not read.
    held: Vec<f64>,
    /// Precision with which each searched coordinate is known to be 0 before any reading; empty where nothing is known.
    pub(crate) known: Vec<f64>,
}

impl FreeEffect {
    pub(crate) fn new(
        effect: &'static dyn Effect,
        variant: usize,
        limits: Vec<Limits>,
        probe: &[f64],
    ) -> FreeEffect {
        let unit = |(limits, &value): (&Limits, &f64)| {
            let reach = limits.high.abs().min(limits.low.abs().max(limits.high.abs()));
            if value != 0.0 { value.abs() } else { reach }
        };
        FreeEffect {
            effect,
            variant,
            units: limits.iter().zip(probe).map(unit).collect(),
            held: probe.to_vec(),
            limits,
            known: Vec::new(),
        }
    }

    /// The same with so much known of its searched coordinates before any reading.
    pub(crate) fn known_to(self, known: Vec<f64>) -> FreeEffect {
        FreeEffect { known, ..self }
    }

    /// Number of parameters that are searched.
    pub(crate) fn free(&self) -> usize {
        self.limits.iter().filter(|limits| !limits.held).count()
    }

    /// Coordinate of parameter `k` at that value.
    pub(crate) fn coordinate(&self, k: usize, value: f64) -> f64 {
        if self.limits[k].logarithmic {
            value.max(f64::MIN_POSITIVE).ln()
        } else {
            value / self.units[k]
        }
    }

    /// Coordinates of the free parameters of `values`.
    pub(crate) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let free = (0..self.limits.len()).filter(|&k| !self.limits[k].held);
        free.map(|k| self.coordinate(k, values[k])).collect()
    }

    /// Adds the limits of the free parameters.
    fn bound(&self, bounds: &mut Bounds) {
        let lows: Vec<f64> = self.limits.iter().map(|limits| limits.low).collect();
        let highs: Vec<f64> = self.limits.iter().map(|limits| limits.high).collect();
        bounds.low.extend(self.coordinates(&lows));
        bounds.high.extend(self.coordinates(&highs));
    }

    /// Parameters at `coordinates` of the free ones.
    pub(crate) fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut next = coordinates.iter();
        let value = |k: usize| {
            if self.limits[k].held {
                return self.held[k];
            }
            let at = next.next().copied().unwrap_or(0.0);
            if self.limits[k].logarithmic {
                at.exp()
            } else {
                at * self.units[k]
            }
        };
        (0..self.limits.len()).map(value).collect()
    }

    /// Parameter, its value per coordinate unit at `value`.
    pub(crate) fn slope(&self, k: usize, value: f64) -> f64 {
        if self.limits[k].logarithmic {
            value
        } else {
            self.units[k]
        }
    }
}

/// The sum of squares of some runs of a group.
#[derive(Clone)]
pub(crate) struct ExtendedProblem<'g> {
    pub(crate) group: &'g RunGroup<'g>,
    /// Runs that take part.
    pub(crate) runs: Vec<usize>,
    pub(crate) effects: Vec<FreeEffect>,
    branches: usize,
    bends: bool,
    units: [f64; 3],
    start: LumpedModel,
    resolved_s: Option<f64>,
    /// Rows that take no part; empty where all do.
    left_out: Vec<bool>,
    bounds: Bounds,
}

impl<'g> ExtendedProblem<'g> {
    /// Step of the difference quotients, in coordinates scaled to be of order one.
    pub(crate) const STEP: f64 = 1e-5;

    /// All runs, with `start` as what sizes are measured by.
    pub(crate) fn new(
        group: &'g RunGroup<'g>,
        start: &LumpedModel,
        effects: Vec<FreeEffect>,
    ) -> ExtendedProblem<'g> {
        let parallel: f64 = start.branches.iter().map(|b| b.resistance_ohm_cm2.recip()).sum();
        let longest_s = group.runs.iter().map(|run| run.duration_s).fold(1e-9, f64::max);
        let steady = start.steady_state_resistance_ohm_cm2.recip();
        let or = |value: f64, other: f64| if value > 0.0 { value } else { other };
        let units = [
            or(steady, 0.01 * parallel),
            or(start.charge_to_curvature_per_c_cm.abs(), 1.0),
            or(start.relaxation_rate_per_s, 0.1 / longest_s),
        ];
        let shortest_s = start
            .branches
            .iter()
            .map(|b| b.time_constant_s())
            .fold(longest_s, f64::min);
        let mut problem = ExtendedProblem {
            group,
            runs: (0..group.runs.len()).collect(),
            effects,
            branches: start.branches.len(),
            bends: group.bends(),
            units,
            start: start.clone(),
            resolved_s: Some(shortest_s),
            left_out: Vec::new(),
            bounds: Bounds::default(),
        };
        problem.bound();
        problem
    }

    fn bound(&mut self) {
        let at = self.base_coordinates(&self.start);
        self.bounds = Bounds::about(&at[..2 * self.branches], REACH);
        self.bounds.push(0.0, 1e6);
        if self.bends {
            self.bounds.push(-1e6, 1e6);
            self.bounds.push(0.0, 1e5);
        }
        for free_effect in &self.effects {
            free_effect.bound(&mut self.bounds);
        }
    }

    /// The same with one more effect, its coordinates behind the others.
    pub(crate) fn with(&self, free_effect: FreeEffect) -> ExtendedProblem<'g> {
        let mut problem = self.clone();
        free_effect.bound(&mut problem.bounds);
        problem.effects.push(free_effect);
        problem
    }

    /// The same with other limits of its effects.
    pub(crate) fn within_limits_of(&self, effects: Vec<FreeEffect>) -> ExtendedProblem<'g> {
        let mut problem = ExtendedProblem {
            effects,
            ..self.clone()
        };
        problem.bound();
        problem
    }

    /// The same over other runs of the group.
    pub(crate) fn over(&self, runs: Vec<usize>) -> ExtendedProblem<'g> {
        ExtendedProblem { runs, ..self.clone() }
    }

    /// The same without some rows of all runs.
    pub(crate) fn without(&self, rows: &[bool]) -> ExtendedProblem<'g> {
        ExtendedProblem {
            left_out: rows.to_vec(),
            ..self.clone()
        }
    }

    /// Number of coordinates of the base model.
    pub(crate) fn base_len(&self) -> usize {
        2 * self.branches + 1 + if self.bends { 2 } else { 0 }
    }

    /// Size of one coordinate of `1/R_ss`, alpha and lambda.
    pub(crate) fn units(&self) -> [f64; 3] {
        self.units
    }

    fn base_coordinates(&self, model: &LumpedModel) -> Vec<f64> {
        let resistances = model.branches.iter().map(|b| b.resistance_ohm_cm2.ln());
        let capacitances = model.branches.iter().map(|b| b.capacitance_f_per_cm2.ln());
        let mut at: Vec<f64> = resistances.chain(capacitances).collect();
        at.push(model.steady_state_resistance_ohm_cm2.recip() / self.units[0]);
        if self.bends {
            at.push(model.charge_to_curvature_per_c_cm / self.units[1]);
            at.push(model.relaxation_rate_per_s / self.units[2]);
        }
        at
    }

    /// Coordinates of a base model and of the effects' parameters.
    pub(crate) fn coordinates(&self, base: &LumpedModel, effects: &[Vec<f64>]) -> Vec<f64> {
        let mut at = self.base_coordinates(base);
        for (free_effect, values) in self.effects.iter().zip(effects) {
            at.extend(free_effect.coordinates(values));
        }
        at
    }

    /// The model at these coordinates.
    pub(crate) fn model(&self, at: &[f64]) -> ExtendedModel {
        let n = self.branches;
        let branch = |k: usize| Branch {
            resistance_ohm_cm2: at[k].exp(),
            capacitance_f_per_cm2: at[n + k].exp(),
        };
        let bending = if self.bends {
            (at[2 * n + 1], at[2 * n + 2])
        } else {
            (0.0, 0.0)
        };
        let base = LumpedModel {
            branches: (0..n).map(branch).collect(),
            steady_state_resistance_ohm_cm2: (at[2 * n].max(0.0) * self.units[0]).recip(),
            charge_to_curvature_per_c_cm: bending.0 * self.units[1],
            relaxation_rate_per_s: bending.1.max(0.0) * self.units[2],
        };
        let mut first = self.base_len();
        let applied = self.effects.iter().map(|free_effect| {
            let end = first + free_effect.free();
            let parameters = free_effect.values(&at[first..end]);
            first = end;
            Applied {
                effect: free_effect.effect,
                variant: free_effect.variant,
                parameters,
            }
        });
        let effects = applied.collect();
        ExtendedModel { base, effects }
    }

    /// Whitened residuals of the runs that take part, channel after channel.
    pub(crate) fn residuals(&self, at: &[f64], out: &mut Vec<f64>) {
        out.clear();
        let model = self.model(at);
        for &run in &self.runs {
            self.run_residuals(&model, run, out);
        }
        for (value, left_out) in out.iter_mut().zip(&self.left_out) {
            if *left_out {
                *value = 0.0;
            }
        }
    }

    /// Sum of squares.
    pub(crate) fn square(&self, at: &[f64]) -> f64 {
        let mut out = Vec::new();
        self.residuals(at, &mut out);
        dot(&out, &out)
    }

    /// Precision of each coordinate before any reading: 0 where nothing is known.
    pub(crate) fn known(&self) -> Vec<f64> {
        let mut known = vec![0.0; self.base_len()];
        for free_effect in &self.effects {
            let own = (0..free_effect.free()).map(|k| free_effect.known.get(k).copied().unwrap_or(0.0));
            known.extend(own);
        }
        known
    }

    /// What is added to the sum of squares by what is known before any reading.
    pub(crate) fn penalty(&self, at: &[f64]) -> f64 {
        self.known()
            .iter()
            .zip(at)
            .map(|(known, at)| known * at * at)
            .sum()
    }

    fn add_known(&self, local: &mut Local, at: &[f64]) {
        let known = self.known();
        if known.iter().any(|precision| *precision > 0.0) {
            let diagonal = Symmetric::from_fn(known.len(), |a, b| if a == b { known[a] } else { 0.0 });
            local.add_known_before(&diagonal, 1.0, at);
        }
    }

    /// Number of residuals of one run.
    pub(crate) fn rows_of(&self, run: usize) -> usize {
        self.group.runs[run]
            .channels
            .iter()
            .flatten()
            .map(WhitenedChannel::len)
            .sum()
    }

    /// Whitened residuals of one run, appended.
    pub(crate) fn run_residuals(&self, model: &ExtendedModel, run: usize, out: &mut Vec<f64>) {
        let group_run = &self.group.runs[run];
        let context = group_run.context(run, self.resolved_s);
        let first = out.len();
        group_run.whitened(&group_run.fitted(model, &context), out);
        group_run.take_out(&mut out[first..]);
    }

    /// Sum of squares with its slope, what is known before added, and the Jacobian of the residuals column by column.
    pub(crate) fn slope(&self, at: &[f64]) -> (Local, Vec<Vec<f64>>) {
        let mut here = Vec::new();
        self.residuals(at, &mut here);
        let columns: Vec<Vec<f64>> = (0..at.len()).map(|k| self.column(at, k, &here)).collect();
        let mut local = local_of(&here, &columns.iter().collect::<Vec<_>>());
        self.add_known(&mut local, at);
        (local, columns)
    }

    /// How whitened residuals follow all resistances of branches at once, and how the size of the bending, both in
    /// logarithms: the shapes of a larger current and of a larger curvature.
    pub(crate) fn edge_shapes(&self, at: &[f64]) -> [Vec<f64>; 2] {
        let mut here = Vec::new();
        self.residuals(at, &mut here);
        let mut by_resistance = vec![0.0; here.len()];
        for k in 0..self.branches {
            add(&mut by_resistance, 1.0, &self.column(at, k, &here));
        }
        let by_size = if self.bends {
            self.column(at, 2 * self.branches + 1, &here)
        } else {
            vec![0.0; here.len()]
        };
        [by_resistance, by_size]
    }

    fn column(&self, at: &[f64], k: usize, here: &[f64]) -> Vec<f64> {
        let step = if at[k] + Self::STEP > self.bounds.high[k] {
            -Self::STEP
        } else {
            Self::STEP
        };
        let mut there = at.to_vec();
        there[k] += step;
        let mut column = Vec::with_capacity(here.len());
        self.residuals(&there, &mut column);
        for (there, here) in column.iter_mut().zip(here) {
            *there = (*there - here) / step;
        }
        column
    }

    /// Lowers the sum of squares from `start` within `limit` evaluations of the slope. Columns of the Jacobian that
    /// are `known` are held: the search then takes more steps, each of them cheap.
    pub(crate) fn search(&self, start: &[f64], limit: u64, settle: f64, known: &[Vec<f64>]) -> Minimum {
        let problem = self;
        Levenberg::by_diagonal(limit, settle).search(&Knowing { problem, known }, start)
    }

    /// Limits of coordinate `k`.
    pub(crate) fn limits_of(&self, k: usize) -> (f64, f64) {
        (self.bounds.low[k], self.bounds.high[k])
    }

    /// Whether coordinate `k` may not take that value.
    pub(crate) fn is_outside(&self, k: usize, value: f64) -> bool {
        !self.bounds.contain(k, value)
    }

    /// The value of coordinate `k`, or the limit that it passes.
    pub(crate) fn within(&self, k: usize, value: f64) -> f64 {
        value.clamp(self.bounds.low[k], self.bounds.high[k])
    }

    /// Whether coordinate `k` lies at a limit of the search.
    pub(crate) fn at_limit(&self, k: usize, value: f64) -> bool {
        let (low, high) = self.limits_of(k);
        let near = 1e-6 * (high - low).min(1.0);
        value <= low + near || value >= high - near
    }
}

/// A problem of which the first columns of the Jacobian are known.
struct Knowing<'k, 'g> {
    problem: &'k ExtendedProblem<'g>,
    known: &'k [Vec<f64>],
}

impl Problem for Knowing<'_, '_> {
    fn bounds(&self) -> Bounds {
        self.problem.bounds.clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let mut here = Vec::new();
        self.problem.residuals(at, &mut here);
        let square = dot(&here, &here) + self.problem.penalty(at);
        // No number is more than none.
        if square > most || !square.is_finite() {
            return Local::refused(square, at.len());
        }
        let fresh: Vec<Vec<f64>> = (self.known.len()..at.len())
            .map(|k| self.problem.column(at, k, &here))
            .collect();
        let mut local = local_of(&here, &self.known.iter().chain(&fresh).collect::<Vec<_>>());
        self.problem.add_known(&mut local, at);
        local
    }
}

/// From residuals and the derivatives of the residuals themselves, whose sign is the other one.
pub(crate) fn local_of(residuals: &[f64], columns: &[&Vec<f64>]) -> Local {
    let mut local = Local::of(residuals, columns);
    local.descent.iter_mut().for_each(|d| *d = -*d);
    local
}
