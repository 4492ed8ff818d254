//! How a current begins behind an edge that may lie before its first reading.
//!
//! The first readings are followed by a straight line, and by a line beside an exponential of every time constant that the
//! readings allow; each is followed back to every place at which the edge may lie. What they say is weighed by how well they
//! describe the readings (an average over models, Hoeting et al., Statistical Science 14, 382, 1999).

use ieap_numerics::linear::LeastSquares;

use super::policy::{
    FASTER, FEWEST_TO_BEGIN, MOST_TO_BEGIN, MOST_UNSEEN, PLACES, READINGS_TO_BEGIN, RESOLVED, SEEN, SHORTEST,
    STRETCHES_TO_BEGIN, TOLD, TRIALS,
};

/// A number that is linear in the first readings of a level.
#[derive(Debug, Clone)]
pub(super) struct Known {
    pub value: f64,
    /// Standard deviation from where the edge lies and how fast the current falls.
    pub error: f64,
    /// Weights of the first readings.
    pub weights: Vec<f64>,
}

/// How a current begins.
#[derive(Debug, Clone)]
pub(super) struct Begun {
    /// The current at the edge, A.
    pub ampere: Known,
    /// The charge from the edge to the reading of the number `to`, C.
    pub charge: Known,
    pub to: usize,
    /// Most charge that may have passed before the first reading without a trace in it, C, with its sign: none where the
    /// readings show a relaxation as it begins, infinite where nothing bounds it.
    pub unseen: f64,
    /// Whether nothing faster than what is seen needs to be reckoned with at the edge.
    pub is_seen: bool,
}

/// The first readings of a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct First<'a> {
    pub time_s: &'a [f64],
    pub amperes: &'a [f64],
    /// How long before the first reading the edge lies at least and at most, s.
    pub since_s: (f64, f64),
    /// By how much the current differs from that before the edge, A.
    pub step: f64,
    /// Standard deviation of the noise, and how much more that of a long sum is.
    pub noise: f64,
    pub memory: f64,
}

