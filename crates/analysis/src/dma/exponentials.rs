//! Sums of one or two exponentials and a constant through the points of a stretch, and which the points allow.

use super::policy::{APART, FEWEST_FOR_RELAXATION, LONGEST_TIME_CONSTANT, MOST_POINTS, SECOND_GAIN};
use super::relaxation::Stretch;
use ieap_numerics::line::halved;
use ieap_numerics::linear::LeastSquares;
use ieap_numerics::sums::mean;

/// Trial time constants of one exponential, and of each of two.
const TRIALS: usize = 120;
const PAIR_TRIALS: usize = 28;
/// Directions in which two time constants are moved to find what the readings allow, and points on each.
const RAYS: u32 = 32;
const RAY_PARTS: u32 = 6;

/// What is fitted.
pub struct Points {
    /// Time since the step, s.
    pub since_s: Vec<f64>,
    /// Values at these times.
    pub values: Vec<f64>,
    shortest_s: f64,
    longest_s: f64,
}

/// Time constants, s, rising, with their least-squares solution: the asymptote first, then the amplitude of each at
/// the first point, so that a fast exponential keeps its digits.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Time constants, s.
    pub taus_s: Vec<f64>,
    /// The solution.
    pub fit: LeastSquares,
}

impl Points {
    /// The readings after the humidity has settled.
    ///
    /// # Errors
    /// There are too few.
    pub fn of(stretch: &Stretch<'_>) -> Result<Points, String> {
        let first = stretch.time_s.partition_point(|&t| t < stretch.settled_s);
        let end = stretch.time_s.partition_point(|&t| t <= stretch.end_s);
        let count = end.saturating_sub(first);
        if count < FEWEST_FOR_RELAXATION {
            return Err(format!(
                "{count} readings after the humidity has settled; {FEWEST_FOR_RELAXATION} are needed"
            ));
        }
        let block = count.div_ceil(MOST_POINTS);
        let times = stretch.time_s[first..end].chunks_exact(block);
        let since_s: Vec<f64> = times.map(|t| mean(t) - stretch.begun.middle_s()).collect();
        let length_s = since_s[since_s.len() - 1] - since_s[0];
        Ok(Points {
            shortest_s: length_s / since_s.len() as f64,
            longest_s: LONGEST_TIME_CONSTANT * length_s,
            values: stretch.values[first..end].chunks_exact(block).map(mean).collect(),
            since_s,
        })
    }

    /// The best single exponential, or the best two where they describe the points better.
    pub fn fitted(&self) -> Option<Trial> {
        let grid = |trials: usize| logarithmic(self.shortest_s, self.longest_s, trials);
        let spacing = |trials: usize| (self.longest_s / self.shortest_s).powf(1.0 / (trials as f64 - 1.0));
        let single = self.best(grid(TRIALS).iter().map(|&tau| vec![tau]))?;
        let single = self.refined(single, spacing(TRIALS));
        let taus = grid(PAIR_TRIALS);
        let pairs = (0..taus.len()).flat_map(|slow| (0..slow).map(move |fast| (fast, slow)));
        let double = self.best(pairs.map(|(fast, slow)| vec![taus[fast], taus[slow]]));
        let double = double.map(|trial| self.refined(trial, spacing(PAIR_TRIALS)));
        match double {
            Some(double) if is_better(&double, &single) => Some(double),
            _ => Some(single),
        }
    }

    /// Trials whose sum of squares is at most `most`, on rays from the best: to both sides of one time constant, to
    /// all sides of two, in coordinates in which the sum of squares is about as steep everywhere.
    pub fn allowed(&self, best: &Trial, most: f64) -> Vec<Trial> {
        let lengths: Vec<f64> = (0..best.taus_s.len())
            .map(|at| self.steepness(best, at, most))
            .collect();
        let directions: Vec<Vec<f64>> = match lengths.as_slice() {
            [only] => vec![vec![*only], vec![-only]],
            [fast, slow] => (0..RAYS)
                .map(|k| {
                    let angle = std::f64::consts::TAU * f64::from(k) / f64::from(RAYS);
                    vec![fast * angle.cos(), slow * angle.sin()]
                })
                .collect(),
            _ => Vec::new(),
        };
        directions
            .iter()
            .flat_map(|direction| self.along(best, direction, most))
            .collect()
    }

    /// Whether a time constant stands at the longest that is looked for.
    pub fn is_slowest(&self, trial: &Trial) -> bool {
        trial.taus_s.iter().any(|&tau_s| tau_s > 0.99 * self.longest_s)
    }

