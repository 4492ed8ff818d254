//! The current of a run, and what of it flows over a level.

use std::sync::Arc;

use ieap_domain::{Channel, range_of};
use ieap_numerics::correlation::Autoregression;
use ieap_numerics::linear::{LeastSquares, variance_of_sum};
use ieap_numerics::local_parabola::MOST_GOES_ON;
use ieap_numerics::noise::{LocalScatter, local_scatter};
use ieap_numerics::robust::sd_on_a_slope;
use ieap_numerics::sums;

use super::begun::{Begun, First, Known};
use super::charge::Place;
use super::policy::{FEW_LEVELS, OF_CORRECTION, READINGS_TO_END};
use super::{Charge, Edge, Level};

/// Noise that no ammeter is below, as a share of its range.
const LEAST_NOISE: f64 = 1e-9;

/// The current with its noise.
pub(crate) struct Flow {
    time_s: Arc<[f64]>,
    amperes: Arc<[f64]>,
    noise: Autoregression,
    /// Shortest stretch in which an edge of the run lies, s; of those that are not known exactly.
    open_s: f64,
}

/// What is known of a level.
pub(crate) struct Told {
    pub charge: Charge,
    /// Its first reading, A.
    pub first: f64,
    pub begins: AtEdge,
    pub ends: AtEdge,
}

/// What is known of the current at an edge of a level, A.
pub(crate) struct AtEdge {
    pub ampere: f64,
    /// Standard deviation from the noise, and from where the edge lies.
    pub noise: f64,
    pub place: f64,
    /// Whether a faster current may have passed between the edge and the first reading.
    pub is_seen: bool,
}

impl Flow {
    /// Of a channel of currents under those levels; none of too few readings.
    ///
    /// Where levels are too short for anything smoother, the noise is that of second differences.
    pub fn of(channel: &Channel, levels: &[Option<Level>]) -> Option<Flow> {
        let (time_s, amperes) = channel.included();
        let (low, high) = range_of(amperes.iter().copied());
        let (sd, correlation) = match scatter(&time_s, &amperes, levels) {
            Some(scatter) => (
                scatter.standard_deviation,
                scatter.correlation.clamp(0.0, MOST_GOES_ON),
            ),
            None => (sd_on_a_slope(&amperes), 0.0),
        };
        (amperes.len() > 2).then(|| Flow {
            time_s,
            noise: Autoregression {
                variance: sd.max(LEAST_NOISE * (high - low)).powi(2),
                correlation,
            },
            amperes,
            open_s: (levels.iter().flatten())
                .map(|level| level.from.open_s())
                .filter(|open_s| *open_s > 0.0)
                .fold(f64::INFINITY, f64::min),
        })
    }

    fn place(&self, change: f64, edge: &Edge) -> Place {
        Place::of(change, (self.open_s / edge.open_s()).min(1.0))
    }

    /// When the current is first and last read, s.
    pub fn ends_s(&self) -> (f64, f64) {
        (self.time_s[0], self.time_s[self.time_s.len() - 1])
    }

    /// Standard deviation of a reading, A.
    pub fn noise(&self) -> f64 {
        self.noise.variance.sqrt()
    }

    fn readings(&self, level: &Level) -> (&[f64], &[f64]) {
        let range = level.readings(&self.time_s);
        (&self.time_s[range.clone()], &self.amperes[range])
    }

    /// How the current begins in a level; none without a reading.
    fn begun(&self, level: &Level) -> Option<Begun> {
        let (time_s, amperes) = self.readings(level);
        let since_s = |edge_s: f64| (time_s[0] - edge_s).max(0.0);
        if time_s.is_empty() {
            return None;
        }
        let before = level.from.readings_before(&self.time_s).checked_sub(1);
        let first = First {
            time_s,
            amperes,
            since_s: (since_s(level.from.no_later_s), since_s(level.from.no_earlier_s)),
            step: amperes[0] - before.map_or(0.0, |before| self.amperes[before]),
            noise: self.noise(),
            memory: self.noise.long_run_variance() / self.noise.variance,
        };
        Some(first.begun())
    }

