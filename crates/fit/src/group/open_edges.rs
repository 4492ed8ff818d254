//! Edges between readings, found with all that a group shares: runs that answer alike tell where each other's edges are.

use ieap_domain::Drive;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Minimum, Problem};
use ieap_numerics::symmetric::Symmetric;

use crate::edges::Settled;
use crate::edges::{EdgeTimes, Shift};
use crate::joint::feature::Feature;
use crate::joint::problem::{Column, JointProblem, add_run};
use crate::widened::{End, Values};

/// Evaluations of a search, and the fall of the sum of squares at which it settles.
const LIMIT: u64 = 60;
const SETTLE: f64 = 1e-8;
/// Step of the derivative by a shift, parts of what is not known of it.
const STEP: f64 = 1e-4;

/// The edges of one run of a group, and where its parameters go to both ends of what is left open of all edges of the group.
pub(super) struct Placed {
    pub(super) settled: Settled,
    pub(super) here: Values,
    pub(super) ends: Vec<[Option<End>; 2]>,
}

/// The edges of every run, searched with the group's parameters from `at`.
pub(super) fn placed(problem: &JointProblem, at: &[f64], edges: &[EdgeTimes]) -> Option<Vec<Placed>> {
    let with_edges = WithEdges::of(problem, edges);
    let best = with_edges.best(at)?;
    let ways = with_edges.open_ways(&best);
    let (place, by_s) = best.at.split_at(at.len());
    let of_run = |(run, (edges, by_s)): (usize, (&EdgeTimes, &[f64]))| {
        let first = with_edges.first(run);
        let own = |(_, shifts): &Way| shifts[first..first + by_s.len()].to_vec();
        let end = |along: &[f64], sign: f64| {
            let by = |(at, by): (&f64, &f64)| at + sign * NORMAL_95 * by;
            let there: Vec<f64> = place.iter().zip(along).map(by).collect();
            Some(End {
                part: 1.0,
                there: values(problem, run, &there),
            })
        };
        let ends = |(along, _): &Way| [-1.0, 1.0].map(|sign| end(along, sign));
        Placed {
            settled: Settled {
                edges: edges.moved(by_s),
                open: ways.iter().map(own).collect(),
            },
            here: values(problem, run, place),
            ends: ways.iter().map(ends).collect(),
        }
    };
    let each = edges.iter().zip(with_edges.by_run(by_s));
    Some(each.enumerate().map(of_run).collect())
}

/// How far the coordinates of a group go, and its shifts, one standard deviation.
type Way = (Vec<f64>, Vec<f64>);

/// The sum of squares of a group as a function of its coordinates and of the shifts of all its edges, s.
struct WithEdges<'p, 'a> {
    problem: &'p JointProblem<'a>,
    edges: &'p [EdgeTimes],
    /// What is known of the shifts before any reading, 1/s2.
    known: Symmetric,
    bounds: Bounds,
}

impl<'p, 'a> WithEdges<'p, 'a> {
    fn of(problem: &'p JointProblem<'a>, edges: &'p [EdgeTimes]) -> WithEdges<'p, 'a> {
        let mut bounds = problem.bounds.clone();
        let count = edges.iter().map(|edges| edges.shifts().len()).sum();
        let (mut known, mut first) = (Symmetric::zero(count), 0);
        for edges in edges {
            let own = edges.known_before();
            for (k, shift) in edges.shifts().iter().enumerate() {
                let (low_s, high_s) = shift.limits_s();
                bounds.push(low_s, high_s);
                (0..=k).for_each(|other| known.set(first + k, first + other, own.get(k, other)));
            }
            first += own.order();
        }
        WithEdges {
            problem,
            edges,
            known,
            bounds,
        }
    }

    /// The first shift of a run among those of all.
    fn first(&self, run: usize) -> usize {
        self.edges[..run].iter().map(|edges| edges.shifts().len()).sum()
    }

