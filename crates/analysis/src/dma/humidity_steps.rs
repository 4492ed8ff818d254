//! Humidity steps, found in the humidity itself: no time is given and none is assumed.
//!
//! The channel is cut into the stretches of constant level that describe it best (optimal partitioning with a price
//! for each cut, Jackson et al. 2005), neighbours that a sensor cannot tell apart are joined, and what lies on the
//! way from one level to the next belongs to the step. A humidity that changes all the time has no levels, and that
//! is said.

use super::policy::{
    AT_LEVEL, CUT_PRICE, DRIFT, FEWEST_POINTS_OF_LEVEL, LEAST_NOISE_PERCENT, LONGEST_CHANGE, MOST_POINTS,
    PASSAGE, SAME_HUMIDITY_PERCENT, STEP_TO_NOISE,
};

use ieap_domain::Edge;
use ieap_domain::Issue;
use ieap_domain::range_of;
use ieap_numerics::noise::local_scatter;
use ieap_numerics::robust::median;

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HumidityStep {
    /// Last reading at the level before, s.
    pub start_s: f64,
    /// Where the change began: from the last reading at the level before, or as long before it as a change that goes unnoticed
    /// takes, to the first reading that has left it.
    pub(crate) begun: Edge,
    /// First reading at the level after, s.
    pub settled_s: f64,
    /// Since when the level before has been held, s.
    pub held_from_s: f64,
    /// Until when the level after is held, s.
    pub held_until_s: f64,
    /// Level before, percent.
    pub before_percent: f64,
    /// Level after, percent.
    pub after_percent: f64,
}

/// Steps in order of time, or why none could be told.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HumiditySteps {
    /// The steps.
    pub steps: Vec<HumidityStep>,
    /// What a reader must know.
    pub issue: Option<Issue>,
}

/// A stretch of points with its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    first: usize,
    end: usize,
    mean: f64,
}

/// Finds the steps of a humidity channel: times, s, rising, and percent.
pub fn find(time_s: &[f64], percent: &[f64]) -> HumiditySteps {
    let points = Points::of(time_s, percent);
    let (scatter, long_run) = points.noise();
    let smallest = SAME_HUMIDITY_PERCENT.max(STEP_TO_NOISE * scatter);
    let price = CUT_PRICE * long_run * (points.level.len().max(2) as f64).ln();
    let mut stretches = partition(&points.level, price);
    join(&mut stretches, &points, smallest);
    drop_passages(&mut stretches, &points);
    let before = stretches.len();
    drop_drifting(&mut stretches, &points);
    // What a dropped stretch kept apart may be one level.
    join(&mut stretches, &points, smallest);
    let changes: Vec<HumidityStep> = stretches
        .windows(2)
        .map(|pair| points.step(time_s, percent, pair[0], pair[1], scatter))
        .collect();
    let between = (0..changes.len()).map(|at| between_neighbours(&changes, at));
    let steps: Vec<HumidityStep> = between.filter(is_step).collect();
    let issue = (stretches.len() < before || steps.len() < changes.len()).then(|| {
        Issue::note(
            "humidity-drifts",
            "parts of the humidity change all the time and hold no level; they belong to no step or to the way \
             between two levels",
        )
    });
    HumiditySteps { steps, issue }
}

/// The change with its levels cut off where the neighbouring changes begin and end.
fn between_neighbours(changes: &[HumidityStep], at: usize) -> HumidityStep {
    let mut step = changes[at];
    if at > 0 {
        step.held_from_s = step.held_from_s.max(changes[at - 1].settled_s);
    }
    if let Some(next) = changes.get(at + 1) {
        step.held_until_s = next.start_s;
    }
    step.held_until_s = step.held_until_s.max(step.settled_s);
    step
}

/// Whether a change is short against the levels that it leads between.
fn is_step(change: &HumidityStep) -> bool {
    let before_s = change.start_s - change.held_from_s;
    let after_s = change.held_until_s - change.settled_s;
    change.settled_s - change.start_s <= LONGEST_CHANGE * before_s.max(after_s)
}