    /// What is left to the asymptote at a time since the step, s.
    pub fn rest(&self, trial: &Trial, since_s: f64) -> f64 {
        let terms = trial.taus_s.iter().zip(&trial.fit.coefficients[1..]);
        let term =
            |(tau_s, amplitude): (&f64, &f64)| amplitude * (-(since_s - self.since_s[0]) / tau_s).exp();
        terms.map(term).sum()
    }

    /// Amplitudes at the step itself, with their time constants, s.
    pub fn terms(&self, trial: &Trial) -> Vec<(f64, f64)> {
        let terms = trial.taus_s.iter().zip(&trial.fit.coefficients[1..]);
        let at_step =
            |(tau_s, amplitude): (&f64, &f64)| (amplitude * (self.since_s[0] / tau_s).exp(), *tau_s);
        terms.map(at_step).collect()
    }

    fn clamp(&self, tau_s: f64) -> f64 {
        tau_s.clamp(self.shortest_s, self.longest_s)
    }

    /// The solution with these time constants; none where two cannot be told apart.
    fn trial(&self, taus_s: Vec<f64>) -> Option<Trial> {
        if taus_s.windows(2).any(|pair| pair[1] < APART * pair[0]) {
            return None;
        }
        let mut columns = vec![vec![1.0; self.since_s.len()]];
        let decay = |tau_s: &f64| {
            let since = self.since_s.iter().map(|t| t - self.since_s[0]);
            since.map(|t| (-t / tau_s).exp()).collect()
        };
        columns.extend(taus_s.iter().map(decay));
        let fit = LeastSquares::of(columns, &self.values)?;
        Some(Trial { taus_s, fit })
    }

    fn best(&self, taus: impl Iterator<Item = Vec<f64>>) -> Option<Trial> {
        let trials = taus.filter_map(|taus| self.trial(taus));
        trials.min_by(|a, b| a.fit.square().total_cmp(&b.fit.square()))
    }

    /// The same with the time constants found between the trial values, which stand `factor` apart.
    fn refined(&self, mut found: Trial, mut factor: f64) -> Trial {
        while factor > 1.0 + 1e-5 {
            let mut is_still = true;
            for at in 0..found.taus_s.len() {
                for by in [1.0 / factor, factor] {
                    let mut taus = found.taus_s.clone();
                    taus[at] = self.clamp(taus[at] * by);
                    if let Some(other) = self.trial(taus)
                        && other.fit.square() < found.fit.square() * (1.0 - 1e-12)
                    {
                        (found, is_still) = (other, false);
                    }
                }
            }
            if is_still {
                factor = factor.sqrt();
            }
        }
        found
    }

    /// How far the logarithm of a time constant may move before the sum of squares exceeds `most`, about.
    fn steepness(&self, best: &Trial, at: usize, most: f64) -> f64 {
        let mut length = 1e-4;
        while length < 2.0 {
            let mut taus = best.taus_s.clone();
            taus[at] = self.clamp(taus[at] * f64::exp(length));
            if self.trial(taus).is_none_or(|trial| trial.fit.square() > most) {
                break;
            }
            length *= 1.5;
        }
        length
    }

    /// Allowed trials from the best to the last allowed one in a direction.
    fn along(&self, best: &Trial, direction: &[f64], most: f64) -> Vec<Trial> {
        let at = |length: f64| {
            let taus = best.taus_s.iter().zip(direction);
            let taus = taus
                .map(|(tau, d)| self.clamp(tau * (length * d).exp()))
                .collect();
            self.trial(taus).filter(|trial| trial.fit.square() <= most)
        };
        let (mut inside, mut outside) = (0.0, 0.25);
        while outside < 64.0 && at(outside).is_some() {
            (inside, outside) = (outside, 2.0 * outside);
        }
        (inside, _) = halved(inside, outside, 12, |length| at(length).is_some());
        let parts = (1..=RAY_PARTS).map(|k| inside * f64::from(k) / f64::from(RAY_PARTS));
        parts.filter_map(at).collect()
    }
}

fn is_better(double: &Trial, single: &Trial) -> bool {
    let gain = single.fit.square() - double.fit.square();
    // Two terms of opposite sign that all but cancel describe an overshoot that noise makes.
    let signs = double.fit.coefficients[1] * double.fit.coefficients[2];
    gain > SECOND_GAIN * double.fit.noise().long_run_variance() && signs > 0.0
}

/// Log-spaced values.
fn logarithmic(low: f64, high: f64, count: usize) -> Vec<f64> {
    let ratio = (high / low).ln() / (count as f64 - 1.0);
    (0..count).map(|k| low * (ratio * k as f64).exp()).collect()
}