impl First<'_> {
    pub fn begun(&self) -> Begun {
        let (t, i) = (self.time_s, self.amperes);
        if t.len() < FEWEST_TO_BEGIN {
            return self.barely();
        }
        let reach_s = t[0] + STRETCHES_TO_BEGIN * self.since_s.1;
        let count = t.partition_point(|t| *t <= reach_s);
        let count = count.clamp(READINGS_TO_BEGIN, MOST_TO_BEGIN).min(t.len());
        let x: Vec<f64> = t[..count].iter().map(|own| own - t[0]).collect();
        let span_s = x[count - 1];
        let to = 2;
        let columns = || vec![vec![1.0; count], x.iter().map(|x| x / span_s).collect()];
        let line = LeastSquares::of(columns(), &i[..count]);
        let shortest_s = SHORTEST * x[1];
        let tau_s = |k: usize| shortest_s * (span_s / shortest_s).powf(k as f64 / (TRIALS - 1) as f64);
        let beside = (0..TRIALS).filter_map(|k| {
            let mut columns = columns();
            columns.push(x.iter().map(|x| (-x / tau_s(k)).exp()).collect());
            Some((Some(tau_s(k)), LeastSquares::of(columns, &i[..count])?))
        });
        let models: Vec<(Option<f64>, LeastSquares)> =
            line.map(|line| (None, line)).into_iter().chain(beside).collect();
        let variance = self.noise * self.noise * self.memory;
        let least = models
            .iter()
            .map(|(_, fit)| fit.square())
            .fold(f64::INFINITY, f64::min);
        let variance = variance.max(least / (count - 3) as f64).max(f64::MIN_POSITIVE);
        let chance = |(tau_s, fit): &(Option<f64>, LeastSquares)| {
            let agrees = (-0.5 * (fit.square() - least) / variance).exp();
            let Some(_) = tau_s else { return agrees };
            // What an amplitude could have been before it was read, over what it may be now.
            let width = (variance * fit.inverse_diagonal(2) * std::f64::consts::TAU).sqrt();
            let most = MOST_UNSEEN * self.step.abs();
            let is_fall = fit.coefficients[2] * self.step > 0.0;
            agrees * (width / most.max(width)) * if is_fall { 1.0 } else { 0.0 } / TRIALS as f64
        };
        let (low_s, high_s) = self.since_s;
        let most = MOST_UNSEEN * self.step.abs().max(self.noise);
        let (mut ampere, mut charge) = (Average::new(count), Average::new(count));
        let (mut all, mut straight, mut logarithm) = (0.0, 0.0, (0.0, 0.0));
        for model in &models {
            let (tau_s, fit) = model;
            // Followed back an exponential grows: not beyond what the current can have been.
            let far_s = match tau_s {
                Some(tau_s) => high_s.min(tau_s * (most / fit.coefficients[2].abs()).ln()),
                None => high_s,
            };
            let share = if high_s > low_s {
                (far_s - low_s) / (high_s - low_s)
            } else {
                1.0
            };
            let places = if high_s > low_s { PLACES } else { 1 };
            let chance = chance(model) * share / places as f64;
            if chance <= 0.0 || far_s < low_s {
                continue;
            }
            for k in 0..places {
                // Both ends are places: a clock that was started by the edge reads on it.
                let since_s = low_s + (far_s - low_s) * k as f64 / (PLACES - 1) as f64;
                let mut at_edge = vec![1.0, -since_s / span_s];
                let mut area = vec![x[to] + since_s, 0.5 * (x[to].powi(2) - since_s.powi(2)) / span_s];
                if let Some(tau_s) = tau_s {
                    let grown = (since_s / tau_s).exp();
                    at_edge.push(grown);
                    area.push(tau_s * (grown - (-x[to] / tau_s).exp()));
                    logarithm.0 += chance * tau_s.ln();
                    logarithm.1 += chance * tau_s.ln().powi(2);
                } else {
                    straight += chance;
                }
                all += chance;
                ampere.add(chance, fit, &at_edge);
                charge.add(chance, fit, &area);
            }
            ampere.weigh(fit);
            charge.weigh(fit);
        }
        let straight = straight / all;
        let curved = (all * (1.0 - straight)).max(f64::MIN_POSITIVE);
        let (mean, square) = (logarithm.0 / curved, logarithm.1 / curved);
        let (mean_s, spread) = (mean.exp(), (square - mean * mean).max(0.0).sqrt());
        // A relaxation far slower than the stretch that nobody saw says nothing of what was in it; of one that is over at the
        // second reading nothing tells how large it was.
        let is_seen = straight < SEEN && mean_s < FASTER * high_s;
        let is_over = straight < SEEN && spread > RESOLVED && mean_s < x[1];
        Begun {
            ampere: ampere.known(),
            charge: charge.known(),
            to,
            unseen: match (is_over, is_seen) {
                _ if high_s <= 0.0 => 0.0,
                (true, _) => self.step.signum() * f64::INFINITY,
                (false, true) => 0.0,
                (false, false) => self.unseen(),
            },
            is_seen: high_s <= 0.0 || is_seen && !is_over,
        }
    }

    /// Of too few readings: the first one back to the edge, half known.
    fn barely(&self) -> Begun {
        let middle_s = 0.5 * (self.since_s.0 + self.since_s.1);
        let mut weights = vec![0.0; self.time_s.len()];
        weights[0] = 1.0;
        let first = self.amperes[0];
        Begun {
            ampere: Known {
                value: first,
                error: 0.5 * first.abs(),
                weights: weights.clone(),
            },
            charge: Known {
                value: first * middle_s,
                error: first.abs() * 0.5 * self.since_s.1,
                weights: weights.iter().map(|weight| weight * middle_s).collect(),
            },
            to: 0,
            unseen: self.unseen(),
            is_seen: self.since_s.1 <= 0.0,
        }
    }

    /// The charge of the largest exponential that has fallen below the noise when the first reading is made; without bound
    /// where the current is that of a resistor all the time, so that all that was stored passed unseen.
    fn unseen(&self) -> f64 {
        let (from, to) = self.amperes.split_at(self.amperes.len() / 2);
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let error = self.noise * (4.0 * self.memory / self.amperes.len() as f64).sqrt();
        if (mean(from) - mean(to)).abs() < TOLD * error {
            return self.step.signum() * f64::INFINITY;
        }
        let (most, left) = (MOST_UNSEEN * self.step.abs(), 2.0 * self.noise);
        if most <= left {
            return 0.0;
        }
        let tau_s = self.since_s.1 / (most / left).ln().max(1.0);
        most * tau_s * self.step.signum()
    }
}

/// A mean over models and places.
struct Average {
    chance: f64,
    mean: f64,
    square: f64,
    /// Of the coefficients of the model that is being added.
    combination: [f64; 3],
    weights: Vec<f64>,
}

impl Average {
    fn new(count: usize) -> Average {
        Average {
            chance: 0.0,
            mean: 0.0,
            square: 0.0,
            combination: [0.0; 3],
            weights: vec![0.0; count],
        }
    }

    fn add(&mut self, chance: f64, fit: &LeastSquares, combination: &[f64]) {
        let value = ieap_numerics::sums::dot(&fit.coefficients, combination);
        // The running mean keeps the digits of a small scatter.
        let off = value - self.mean;
        self.chance += chance;
        self.mean += off * chance / self.chance;
        self.square += chance * off * (value - self.mean);
        for (own, part) in self.combination.iter_mut().zip(combination) {
            *own += chance * part;
        }
    }

    /// The weights of the model whose places have been added.
    fn weigh(&mut self, fit: &LeastSquares) {
        let combination = std::mem::take(&mut self.combination);
        let weights = fit.weights(&combination[..fit.coefficients.len()]);
        for (own, weight) in self.weights.iter_mut().zip(weights) {
            *own += weight;
        }
    }

    fn known(self) -> Known {
        let chance = self.chance.max(f64::MIN_POSITIVE);
        Known {
            value: self.mean,
            error: (self.square / chance).max(0.0).sqrt(),
            weights: self.weights.iter().map(|weight| weight / chance).collect(),
        }
    }
}
