//! What follows the drive and is none of the laws that are asked: the list is never complete.
//!
//! Where the true law is not in it, its nearest neighbour would be certain. Beside the laws stands an answer to the drive of
//! any smooth course: random sums of relaxations after every edge, as the square or the cube of the voltage or growing with the
//! clock, common to all runs or each run's own. An added current is stored, and then bends, or leaks. Or a part of the model changes with
//! something that was not asked: by a smooth function of the time in each run, of its own.

use std::collections::BTreeMap;

use ieap_model::LumpedModel;
use ieap_model::effects::Site;
use ieap_model::effects::smooth_laws::Place;
use rayon::prelude::*;

use super::columns::LawColumns;
use super::evidence::evidence;
use super::policy::{MOST_RELAXATIONS, RELAXATIONS};
use crate::cause::evidence::{Column, Process, log_mean};
use crate::fitting::tangent::Tangent;
use crate::readings::group::{GroupRun, RunGroup};

/// What such answers say of the residuals at a site: each by its products.
#[derive(Clone)]
pub(crate) struct Unnamed {
    pub(super) site: Site,
    answers: Vec<Process>,
}

impl Unnamed {
    /// Logarithm of the evidence of any of them over that of nothing, in noise of `t` times the variance.
    pub(super) fn log(&self, t: f64) -> f64 {
        let each = self
            .answers
            .iter()
            .filter_map(|own| Some(evidence(&own.broadened(t))?.log));
        log_mean(&each.collect::<Vec<f64>>())
    }

    /// What the likelihood gains by the best of them.
    pub(super) fn fall(&self) -> f64 {
        let of = |own: &Process| {
            let precisions = evidence(own)?.precisions;
            Some(0.5 * own.most_probable(&precisions).1)
        };
        self.answers.iter().filter_map(of).fold(0.0, f64::max)
    }
}

/// The same at both sites, beside a base model; `laws` are those that are asked.
pub(super) fn unnamed(
    group: &RunGroup,
    base: &LumpedModel,
    laws: &[LawColumns],
    tangent: &Tangent,
    residuals: &[f64],
) -> Vec<Unnamed> {
    let of_site = |site: Site| {
        // Bending is no current: it is asked once.
        let stored: &[bool] = match site {
            Site::Current => &[true, false],
            _ => &[false],
        };
        let answers = stored
            .iter()
            .flat_map(|&bends| [Of::All, Of::Each].map(|of| Answer { site, bends, of }));
        let of_drive = answers.map(|answer| answer.columns(group, base));
        let all: Vec<Vec<Column>> = of_drive.chain(of_parts(site, group, laws)).collect();
        let process = |columns: Vec<Column>| Process::of(&columns, tangent, residuals);
        let answers: Vec<Process> = all.into_par_iter().map(process).collect();
        let answers: Vec<Process> = answers.into_iter().filter(|own| !own.is_nothing()).collect();
        (!answers.is_empty()).then_some(Unnamed { site, answers })
    };
    let sites = [Site::Current, Site::Bending];
    sites.into_par_iter().filter_map(of_site).collect()
}

/// Of each part of the model at a site, that it goes in each run by a function of its own of the time and of that since an edge: the
/// columns of these laws, run by run.
fn of_parts(site: Site, group: &RunGroup, laws: &[LawColumns]) -> Vec<Vec<Column>> {
    let mut parts: BTreeMap<Place, Vec<Column>> = BTreeMap::new();
    let is_of_time = |law: &&LawColumns| {
        let place = law.law.place;
        place.site == site && matches!(place.variable, "time_s" | "time_since_edge_s")
    };
    for law in laws.iter().filter(is_of_time) {
        let part = Place {
            variable: "",
            ..law.law.place
        };
        let columns = parts.entry(part).or_default();
        for run in 0..group.runs.len() {
            let rows = group.rows_of(run);
            let own = |column: &Vec<f64>| Column::of(vec![(rows.start, column[rows.clone()].to_vec())]);
            columns.extend(law.columns.iter().map(own));
        }
    }
    parts.into_values().collect()
}

/// What an answer is in proportion to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum By {
    Voltage,
    Square,
    Cube,
    Clock,
}

impl By {
    fn of(self, volts: f64, largest_v: f64) -> f64 {
        let part = volts / largest_v.max(f64::MIN_POSITIVE);
        match self {
            By::Voltage | By::Clock => part,
            By::Square => part * part,
            By::Cube => part.powi(3),
        }
    }
}

