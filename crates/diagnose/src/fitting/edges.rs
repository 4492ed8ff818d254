//! Edges of the drives that only readings tell of, found with a model of the group.

use ieap_fit::Shift;
use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Problem};
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use crate::readings::group::RunGroup;

/// Evaluations of a search, and the fall of the sum of squares that ends it.
const LIMIT: u64 = 40;
const SETTLE: f64 = 0.05;
/// Step of the difference quotients, in parts of a shift's range.
const STEP: f64 = 1e-4;

/// The group with its edges where the model has them best, and its coordinates there; none where no edge is open.
pub(crate) fn settled<'a>(group: &RunGroup<'a>, base: &Fitted) -> Option<(RunGroup<'a>, Vec<f64>)> {
    let open: Vec<(usize, usize)> = (group.runs.iter().enumerate())
        .flat_map(|(run, own)| (0..own.edges.shifts().len()).map(move |shift| (run, shift)))
        .collect();
    if open.is_empty() {
        return None;
    }
    let searched = WithEdges {
        problem: &base.problem,
        coordinates: base.at.len(),
        group,
        open,
    };
    let begun_at = |place: usize| {
        let shifts = searched.shifts().map(|shift| shift.begun_at_s()[place]);
        let start: Vec<f64> = base.at.iter().copied().chain(shifts).collect();
        Levenberg::by_diagonal(LIMIT, SETTLE).search(&searched, &start)
    };
    let best = (0..Shift::PLACES)
        .map(begun_at)
        .filter(|found| found.local.square.is_finite())
        .min_by(|a, b| a.local.square.total_cmp(&b.local.square))?;
    let (at, shifts_s) = best.at.split_at(base.at.len());
    let mut moved = group.clone();
    for (run, by_s) in moved.runs.iter_mut().zip(searched.by_run(shifts_s)) {
        run.edges = run.edges.moved(&by_s);
    }
    Some((moved, at.to_vec()))
}

/// The problem with the shifts of all runs' edges behind its coordinates, s.
struct WithEdges<'p, 'g> {
    problem: &'p ExtendedProblem<'p>,
    /// How many the model has.
    coordinates: usize,
    group: &'p RunGroup<'g>,
    /// Run and place of every shift.
    open: Vec<(usize, usize)>,
}

impl WithEdges<'_, '_> {
    fn shifts(&self) -> impl Iterator<Item = &Shift> {
        let shift = |&(run, shift): &(usize, usize)| &self.group.runs[run].edges.shifts()[shift];
        self.open.iter().map(shift)
    }

    fn ranges_s(&self) -> impl Iterator<Item = (f64, f64)> {
        self.shifts().map(Shift::limits_s)
    }

    /// The shifts of each run.
    fn by_run(&self, shifts_s: &[f64]) -> Vec<Vec<f64>> {
        let mut each: Vec<Vec<f64>> = vec![Vec::new(); self.group.runs.len()];
        for ((run, _), by_s) in self.open.iter().zip(shifts_s) {
            each[*run].push(*by_s);
        }
        each
    }

    /// What is known of all shifts before the readings tell, run by run.
    fn known_before(&self) -> Symmetric {
        let each: Vec<Symmetric> = self
            .group
            .runs
            .iter()
            .map(|run| run.edges.known_before())
            .collect();
        let first = |run: usize| self.open.iter().position(|(own, _)| *own == run).unwrap_or(0);
        Symmetric::from_fn(self.open.len(), |a, b| {
            let (run, other) = (self.open[a].0, self.open[b].0);
            if run == other {
                each[run].get(a - first(run), b - first(run))
            } else {
                0.0
            }
        })
    }

    /// Whitened residuals run by run.
    fn residuals(&self, at: &[f64], by_run: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let runs = 0..self.group.runs.len();
        runs.map(|run| self.of_run(at, run, &by_run[run])).collect()
    }

    fn of_run(&self, at: &[f64], run: usize, by_s: &[f64]) -> Vec<f64> {
        let own = &self.group.runs[run];
        let drive = own.edges.shifted(by_s);
        let mut context = own.context(run, None);
        context.drive = &drive;
        let mut out = Vec::new();
        own.whitened(&own.fitted(&self.problem.model(at), &context), &mut out);
        own.open_zeros.take_out(&mut out);
        out
    }
}

impl Problem for WithEdges<'_, '_> {
    fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        for k in 0..self.coordinates {
            let (low, high) = self.problem.limits_of(k);
            bounds.push(low, high);
        }
        self.ranges_s()
            .for_each(|(low_s, high_s)| bounds.push(low_s, high_s));
        bounds
    }

    fn local(&self, all: &[f64], most: f64) -> Local {
        let (at, shifts_s) = all.split_at(self.coordinates);
        let by_run = self.by_run(shifts_s);
        let here = self.residuals(at, &by_run);
        let square: f64 = here.iter().map(|own| dot(own, own)).sum();
        if square > most || !square.is_finite() {
            return Local::refused(square, all.len());
        }
        let whole = here.concat();
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(all.len());
        for k in 0..at.len() {
            let mut there = at.to_vec();
            there[k] += ExtendedProblem::STEP;
            let moved = self.residuals(&there, &by_run).concat();
            columns.push(quotients(&whole, &moved, ExtendedProblem::STEP));
        }
        let mut first = vec![0; here.len() + 1];
        for (run, own) in here.iter().enumerate() {
            first[run + 1] = first[run] + own.len();
        }
        let ranges: Vec<(f64, f64)> = self.ranges_s().collect();
        for (&(run, shift), (low_s, high_s)) in self.open.iter().zip(ranges) {
            let mut by_s = by_run[run].clone();
            let step_s = STEP
                * (high_s - low_s)
                * if by_s[shift] > 0.5 * (low_s + high_s) {
                    -1.0
                } else {
                    1.0
                };
            by_s[shift] += step_s;
            let mut column = vec![0.0; whole.len()];
            let own = quotients(&here[run], &self.of_run(at, run, &by_s), step_s);
            column[first[run]..first[run + 1]].copy_from_slice(&own);
            columns.push(column);
        }
        let mut local = Local::of(&whole, &columns);
        // Where the readings do not tell, an edge stays in the middle of where it may be; nor does a model tell that leaves more
        // than the noise: it would move edges to hide what it misses.
        let beyond_noise = (square / whole.len().max(1) as f64).max(1.0);
        local.add_known_before(&self.known_before(), beyond_noise, all);
        local
    }
}

/// How far what is taken from the readings goes with a coordinate: residuals go the other way.
fn quotients(here: &[f64], there: &[f64], step: f64) -> Vec<f64> {
    here.iter()
        .zip(there)
        .map(|(here, there)| (here - there) / step)
        .collect()
}