    /// The shifts of each run.
    fn by_run<'s>(&self, mut shifts: &'s [f64]) -> Vec<&'s [f64]> {
        let of_run = |edges: &EdgeTimes| {
            let (own, rest) = shifts.split_at(edges.shifts().len());
            shifts = rest;
            own
        };
        self.edges.iter().map(of_run).collect()
    }

    /// The deepest minimum from the places at which shifts are begun.
    fn best(&self, at: &[f64]) -> Option<Minimum> {
        let begun_at = |place: usize| {
            let shifts = self.edges.iter().flat_map(EdgeTimes::shifts);
            let shifts = shifts.map(|shift| shift.begun_at_s()[place]);
            let start: Vec<f64> = at.iter().copied().chain(shifts).collect();
            Levenberg::by_diagonal(LIMIT, SETTLE).search(self, &start)
        };
        Minimum::lowest((0..Shift::PLACES).map(begun_at))
    }

    /// Independent ways in which all shifts may still be off together, and where the coordinates then go.
    fn open_ways(&self, best: &Minimum) -> Vec<Way> {
        let (count, all) = (self.problem.bounds.count(), best.at.len());
        let normal = &best.local.normal;
        let shifts: Vec<usize> = (count..all).collect();
        let held = normal.first(count).inverse(1e-13);
        let (sizes, vectors) = normal.floored_inverse(1e-13).part(&shifts).eigen();
        let way = |(place, size): (usize, &f64)| {
            let sd = size.max(0.0).sqrt();
            let by_s: Vec<f64> = vectors.iter().map(|of_shift| sd * of_shift[place]).collect();
            let pull = |k: usize| {
                -(0..by_s.len())
                    .map(|j| normal.get(k, count + j) * by_s[j])
                    .sum::<f64>()
            };
            let pull: Vec<f64> = (0..count).map(pull).collect();
            (held.times(&pull), by_s)
        };
        sizes.iter().enumerate().map(way).collect()
    }

    /// Derivatives by the shifts of a run, whose residuals are `here` and whose parameters are `local`.
    fn shift_columns(&self, run: usize, local: &[f64], by_s: &[f64], here: &[f64]) -> Vec<Column> {
        let first = self.problem.bounds.count() + self.first(run);
        let column = |(k, shift): (usize, &Shift)| {
            let step_s = STEP * shift.standard_deviation_s();
            let step_s = if by_s[k] > 0.0 { -step_s } else { step_s };
            let mut moved = by_s.to_vec();
            moved[k] += step_s;
            let there = self.residuals(run, local, &self.edges[run].shifted(&moved));
            let along = here
                .iter()
                .zip(&there)
                .map(|(here, there)| (here - there) / step_s);
            (first + k, along.collect())
        };
        self.edges[run].shifts().iter().enumerate().map(column).collect()
    }

    /// Weighted residuals of a run under another drive.
    fn residuals(&self, run: usize, local: &[f64], drive: &Drive) -> Vec<f64> {
        let mut out = Vec::new();
        self.problem.residuals(run, drive, local, &mut out);
        out
    }
}

impl Problem for WithEdges<'_, '_> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, place: &[f64], most: f64) -> Local {
        let (at, by_s) = place.split_at(self.problem.bounds.count());
        let mut all = Local::zero(place.len());
        for (run, by_s) in self.by_run(by_s).into_iter().enumerate() {
            let drive = self.edges[run].shifted(by_s);
            let local = self.problem.of_run(run, at);
            let here = self.residuals(run, &local, &drive);
            all.square += here.iter().map(|left| left * left).sum::<f64>();
            if all.square > most {
                return all;
            }
            let mut columns = self.problem.columns(run, &drive, at, &here);
            columns.sort_by_key(|(k, _)| *k);
            columns.extend(self.shift_columns(run, &local, by_s, &here));
            add_run(&columns, &here, &mut all);
        }
        for spectrum in &self.problem.spectra {
            self.problem.add_spectrum(spectrum, at, &mut all);
        }
        all.add_known_before(&self.known, 1.0, place);
        all
    }
}

/// The values that are stated of a run at a place.
fn values(problem: &JointProblem, run: usize, at: &[f64]) -> Values {
    let local = problem.of_run(run, at);
    let of = |feature: Feature| {
        let stated = feature.stated(feature.of(problem.layout, &local));
        Some((feature.key()?.to_owned(), stated))
    };
    Feature::all(problem.layout.branches).filter_map(of).collect()
}