/// How the runs have part in it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Of {
    All,
    Each,
}

/// An answer as it is asked: where, whether it is stored, whose.
#[derive(Debug, Clone, Copy)]
struct Answer {
    site: Site,
    bends: bool,
    of: Of,
}

/// The scales of a group.
struct Scales {
    longest_s: f64,
    shortest_s: f64,
    largest_v: f64,
}

impl Scales {
    fn of(group: &RunGroup) -> Scales {
        let longest_s = group.runs.iter().map(|run| run.duration_s).fold(0.0, f64::max);
        let closest = |times: &[f64]| {
            let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
            steps.filter(|step| *step > 0.0).fold(longest_s, f64::min)
        };
        let times = group.runs.iter().flat_map(|run| [run.times(0), run.times(1)]);
        Scales {
            longest_s,
            shortest_s: times.map(closest).fold(longest_s, f64::min),
            largest_v: group
                .runs
                .iter()
                .map(|run| run.drive().largest_v())
                .fold(0.0, f64::max),
        }
    }

    /// Rates of relaxations from the shortest time between readings to the longest record, 1/s, and none at all.
    fn rates(&self, count: usize) -> Vec<f64> {
        let whole = self.longest_s / self.shortest_s;
        let rate = |k: usize| whole.powf(k as f64 / (count - 1).max(1) as f64) / self.longest_s;
        std::iter::once(0.0).chain((0..count).map(rate)).collect()
    }
}

impl Answer {
    fn columns(self, group: &RunGroup, base: &LumpedModel) -> Vec<Column> {
        let scales = Scales::of(group);
        let count = match self.of {
            Of::All => RELAXATIONS,
            Of::Each => (MOST_RELAXATIONS / group.runs.len().max(1)).clamp(2, RELAXATIONS),
        };
        let rates = scales.rates(count);
        let piece = |run: usize, by: By, rate: f64| {
            let relaxing = Relaxing {
                by,
                rate,
                scales: &scales,
            };
            (
                group.rows_of(run).start,
                self.rows(&group.runs[run], base, relaxing),
            )
        };
        let runs = || 0..group.runs.len();
        match self.of {
            Of::All => {
                // In proportion to the voltage it would be one more time scale, which is a law of the list.
                let each =
                    [By::Square, By::Cube, By::Clock].map(|by| rates.iter().map(move |rate| (by, *rate)));
                let column = |(by, rate)| Column::of(runs().map(|run| piece(run, by, rate)).collect());
                each.into_iter().flatten().map(column).collect()
            }
            Of::Each => {
                let each = runs().flat_map(|run| rates.iter().map(move |rate| (run, *rate)));
                each.map(|(run, rate)| Column::of(vec![piece(run, By::Voltage, rate)]))
                    .collect()
            }
        }
    }

    /// Whitened rows of a run.
    fn rows(self, run: &GroupRun, base: &LumpedModel, relaxing: Relaxing) -> Vec<f64> {
        let mut rows = Vec::new();
        for (k, channel) in run.channels.iter().enumerate() {
            let Some(channel) = channel else { continue };
            let times = channel.time_s();
            let mut series = match (self.site, k) {
                (Site::Current, 0) | (Site::Bending, 1) => relaxing.over(run, times),
                (Site::Current, 1) if self.bends => relaxing.bent(run, base, times),
                _ => vec![0.0; times.len()],
            };
            channel.whiten(&mut series);
            rows.extend(series);
        }
        run.take_out(&mut rows);
        rows
    }
}

/// A relaxation after every edge.
#[derive(Clone, Copy)]
struct Relaxing<'a> {
    by: By,
    rate: f64,
    scales: &'a Scales,
}