/// The channel as at most [`MOST_POINTS`] points.
struct Points {
    level: Vec<f64>,
    /// Time of the first reading of each point, s, and at the end that of the last reading.
    edge_s: Vec<f64>,
    /// Readings of a point.
    block: usize,
}

impl Points {
    fn of(time_s: &[f64], percent: &[f64]) -> Points {
        let block = percent.len().div_ceil(MOST_POINTS).max(1);
        let mut edge_s: Vec<f64> = time_s.iter().step_by(block).copied().collect();
        edge_s.extend(time_s.last());
        Points {
            level: percent.chunks(block).map(middle).collect(),
            edge_s,
            block,
        }
    }

    /// Standard deviation of a point, and variance of a long sum per point.
    fn noise(&self) -> (f64, f64) {
        let least = LEAST_NOISE_PERCENT * LEAST_NOISE_PERCENT;
        let Some(scatter) = local_scatter(&[&self.level]) else {
            return (LEAST_NOISE_PERCENT, least);
        };
        let (variance, rho) = (scatter.standard_deviation.powi(2).max(least), scatter.correlation);
        let memory = ((1.0 + rho) / (1.0 - rho)).clamp(1.0, 50.0);
        (variance.sqrt(), variance * memory)
    }

    fn duration_s(&self, stretch: Stretch) -> f64 {
        self.edge_s[stretch.end] - self.edge_s[stretch.first]
    }

    /// How far the medians of a stretch's thirds lie apart.
    fn drift(&self, stretch: Stretch) -> f64 {
        let values = &self.level[stretch.first..stretch.end];
        let thirds = values.chunks(values.len().div_ceil(3)).map(middle);
        let (low, high) = range_of(thirds);
        high - low
    }

    /// The step between two levels, its ends to a reading.
    fn step(
        &self,
        time_s: &[f64],
        percent: &[f64],
        before: Stretch,
        after: Stretch,
        scatter: f64,
    ) -> HumidityStep {
        let range = |stretch: Stretch| {
            let end = (stretch.end * self.block).min(percent.len());
            stretch.first * self.block..end
        };
        let (before, after) = (range(before), range(after));
        let quarter = |length: usize| (length / 4).max(FEWEST_POINTS_OF_LEVEL).min(length);
        // Levels where they are left and reached: a slow drift within a level is no part of the step.
        let left = middle(&percent[before.end - quarter(before.len())..before.end]);
        let reached = middle(&percent[after.end - quarter(after.len())..after.end]);
        let done = |value: f64| (value - left) / (reached - left);
        let near = AT_LEVEL.max((3.0 * scatter / (reached - left).abs()).min(0.3));
        let (low, high) = (before.start, after.end);
        // Where the smoothed channel first passes half of the way, the way to the level before left out.
        let from = before.start + before.len() / 2;
        let half = (from..high)
            .find(|&k| done(middle(&percent[k.saturating_sub(1)..(k + 2).min(high)])) >= 0.5)
            .unwrap_or(after.start);
        let start = (low..half)
            .rev()
            .find(|&k| done(percent[k]) <= near)
            .unwrap_or(low);
        let settled = (half..high)
            .find(|&k| done(percent[k]) >= 1.0 - near)
            .unwrap_or(high - 1);
        HumidityStep {
            start_s: time_s[start],
            begun: Edge::between(
                time_s[start] - near * (time_s[settled] - time_s[start + 1]).max(0.0),
                time_s[start + 1],
            ),
            settled_s: time_s[settled],
            held_from_s: time_s[before.start],
            held_until_s: time_s[after.end - 1],
            before_percent: left,
            after_percent: reached,
        }
    }
}

/// The median; of no values not a number, which no threshold takes.
fn middle(values: &[f64]) -> f64 {
    median(values).unwrap_or(f64::NAN)
}