    /// The charge of a level, and its current at both edges.
    ///
    /// # Errors
    /// The level has no reading.
    pub fn told(&self, level: &Level) -> Result<Told, &'static str> {
        let (t, i) = self.readings(level);
        let (Some(&first), Some(begun)) = (i.first(), self.begun(level)) else {
            return Err("a level has no reading of the current");
        };
        let to = begun.to;
        let middle = trapezia(&t[to..], &i[to..]);
        let (after, ends) = end(t, i, &level.until);
        let mut weights = vec![0.0; t.len()];
        let parts = [
            (0, &begun.charge),
            (to, &middle),
            (t.len() - after.weights.len(), &after),
        ];
        for (from, of) in parts {
            sums::add(&mut weights[from..], 1.0, &of.weights);
        }
        let charge = Charge {
            value: begun.charge.value + middle.value + after.value,
            noise: variance_of_sum(&weights, &self.noise).sqrt(),
            curvature: if t.len() > 3 {
                middle.error
            } else {
                0.5 * middle.value
            },
            edges: [
                self.place(-begun.charge.error * begun.ampere.value.signum(), &level.from),
                self.place(after.error * ends.value.signum(), &level.until),
            ],
            unseen: begun.unseen,
        };
        let at_edge = |known: Known, is_seen| AtEdge {
            ampere: known.value,
            noise: variance_of_sum(&known.weights, &self.noise).sqrt(),
            place: known.error,
            is_seen,
        };
        Ok(Told {
            charge,
            first,
            // How far to follow it back is known where the edge is.
            begins: at_edge(begun.ampere, begun.is_seen && level.from.open_s() <= 0.0),
            ends: at_edge(ends, true),
        })
    }

    /// The charge of a level.
    ///
    /// # Errors
    /// As of [`Flow::told`].
    pub fn charge(&self, level: &Level) -> Result<Charge, &'static str> {
        Ok(self.told(level)?.charge)
    }

    /// The charge from the third reading of a level to a time in it, C; none before that, and behind the last reading.
    pub fn since_third(&self, level: &Level) -> Cumulated<'_> {
        let (time_s, amperes) = self.readings(level);
        let from = 2.min(time_s.len());
        Cumulated::of(&time_s[from..], &amperes[from..])
    }

    /// The largest current of a level and its standard error: that of the first reading, where no later one is surely
    /// larger by `told` errors; the largest of many would be one of noise.
    pub fn largest(&self, level: &Level, told: f64) -> Option<(f64, f64)> {
        let (_, i) = self.readings(level);
        let largest = *i.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let is_later = largest.abs() > i[0].abs() + told * self.noise();
        Some((if is_later { largest } else { i[0] }, self.noise()))
    }
}

/// The noise of a channel under those levels: of many only of their later halves, where it is steady. None where they are too
/// short.
fn scatter(time_s: &[f64], values: &[f64], levels: &[Option<Level>]) -> Option<LocalScatter> {
    let later = if levels.len() > FEW_LEVELS { 2 } else { usize::MAX };
    let own = levels.iter().flatten().map(|level| level.readings(time_s));
    let stretches = own.map(|range| &values[range.start + range.len() / later..range.end]);
    let rest = levels
        .iter()
        .flatten()
        .next()
        .map_or(0, |first| first.from.readings_before(time_s));
    local_scatter(&stretches.chain([&values[..rest]]).collect::<Vec<_>>())
}

/// The charge from the last readings to the end of a level, and the current there.
fn end(t: &[f64], i: &[f64], until: &Edge) -> (Known, Known) {
    let line = Line::of(t, i);
    let (middle_s, error_s) = (until.middle_s() - t[t.len() - 1], until.standard_deviation_s());
    let square_s = middle_s * middle_s + error_s * error_s;
    let ampere = Known {
        value: line.last + line.slope * middle_s,
        error: (line.slope * error_s).abs(),
        weights: line.weights([1.0, middle_s]),
    };
    let charge = Known {
        value: line.last * middle_s + 0.5 * line.slope * square_s,
        error: ampere.value.abs() * error_s,
        weights: line.weights([middle_s, 0.5 * square_s]),
    };
    (charge, ampere)
}