impl Relaxing<'_> {
    fn over(self, run: &GroupRun, time_s: &[f64]) -> Vec<f64> {
        let relaxed = self.relaxed(run, self.rate, time_s);
        self.by_clock(relaxed, time_s)
    }

    /// What it bends, as a current that is stored, where the strip forgets.
    fn bent(self, run: &GroupRun, base: &LumpedModel, time_s: &[f64]) -> Vec<f64> {
        let forgets = base.relaxation_rate_per_s;
        let nearest = 1e-6 * self.rate.max(forgets).max(self.scales.longest_s.recip());
        // One that fades as fast as the strip forgets is the limit of those beside it.
        let apart = Some(self.rate - forgets)
            .filter(|apart| apart.abs() > nearest)
            .unwrap_or(nearest);
        let kept = self.relaxed(run, forgets, time_s);
        let passed = self.relaxed(run, forgets + apart, time_s);
        let alpha = base.charge_to_curvature_per_c_cm;
        let bent = kept
            .iter()
            .zip(&passed)
            .map(|(kept, passed)| alpha * (kept - passed) / apart);
        self.by_clock(bent.collect(), time_s)
    }

    fn by_clock(self, mut values: Vec<f64>, time_s: &[f64]) -> Vec<f64> {
        if self.by == By::Clock {
            let each = values.iter_mut().zip(time_s);
            each.for_each(|(value, time)| *value *= time / self.scales.longest_s);
        }
        values
    }

    /// The sum over all edges of their jumps, each fading at that rate since.
    fn relaxed(self, run: &GroupRun, rate: f64, time_s: &[f64]) -> Vec<f64> {
        let drive = run.drive();
        let of = |volts: f64| self.by.of(volts, self.scales.largest_v);
        let (mut level, mut sum, mut since_s) = (of(drive.baseline_v), 0.0, 0.0);
        let mut edges = drive.levels().peekable();
        // Before the first edge nothing fades, however long.
        let faded = |sum: f64, passed_s: f64| sum * (-rate * passed_s.max(0.0)).exp();
        let at = |&time: &f64| {
            while let Some((edge_s, volts)) = edges.next_if(|(edge_s, _)| *edge_s <= time) {
                // An open circuit drives nothing new.
                let next = volts.map_or(level, of);
                sum = faded(sum, edge_s - since_s) + next - level;
                (level, since_s) = (next, edge_s);
            }
            faded(sum, time - since_s)
        };
        time_s.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{FOUR, Runs};

    fn scales() -> Scales {
        Scales {
            longest_s: 1000.0,
            shortest_s: 1e-3,
            largest_v: 2.0,
        }
    }

    /// Against small steps of what a stored current bends, which is forgotten meanwhile.
    #[test]
    fn a_stored_current_bends_as_the_strip_forgets() {
        let runs = Runs::with(None, FOUR, 5);
        let inputs = runs.inputs();
        let group = RunGroup::new(&inputs);
        let scales = scales();
        let mut base = crate::tests::base();
        for (rate, forgets) in [(0.05, 0.004), (0.0, 0.0), (0.01, 0.01), (0.0, 0.02)] {
            base.relaxation_rate_per_s = forgets;
            let relaxing = Relaxing {
                by: By::Voltage,
                rate,
                scales: &scales,
            };
            for run in &group.runs {
                let time_s: Vec<f64> = (-200..4000).map(|k| 0.1 * f64::from(k)).collect();
                let current = relaxing.over(run, &time_s);
                let bent = relaxing.bent(run, &base, &time_s);
                let (mut strain, mut most, mut worst) = (0.0, 0.0_f64, 0.0_f64);
                for (current, bent) in current.iter().zip(&bent) {
                    let expected = base.charge_to_curvature_per_c_cm * strain;
                    most = most.max(expected.abs());
                    worst = worst.max((bent - expected).abs());
                    strain += 0.1 * (current - forgets * strain);
                }
                assert!(worst < 0.02 * most, "{rate} {forgets}: {worst} of {most}");
            }
        }
    }

    /// Records that begin long before their first edge and are read fast: nothing overflows.
    #[test]
    fn a_long_rest_is_no_number_that_overflows() {
        let runs = Runs::with(None, FOUR, 5);
        let inputs = runs.inputs();
        let group = RunGroup::new(&inputs);
        let scales = scales();
        for rate in scales.rates(RELAXATIONS) {
            let relaxing = Relaxing {
                by: By::Clock,
                rate,
                scales: &scales,
            };
            let time_s = [-1e5, -1.0, 0.0, 1e-3, 10.0, 1e6];
            let all = relaxing.over(&group.runs[0], &time_s);
            let bent = relaxing.bent(&group.runs[0], &crate::tests::base(), &time_s);
            assert!(
                all.iter().chain(&bent).all(|v| v.is_finite()),
                "{rate}: {all:?} {bent:?}"
            );
            assert_eq!((all[0], bent[0]), (0.0, 0.0));
        }
    }
}