/// The cuts with the least sum of squares about the stretches' means plus `price` a stretch.
fn partition(level: &[f64], price: f64) -> Vec<Stretch> {
    let n = level.len();
    if n < 2 * FEWEST_POINTS_OF_LEVEL {
        return Vec::new();
    }
    // Sums from the first level, so that differences of sums keep their digits.
    let mut sums = vec![(0.0, 0.0)];
    for value in level {
        let (sum, square) = sums[sums.len() - 1];
        let off = value - level[0];
        sums.push((sum + off, square + off * off));
    }
    let cost = |first: usize, end: usize| {
        let (sum, square) = (sums[end].0 - sums[first].0, sums[end].1 - sums[first].1);
        (square - sum * sum / (end - first) as f64).max(0.0)
    };
    let mut best = vec![(f64::INFINITY, 0); n + 1];
    best[0].0 = 0.0;
    for end in FEWEST_POINTS_OF_LEVEL..=n {
        for first in 0..=end - FEWEST_POINTS_OF_LEVEL {
            let total = best[first].0 + cost(first, end) + price;
            if total < best[end].0 {
                best[end] = (total, first);
            }
        }
    }
    let mut stretches = Vec::new();
    let mut end = n;
    while end > 0 {
        let first = best[end].1;
        let mean = level[0] + (sums[end].0 - sums[first].0) / (end - first) as f64;
        stretches.push(Stretch { first, end, mean });
        end = first;
    }
    stretches.reverse();
    stretches
}

/// Joins neighbours that differ by less than `smallest`, the closest first.
fn join(stretches: &mut Vec<Stretch>, points: &Points, smallest: f64) {
    loop {
        let differences = stretches
            .windows(2)
            .map(|pair| (pair[1].mean - pair[0].mean).abs());
        let closest = differences.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((at, difference)) = closest.filter(|(_, difference)| *difference < smallest) else {
            return;
        };
        debug_assert!(difference.is_finite());
        let (before, after) = (stretches[at], stretches.remove(at + 1));
        let level = &points.level[before.first..after.end];
        let (a, b) = (
            (before.end - before.first) as f64,
            (after.end - after.first) as f64,
        );
        let is_whole = before.end == after.first;
        stretches[at] = Stretch {
            first: before.first,
            end: after.end,
            mean: if is_whole {
                level.iter().sum::<f64>() / level.len() as f64
            } else {
                (a * before.mean + b * after.mean) / (a + b)
            },
        };
    }
}

/// Drops stretches that lie between the levels beside them and are short: the way from one to the other.
fn drop_passages(stretches: &mut Vec<Stretch>, points: &Points) {
    loop {
        let is_passage = |at: &usize| {
            let [before, here, after] = [at - 1, *at, at + 1].map(|k| stretches[k]);
            let between = (here.mean - before.mean) * (after.mean - here.mean) > 0.0;
            let longer = points.duration_s(before).max(points.duration_s(after));
            between && points.duration_s(here) < PASSAGE * longer
        };
        let inner = 1..stretches.len().saturating_sub(1);
        let shortest = inner.filter(is_passage).min_by(|&a, &b| {
            points
                .duration_s(stretches[a])
                .total_cmp(&points.duration_s(stretches[b]))
        });
        match shortest {
            Some(at) => drop(stretches.remove(at)),
            None => return,
        }
    }
}

/// Drops stretches that drift about as far as the steps beside them: a ramp cut into pieces.
fn drop_drifting(stretches: &mut Vec<Stretch>, points: &Points) {
    let step = |a: Stretch, b: Stretch| (b.mean - a.mean).abs();
    let kept = (0..stretches.len()).filter(|&at| {
        let here = stretches[at];
        let before = (at > 0).then(|| step(stretches[at - 1], here));
        let after = stretches.get(at + 1).map(|&next| step(here, next));
        let smaller = before.into_iter().chain(after).fold(f64::INFINITY, f64::min);
        points.drift(here) <= DRIFT * smaller
    });
    *stretches = kept.map(|at| stretches[at]).collect();
}

#[cfg(test)]
#[path = "humidity_steps_tests.rs"]
mod tests;
