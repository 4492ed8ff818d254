//! How a current begins behind an edge that may lie before its first reading.
//!
//! The first readings are followed by a straight line, and by a line beside an exponential of every time constant that the
//! readings allow; each is followed back to every place at which the edge may lie. What they say is weighed by how well they
//! describe the readings (an average over models, Hoeting et al., Statistical Science 14, 382, 1999).

use ieap_numerics::linear::LeastSquares;
use ieap_numerics::sums::{self, mean};

use super::policy::{
    FASTER, FEWEST_TO_BEGIN, MOST_TO_BEGIN, MOST_UNSEEN, PLACES, READINGS_TO_BEGIN, RESOLVED, SEEN, SHORTEST,
    STRETCHES_TO_BEGIN, TOLD, TRIALS,
};

/// The reading to which the models tell the charge: from it on trapezia do.
const TO: usize = 2;

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

/// What the first readings may follow: a straight line, or one beside an exponential.
struct Model {
    tau_s: Option<f64>,
    fit: LeastSquares,
}

impl First<'_> {
    pub fn begun(&self) -> Begun {
        if self.time_s.len() < FEWEST_TO_BEGIN {
            return self.barely();
        }
        let x = self.since_first();
        let models = self.models(&x);
        let least = models.iter().map(|model| model.fit.square());
        let least = least.fold(f64::INFINITY, f64::min);
        let variance = (self.noise * self.noise * self.memory).max(least / (x.len() - 3) as f64);
        let (mut ampere, mut charge) = (Average::new(x.len()), Average::new(x.len()));
        let mut seen = Seen::default();
        for model in &models {
            let (places, share) = self.places(model);
            let chance = self.chance(model, least, variance) * share / places.len() as f64;
            for since_s in places.into_iter().filter(|_| chance > 0.0) {
                let (at_edge, area) = model.followed(since_s, x[TO], x[x.len() - 1]);
                ampere.add(chance, &model.fit, &at_edge);
                charge.add(chance, &model.fit, &area);
                seen.add(chance, model.tau_s);
            }
            ampere.weigh(&model.fit);
            charge.weigh(&model.fit);
        }
        let most_s = self.since_s.1;
        let (is_seen, is_over) = (seen.is_seen(most_s), seen.is_over(x[1]));
        Begun {
            ampere: ampere.known(),
            charge: charge.known(),
            to: TO,
            unseen: match (is_over, is_seen) {
                _ if most_s <= 0.0 => 0.0,
                (true, _) => self.step.signum() * f64::INFINITY,
                (false, true) => 0.0,
                (false, false) => self.unseen(),
            },
            is_seen: most_s <= 0.0 || is_seen && !is_over,
        }
    }

    /// Times of the readings that tell, s since the first one.
    fn since_first(&self) -> Vec<f64> {
        let t = self.time_s;
        let reach_s = t[0] + STRETCHES_TO_BEGIN * self.since_s.1;
        let count = t.partition_point(|t| *t <= reach_s);
        let count = count.clamp(READINGS_TO_BEGIN, MOST_TO_BEGIN).min(t.len());
        t[..count].iter().map(|own| own - t[0]).collect()
    }

    /// The models through the first readings; what relaxes does so the way of the step.
    fn models(&self, x: &[f64]) -> Vec<Model> {
        let (shortest_s, span_s) = (SHORTEST * x[1], x[x.len() - 1]);
        let trial_s = |k: usize| shortest_s * (span_s / shortest_s).powf(k as f64 / (TRIALS - 1) as f64);
        let model = |tau_s: Option<f64>| {
            let mut columns = vec![vec![1.0; x.len()], x.iter().map(|x| x / span_s).collect()];
            columns.extend(tau_s.map(|tau_s| x.iter().map(|x| (-x / tau_s).exp()).collect()));
            let fit = LeastSquares::of(columns, &self.amperes[..x.len()])?;
            Some(Model { tau_s, fit })
        };
        let trials = std::iter::once(None).chain((0..TRIALS).map(|k| Some(trial_s(k))));
        let follows = |model: &Model| model.amplitude().is_none_or(|own| own * self.step > 0.0);
        trials.filter_map(model).filter(follows).collect()
    }

    /// How likely a model is, beside the line that describes the readings as well.
    fn chance(&self, model: &Model, least: f64, variance: f64) -> f64 {
        let agrees = (-0.5 * (model.fit.square() - least) / variance.max(f64::MIN_POSITIVE)).exp();
        if model.tau_s.is_none() {
            return agrees;
        }
        // What an amplitude could have been before it was read, over what it may be now.
        let width = (variance * model.fit.inverse_diagonal(2) * std::f64::consts::TAU).sqrt();
        agrees * width / self.most().max(width) / TRIALS as f64
    }

    /// Most that the current may differ at the edge from that before it, A.
    fn most(&self) -> f64 {
        MOST_UNSEEN * self.step.abs().max(self.noise)
    }

    /// Places of the edge to which a model can be followed back, s before the first reading, and their share of all. Both ends
    /// are places: a clock that was started by the edge reads on it. Followed back an exponential grows.
    fn places(&self, model: &Model) -> (Vec<f64>, f64) {
        let (low_s, high_s) = self.since_s;
        let grown_s = |(tau_s, amplitude): (f64, f64)| tau_s * (self.most() / amplitude.abs()).ln();
        let far_s = model
            .tau_s
            .zip(model.amplitude())
            .map_or(high_s, grown_s)
            .min(high_s);
        if high_s <= low_s || far_s <= low_s {
            return (vec![low_s], f64::from(u8::from(far_s >= low_s)));
        }
        let place = |k: usize| low_s + (far_s - low_s) * k as f64 / (PLACES - 1) as f64;
        (
            (0..PLACES).map(place).collect(),
            (far_s - low_s) / (high_s - low_s),
        )
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

impl Model {
    fn amplitude(&self) -> Option<f64> {
        self.fit.coefficients.get(2).copied()
    }

    /// What of its coefficients make the current at an edge so long before the first reading, and the charge from there to
    /// `to_s` after it.
    fn followed(&self, since_s: f64, to_s: f64, span_s: f64) -> (Vec<f64>, Vec<f64>) {
        let mut at_edge = vec![1.0, -since_s / span_s];
        let mut area = vec![to_s + since_s, 0.5 * (to_s.powi(2) - since_s.powi(2)) / span_s];
        if let Some(tau_s) = self.tau_s {
            let grown = (since_s / tau_s).exp();
            at_edge.push(grown);
            area.push(tau_s * (grown - (-to_s / tau_s).exp()));
        }
        (at_edge, area)
    }
}

/// What the models together say of a relaxation.
#[derive(Default)]
struct Seen {
    straight: f64,
    curved: f64,
    /// Sums of the logarithm of the time constant and its square.
    logarithm: f64,
    square: f64,
}

impl Seen {
    fn add(&mut self, chance: f64, tau_s: Option<f64>) {
        match tau_s.map(f64::ln) {
            None => self.straight += chance,
            Some(logarithm) => {
                self.curved += chance;
                self.logarithm += chance * logarithm;
                self.square += chance * logarithm * logarithm;
            }
        }
    }

    fn is_curved(&self) -> bool {
        self.straight < SEEN * (self.straight + self.curved)
    }

    fn mean_s(&self) -> f64 {
        (self.logarithm / self.curved).exp()
    }

    /// Whether one is seen as it begins: one far slower than the stretch that nobody saw says nothing of what was in it.
    fn is_seen(&self, stretch_s: f64) -> bool {
        self.is_curved() && self.mean_s() < FASTER * stretch_s
    }

    /// Whether one is seen of which nothing tells how large it was: it is over at the second reading.
    fn is_over(&self, second_s: f64) -> bool {
        let mean = self.logarithm / self.curved;
        let spread = (self.square / self.curved - mean * mean).max(0.0).sqrt();
        self.is_curved() && spread > RESOLVED && self.mean_s() < second_s
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
        let value = sums::dot(&fit.coefficients, combination);
        // The running mean keeps the digits of a small scatter.
        let off = value - self.mean;
        self.chance += chance;
        self.mean += off * chance / self.chance;
        self.square += chance * off * (value - self.mean);
        sums::add(&mut self.combination, chance, combination);
    }

    /// The weights of the model whose places have been added.
    fn weigh(&mut self, fit: &LeastSquares) {
        let combination = std::mem::take(&mut self.combination);
        let weights = fit.weights(&combination[..fit.coefficients.len()]);
        sums::add(&mut self.weights, 1.0, &weights);
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
