//! Least squares over all series at once, with derivatives by differences: the series is cheap and smooth.

use crate::numerics::correlation::{Autoregression, lag_one};
use crate::numerics::levenberg::{self, Local, Stop};
use crate::numerics::symmetric::{CAPACITY, Symmetric};

use super::readings::{Group, Kind, Readings};
use super::{DistributedInput, model_of, response};

/// Step of the differences in a logarithm: the error of second order is then about a part in 10^9.
const STEP: f64 = 3e-5;
/// Evaluations of one search.
const LIMIT: u64 = 120;
/// Half width of the box around a start, in logarithms.
const HALF_BOX: f64 = 16.0;
/// Rates of relaxation tried before the search.
const RATES: usize = 24;

/// A minimum with what its uncertainty needs.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Parameters at the minimum.
    pub at: Vec<f64>,
    /// Sum of squared residuals, each over its noise.
    pub square: f64,
    /// Covariance of the parameters, noise correlation and misfit allowed for.
    pub covariance: Symmetric,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Why the search stopped.
    pub stop: Stop,
    /// Evaluations that it took.
    pub evaluations: u64,
}

/// Predicts the series of a group from the parameters.
type Predict<'a> = Box<dyn Fn(&[f64], &Group) -> Vec<f64> + 'a>;

/// A least-squares problem: groups of series and what predicts them.
pub(super) struct Problem<'a> {
    groups: Vec<&'a Group>,
    parameters: usize,
    predict: Predict<'a>,
}