/// A straight line through the last readings of a level, about the last one; a constant where they are too few.
struct Line {
    last: f64,
    slope: f64,
    fit: Option<LeastSquares>,
}

impl Line {
    fn of(t: &[f64], i: &[f64]) -> Line {
        let from = t.len().saturating_sub(READINGS_TO_END);
        let (last_s, t, i) = (t[t.len() - 1], &t[from..], &i[from..]);
        let columns = vec![vec![1.0; t.len()], t.iter().map(|own| own - last_s).collect()];
        let fit = (t.len() > 2).then(|| LeastSquares::of(columns, i)).flatten();
        let line = fit.as_ref().map(|fit| (fit.coefficients[0], fit.coefficients[1]));
        let (last, slope) = line.unwrap_or((i[i.len() - 1], 0.0));
        Line { last, slope, fit }
    }

    /// Weights of the last readings.
    fn weights(&self, combination: [f64; 2]) -> Vec<f64> {
        let constant = || vec![combination[0]];
        self.fit
            .as_ref()
            .map_or_else(constant, |fit| fit.weights(&combination))
    }
}

/// The integral over readings: trapezia, and what their curvature adds.
fn trapezia(t: &[f64], i: &[f64]) -> Known {
    let mut weights = vec![0.0; t.len()];
    for k in 1..t.len() {
        let half = 0.5 * (t[k] - t[k - 1]);
        weights[k - 1] += half;
        weights[k] += half;
    }
    let plain = ieap_numerics::sums::dot(&weights, i);
    let value = Cumulated::of(t, i).charge.last().copied().unwrap_or(0.0);
    Known {
        value,
        error: OF_CORRECTION * (value - plain),
        weights,
    }
}

/// The charge since a reading.
pub(crate) struct Cumulated<'a> {
    pub time_s: &'a [f64],
    amperes: &'a [f64],
    charge: Vec<f64>,
}

impl<'a> Cumulated<'a> {
    /// Trapezia with the corrections of Euler and Maclaurin: slopes are those of parabolas through three readings.
    fn of(time_s: &'a [f64], amperes: &'a [f64]) -> Cumulated<'a> {
        let (t, i) = (time_s, amperes);
        let rise = |k: usize| (i[k + 1] - i[k]) / (t[k + 1] - t[k]);
        let slope = |k: usize| {
            let last = t.len() - 1;
            // At the ends the parabola of the three readings there.
            let at = k.clamp(1, last - 1);
            let (before_s, after_s) = (t[at] - t[at - 1], t[at + 1] - t[at]);
            let bend = (rise(at) - rise(at - 1)) / (before_s + after_s);
            rise(at - 1) + bend * before_s + 2.0 * bend * (t[k] - t[at])
        };
        let mut charge = vec![0.0; t.len()];
        for k in 1..t.len() {
            let step_s = t[k] - t[k - 1];
            let bent = if t.len() > 2 { slope(k - 1) - slope(k) } else { 0.0 };
            charge[k] = charge[k - 1] + 0.5 * step_s * (i[k] + i[k - 1]) + step_s * step_s / 12.0 * bent;
        }
        Cumulated {
            time_s,
            amperes,
            charge,
        }
    }

    /// The charge at a time; none outside of the readings.
    pub fn at(&self, t: f64) -> Option<f64> {
        let after = self.time_s.partition_point(|own| *own < t);
        let own_s = *self.time_s.get(after)?;
        if own_s == t {
            return Some(self.charge[after]);
        }
        let before = after.checked_sub(1)?;
        let (step_s, x) = (own_s - self.time_s[before], t - self.time_s[before]);
        let (a, b) = (self.amperes[before], self.amperes[after]);
        let trapezium = a * x + 0.5 * (b - a) * x * x / step_s;
        let left = self.charge[after] - self.charge[before] - 0.5 * step_s * (a + b);
        Some(self.charge[before] + trapezium + left * x / step_s)
    }
}