impl<'a> Problem<'a> {
    /// Voltages along the strip and the current against the electrical parameters.
    pub fn electrical(input: &'a DistributedInput<'a>, readings: &'a Readings) -> Problem<'a> {
        let groups = readings
            .groups
            .iter()
            .filter(|group| group.kind != Kind::Curvature)
            .collect();
        let parameters = if input.strip.electrode_resistance_ohm_per_sq.is_some() {
            3
        } else {
            4
        };
        let predict = move |at: &[f64], group: &Group| {
            response::predicted(&model_of(&input.strip, at, 0.0), input.drive, group)
        };
        Problem {
            groups,
            parameters,
            predict: Box::new(predict),
        }
    }

    /// Curvatures against mu (in units of `scale`) and the logarithm of lambda, the electrical ones fixed.
    fn mechanical(
        input: &'a DistributedInput<'a>,
        readings: &'a Readings,
        electrical: &'a [f64],
        scale: f64,
    ) -> Problem<'a> {
        let predict = move |at: &[f64], group: &Group| {
            let model = model_of(&input.strip, electrical, at[1].exp());
            let mut values = response::predicted(&model, input.drive, group);
            values.iter_mut().for_each(|value| *value *= at[0] * scale);
            values
        };
        Problem {
            groups: readings.of(Kind::Curvature).collect(),
            parameters: 2,
            predict: Box::new(predict),
        }
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Sum of squares at a place.
    pub fn square(&self, at: &[f64]) -> f64 {
        self.groups
            .iter()
            .map(|group| sum_of_squares(&self.residuals(at, group)))
            .sum()
    }

    /// Residuals of a group over the noise.
    pub fn residuals(&self, at: &[f64], group: &Group) -> Vec<f64> {
        let mut residuals = (self.predict)(at, group);
        let times = group.time_s.len();
        for (place, row) in residuals.chunks_exact_mut(times).enumerate() {
            let noise = group.noise[place];
            row.iter_mut()
                .zip(group.values[place].iter())
                .for_each(|(r, v)| *r = (v - *r) / noise);
        }
        residuals
    }

    fn local(&self, at: &[f64]) -> Local {
        let n = self.parameters;
        let mut local = Local {
            square: 0.0,
            descent: [0.0; CAPACITY],
            normal: Symmetric::zero(n),
        };
        for group in &self.groups {
            let residuals = self.residuals(at, group);
            let slopes = self.slopes(at, group);
            local.square += sum_of_squares(&residuals);
            for row in 0..n {
                local.descent[row] += dot(&slopes[row], &residuals);
                for column in 0..=row {
                    local.normal.set(
                        row,
                        column,
                        local.normal.get(row, column) + dot(&slopes[row], &slopes[column]),
                    );
                }
            }
        }
        local
    }

    /// Derivatives of the predictions over the noise, by central differences.
    fn slopes(&self, at: &[f64], group: &Group) -> Vec<Vec<f64>> {
        (0..self.parameters)
            .map(|k| {
                let moved = |by: f64| {
                    let mut place = at.to_vec();
                    place[k] += by;
                    self.residuals(&place, group)
                };
                let (up, down) = (moved(STEP), moved(-STEP));
                up.iter()
                    .zip(&down)
                    .map(|(up, down)| (down - up) / (2.0 * STEP))
                    .collect()
            })
            .collect()
    }

    /// Searches from `start` and forms the covariance at the minimum.
    pub fn search(&self, start: &[f64]) -> Fitted {
        let n = self.parameters;
        let low: Vec<f64> = start.iter().map(|x| x - HALF_BOX).collect();
        let high: Vec<f64> = start.iter().map(|x| x + HALF_BOX).collect();
        let found = levenberg::minimise(start, &low, &high, LIMIT, 1e-12, 0.0, |at| self.local(at));
        let at = found.at[..n].to_vec();
        let readings: f64 = self
            .groups
            .iter()
            .map(|group| (group.time_s.len() * group.values.len()) as f64)
            .sum();
        let freedom = (readings - n as f64).max(1.0);
        let inflation = self.long_run(&at, n) / freedom;
        let inverse = found.local.normal.floored_inverse(1e-13);
        let covariance = Symmetric::from_fn(n, |row, column| inverse.get(row, column) * inflation);
        Fitted {
            at,
            square: found.local.square,
            covariance,
            freedom,
            stop: found.stop,
            evaluations: found.evaluations,
        }
    }

    /// Sum over the series of the long-run variance of the residuals times their number of readings.
    fn long_run(&self, at: &[f64], parameters: usize) -> f64 {
        let series: usize = self.groups.iter().map(|group| group.values.len()).sum();
        let each = parameters as f64 / series.max(1) as f64;
        let mut total = 0.0;
        for group in &self.groups {
            let residuals = self.residuals(at, group);
            for row in residuals.chunks_exact(group.time_s.len()) {
                let square = sum_of_squares(row);
                let noise = Autoregression::from_sums(square, lag_one(row) * square, row.len() as f64, each);
                total += noise.long_run_variance().max(noise.variance) * row.len() as f64;
            }
        }
        total
    }
}

/// Phase 3 with the uncertainty of the phases before carried along: covariance of (mu, ln lambda).
#[derive(Debug, Clone)]
pub(super) struct Mechanical {
    /// mu, 1/C.
    pub mu_per_c: f64,
    /// The minimum in (mu / scale, ln lambda).
    pub fitted: Fitted,
    /// Scale of the first parameter, 1/C.
    pub scale: f64,
    /// Upper bound of lambda, 1/s, where it cannot be told from zero.
    pub rate_below_per_s: Option<f64>,
}

/// Phase 3.
pub(super) fn fit_mechanical(
    input: &DistributedInput,
    readings: &Readings,
    electrical: &Fitted,
) -> Mechanical {
    let duration_s = readings.duration_s();
    let shortest_s = readings
        .of(Kind::Curvature)
        .flat_map(|group| group.time_s.windows(2).map(|pair| pair[1] - pair[0]))
        .fold(duration_s, f64::min);
    let (low, high) = ((1e-4 / duration_s).ln(), (3.0 / shortest_s).ln());
    let problem = Problem::mechanical(input, readings, &electrical.at, 1.0);
    let rates = (0..RATES).map(|k| low + (high - low) * k as f64 / (RATES - 1) as f64);
    let tried = rates.map(|rate| {
        let mu = best_factor(&problem, rate);
        (problem.square(&[mu, rate]), mu, rate)
    });
    let Some((_, mu, rate)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Mechanical {
            mu_per_c: 0.0,
            fitted: problem.search(&[0.0, low]),
            scale: 1.0,
            rate_below_per_s: None,
        };
    };
    let scale = if mu == 0.0 { 1.0 } else { mu };
    let scaled = Problem::mechanical(input, readings, &electrical.at, scale);
    let mut fitted = scaled.search(&[1.0, rate]);
    carry_over(&mut fitted, &scaled, input, electrical, scale);
    let rate_below_per_s = bound_of_rate(&problem, &fitted, low);
    Mechanical {
        mu_per_c: fitted.at[0] * scale,
        fitted,
        scale,
        rate_below_per_s,
    }
}

/// The factor that fits best at a rate.
fn best_factor(problem: &Problem, rate: f64) -> f64 {
    let (mut cross, mut own) = (0.0, 0.0);
    for group in &problem.groups {
        let unit = (problem.predict)(&[1.0, rate], group);
        for (place, row) in unit.chunks_exact(group.time_s.len()).enumerate() {
            let weight = group.noise[place].powi(-2);
            cross += weight * dot(row, &group.values[place]);
            own += weight * sum_of_squares(row);
        }
    }
    if own > 0.0 { cross / own } else { 0.0 }
}

/// Adds what the uncertainty of the electrical parameters does to the mechanical ones: with J the slopes by the
/// mechanical and E those by the electrical parameters, the mechanical ones move by -(J'J)^-1 J'E.
fn carry_over(
    fitted: &mut Fitted,
    problem: &Problem,
    input: &DistributedInput,
    electrical: &Fitted,
    scale: f64,
) {
    let (mine, theirs) = (problem.parameters, electrical.at.len());
    let mut normal = Symmetric::zero(mine);
    let mut cross = vec![vec![0.0; theirs]; mine];
    for group in &problem.groups {
        let own = problem.slopes(&fitted.at, group);
        let by_theirs = Problem {
            groups: vec![group],
            parameters: theirs,
            predict: Box::new(|at: &[f64], group: &Group| {
                let model = model_of(&input.strip, at, fitted.at[1].exp());
                let mut values = response::predicted(&model, input.drive, group);
                values.iter_mut().for_each(|value| *value *= fitted.at[0] * scale);
                values
            }),
        }
        .slopes(&electrical.at, group);
        for row in 0..mine {
            for column in 0..=row {
                normal.set(
                    row,
                    column,
                    normal.get(row, column) + dot(&own[row], &own[column]),
                );
            }
            for (column, slope) in by_theirs.iter().enumerate() {
                cross[row][column] += dot(&own[row], slope);
            }
        }
    }
    let inverse = normal.floored_inverse(1e-13);
    let moves: Vec<Vec<f64>> = (0..mine)
        .map(|row| {
            (0..theirs)
                .map(|k| -(0..mine).map(|j| inverse.get(row, j) * cross[j][k]).sum::<f64>())
                .collect()
        })
        .collect();
    let carried = |row: usize, column: usize| electrical.covariance.form(&moves[row], &moves[column]);
    fitted.covariance = Symmetric::from_fn(mine, |row, column| {
        fitted.covariance.get(row, column) + carried(row, column)
    });
}

/// Largest rate whose sum of squares is within 95 % of that without relaxation, where the record does not tell
/// the rate from zero.
fn bound_of_rate(problem: &Problem, fitted: &Fitted, low: f64) -> Option<f64> {
    let best = |rate: f64| problem.square(&[best_factor(problem, rate), rate]);
    let per_reading = fitted.square / fitted.freedom;
    let limit = fitted.square + 3.84 * per_reading;
    if best(low) > limit {
        return None;
    }
    let (mut inside, mut outside) = (low, fitted.at[1].max(low) + 12.0);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if best(middle) <= limit {
            inside = middle
        } else {
            outside = middle
        }
    }
    Some(outside.exp())
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
